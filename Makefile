# exocarp: everything a newcomer needs is `make demo` and `make test`; both install what is missing.
#
#   make demo                       offset a generated model outward and inward, into ./out
#   make demo MODEL=path D=2%       the same for your own mesh
#   make demo MODEL=scan.ply ARGS="--sign pseudonormal"
#   make test                       all tests
#   make test-full                  also the long ones, in release
#   make bench                      each stage, and the whole beside OpenVDB's tools and MeshLib
#   make bench-report               measures all, and writes docs/benchmarks.md; QUICK=1: ten minutes
#   make pictures                   renders the pictures of README.md and docs/thicken.md
#   make instructions OLD=a NEW=b   two commits by instruction counts
#   make dist                       the program as it is published, in target/dist
#   make lint doc setup

SHELL := /bin/bash
.DEFAULT_GOAL := demo

# The model of the demo: a mesh file, or the name of a generated model.
MODEL ?= carved_cube
# The distance of the demo, in model units or with % of the diagonal; it goes both ways.
D ?= 2%
# More options for `exocarp offset`.
ARGS ?=

# What `make bench` compares with the peers, and the interpreter that may have meshlib.
BENCH_MODEL ?= anchor
BENCH_RESOLUTION ?= 256
PYTHON ?= python3
# What `make bench-report` measures: the program as it is published.
PROGRAM ?= target/dist/exocarp
# What `make instructions` compares.
OLD ?= HEAD~1
NEW ?= HEAD

.PHONY: setup setup-tests build dist demo test test-full lint bench bench-report pictures instructions doc clean

setup:
	@bash scripts/setup.sh

setup-tests:
	@bash scripts/setup.sh tests

# Quick to build.
build: setup
	cargo build --release --locked

# What is published, and what is measured: 4% to 6% faster, and twice as long to build.
dist: setup
	cargo build --profile dist --locked

demo: build
	@bash scripts/demo.sh '$(MODEL)' '$(D)' $(ARGS)

# Names at the end what was not run, and why; EXOCARP_MODELS=dir for the tests with models.
test: setup-tests
	@bash scripts/test.sh

test-full: setup-tests
	@EXOCARP_HEAVY=1 bash scripts/test.sh --profile heavy

lint: setup
	cargo fmt --check
	cargo clippy --all-targets --locked -- -D warnings

# Each stage, then the whole beside the peers, in turn; MeshLib if PYTHON can import it.
bench: dist
	cargo bench --locked
	@mkdir -p out
	target/dist/exocarp model '$(BENCH_MODEL)' -o out/bench.ply
	target/dist/exocarp compare out/bench.ply -d 2% --resolution $(BENCH_RESOLUTION) --runs 5 --once-above 25 \
	    --python '$(PYTHON)'

# Writes docs/benchmarks.md, what is beside it, and the figures of README.md from one run. The models
# are those of EXOCARP_MODELS, MeshLib is compared if PYTHON can import it.
bench-report: dist
	python3 scripts/bench_report.py $(if $(QUICK),--quick) --program '$(PROGRAM)' --python '$(PYTHON)'

pictures: build
	python3 scripts/pictures.py --program target/release/exocarp

# Instructions of two commits on a small case: make instructions OLD=HEAD~1 NEW=HEAD
instructions:
	@bash scripts/instructions.sh '$(OLD)' '$(NEW)'

doc: setup
	RUSTDOCFLAGS="-D warnings" cargo doc --no-deps --locked

clean:
	cargo clean
	rm -rf out

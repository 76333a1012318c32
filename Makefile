# exocarp: everything a newcomer needs is `make demo` and `make test`; both install what is missing.
#
#   make demo                       offset a generated model outward and inward, into ./out
#   make demo MODEL=path D=2%       the same for your own mesh
#   make demo MODEL=scan.ply ARGS="--sign pseudonormal"
#   make test                       all tests
#   make test-full                  also the long ones, in release
#   make lint bench doc setup

SHELL := /bin/bash
.DEFAULT_GOAL := demo

# The model of the demo: a mesh file, or the name of a generated model.
MODEL ?= carved_cube
# The distance of the demo, in model units or with % of the diagonal; it goes both ways.
D ?= 2%
# More options for `exocarp offset`.
ARGS ?=

.PHONY: setup build demo test test-full lint bench doc clean

setup:
	@bash scripts/setup.sh

build: setup
	cargo build --release --locked

demo: build
	@bash scripts/demo.sh '$(MODEL)' '$(D)' $(ARGS)

test: setup
	cargo test --locked

test-full: setup
	EXOCARP_HEAVY=1 cargo test --release --locked

lint: setup
	cargo fmt --check
	cargo clippy --all-targets --locked -- -D warnings

bench: setup
	cargo bench --locked

doc: setup
	RUSTDOCFLAGS="-D warnings" cargo doc --no-deps --locked

clean:
	cargo clean
	rm -rf out

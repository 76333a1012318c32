#!/usr/bin/env python3
"""Measures the engine and its peers, and writes docs/benchmarks.md and the pages beside it.

    make bench-report                        all models and peers; QUICK=1: ten minutes
    python3 scripts/bench_report.py --help   the options

Everything comes from one build on one machine, which the head of each page names. Results of a step
are kept in --work, by commit, so that a run that was interrupted goes on; --again measures anew.
The pages are docs/benchmarks.md, docs/compare, docs/paper-tables.md and the figures of README.md.
Needs Python 3 and nothing else; MeshLib is compared if --python can import it.
"""

import argparse
import datetime
import json
import os
import statistics
import subprocess
import sys
from pathlib import Path

import bench_pages
import noise

# The peers of a quick run: the quickest way of OpenVDB, and the only way that has creases.
QUICK_METHODS = "exocarp,openvdb-wide,meshlib-sharp"
# A method that takes longer than this, in seconds, runs once: its scatter is small enough.
ONCE_ABOVE = {True: "5", False: "25"}
# Distances of the table of costs at one resolution, besides those of all resolutions.
DISTANCES = ["1%", "4%", "8%", "16%", "32%"]


class Bench:
    """One run: the program, where results are kept, and how much is measured."""

    def __init__(self, options):
        self.options = options
        self.program = str(Path(options.program).resolve())
        mode = "tiny" if options.tiny else "quick" if options.quick else "full"
        self.commit = commit()
        self.work = Path(options.work).resolve() / f"{self.commit.replace(' ', '-')}-{mode}"
        self.work.mkdir(parents=True, exist_ok=True)
        self.runs = 1 if options.tiny else 3
        self.small = options.quick or options.tiny

    def scaled(self, resolution):
        """The resolution, or a coarse one for a test of this script."""
        return resolution // 8 if self.options.tiny else resolution

    def model(self, name):
        """The path of a model: a file of --models, or a generated one; None if there is none."""
        if self.options.models:
            for path in sorted(Path(self.options.models).glob(f"{name}.*")):
                return str(path)
        path = self.work / f"{name}.ply"
        if not path.exists():
            made = [self.program, "model", name, "-o", str(path), "--quiet"]
            if subprocess.run(made, stderr=subprocess.DEVNULL).returncode != 0:
                return None
        return str(path)

    def kept(self, name, make):
        """The result of a step: from the last run of the same commit, or made now."""
        path = self.work / f"{name}.json"
        if not path.exists() or self.options.again:
            print(f"{datetime.datetime.now():%H:%M:%S} {name}", file=sys.stderr, flush=True)
            path.write_text(json.dumps(make()))
        return json.loads(path.read_text())

    def command(self, *arguments):
        """Runs the program; what it says on stderr is shown when it fails."""
        done = subprocess.run(
            [self.program, *map(str, arguments)], cwd=self.work, capture_output=True, text=True
        )
        if done.returncode not in (0, 6):
            raise SystemExit(
                f"bench_report: {' '.join(map(str, arguments))}: {done.stderr.strip()}"
            )

    def timed(self, *arguments, runs=None):
        """Medians of a command that writes statistics."""
        found = []
        for _ in range(runs or self.runs):
            self.command(*arguments, "--stats", "stats.json", "--quiet")
            found.append(json.loads((self.work / "stats.json").read_text()))
        return median(found)


def commit():
    """The commit that is measured, and whether the tree differs from it."""
    git = lambda *words: subprocess.run(
        ["git", *words], capture_output=True, text=True
    ).stdout.strip()
    changed = git(
        "status",
        "--porcelain",
        "--untracked-files=no",
        "--",
        "src",
        "cpp",
        "Cargo.toml",
        "Cargo.lock",
    )
    return (git("rev-parse", "--short=10", "HEAD") or "unknown") + (" changed" if changed else "")


def median(found):
    """The medians of times and memory over several runs, and counts of the last run."""
    middle = lambda value: statistics.median(value(f) for f in found)
    last = found[-1]
    phases = {name: middle(lambda f, name=name: f["phases"][name]) for name in last["phases"]}
    engine = lambda f: sum(
        t for name, t in f["phases"].items() if name not in ("load", "clean", "write")
    )
    contour = last.get("contour") or {}
    return {
        "phases": phases,
        "engine": middle(engine),
        "range": [min(map(engine, found)), max(map(engine, found))],
        "wall": middle(lambda f: f["wall"]),
        "memory": middle(lambda f: f["peak_rss"]),
        "input": last["input"]["triangles"],
        "triangles": contour.get("triangles"),
        "jumps": (last.get("edges") or {}).get("sign_jumps"),
        "crossed": (last.get("edges") or {}).get("intersected"),
        "slabs": last.get("slabs"),
        "voxel": last["settings"]["voxel"],
        "new": (last.get("triangles") or {}).get("new"),
        "runs": len(found),
    }


def line(*command):
    """The first line that a command prints; nothing if it fails."""
    try:
        done = subprocess.run(command, capture_output=True, text=True)
    except OSError:
        return ""
    return done.stdout.strip().split("\n")[0] if done.returncode == 0 else ""


def machine(options):
    """Facts of the machine by which times are read; nothing that names it."""
    read = lambda path: Path(path).read_text() if Path(path).exists() else ""
    value = lambda text, key, by: next(
        (l.split(by, 1)[1].strip() for l in text.splitlines() if l.startswith(key)), ""
    )
    memory = value(read("/proc/meminfo"), "MemTotal", ":").split(" ")[0]
    meshlib = "import importlib.metadata as m; print(m.version('meshlib'))"
    return {
        "cpu": value(read("/proc/cpuinfo"), "model name", ":") or "processor unknown",
        "virtual": " hypervisor" in read("/proc/cpuinfo"),
        "cores": len(os.sched_getaffinity(0)),
        "memory": int(memory) / 1048576 if memory.isdigit() else 0.0,
        "system": value(read("/etc/os-release"), "PRETTY_NAME", "=").strip('"'),
        "rustc": line("rustc", "--version").split(" (")[0],
        "openvdb": line("dpkg-query", "-W", "-f", "${Version}", "libopenvdb-dev").split("-")[0],
        "meshlib": line(options.python, "-c", meshlib),
        "load": os.getloadavg()[0],
    }


def peers(bench):
    """Offsets beside other programs, by `exocarp compare`, which takes turns and judges all."""
    cases = [("carved_cube", "2%", 256), ("fandisk", "2%", 256), ("fandisk", "-2%", 256)]
    cases += [("armadillo", "2%", 256), ("armadillo", "-2%", 256)]
    cases += [("fandisk", "2%", 512), ("armadillo", "2%", 512)]
    if not bench.small:
        cases += [("fandisk", "-2%", 512), ("armadillo", "-2%", 512)]
        cases += [
            (name, d, n)
            for name in ("rocker-arm", "anchor_dense")
            for d in ("2%", "-2%")
            for n in (256, 512)
        ]
    if bench.options.tiny:
        cases = [("carved_cube", "2%", 256), ("anchor", "-2%", 256)]
    found = []
    for name, distance, resolution in cases:
        model = bench.model(name)
        if not model:
            continue
        step = f"compare-{name}{distance.strip('%')}-{resolution}"
        options = [
            "--distance=" + distance,
            "--resolution",
            bench.scaled(resolution),
            "--runs",
            bench.runs,
        ]
        options += [
            "--once-above",
            ONCE_ABOVE[bench.small],
            "--python",
            bench.options.python,
            "--threads",
            2,
        ]
        if bench.small:
            options += ["--methods", QUICK_METHODS]
        if (name, distance, resolution) in bench_pages.PICTURES:
            options += ["--report", step]

        def make(model=model, step=step, options=options):
            bench.command("compare", model, *options, "--json", f"{step}-all.json", "--quiet")
            return json.loads((bench.work / f"{step}-all.json").read_text())

        result = bench.kept(step, make)
        found.append(
            {
                "model": name,
                "distance": distance,
                "resolution": bench.scaled(resolution),
                "result": result,
            }
        )
        found[-1]["report"] = str(bench.work / step / "index.html")
    return found


def growth(bench):
    """How the cost grows with the resolution and the distance."""
    name = "carved_cube" if bench.options.tiny or not bench.model("armadillo") else "armadillo"
    resolutions = [256, 512, 1024] if bench.small else [128, 256, 512, 1024, 2048]
    cases = [("2%", n) for n in resolutions] + [(d, 512) for d in DISTANCES]
    rows = []
    for distance, resolution in cases:
        options = [
            "--distance=" + distance,
            "--resolution",
            bench.scaled(resolution),
            "--threads",
            2,
        ]
        make = lambda: bench.timed("offset", bench.model(name), *options, "-o", "out.ply")
        row = bench.kept(f"growth{distance.strip('%')}-{resolution}", make)
        rows.append(
            {"model": name, "distance": distance, "resolution": bench.scaled(resolution), **row}
        )
    return rows


def streaming(bench):
    """The same file at once and in slabs."""
    name = growth(bench)[0]["model"]
    resolution = bench.scaled(1024)
    rows = []
    for way, options in [("at once", []), ("in slabs", ["--stream", "--max-memory", "500M"])]:
        options = [
            bench.model(name),
            "--distance=2%",
            "--resolution",
            resolution,
            "--threads",
            2,
            *options,
        ]
        output = f"{way.replace(' ', '-')}.ply"

        def make(options=options, output=output):
            return bench.timed("offset", *options, "-o", output)

        rows.append(
            {
                "model": name,
                "way": way,
                "resolution": resolution,
                **bench.kept(f"stream-{output}", make),
            }
        )
    same = lambda: (
        (bench.work / "at-once.ply").read_bytes() == (bench.work / "in-slabs.ply").read_bytes()
    )
    return {"rows": rows, "same": bench.kept("stream-same", same)}


def threads(bench):
    """One thread and two: times, and whether the bytes are the same."""
    rows = []
    for name in ("fandisk", "armadillo") if not bench.options.tiny else ("carved_cube",):
        model = bench.model(name)
        if not model:
            continue
        for count in (1, 2):
            options = [
                model,
                "--distance=2%",
                "--resolution",
                bench.scaled(512),
                "--threads",
                count,
            ]
            output = f"threads-{name}-{count}.ply"
            make = lambda: bench.timed("offset", *options, "-o", output)
            rows.append(
                {"model": name, "threads": count, **bench.kept(f"threads-{name}-{count}", make)}
            )
        read = lambda count: (bench.work / f"threads-{name}-{count}.ply").read_bytes()
        rows[-1]["same"] = bench.kept(f"threads-{name}-same", lambda: read(1) == read(2))
    return rows


def noisy(bench):
    """A scan as it is, and cut finer with noise that folds its needles over one another."""
    name = "carved_cube" if bench.options.tiny else "dragon"
    model = bench.model(name)
    rows = []
    for cuts in (0, 1) if model else ():
        step = f"noisy-{name}-{cuts}"
        path = Path(model) if cuts == 0 else bench.work / f"{step}.ply"

        def make(path=path, cuts=cuts):
            if cuts:
                noise.write(Path(model), path, cuts)
            options = ["--distance=2%", "--sign", "pseudonormal"]
            more = ["--resolution", bench.scaled(512), "--threads", 2]
            row = bench.timed(
                "offset", path, *options, *more, "-o", "out.ply", runs=1 if bench.small else None
            )
            judge = ["--voxel", row["voxel"], "--quiet", "--json", "verify.json"]
            bench.command("verify", path, "out.ply", *options, *judge)
            row["report"] = json.loads((bench.work / "verify.json").read_text())
            return row

        rows.append(
            {"model": name, "cuts": cuts, "resolution": bench.scaled(512), **bench.kept(step, make)}
        )
    return rows


def thickening(bench):
    """Open patches made solid, by [WC13]."""
    cases = [("wave", "4%")]
    if not bench.options.tiny:
        cases += [(name, "4%") for name in ("face", "lion", "head")]
    rows = []
    for name, thickness in cases:
        model = bench.model(name)
        if not model:
            continue
        for resolution in (128, 256):
            options = [
                "-t",
                thickness,
                "--resolution",
                bench.scaled(resolution) * (4 if bench.options.tiny else 1),
            ]
            make = lambda: bench.timed(
                "thicken", model, *options, "--threads", 2, "-o", "solid.ply"
            )
            row = bench.kept(f"thicken-{name}-{resolution}", make)
            rows.append({"model": name, "thickness": thickness, "resolution": resolution, **row})
    return rows


def paper(bench):
    """The tables of [LW11] as the program prints them, on a coarser grid in a quick run."""
    options = ["--models", bench.options.models] if bench.options.models else []
    if bench.small:
        options += ["--resolution", 32 if bench.options.tiny else 128]

    def make():
        command = [bench.program, "paper", *map(str, options), "--threads", "2"]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout

    return bench.kept("paper", make)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--program", default="target/dist/exocarp", help="the program to measure"
    )
    parser.add_argument(
        "--models",
        default=os.environ.get("EXOCARP_MODELS"),
        help="a directory with fandisk, armadillo, ...",
    )
    parser.add_argument(
        "--python", default="python3", help="an interpreter that can import meshlib"
    )
    parser.add_argument("--work", default="out/bench", help="where results are kept, by commit")
    parser.add_argument("--docs", default="docs", help="where the pages go")
    parser.add_argument(
        "--readme", default="README.md", help="where the figures go; nowhere if empty"
    )
    parser.add_argument(
        "--quick", action="store_true", help="fewer cases and peers: within ten minutes"
    )
    parser.add_argument(
        "--tiny", action="store_true", help="a test of this script; the figures mean nothing"
    )
    parser.add_argument("--again", action="store_true", help="measure anew what is kept")
    options = parser.parse_args()
    bench = Bench(options)
    data = {
        "commit": bench.commit,
        "date": f"{datetime.date.today()}",
        "quick": bench.small,
        "runs": bench.runs,
        "machine": bench.kept("machine", lambda: machine(options)),
    }
    for step in (peers, growth, threads, streaming, noisy, thickening, paper):
        data[step.__name__] = step(bench)
    bench_pages.write(data, Path(options.docs))
    if not options.tiny and options.readme:
        bench_pages.write_figures(data, Path(options.readme))


if __name__ == "__main__":
    main()

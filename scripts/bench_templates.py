"""The prose of the pages that bench_pages.py writes."""

BENCHMARKS = """# Benchmarks

Written by `make bench-report` from one run; do not edit. `make bench-report QUICK=1` takes ten
minutes.

{head}

Figures of one page may be compared with each other, not with those of another machine or
day. *Engine* is wall time from the mesh in memory to the offset surface in memory: files are not in
it. *Memory* is the most that the process had resident. Errors are in voxels, by [`exocarp
verify`](verify.md): *mean* and *max* of | |distance to the input| - |d| | over the result,
*missing* the farthest that a point of the true offset surface is from the result, *creases* the
share of the true creases' length along which the result has an edge. Distances are in percent of
the input's diagonal, *voxels* those along the longest side of the result (`--resolution`). Models
beside the generated ones are public test models, found through `EXOCARP_MODELS`.

## Beside the peers

Every method gets the same cleaned mesh, distance, voxel size and threads, and a process of its own
for each run; the methods take turns. [compare/](compare/README.md) has all columns, and pictures.

```sh
exocarp compare MODEL -d D --resolution N --runs {runs} --once-above {once} --json figures.json
```

{times}

The results judged, all alike:

{quality}

## How the cost grows

The creases of a model are as many at every resolution, and each is recovered: so a triangle takes
less time where there are more of them.

```sh
exocarp offset MODEL -d D --resolution N --threads 2 -o out.ply --stats out.json
```

{growth}

## Threads

{threads}

## In slabs

```sh
exocarp offset MODEL -d 2% --resolution N --stream --max-memory 500M --threads 2 -o out.ply
```

{streaming}

## Noisy scans

A scan as it is, and with each triangle cut into four and a normal deviate of {deviate} of the
diagonal added to each coordinate (`scripts/noise.py`). The noise folds needles over one another, so
the sign by pseudonormals is wrong in places: such lattice edges are *jumps*, and no creases are
looked for there. The surface is closed by walls along them, so the mean of *missing* over the
faces of the scan says how near the result is. {single}

```sh
exocarp offset SCAN -d 2% --resolution N --sign pseudonormal --threads 2 -o out.ply --stats out.json
exocarp verify SCAN out.ply -d 2% --sign pseudonormal --json verify.json
```

{noisy}

## Thickening

```sh
exocarp thicken PATCH -t T --resolution N --threads 2 -o solid.ply --stats solid.json
```

{thickening}

## Stages

`make bench` times each stage on a generated model. `make instructions OLD=a NEW=b` compares two
commits by the instructions that a small offset takes: a change of one percent is seen there,
whatever else the machine does. [design-notes.md](design-notes.md) says what brought how much, and
what did not pay.
"""

COMPARE = """# The same offset with other programs

Written by `make bench-report` from one run; do not edit. `exocarp compare MODEL -d D --report out`
makes a page like this for one model, with more pictures.

{head}

- *OpenVDB wide band*: `meshToVolume` with a band of |D| + 3 voxels, `volumeToMesh` at D.
- *OpenVDB offset*: `meshToVolume` with 3 voxels, `LevelSetFilter::offset` with FIRST_BIAS and
  TVD_RK1 or HJWENO5_BIAS and TVD_RK3, `volumeToMesh`.
- *MeshLib*: `generalOffsetMesh`, standard or sharpening, signs from OpenVDB.
- *Memory* holds what was there before the method began: the program, its libraries and the input,
  for MeshLib the Python interpreter, too.
- [benchmarks.md](../benchmarks.md) says what the other columns are.

{cases}"""

PAPER = """# The tables of [LW11], measured here

Written by `make bench-report` from one run, as `exocarp paper --models DIR` prints them; do not
edit. The paper's figures stand beside ours. Most of its models are not public; each table says what
stands for them. [design-notes.md](design-notes.md#what-a-close-reading-of-lw11-shows) says what a
close reading shows.

{head}

```text
{tables}
```

[LW11]: paper-map.md#lw11-offsets
"""

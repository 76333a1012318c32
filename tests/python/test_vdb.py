"""Checks a .vdb file of exocarp with Python's OpenVDB, which is independent of exocarp's own reader.

usage: test_vdb.py FILE.vdb (--sphere RADIUS | --nodes FILE) --voxel H --half-width W --active N [--two-grids]

The file holds the level set of a sphere around the world origin, or one whose exact values at some nodes
are given, a line "i j k phi" each. It is the only grid unless there are two. Exits with
an AssertionError that says what is wrong.
"""

import argparse
import random
import struct

try:
    import pyopenvdb as vdb
except ImportError:
    import openvdb as vdb


def as_f32(x):
    return struct.unpack("f", struct.pack("f", x))[0]


def check_header(path, grid, args):
    """Name, class, background, transform, statistics and metadata: what programs ask first."""
    assert grid.name == "surface", grid.name
    assert grid.gridClass == vdb.GridClass.LEVEL_SET, grid.gridClass
    assert abs(grid.background - args.half_width * args.voxel) < 1e-6 * grid.background, grid.background
    assert grid.background >= as_f32(args.half_width * args.voxel), grid.background
    assert grid.transform.voxelSize() == (args.voxel,) * 3, grid.transform.voxelSize()
    assert grid.transform.indexToWorld((0, 0, 0)) == (0.0, 0.0, 0.0)
    assert grid.activeVoxelCount() == args.active, (grid.activeVoxelCount(), args.active)
    assert grid["file_voxel_count"] == args.active, grid["file_voxel_count"]
    low, high = grid.evalActiveVoxelBoundingBox()
    assert tuple(grid["file_bbox_min"]) == low, (grid["file_bbox_min"], low)
    assert tuple(grid["file_bbox_max"]) == high, (grid["file_bbox_max"], high)
    metadata = vdb.readMetadata(path)
    metadata = metadata if isinstance(metadata, dict) else dict(metadata.items())
    assert metadata["unit"] == "mm" and metadata["offset_distance"] == 0.5, metadata
    assert metadata["voxel_size"] == args.voxel and metadata["half_width"] == args.half_width, metadata
    assert metadata["creator"].startswith("exocarp"), metadata


def read_surface(path, two_grids):
    """The level set, by way of all that the file holds. The module knows no grids of integers: with one in the
    file it finds the level set by its name only."""
    if two_grids:
        return vdb.read(path, "surface")
    names = [grid.name for grid in vdb.readAllGridMetadata(path)]
    assert names == ["surface"], names
    grids, metadata = vdb.readAll(path)
    assert [grid.name for grid in grids] == ["surface"], grids
    assert metadata["creator"].startswith("exocarp"), metadata
    return grids[0]


def check_band(grid):
    """Active are exactly the nodes within the background; no tile is active."""
    active = inactive = 0
    for item in grid.iterOnValues():
        assert item.depth == 3, "an active tile"
        assert 0 < abs(item.value) < grid.background, item.value
        active += 1
    for item in grid.iterOffValues():
        assert abs(item.value) == grid.background, item.value
        inactive += 1
    assert active and inactive


def random_nodes(grid, radius, voxel):
    """1000 random nodes in and around the band of a sphere, with the analytic distance."""
    rng = random.Random(1)
    reach = int(1.5 * radius / voxel)
    for _ in range(1000):
        node = tuple(rng.randint(-reach, reach) for _ in range(3))
        position = grid.transform.indexToWorld(node)
        yield node, sum(c * c for c in position) ** 0.5 - radius


def nodes_of(path):
    """The nodes and values of a file."""
    for line in open(path):
        i, j, k, phi = line.split()
        yield (int(i), int(j), int(k)), float(phi)


def check_values(grid, nodes):
    """Signs, values and active states against exact ones."""
    accessor = grid.getConstAccessor()
    background = grid.background
    counts = {"inside": 0, "outside": 0, "band": 0}
    for node, exact in nodes:
        value, active = accessor.probeValue(node)
        assert (value < 0) == (exact < 0), (node, value, exact)
        clamped = max(-background, min(background, exact))
        assert abs(value - clamped) <= 1e-6 * background, (node, value, exact)
        assert active == (abs(value) < background), (node, value, active)
        counts["band" if active else "inside" if value < 0 else "outside"] += 1
    assert min(counts.values()) > 10, counts
    print(sum(counts.values()), "random nodes:", counts)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("file")
    parser.add_argument("--sphere", type=float)
    parser.add_argument("--nodes")
    parser.add_argument("--voxel", type=float, required=True)
    parser.add_argument("--half-width", type=float, required=True)
    parser.add_argument("--active", type=int, required=True)
    parser.add_argument("--two-grids", action="store_true")
    args = parser.parse_args()

    surface = read_surface(args.file, args.two_grids)
    check_header(args.file, surface, args)
    check_band(surface)
    given = nodes_of(args.nodes) if args.nodes else random_nodes(surface, args.sphere, args.voxel)
    check_values(surface, given)


if __name__ == "__main__":
    main()

"""Writes level sets and other grids with Python's OpenVDB, for exocarp to read.

usage: make_vdb.py FILE.vdb

All but the mask are of one sphere of radius 2.01 around node (0, 0, 0), with voxels of 0.1.
"""

import sys

try:
    import pyopenvdb as vdb
except ImportError:
    import openvdb as vdb


def sphere(name, transform=None):
    grid = vdb.createLevelSetSphere(radius=2.01, center=(0, 0, 0), voxelSize=0.1, halfWidth=3.0)
    grid.name = name
    if transform:
        grid.transform = transform
    return grid


def main():
    moved = vdb.createLinearTransform(voxelSize=0.1)
    moved.translate((1.0, -2.0, 0.5))
    turned = vdb.createLinearTransform(voxelSize=0.1)
    turned.rotate(0.3, vdb.Axis.Z)
    stretched = vdb.createLinearTransform([[0.1, 0, 0, 0], [0, 0.2, 0, 0], [0, 0, 0.1, 0], [0, 0, 0, 1]])
    fog = sphere("fog")
    fog.gridClass = vdb.GridClass.FOG_VOLUME
    mask = vdb.BoolGrid()
    mask.name = "mask"
    plain = sphere("plain")
    # A copy shares the tree, in the file as well.
    shared = plain.copy()
    shared.name = "shared"
    vdb.write(
        sys.argv[1],
        grids=[shared, plain, sphere("moved", moved), sphere("turned", turned),
               sphere("stretched", stretched), fog, mask],
    )


if __name__ == "__main__":
    main()

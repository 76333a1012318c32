"""Noisy scans for the benchmarks: models with finer triangles and noise on each coordinate."""

import random
import struct
from array import array

# The normal deviate of a coordinate, in diagonals. An eightieth of a voxel at resolution 512, it
# folds the needles of a fine scan over one another, which is what makes noisy scans hard.
DEVIATE = 2e-5
SEED = 1


def read(path):
    """Positions and triangles of an OBJ file, or of a binary PLY file with nothing but these."""
    data = path.read_bytes()
    if path.suffix == ".obj":
        lines = [line.split() for line in data.decode().splitlines()]
        positions = [tuple(map(float, w[1:4])) for w in lines if w and w[0] == "v"]
        return positions, [
            tuple(int(c.split("/")[0]) - 1 for c in w[1:4]) for w in lines if w and w[0] == "f"
        ]
    end = data.index(b"end_header\n") + len(b"end_header\n")
    vertices, faces = (
        int(l.split()[2]) for l in data[:end].decode().splitlines() if l.startswith("element")
    )
    form = "<3d" if b"property double x" in data[:end] else "<3f"
    middle = end + vertices * struct.calcsize(form)
    positions = list(struct.iter_unpack(form, data[end:middle]))
    triangles = struct.iter_unpack("<B3i", data[middle : middle + 13 * faces])
    return positions, [t[1:] for t in triangles]


def weld(positions, triangles):
    """One vertex for each position, and no triangle with two vertices at one."""
    numbers = {}
    new = [numbers.setdefault(p, len(numbers)) for p in positions]
    triangles = ((new[a], new[b], new[c]) for a, b, c in triangles)
    return list(numbers), [t for t in triangles if len(set(t)) == 3]


def cut(positions, triangles):
    """Each triangle in four, at the middles of its edges."""
    middles = {}

    def middle(a, b):
        key = (a, b) if a < b else (b, a)
        if key not in middles:
            middles[key] = len(positions)
            positions.append(tuple(0.5 * (x + y) for x, y in zip(positions[a], positions[b])))
        return middles[key]

    new = []
    for a, b, c in triangles:
        x, y, z = middle(a, b), middle(b, c), middle(c, a)
        new += [(a, x, z), (b, y, x), (c, z, y), (x, y, z)]
    return new


def write(model, path, cuts, deviate=DEVIATE):
    """Writes `model` as PLY to `path`, cut `cuts` times, with noise of `deviate` diagonals."""
    positions, triangles = weld(*read(model))
    for _ in range(cuts):
        triangles = cut(positions, triangles)
    sides = [max(c) - min(c) for c in zip(*positions)]
    sigma = deviate * sum(s * s for s in sides) ** 0.5
    gauss = random.Random(SEED).gauss
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(positions)}\n"
    header += "".join(f"property float {axis}\n" for axis in "xyz")
    header += f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    with open(path, "wb") as out:
        out.write(header.encode())
        array("f", (x + gauss(0.0, sigma) for p in positions for x in p)).tofile(out)
        triangle = struct.Struct("<B3i").pack
        out.write(b"".join(triangle(3, *t) for t in triangles))

#!/usr/bin/env python3
"""Renders the pictures of README.md and docs/thicken.md: make pictures.

The meshes come from the program, the pixels from a small rasteriser below: parallel projection, a
depth buffer, one light from the camera's shoulder, and dark lines along creases. Needs Python 3 and
nothing else.
"""

import argparse
import math
import struct
import subprocess
import tempfile
import zlib
from pathlib import Path

import noise

# Pixels of a panel's side, and samples for each along x and y.
SIDE, SAMPLES = 300, 2
# Seen from the right, above and in front: most models stand along y.
TOWARDS, UP = (0.55, 0.5, 0.75), (0.0, 1.0, 0.0)
LIGHT = (0.15, 0.75, 0.65)
# Edges sharper than this, in degrees, are drawn as creases.
CREASE = 35.0
# Twice a triangle's area by the square of its longest side, below which it counts as a sliver.
SLIVER = 0.2
# The colours of surfaces, of their backs, and of lines.
GREY, AMBER, BLUE, BACK, LINE = (
    (196, 202, 210),
    (236, 178, 96),
    (126, 178, 222),
    (214, 120, 100),
    (40, 44, 52),
)
WHITE = (255, 255, 255)
# Steps of brightness: few make small files.
STEPS = 40


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(dot(a, a)) or 1.0
    return (a[0] / length, a[1] / length, a[2] / length)


class Camera:
    """Sees a ball from `towards`, with `up` upwards, in a square picture."""

    def __init__(self, middle, radius, towards, up):
        self.z = unit(towards)
        self.x = unit(cross(up, self.z))
        self.y = cross(self.z, self.x)
        self.size = SIDE * SAMPLES
        self.middle, self.scale = middle, 0.5 * self.size / radius

    def sees(self, p):
        """Column, row and height of a point."""
        q = sub(p, self.middle)
        half = 0.5 * self.size
        return (
            half + self.scale * dot(q, self.x),
            half - self.scale * dot(q, self.y),
            self.scale * dot(q, self.z),
        )


def normals(positions, triangles):
    found = []
    for a, b, c in triangles:
        p = positions[a]
        found.append(unit(cross(sub(positions[b], p), sub(positions[c], p))))
    return found


def is_sliver(corners, positions):
    """Whether a triangle is too narrow for its normal to say where a crease is."""
    a, b, c = (positions[v] for v in corners)
    sides = [dot(s, s) for s in (sub(b, a), sub(c, b), sub(a, c))]
    n = cross(sub(b, a), sub(c, a))
    return math.sqrt(dot(n, n)) < SLIVER * max(sides)


def creases(positions, triangles, normal):
    """The edges along which two triangles meet at an angle, and those with one triangle."""
    first, sharp, limit = {}, [], math.cos(math.radians(CREASE))
    slivers = [is_sliver(corners, positions) for corners in triangles]
    for t, corners in enumerate(triangles):
        for k in range(3):
            a, b = corners[k], corners[(k + 1) % 3]
            other = first.pop((b, a), None)
            if other is None:
                first[(a, b)] = t
            elif dot(normal[t], normal[other]) < limit and not (slivers[t] or slivers[other]):
                sharp.append((a, b))
    return sharp + list(first)


def draw(mesh, colour, camera):
    """One panel: rows of colours, SAMPLES to a pixel along x and y."""
    positions, triangles = mesh
    size = camera.size
    depth = [-1e30] * (size * size)
    colours = [WHITE] * (size * size)
    normal = normals(positions, triangles)
    points = [camera.sees(p) for p in positions]
    light = unit(
        tuple(
            sum(LIGHT[k] * axis[i] for k, axis in enumerate((camera.x, camera.y, camera.z)))
            for i in range(3)
        )
    )
    for corners, n in zip(triangles, normal):
        front = dot(n, camera.z) >= 0.0
        towards = n if front else (-n[0], -n[1], -n[2])
        bright = 0.30 + 0.55 * max(dot(towards, light), 0.0) + 0.17 * dot(towards, camera.z)
        bright = round(min(bright, 1.0) * STEPS) / STEPS
        shade = tuple(int(c * bright) for c in (colour if front else BACK))
        fill(
            points[corners[0]], points[corners[1]], points[corners[2]], shade, size, depth, colours
        )
    for a, b in creases(positions, triangles, normal):
        stroke(points[a], points[b], size, depth, colours)
    return colours


def fill(a, b, c, shade, size, depth, colours):
    """Fills the samples whose middle lies in a triangle that is nearer than what is there."""
    area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    if area == 0.0:
        return
    xs, ys = (a[0], b[0], c[0]), (a[1], b[1], c[1])
    for row in range(max(math.ceil(min(ys) - 0.5), 0), min(math.floor(max(ys) + 0.5), size)):
        y = row + 0.5
        for column in range(max(math.ceil(min(xs) - 0.5), 0), min(math.floor(max(xs) + 0.5), size)):
            x = column + 0.5
            v = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area
            w = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area
            if v < 0.0 or w < 0.0 or v + w > 1.0:
                continue
            z = a[2] + v * (b[2] - a[2]) + w * (c[2] - a[2])
            at = row * size + column
            if z > depth[at]:
                depth[at] = z
                colours[at] = shade


def stroke(a, b, size, depth, colours):
    """Draws a line where nothing is more than two samples in front of it: it is on the surface."""
    steps = max(int(2.0 * max(abs(b[0] - a[0]), abs(b[1] - a[1]))), 1)
    for k in range(steps + 1):
        t = k / steps
        x, y, z = (a[i] + t * (b[i] - a[i]) for i in range(3))
        for row in (int(y - 0.5), int(y + 0.5)):
            for column in (int(x - 0.5), int(x + 0.5)):
                if 0 <= row < size and 0 <= column < size and z + 4.0 > depth[row * size + column]:
                    colours[row * size + column] = LINE


def pixels(colours):
    """The means of the samples of each pixel, with a few bits for each channel."""
    size = SIDE * SAMPLES
    rows = []
    for row in range(SIDE):
        line = []
        for column in range(SIDE):
            at = [
                (row * SAMPLES + i) * size + column * SAMPLES + j
                for i in range(SAMPLES)
                for j in range(SAMPLES)
            ]
            line.append(
                tuple(
                    min(sum(colours[k][c] for k in at) // len(at) + 2, 255) // 4 * 4 + 3
                    for c in range(3)
                )
            )
        rows.append(line)
    return rows


def png(panels):
    """Panels side by side as PNG."""
    rows = [sum((panel[row] for panel in panels), []) for row in range(SIDE)]
    raw = b"".join(b"\0" + bytes(c for pixel in row for c in pixel) for row in rows)
    chunk = lambda kind, data: (
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    )
    head = struct.pack(">IIBBBBB", SIDE * len(panels), SIDE, 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", head)
        + chunk(b"IDAT", zlib.compress(raw, 9))
        + chunk(b"IEND", b"")
    )


def around(meshes, towards, up=UP):
    """A camera that sees all meshes whole."""
    points = [p for positions, _ in meshes for p in positions]
    middle = tuple((min(c) + max(c)) / 2 for c in zip(*points))
    camera = Camera(middle, 1.0, towards, up)
    spread = lambda axis: [dot(sub(p, middle), axis) for p in points]
    ends = [end for axis in (camera.x, camera.y) for end in (min(spread(axis)), max(spread(axis)))]
    shift = [(ends[0] + ends[1]) / 2, (ends[2] + ends[3]) / 2]
    middle = tuple(middle[i] + shift[0] * camera.x[i] + shift[1] * camera.y[i] for i in range(3))
    return Camera(middle, 0.52 * max(ends[1] - ends[0], ends[3] - ends[2]), towards, up)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--program", default="target/release/exocarp", help="the program that makes the meshes"
    )
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory:

        def made(*arguments):
            path = Path(directory) / f"{len(list(Path(directory).iterdir()))}.ply"
            subprocess.run(
                [options.program, *map(str, arguments), "-o", path, "--quiet"], check=True
            )
            return path, noise.read(path)

        path, cube = made("model", "carved_cube")
        _, grown = made("offset", path, "-d", "5%", "--resolution", 96)
        _, shrunk = made("offset", path, "-d", "-5%", "--resolution", 96)
        camera = around([cube, grown], TOWARDS)
        panels = [(cube, GREY), (grown, AMBER), (shrunk, BLUE)]
        save("docs/offset.png", [draw(mesh, colour, camera) for mesh, colour in panels])

        path, wave = made("model", "wave")
        _, plate = made("thicken", path, "-t", "8%")
        camera = around([plate], (0.5, -0.75, 0.6), (0.0, 0.0, 1.0))
        panels = [(wave, GREY), (plate, AMBER)]
        save("docs/thicken/wave.png", [draw(mesh, colour, camera) for mesh, colour in panels])


def save(name, panels):
    data = png([pixels(panel) for panel in panels])
    Path(name).write_bytes(data)
    print(f"{name}: {len(data):,} bytes")


if __name__ == "__main__":
    main()

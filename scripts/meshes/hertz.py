#!/usr/bin/python3 -B
"""Writes the meshes of the Hertz problems as Gmsh 2.2 files, each with two bodies that touch in one point or line:

hertz-sphere.msh      `ball`, a quarter with a spherical underside of radius 50, on `block`; both 8 x 8 x 8 mm
hertz-cylinder.msh    `roller`, one layer with a cylindrical underside of radius 50, on `block`; both 12 x 6 x 1 mm
cattaneo-mindlin.msh  the same, with as many elements on both sides

      ________
     |  back  |            Elements are graded from the contact, whose radius a = 1 or half-width b = 0.2 has 8, 12 or
     |        |  sides     16 of them on the block; the upper body, whose surface is curved, has half of that or 16.
      \\______/  underside
     |  top   |            Volume groups are the names of the bodies; surface groups are `top` and `base` of the block,
     |  base  |            `underside` and `back` of the other, and `xmin` ... `ymax`, the sides of both.
"""

import math
import sys
from itertools import product
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, add_out, arguments, gmsh, written

BALL, A = 50.0, 1.0  # radius of the ball, and about that of the contact
ROLLER, B = 50.0, 0.2


def graded(first, length, count):
    """Places from 0 to `length`: elements that grow by a constant ratio, the first about as long as `first`."""
    places = lambda ratio: [first * sum(ratio**k for k in range(n)) for n in range(count + 1)]
    low, high = 1.0, 4.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if places(middle)[-1] < length else (low, middle)
    return [p * length / places(low)[-1] for p in places(low)]


def quarter(n, side):
    """Points and quadrilaterals of the quarter of a square: a rounded core of n x n elements up to the radius of
    contact, n/2 rings of the same width that become a circle, and rings that become the square."""
    rounded = lambda s, t: (A * s * math.sqrt(1 - t * t / 4), A * t * math.sqrt(1 - s * s / 4))
    points = [rounded(i / n, j / n) for j, i in product(range(n + 1), repeat=2)]
    quads = [[k, k + 1, k + n + 2, k + n + 1] for k in (j * (n + 1) + i for j, i in product(range(n), repeat=2))]
    rim = [j * (n + 1) + n for j in range(n + 1)] + [n * (n + 1) + i for i in range(n - 1, -1, -1)]
    far = graded(A / n, side - 1.5 * A, round(7 / 8 * n))
    rings = n // 2
    mix = lambda p, q, s: tuple(a + (b - a) * s for a, b in zip(p, q))
    columns = []
    for m, start in enumerate(rim):
        x, y = math.cos(math.pi * m / (4 * n)), math.sin(math.pi * m / (4 * n))
        circle, corner = (1.5 * A * x, 1.5 * A * y), (side * x / max(x, y), side * y / max(x, y))
        line = [mix(points[start], circle, k / rings) for k in range(1, rings + 1)]
        line += [mix(circle, corner, p / far[-1]) for p in far[1:]]
        columns.append([start, *range(len(points), len(points) + len(line))])
        points += line
    for inner, outer in zip(columns, columns[1:]):
        quads += [[inner[k], inner[k + 1], outer[k + 1], outer[k]] for k in range(len(inner) - 1)]
    return points, quads


def ball_body(n, _, way, sag, side=8.0):
    """A body of `ball_and_block` on the side `way` of the contact: points, hexahedra, points on its contact face."""
    flat, quads = quarter(n, side)
    levels = graded(A / n, side, round(1.25 * n))
    points = [(x, y, way * z + sag(math.hypot(x, y)) * (1 - z / side)) for z in levels for x, y in flat]
    layers = [[k * len(flat), (k + 1) * len(flat)][::way] for k in range(len(levels) - 1)]
    return points, [[s + q for s in ends for q in quad] for ends in layers for quad in quads], len(flat)


def roller_body(n, far, way, sag, side=6.0):
    """The same for a cylinder with its axis along z, with `far` elements on each side of those in the contact."""
    near = [k * B / n for k in range(round(1.25 * n))]
    half = near + [1.25 * B + p for p in graded(B / n, side - 1.25 * B, far)]
    xs = [-x for x in half[:0:-1]] + half
    levels = graded(B / n, side, round(4 / 3 * far))
    points = [(x, way * y + sag(x) * (1 - y / side), z) for y in levels for x in xs for z in (0.0, 1.0)]
    node = lambda i, j, k: k + 2 * (i + len(xs) * j)
    hexes = []
    for j, i in product(range(len(levels) - 1), range(len(xs) - 1)):
        around = ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))
        hexes.append([node(*at, k) for k in (0, 1)[::way] for at in around])
    return points, hexes, 2 * len(xs)


def groups(points, contact, names):
    """Sets of points by name: the contact face, the face beyond, and the sides."""
    found = {names[0]: set(range(contact)), names[1]: set(range(len(points) - contact, len(points)))}
    for axis, key in enumerate("xy" if "ball" in names else "x"):
        for end, at in (("min", min(p[axis] for p in points)), ("max", max(p[axis] for p in points))):
            found[key + end] = {n for n, p in enumerate(points) if p[axis] == at}
    return found


def bodies(n, far, share, body, upper, radius):
    """Bodies by name: points, hexahedra, groups. The upper one has `share` times the elements."""
    sag = lambda r: radius - math.sqrt(radius * radius - r * r)
    lower = body(n, far, -1, lambda r: 0.0)
    above = body(round(share * n), far, 1, sag)
    return {"block": (*lower[:2], groups(lower[0], lower[2], ("top", "base", upper))),
            upper: (*above[:2], groups(above[0], above[2], ("underside", "back", upper)))}


def main():
    parser = arguments(__doc__)
    parser.add_argument("--refine", type=float, default=1.0, metavar="F", help="times the elements, 0.5 or more (1)")
    add_out(parser, INPUTS)
    args = parser.parse_args()
    sizes = [4 * round(2 * args.refine), 4 * round(3 * args.refine), 4 * round(4 * args.refine)]
    far = round(12 * args.refine)
    if min(sizes) < 4:
        parser.error("F is 0.5 or more")
    for name, problem in {
        "hertz-sphere": bodies(sizes[0], far, 0.5, ball_body, "ball", BALL),
        "hertz-cylinder": bodies(sizes[1], far, 0.5, roller_body, "roller", ROLLER),
        "cattaneo-mindlin": bodies(sizes[2], far, 1.0, roller_body, "roller", ROLLER),
    }.items():
        written(args.out / f"{name}.msh").write_text(gmsh.of_bodies(problem))


if __name__ == "__main__":
    main()

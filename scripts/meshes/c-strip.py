#!/usr/bin/python3 -B
"""Writes a hairpin of an elastic strip, 2 mm thick, whose legs end in lips that curl outwards, as a Gmsh 2.2 mesh:
68 x 3 hexahedra in one layer, z from 0 to 1 mm, symmetric about y = 0.

          leg-top     lip-top    .
      .-------v----------v------'    lip: radius 4 of the middle line, 50 degrees, 4 elements
     /  _______________________.     leg: 16 mm, 20 elements
    |  |
    |  |     inside                  bend: radius 5 of the middle line, 20 elements
    |  |_______________________
     \\                         .
      '-------^----------^------.
          leg-bottom  lip-bottom

The volume group is `strip`; surface groups are `inside`, `outside`, `tips` and `skin` (all three). Groups of lines
across the outside are `leg-top` and `leg-bottom` at x = 4.8, `lip-top` and `lip-bottom` at x = 14.4, and `bend` at
y = 0; `cut` has the lines of the whole section at y = 0.
"""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, add_out, arguments, gmsh, written

RADIUS, THICKNESS, LEG, LIP, CURL = 5.0, 2.0, 16.0, 4.0, math.radians(50)
BEND, ALONG, TIP, LAYERS = 10, 20, 4, 3
HALF = BEND + ALONG + TIP


def upper():
    """Points of the middle line with their unit normals to the outside, from the bend to the tip."""
    for i in range(BEND):
        a = math.pi - math.pi / 2 * i / BEND
        yield (RADIUS * math.cos(a), RADIUS * math.sin(a) if i else 0.0), (math.cos(a), math.sin(a) if i else 0.0)
    for i in range(ALONG):
        yield (LEG * i / ALONG, RADIUS), (0.0, 1.0)
    for i in range(TIP + 1):
        a = CURL * i / TIP
        normal = (-math.sin(a), math.cos(a))
        yield (LEG - LIP * normal[0], RADIUS + LIP - LIP * normal[1]), normal


def mesh():
    """Gmsh 2.2 text; the node of section i, from the lower tip to the upper, in layer j from the inside, on plane k."""
    node = lambda i, j, k: 1 + k + 2 * (j + (LAYERS + 1) * i)
    half = list(upper())
    mirrored = [((x, -y), (n, -m)) for (x, y), (n, m) in reversed(half[1:])]
    points = []
    for (x, y), (n, m) in mirrored + half:
        for j in range(LAYERS + 1):
            s = THICKNESS * (j / LAYERS - 0.5)
            points += [(x + s * n, y + s * m, z) for z in (0.0, 1.0)]
    sections = 2 * HALF
    quad = lambda a, b: [node(*a, 0), node(*b, 0), node(*b, 1), node(*a, 1)]
    inside = [quad((i, 0), (i + 1, 0)) for i in range(sections)]
    outside = [quad((i + 1, LAYERS), (i, LAYERS)) for i in range(sections)]
    tips = [quad((0, j + 1), (0, j)) for j in range(LAYERS)]
    tips += [quad((sections, j), (sections, j + 1)) for j in range(LAYERS)]
    surfaces = {
        "inside": inside,
        "outside": outside,
        "tips": tips,
        "skin": inside + outside + tips,
    }
    across = lambda i: [node(i, LAYERS, 0), node(i, LAYERS, 1)]
    lines = {
        "cut": [[node(HALF, j, 0), node(HALF, j, 1)] for j in range(LAYERS + 1)],
        "bend": [across(HALF)],
        **{name + end: [across(HALF + sign * (BEND + at))]
           for end, sign in (("-top", 1), ("-bottom", -1)) for name, at in (("leg", 6), ("lip", 18))},
    }
    around = lambda i, j: ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))
    hexes = [[node(a, b, k) for k in (0, 1) for a, b in around(i, j)] for i in range(sections) for j in range(LAYERS)]
    groups = [(1, lines), (2, surfaces), (3, {"strip": hexes})]
    return gmsh.text(points, [(d, name, cell) for d, of in groups for name, cells in of.items() for cell in cells])


def main():
    parser = arguments(__doc__)
    add_out(parser, INPUTS / "c-strip.msh")
    written(parser.parse_args().out).write_text(mesh())


if __name__ == "__main__":
    main()

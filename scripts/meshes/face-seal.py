#!/usr/bin/python3 -B
"""Writes the section of an O-ring, a disc of 5.33 mm around (22.5, 0), as a Gmsh 2.2 mesh: a layer of hexahedra,
z from 0 to 0.4 mm, to be turned about the y axis.

       .--------.
      / \\  3   / \\      Five blocks: a core of N x N elements with N / 2 + 1 layers of N around each quarter.
     |   .----.   |     The volume group is `rubber`; surface groups are `outside`, all around, and `fluid`, the third
     | 2 | 0  | 1 |     that looks to the axis.
     |   '----'   |
      \\ /  4   \\ /
       '--------'
"""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, add_out, arguments, gmsh, written

CENTRE, RADIUS, DEPTH, N = 22.5, 5.33 / 2, 0.4, 12
CORE = 0.5  # its corners, over the radius


def mesh():
    """Gmsh 2.2 text."""
    points, number = [], {}

    def node(x, y, z):
        key = (round(x, 9), round(y, 9), z)
        if key not in number:
            number[key] = len(number) + 1
            points.append((CENTRE + x, y, z))
        return number[key]

    side = CORE * RADIUS / math.sqrt(2)
    # The sides of the core bulge by a part of the circle through its corners.
    core = lambda i, j: [side * (2 * i / N - 1) * (1 + 0.2 * (1 - (2 * j / N - 1) ** 2)),
                         side * (2 * j / N - 1) * (1 + 0.2 * (1 - (2 * i / N - 1) ** 2))]
    layers = N // 2 + 1

    def ring(quarter, i, k):
        """Place k of 0 to `layers`, from the core to the circle, at i of 0 to N along a quarter."""
        inner = {0: core(N, i), 1: core(N - i, N), 2: core(0, N - i), 3: core(i, 0)}[quarter]
        angle = math.pi / 2 * (quarter - 0.5 + i / N)
        outer = RADIUS * math.cos(angle), RADIUS * math.sin(angle)
        return [a + (b - a) * k / layers for a, b in zip(inner, outer)]

    column = lambda corners: [node(*corner, z) for z in (0.0, DEPTH) for corner in corners]
    hexes = [column([core(i, j), core(i + 1, j), core(i + 1, j + 1), core(i, j + 1)])
             for j in range(N) for i in range(N)]
    around = {}
    for quarter in range(4):
        for i in range(N):
            hexes += [column([ring(quarter, i, k), ring(quarter, i, k + 1), ring(quarter, i + 1, k + 1),
                              ring(quarter, i + 1, k)]) for k in range(layers)]
            a, b = ring(quarter, i, layers), ring(quarter, i + 1, layers)
            around.setdefault(quarter, []).append([node(*a, 0.0), node(*b, 0.0), node(*b, DEPTH), node(*a, DEPTH)])
    sixth = N // 6
    fluid = around[1][-sixth:] + around[2] + around[3][:sixth]
    surfaces = {"outside": sum(around.values(), []), "fluid": fluid}
    groups = [(2, surfaces), (3, {"rubber": hexes})]
    return gmsh.text(points, [(d, name, cell) for d, of in groups for name, cells in of.items() for cell in cells])


def main():
    parser = arguments(__doc__)
    add_out(parser, INPUTS / "face-seal.msh")
    written(parser.parse_args().out).write_text(mesh())


if __name__ == "__main__":
    main()

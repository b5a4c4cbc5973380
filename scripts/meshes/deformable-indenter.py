#!/usr/bin/python3 -B
"""Writes the elastic indenter of a frictional ironing problem as a Gmsh 2.2 mesh: hexahedra in one layer, z from 0 to
1 mm, with the volume group `indenter` and the surface groups `bottom` and `top`. Layers go from each point of the
underside straight to the top. SHAPE is one of

  fillets   16 x 7 elements: flat from x = 15 to 35, quarter fillets of radius 10 with 4 elements each, top
            at y = 40; `bottom` is the underside with the sides: inputs/ironing-indenter-elastic.msh
  arc       12 x 6 elements: an arc of radius 0.75 from x = 0.2 to 1.4 with its lowest point at y = 0.2, sides of 0.9
            above it; `bottom` is the underside with the sides: inputs/shallow-indenter.msh
  peers     14 x 8 elements: flat from x = 45 to 65, fillets of 60 degrees and radius 20 with 4 elements each, top at
            y = 30; `bottom` is the underside alone: inputs/peers-indenter.msh
"""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, arguments, gmsh, written


class Shape:
    """Points (x, y) of the underside from left to right, and what lies above them."""

    def __init__(self, file, underside, top, layers, sides):
        self.file, self.underside, self.top, self.layers, self.sides = file, underside, top, layers, sides
        self.columns = len(underside) - 1

    def point(self, i, j):
        (x, y), s = self.underside[i], j / self.layers
        left, right = self.underside[0][0], self.underside[-1][0]
        top = left + (right - left) * i / self.columns
        return x + (top - x) * s, y + (self.top - y) * s

    def strip(self):
        """Grid points along `bottom`, with the inside on the left hand."""
        under = [(i, 0) for i in range(self.columns + 1)]
        heights = range(1, self.layers + 1)
        left, right = [(0, j) for j in reversed(heights)], [(self.columns, j) for j in heights]
        return left + under + right if self.sides else under


def rounded(centre, flat, radius, angle, pieces, columns):
    """A flat underside at y = 0 with a fillet of so many pieces on either side."""
    turns = [math.radians(angle) * k / pieces for k in range(1, pieces + 1)]
    fillet = [(flat / 2 + radius * math.sin(a), radius - radius * math.cos(a)) for a in turns]
    left = [(centre - x, y) for x, y in reversed(fillet)]
    return (left + [(centre - flat / 2 + flat * i / columns, 0.0) for i in range(columns + 1)]
            + [(centre + x, y) for x, y in fillet])


def arc(ends, columns, radius, lowest):
    """An arc, with points at even distances along x."""
    centre = sum(ends) / 2
    points = [ends[0] + (ends[1] - ends[0]) * i / columns for i in range(columns + 1)]
    return [(x, lowest + radius - math.sqrt(radius**2 - (x - centre) ** 2)) for x in points]


SHAPES = {
    "fillets": Shape("ironing-indenter-elastic.msh", rounded(25.0, 20.0, 10.0, 90.0, 4, 8), 40.0, 7, True),
    "arc": Shape("shallow-indenter.msh", arc((0.2, 1.4), 12, 0.75, 0.2), 1.4, 6, True),
    "peers": Shape("peers-indenter.msh", rounded(55.0, 20.0, 20.0, 60.0, 4, 6), 30.0, 8, False),
}


def mesh(shape):
    """Gmsh 2.2 text; the node of column i in layer j on plane k."""
    columns, layers = shape.columns, shape.layers
    node = lambda i, j, k: 1 + k + 2 * (i + (columns + 1) * j)
    points = [(*shape.point(i, j), z) for j in range(layers + 1) for i in range(columns + 1) for z in (0.0, 1.0)]
    hexes = []
    for j in range(layers):
        for i in range(columns):
            around = ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))
            hexes.append([node(a, b, k) for k in (0, 1) for a, b in around])
    strip = lambda line: [[node(*a, 0), node(*b, 0), node(*b, 1), node(*a, 1)] for a, b in zip(line, line[1:])]
    top = strip([(i, layers) for i in range(columns, -1, -1)])
    cells = [(2, "bottom", q) for q in strip(shape.strip())] + [(2, "top", q) for q in top]
    return gmsh.text(points, cells + [(3, "indenter", h) for h in hexes])


def main():
    parser = arguments(__doc__)
    parser.add_argument("shape", nargs="?", choices=SHAPES, default="fillets", help="(%(default)s)")
    parser.add_argument("--out", type=Path, metavar="FILE", help="(the one of the shape in inputs)")
    args = parser.parse_args()
    shape = SHAPES[args.shape]
    written(args.out or INPUTS / shape.file).write_text(mesh(shape))


if __name__ == "__main__":
    main()

#!/usr/bin/python3 -B
"""Writes a rigid spherical cap, radius 20 mm, as a Gmsh 2.2 mesh: N x N quadrilaterals over the square [-10, 10]^2
of the xy-plane. Its lowest point is at z = 20; normals point down, out of the sphere."""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, add_out, arguments, gmsh, written

RADIUS, HALF_WIDTH, BOTTOM = 20.0, 10.0, 20.0


def mesh(n):
    """Gmsh 2.2 text; node (n + 1) j + i + 1 is column i of row j."""
    grid = [HALF_WIDTH * (2 * i / n - 1) for i in range(n + 1)]
    nodes = [(x, y, BOTTOM + RADIUS - math.sqrt(RADIUS**2 - x * x - y * y)) for y in grid for x in grid]
    corners = [(n + 1) * j + i + 1 for j in range(n) for i in range(n)]
    quads = [(c, c + n + 1, c + n + 2, c + 1) for c in corners]
    return gmsh.text(nodes, [(2, "cap", q) for q in quads])


def main():
    parser = arguments(__doc__)
    parser.add_argument("--facets", type=int, default=8, metavar="N", help="along each side (%(default)s)")
    add_out(parser, INPUTS / "sphere-cap.msh")
    args = parser.parse_args()
    if args.facets < 1:
        parser.error("N is 1 or more")
    written(args.out).write_text(mesh(args.facets))


if __name__ == "__main__":
    main()

#!/usr/bin/python3 -B
"""Writes the half disk of inputs/disk-in-plate.toml as a Gmsh 2.2 mesh: one layer of hexahedra, z from 0 to 1 mm,
radius 9.996 mm, so placed that it touches a bore of radius 10 mm about the origin at its lowest point. The rim has N
edges, as the bore has; rings lie around a core of N/4 x N/2 elements. Groups: the volume `disk`, the faces `rim` and
`axis` (x = 0), and the nodes `centre`.

     _
    | `-.     rings grow by 1.3 from the rim inwards
    |--. \\    the core is half of a square with bent sides, its nodes on rays to the nodes of the rim
    |  |  |
    o  |  |   centre (0, -0.004)
    |  |  |
    |--' /
    |_.-'
"""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, add_out, arguments, gmsh, written

BORE, CLEARANCE, GROWTH = 10.0, 0.004, 1.3
RADIUS = BORE - CLEARANCE


def core(u, v):
    """Half a square with bent sides, of tangents of angles u in [0, 1] and v in [-1, 1]: between square and circle."""
    square, bend = 0.34 * RADIUS, 0.435 * RADIUS
    return (u * (square + bend * math.sqrt(1 - v * v / 2)), v * (square + bend * math.sqrt(1 - u * u / 2)))


def points(arc, rings):
    """Nodes (x, y) by name: ("core", i, j) from (0, bottom), and (k, ring) along the rim from the bottom."""
    side = arc // 4
    tangent = [math.tan(math.pi / 4 * i / side) for i in range(-side, side + 1)]
    nodes = {("core", i, j): core(tangent[side + i], tangent[j]) for i in range(side + 1) for j in range(2 * side + 1)}
    depth = [sum(GROWTH ** m for m in range(n)) for n in range(rings + 1)]
    for k in range(arc + 1):
        inner, angle = nodes[rim_of_core(k, side)], math.pi * k / arc
        outer = (RADIUS * math.sin(angle) if k < arc else 0.0, -RADIUS * math.cos(angle))
        for ring in range(1, rings + 1):
            s = 1 - depth[rings - ring] / depth[rings]
            nodes[k, ring] = tuple(a + (b - a) * s for a, b in zip(inner, outer))
    return nodes


def rim_of_core(k, side):
    """The node of the core on the ray to node k of the rim."""
    if k <= side:
        return ("core", k, 0)
    return ("core", side, k - side) if k <= 3 * side else ("core", 4 * side - k, 2 * side)


def mesh(arc, rings):
    """Gmsh 2.2 text; each node of the plane stands for two, at z = 0 and z = 1."""
    side = arc // 4
    plane = points(arc, rings)
    number = {name: 2 * n + 1 for n, name in enumerate(plane)}
    at = lambda k, ring: number[(k, ring) if ring else rim_of_core(k, side)]
    inner = lambda i, j: number["core", i, j]
    quads = [(inner(i, j), inner(i + 1, j), inner(i + 1, j + 1), inner(i, j + 1))
             for j in range(2 * side) for i in range(side)]
    quads += [(at(k, r), at(k, r + 1), at(k + 1, r + 1), at(k + 1, r)) for r in range(rings) for k in range(arc)]
    strip = lambda line: [(a, b, b + 1, a + 1) for a, b in zip(line, line[1:])]
    rim = strip([at(k, rings) for k in range(arc + 1)])
    down = [at(arc, r) for r in range(rings, 0, -1)] + [inner(0, j) for j in range(2 * side, -1, -1)]
    axis = strip(down + [at(0, r) for r in range(1, rings + 1)])
    centre = number["core", 0, side]
    cells = [(0, "centre", (centre,)), (0, "centre", (centre + 1,))]
    cells += [(2, "rim", q) for q in rim] + [(2, "axis", q) for q in axis]
    cells += [(3, "disk", q + tuple(n + 1 for n in q)) for q in quads]
    places = []
    for name, (x, y) in plane.items():
        digits = "%.14g %.14g" if name[1] == rings and name[0] != "core" else "%.6g %.6g"
        place = digits % (x + 0.0, y - CLEARANCE)
        places += [f"{place} {z}" for z in (0, 1)]
    return gmsh.text(places, cells)


def main():
    parser = arguments(__doc__)
    parser.add_argument("--arc", type=int, default=108, metavar="N",
                        help="edges of the rim, a multiple of 4 (%(default)s)")
    parser.add_argument("--rings", type=int, default=4, metavar="N", help="around the core (%(default)s)")
    add_out(parser, INPUTS / "disk-in-plate.msh")
    args = parser.parse_args()
    if args.arc % 4 or args.arc < 8 or args.rings < 1:
        parser.error("N of the rim is a multiple of 4 from 8 on, and there is a ring or more")
    written(args.out).write_text(mesh(args.arc, args.rings))


if __name__ == "__main__":
    main()

#!/usr/bin/python3 -B
"""Writes a quarter of a billet and of the die that it is pushed into, as one Gmsh 2.2 mesh; axis x, in mm.

                     ___________________________
    90               |___________________________    die: 7 x 30 elements around and along, 4 across
                     |___________________________
    50     skin  ____|_________............bore..
                |billet       |
     0  - - back|_____________|front - - - - - - -   billet: 20 slices of 3 x 3 elements inside and 3 rings of 6
                x = 0        100              300

The bore has a radius of 50 up to x = 100, and from x = 120 is a cone, by which a billet that keeps its volume is
strained by 0.23 at its front when it has been pushed by 150. Volume groups are `billet` and `die`; surface groups
`back`, `front`, `skin`, `bore`, `outer`, and `side-y` and `side-z`, the planes of symmetry of both. Normals of `bore`
point to the axis.

    scripts/meshes/extrusion.py --slices 8 --along 12 --out coarse.msh
"""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, add_out, arguments, gmsh, written

RADIUS, LENGTH, DIE_LENGTH, DIE_RADIUS = 50.0, 100.0, 300.0, 90.0
CORE, RINGS, AROUND, ACROSS = 3, 3, 7, 4


def bore(x, entry, slope):
    """Radius of the bore."""
    beyond = max(0.0, x - LENGTH)
    return RADIUS - slope * (beyond**2 / (2 * entry) if beyond < entry else beyond - entry / 2)


def section():
    """Points (y, z) of a section of the billet, and quadrilaterals of their numbers, counter-clockwise."""
    points = {}
    for i in range(CORE + 1):
        for j in range(CORE + 1):
            s, t = i / CORE, j / CORE
            scale = 0.48 * RADIUS * (1 - 0.1 * s * t)
            points[i, j] = (scale * s, scale * t)
    rim = [(CORE, j) for j in range(CORE)] + [(i, CORE) for i in range(CORE, -1, -1)]
    rows = [rim]
    for ring in range(1, RINGS + 1):
        rows.append([(key, ring) for key in rim])
        for k, key in enumerate(rim):
            angle = math.pi / 2 * k / (2 * CORE)
            outer = (RADIUS * math.cos(angle), RADIUS * math.sin(angle))
            points[key, ring] = tuple(p + (q - p) * ring / RINGS for p, q in zip(points[key], outer))
    quads = [((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)) for i in range(CORE) for j in range(CORE)]
    quads += [(a[k], b[k], b[k + 1], a[k + 1]) for a, b in zip(rows, rows[1:]) for k in range(2 * CORE)]
    number = {key: n for n, key in enumerate(points)}
    return list(points.values()), [[number[key] for key in quad] for quad in quads], [number[key] for key in rows[-1]]


def swept(section, stations, place):
    """Points and hexahedra of a section at stations along x."""
    flat, quads = section
    size = len(flat)
    points = [place(x, *p) for x in stations for p in flat]
    hexes = [[size * (k + a) + n for a in (0, 1) for n in quad] for k in range(len(stations) - 1) for quad in quads]
    return points, hexes


def sides(points):
    """The planes of symmetry."""
    near = lambda c: {n for n, p in enumerate(points) if abs(p[c]) < 1e-9}
    return {"side-y": near(1), "side-z": near(2)}


def billet(slices):
    flat, quads, rim = section()
    points, hexes = swept((flat, quads), [LENGTH * k / slices for k in range(slices + 1)], lambda x, y, z: (x, y, z))
    size = len(flat)
    sets = {"back": set(range(size)), "front": set(range(size * slices, size * (slices + 1)))}
    sets["skin"] = {size * k + n for k in range(slices + 1) for n in rim}
    return points, hexes, sets | sides(points)


def die(along, entry, slope):
    angles = [math.pi / 2 * k / AROUND for k in range(AROUND + 1)]
    flat = [(c, a) for a in angles for c in range(ACROSS + 1)]
    at = lambda k, c: (ACROSS + 1) * k + c
    quads = [[at(k, c), at(k, c + 1), at(k + 1, c + 1), at(k + 1, c)] for k in range(AROUND) for c in range(ACROSS)]

    def place(x, c, a):
        r = bore(x, entry, slope)
        r += (DIE_RADIUS - r) * c / ACROSS
        return (x, r * math.cos(a), r * math.sin(a))

    points, hexes = swept((flat, quads), [DIE_LENGTH * k / along for k in range(along + 1)], place)
    layer = lambda c: set(range(c, len(points), ACROSS + 1))
    sets = {"bore": layer(0), "outer": layer(ACROSS)}
    return points, hexes, sets | sides(points)


def main():
    parser = arguments(__doc__)
    parser.add_argument("--slices", type=int, default=20, metavar="N", help="elements along the billet (%(default)s)")
    parser.add_argument("--along", type=int, default=30, metavar="N", help="elements along the die (%(default)s)")
    parser.add_argument("--entry", type=float, default=20.0, metavar="MM",
                        help="length over which the bore becomes a cone: two elements of the die (%(default)s)")
    parser.add_argument("--slope", type=float, default=0.035,
                        help="of the cone; 0.0339 and 0.03765 for entries of 10 and 40 (%(default)s)")
    add_out(parser, INPUTS / "extrusion.msh")
    args = parser.parse_args()
    die_of = die(args.along, args.entry, args.slope)
    written(args.out).write_text(gmsh.of_bodies({"billet": billet(args.slices), "die": die_of}))


if __name__ == "__main__":
    main()

#!/usr/bin/python3 -B
"""Writes the rigid tools of the square cup of Numisheet'93, a quarter of them. Of each of die, holder and punch:

- square-cup-TOOL.msh: a Gmsh 2.2 mesh with three edges on the quarter circles of a section and six on those of the
  outline, to be smoothed with Nagata patches
- square-cup-TOOL-facets.msh: one with ten, to be used as it is
- square-cup-TOOL.bpt: the exact shape in rational Bezier patches

All are drawn along the outline of a square whose corners are rounded about (25, 25), from beyond the plane x = 0 to
beyond y = 0: there the tools are straight, and go on by 2 mm. The section of each, over the distance r from the
corner's centre (half-widths of the square are 25 + r), around a sheet from z = 0 to 0.78:

            2   10  12 14  17                72
                |    holder ------------------   z = 0.78, opening 78 mm
       punch   /                                 radius 8, 70 mm wide, plan radius 10
        ------'
      ======================================     sheet
                       ,--------------------     z = 0, radius 5, opening 74 mm, plan radius 12
                     |     die
"""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, add_out, arguments, gmsh, written

CENTRE, BEYOND, THICKNESS, DEPTH = 25.0, 2.0, 0.78, 48.0
ROOT = math.sqrt(0.5)
SMOOTHED = {"straight": 6, "corner": 6, "wall": 4, "fillet": 3, "flat": 4}
FACETED = {"straight": 12, "corner": 10, "wall": 6, "fillet": 10, "flat": 9}


def sections():
    """The parts of each tool's section: two ends (r, z), or for a fillet the ends and the corner between them; and
    their kind. The normal of a tool is that of the way along the outline (clockwise, seen from above) times that along
    these."""
    low, high = THICKNESS, THICKNESS + DEPTH
    die = [[(12, -DEPTH), (12, -5), "wall"], [(12, -5), (12, 0), (17, 0), "fillet"], [(17, 0), (72, 0), "flat"]]
    holder = [[(72, low), (14, low), "flat"]]
    punch = [[(10, high), (10, low + 8), "wall"], [(10, low + 8), (10, low), (2, low), "fillet"]]
    return {"die": die, "holder": holder, "punch": punch}


def outline(straight, arc):
    """Maps from (r, z) into space, one for each station along the outline, and whether it is on the corner."""
    def corner(angle):
        c, s = math.cos(angle), math.sin(angle)
        return lambda r, z: (CENTRE + r * c, CENTRE + r * s, z)

    along = [-BEYOND + (CENTRE + BEYOND) * i / straight for i in range(straight)]
    first = [lambda r, z, x=x: (x, CENTRE + r, z) for x in along]
    last = [lambda r, z, y=y: (CENTRE + r, y, z) for y in reversed(along)]
    return first + [corner(math.pi / 2 * (1 - i / arc)) for i in range(arc + 1)] + last


def stations(part, counts):
    """Points (r, z) along a part of a section."""
    *points, kind = part
    n = counts[kind]
    if kind == "fillet":
        (r0, z0), (rc, zc), (r1, z1) = points
        centre = (r0 + r1 - rc, z0 + z1 - zc)
        way = [(math.cos(math.pi / 2 * i / n), math.sin(math.pi / 2 * i / n)) for i in range(n + 1)]
        return [tuple(m + c * (a - m) + s * (b - m) for m, a, b in zip(centre, points[0], points[2])) for c, s in way]
    return [tuple(a + (b - a) * i / n for a, b in zip(*points)) for i in range(n + 1)]


def mesh(name, section, counts):
    """Gmsh 2.2 text of one tool; counts are edges along parts of the section, and of the outline."""
    straight, arc = counts["straight"], counts["corner"]
    rows = [station for k, part in enumerate(section) for station in stations(part, counts)[k > 0:]]
    if name == "punch":
        rows.append((1.0, rows[-1][1]))
    ways = outline(straight, arc)
    nodes = [way(*row) for row in rows for way in ways]
    facets = [(i + j, i + j + 1, i + j + 1 + len(ways), i + j + len(ways))
              for j in range(0, len(nodes) - len(ways), len(ways)) for i in range(len(ways) - 1)]
    if name == "punch":
        facets += bottom(nodes, straight, arc)
    return gmsh.text(nodes, [(2, name, [n + 1 for n in facet]) for facet in facets])


def bottom(nodes, straight, arc):
    """Closes the punch below, inside the last row of nodes: the square to the corner's centre, which it adds to the
    nodes, strips along it, and a fan in the corner."""
    last, start, n = len(nodes) - 2 * straight - arc - 1, len(nodes), straight + 1
    along = [-BEYOND + (CENTRE + BEYOND) * i / straight for i in range(n)]
    nodes += [(x, y, nodes[last][2]) for y in reversed(along) for x in along]
    square = [(i + j, i + j + 1, i + j + 1 + n, i + j + n)
              for j in range(start, start + straight * n, n) for i in range(straight)]
    centre, end = start + straight, last + straight + arc
    first = [(last + i, last + i + 1, start + i + 1, start + i) for i in range(straight)]
    second = [(end + i, end + i + 1, centre + (i + 1) * n, centre + i * n) for i in range(straight)]
    return square + first + second + [(last + straight + i, last + straight + i + 1, centre) for i in range(arc)]


def patches(name, section):
    """Bezier patches (degrees, control points x, y, z, weight) of one tool."""
    def straight(r, z, w):
        return [(-BEYOND, CENTRE + r, z, w), (CENTRE, CENTRE + r, z, w)]

    def corner(r, z, w):
        return [(CENTRE, CENTRE + r, z, w), (CENTRE + r, CENTRE + r, z, ROOT * w), (CENTRE + r, CENTRE, z, w)]

    def other(r, z, w):
        return [(CENTRE + r, CENTRE, z, w), (CENTRE + r, -BEYOND, z, w)]

    ways = (straight, 1), (corner, 2), (other, 1)
    found = []
    for *points, kind in section:
        weights = [1.0, ROOT, 1.0] if kind == "fillet" else [1.0, 1.0]
        for way, degree in ways:
            found.append(((degree, len(points) - 1), [p for q, w in zip(points, weights) for p in way(*q, w)]))
    if name == "punch":
        # Inside the fillet, its radius being 2 there: the square, strips along it, and the corner in three parts.
        (radius, z) = section[-1][2]
        ends = (-BEYOND, CENTRE)
        found.append(((1, 1), [(x, y, z, 1.0) for y in reversed(ends) for x in ends]))
        found += [((1, 1), way(radius, z, 1.0) + way(0.0, z, 1.0)) for way in (straight, other)]

        def polar(r, degrees, w=1.0):
            angle = math.radians(degrees)
            return (CENTRE + r * math.cos(angle), CENTRE + r * math.sin(angle), z, w)

        half, w = 0.5 * radius, math.cos(math.pi / 8)
        for a in (90, 45):
            p, q = polar(half, a), polar(half, a - 45)
            middle = tuple((s + t) / 2 for s, t in zip(p, q))[:3] + (w,)
            rim = [polar(radius, a), polar(radius / w, a - 22.5, w), polar(radius, a - 45)]
            found.append(((2, 1), rim + [p, middle, q]))
        found.append(((1, 1), [polar(0.0, 0), polar(half, 90), polar(half, 0), polar(half, 45)]))
    return found


def bezier(found):
    """Text with the number of patches, then of each its degrees and control points."""
    lines = [str(len(found))]
    for degrees, points in found:
        lines += ["{} {}".format(*degrees)] + ["{:.17g} {:.17g} {:.17g} {:.17g}".format(*p) for p in points]
    return "\n".join(lines + [""])


def main():
    parser = arguments(__doc__)
    add_out(parser, INPUTS)
    parser.add_argument("--arc", type=int, metavar="N",
                        help="edges of all quarter circles of the meshes that are to be smoothed (3 and 6)")
    args = parser.parse_args()
    folder, smoothed = args.out, SMOOTHED | ({"corner": args.arc, "fillet": args.arc} if args.arc else {})
    for name, section in sections().items():
        stem = "square-cup-" + name
        written(folder / (stem + ".msh")).write_text(mesh(name, section, smoothed))
        (folder / (stem + "-facets.msh")).write_text(mesh(name, section, FACETED))
        (folder / (stem + ".bpt")).write_text(bezier(patches(name, section)))


if __name__ == "__main__":
    main()

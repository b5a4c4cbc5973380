#!/usr/bin/python3 -B
"""Writes a deck of CalculiX: a hollow pin in a lug, half of both, one layer of 5 mm. mm, N, MPa.

     back                The lug is 40 wide with a bore of radius 10 and a round end; the pin has 9.95 and is drawn
     |=========--.       along x by its own bore. y = 0 is the plane of symmetry, z = 0 that of the middle of the
     |         O  )      plate. The bore of the lug is the slave, the pin, which is meshed more coarsely, the master.
     |=========--'
"""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import ROOT, add_out, arguments, calculix, written

BORE, HALF, LENGTH, THICKNESS = 10.0, 20.0, 50.0, 5.0
PIN, INNER = 9.95, 4.0
CONTACT = "SURFACE TO SURFACE", "LINEAR", "5e6", "*FRICTION", "0.1, 5e5"


def rows(lines):
    """Points and hexahedra of one layer between rows of points in the plane, each as long as the next; points of one
    place are one."""
    number, points, hexes = {}, [], []

    def point(x, y, z):
        key = round(x, 6), round(y, 6), z
        if key not in number:
            number[key] = len(points)
            points.append(key)
        return number[key]

    for low, high in zip(lines, lines[1:]):
        for a, b, c, d in zip(low, low[1:], high[1:], high):
            corners = [a, b, c, d]
            if sum(p[0] * q[1] - q[0] * p[1] for p, q in zip(corners, [*corners[1:], corners[0]])) < 0:
                corners.reverse()
            hexes.append([point(*p, z) for z in (0.0, THICKNESS) for p in corners])
    return points, hexes


def between(p, q, shares):
    return [(p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1])) for s in shares]


def rim(angle):
    """Where a ray from the bore meets the round end, the side or the line at which the plate begins."""
    x, y = math.cos(angle), math.sin(angle)
    scale = HALF if x >= 0 else HALF / max(y, -x)
    return scale * x, scale * y


def lug(n):
    angles = [math.pi * k / n for k in range(n + 1)]
    rings = round(n * 6 / 32)
    shares = [(k / rings) ** 1.5 for k in range(rings + 1)]
    lines = [between((BORE * math.cos(a), BORE * math.sin(a)), rim(a), shares) for a in angles]
    points, hexes = rows(lines)
    ends = [rim(a) for a in angles[3 * n // 4:]]
    more = rows([between(p, (-LENGTH, p[1]), [4 * k / n for k in range(n // 4 + 1)]) for p in ends])
    return joined((points, hexes), more)


def joined(first, second):
    number, points = {p: k for k, p in enumerate(first[0])}, list(first[0])
    for p in second[0]:
        if p not in number:
            number[p] = len(points)
            points.append(p)
    return points, first[1] + [[number[second[0][k]] for k in nodes] for nodes in second[1]]


def pin(n):
    angles = [math.pi * k / n for k in range(n + 1)]
    at = lambda radius, a: (radius * math.cos(a), radius * math.sin(a))
    return rows([between(at(INNER, a), at(PIN, a), [6 * k / n for k in range(n // 6 + 1)]) for a in angles])


def members(points, *tests):
    """The sets of points that pass each test."""
    return [{k for k, p in enumerate(points) if test(*p)} for test in tests]


def main():
    parser = arguments(__doc__)
    add_out(parser, ROOT / "docs" / "tutorial" / "lug.inp")
    parser.add_argument("--bore", type=int, default=32, metavar="N",
                        help="elements along half of the bore, a multiple of 8 (%(default)s)")
    args = parser.parse_args()
    if args.bore < 8 or args.bore % 8:
        parser.error("--bore must be a multiple of 8")
    middle, plane = lambda x, y, z: abs(y) < 1e-9, lambda x, y, z: z == 0.0
    around = lambda radius: lambda x, y, z: abs(math.hypot(x, y) - radius) < 1e-5
    bodies = {}
    for name, (points, hexes), tests in [
        ("LUG", lug(args.bore), {"BORE": around(BORE), "BACK": lambda x, y, z: x < -LENGTH + 1e-6}),
        ("PIN", pin(3 * args.bore // 4), {"OUTSIDE": around(PIN), "INSIDE": around(INNER)}),
    ]:
        names = [*tests, "MIDDLE", "PLANE"]
        sets = members(points, *tests.values(), middle, plane)
        bodies[name] = points, hexes, dict(zip(names, sets))
    free = None
    held = {(name, "MIDDLE"): (free, 0.0, free) for name in bodies}
    held |= {(name, "PLANE"): (free, free, 0.0) for name in bodies}
    step = {("LUG", "BACK"): (0.0, free, free), ("PIN", "INSIDE"): (0.25, 0.0, free), **held}
    material = ["*ELASTIC", "206000., 0.3"]
    slave, master, driven = ("LUG", "BORE"), ("PIN", "OUTSIDE"), ("PIN", "INSIDE")
    text = calculix.deck(bodies, material, slave, master, CONTACT, [(10, step)], driven)
    written(args.out).write_text(text)


main()

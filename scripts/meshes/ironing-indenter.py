#!/usr/bin/python3 -B
"""Writes the rigid indenter of the frictional ironing problem in three descriptions:

- ironing-indenter.msh: a Gmsh 2.2 mesh, one strip of 26 quadrilaterals
- ironing-indenter.igs: the exact shape in IGES, five NURBS surfaces
- ironing-indenter.bpt: five Bezier patches, the fillets cubic and so a little off (by 2.7e-4 of their radius)

z runs from -0.5 to 1.5 mm, beyond a slab of 1 mm on both sides.

      5        45
   40 |        |     sides: 5 quads each
      |        |
   10 \\        /     quarter fillets, radius 10: 4 quads each, nodes on the arc
    0  \\______/      flat bottom from x = 15 to 35: 8 quads

Normals point out of the indenter (the bottom's to -y).
"""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, add_out, arguments, gmsh, written

CENTRE, HALF_WIDTH, RADIUS, HEIGHT = 25.0, 20.0, 10.0, 40.0
SIDE, ARC, FLAT = 5, 4, 8
Z = (-0.5, 1.5)


def profile(arc):
    """Points (x, y) down the left side, along the bottom and up the right side, with so many edges to a fillet: the
    solid is on the left hand."""
    left = [(-HALF_WIDTH, HEIGHT - (HEIGHT - RADIUS) * i / SIDE) for i in range(SIDE + 1)]
    for i in range(1, arc):
        angle = math.pi / 2 * i / arc
        left.append((RADIUS - HALF_WIDTH - RADIUS * math.cos(angle), RADIUS - RADIUS * math.sin(angle)))
    flat_half = HALF_WIDTH - RADIUS
    left += [(-flat_half + 2 * flat_half * i / FLAT, 0.0) for i in range(FLAT // 2)]
    right = [(-x, y) for x, y in reversed(left)]
    return [(CENTRE + x, y) for x, y in left + [(0.0, 0.0)] + right]


def mesh(points):
    """Gmsh 2.2 text; nodes 2i+1 and 2i+2 are profile point i on the two z-planes."""
    nodes = [(x, y, z) for x, y in points for z in Z]
    quads = [(2 * i + 1, 2 * i + 3, 2 * i + 4, 2 * i + 2) for i in range(len(points) - 1)]
    return gmsh.text(nodes, [(2, "indenter", q) for q in quads])


def sections():
    """The five parts of the profile, each as its two ends, or for a fillet the ends and the corner between them."""
    low, high = CENTRE - HALF_WIDTH, CENTRE + HALF_WIDTH
    fillets = [[(low, RADIUS), (low, 0.0), (low + RADIUS, 0.0)], [(high - RADIUS, 0.0), (high, 0.0), (high, RADIUS)]]
    left, right = [(low, HEIGHT), (low, RADIUS)], [(high, RADIUS), (high, HEIGHT)]
    return [left, fillets[0], [(low + RADIUS, 0.0), (high - RADIUS, 0.0)], fillets[1], right]


def between(a, b, t):
    """The point that is the part t of the way from a to b."""
    return tuple((1 - t) * p + t * q for p, q in zip(a, b))


def bezier(parts):
    """Text with the number of patches, then of each its degrees and control points."""
    lines = [str(len(parts))]
    for start, *corner, end in parts:
        k = 4 / 3 * math.tan(math.pi / 8)
        control = [start, *(between(tip, c, k) for c in corner for tip in (start, end)), end]
        lines.append(f"{len(control) - 1} 1")
        lines += [f"{x:.17g} {y:.17g} {z:.17g}" for z in Z for x, y in control]
    return "\n".join(lines + [""])


def iges(parts):
    """IGES 5.3: a rational B-spline surface (128) for each part, a fillet being an exact quarter of a circle."""
    start = ["Rigid indenter of the frictional ironing problem, in millimetres."]
    texts = [hollerith(text) for text in (",", ";", "indenter", "ironing-indenter.igs", "nagata", "1")]
    texts += ["32", "308", "15", "308", "15", hollerith("indenter"), "1.", "2", hollerith("MM"), "1", "0.1"]
    texts += [hollerith("20240101.000000"), "1.E-9", "100.", "", "", "11", "0"]
    directory, parameters = [], []
    for number, part in enumerate(parts):
        first = len(parameters) + 1
        text = folded([word + "," for word in surface(part)[:-1]] + [surface(part)[-1] + ";"], 64)
        parameters += [f"{line:<64}{2 * number + 1:8}" for line in text]
        directory.append("".join(f"{n:8}" for n in (128, first, 0, 0, 0, 0, 0, 0)) + "00000000")
        directory.append("".join(f"{n:8}" for n in (128, 0, 0, len(text), 0)) + f"{'INDENTER':>24}{number:8}")
    sheets = [("S", start), ("G", folded([t + "," for t in texts[:-1]] + [texts[-1] + ";"], 72))]
    sheets += [("D", directory), ("P", parameters)]
    sheets.append(("T", ["".join(f"{letter}{len(lines):7}" for letter, lines in sheets)]))
    return "".join(f"{line:<72}{letter}{i:7}\n" for letter, lines in sheets for i, line in enumerate(lines, 1))


def surface(part):
    """The parameters of entity 128 for a part of the profile drawn out along z."""
    degree = len(part) - 1
    weights = [1.0, math.sqrt(0.5), 1.0] if degree == 2 else [1.0, 1.0]
    knots = [0.0] * (degree + 1) + [1.0] * (degree + 1)
    points = [c for z in Z for x, y in part for c in (x, y, z)]
    flags = [0, 0, 0 if degree == 2 else 1, 0, 0]
    reals = knots + [0.0, 0.0, 1.0, 1.0] + weights * 2 + points + [0.0, 1.0, 0.0, 1.0]
    return [str(n) for n in [128, degree, 1, degree, 1] + flags] + [repr(x) for x in reals]


def hollerith(text):
    """A text as IGES writes it."""
    return f"{len(text)}H{text}"


def folded(words, width):
    """Words put into lines."""
    lines = [""]
    for word in words:
        if len(lines[-1]) + len(word) > width:
            lines.append("")
        lines[-1] += word
    return lines


def main():
    parser = arguments(__doc__)
    add_out(parser, INPUTS)
    parser.add_argument("--arc", type=int, default=ARC, metavar="N", help="quads of a fillet of the mesh (%(default)s)")
    args = parser.parse_args()
    stem = written(args.out / "ironing-indenter")
    stem.with_suffix(".msh").write_text(mesh(profile(args.arc)))
    stem.with_suffix(".igs").write_text(iges(sections()))
    stem.with_suffix(".bpt").write_text(bezier(sections()))


if __name__ == "__main__":
    main()

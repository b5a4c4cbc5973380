#!/usr/bin/python3 -B
"""Runs the ball on a block of inputs/hertz-sphere.toml with elements of several kinds, on about as many nodes as the
scene's own mesh has, from node to surface and from segment to segment, and prints as a Markdown table by how much
force, radius and pressures are off, as scripts/studies/hertz.py does. Tetrahedra are cut from the hexahedra, each side
along the diagonal from its lowest node; nodes in the middles of edges lie on the ball where their ends do."""

import sys
import tempfile
from importlib import import_module
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, ROOT, arguments, gmsh, hertz, say, study

# Elements of the block over the radius of the contact.
ELEMENTS = {"hex8": 8, "hex8-fbar": 8, "tet4": 8, "hex27": 4, "tet10": 4, "tet10-sri": 4}
HEAD = ["element", "discretization", "dofs", "iterations", "force", "radius", "highest pressure", "pressure, rms"]


def tetrahedra(nodes):
    """Those of a hexahedron."""
    apex = min(nodes)
    for side in gmsh.FACES:
        around = [nodes[k] for k in side]
        if apex not in around:
            first = around.index(min(around))
            a, b, c, d = around[first:] + around[:first]
            # Sides turn to the left as seen from outside, and a tetrahedron's first one as seen from within.
            yield from ([a, c, b, apex], [a, d, c, apex])


def cells(hexahedra, group, sets, is_cut, middle):
    """Of a body: its elements, and the sides with all nodes in a set."""
    for nodes in (t for h in hexahedra for t in (tetrahedra(h) if is_cut else [h])):
        ends = gmsh.EDGES[len(nodes)] if middle else ()
        yield 3, group, nodes + [middle(nodes[i], nodes[j]) for i, j in ends]
        for side in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)) if is_cut else gmsh.FACES:
            corners = [nodes[k] for k in side]
            halves = zip(corners, corners[1:] + corners[:1]) if middle else ()
            between = [middle(i, j) for i, j in halves]
            yield from ((2, name, corners + between) for name, members in sets.items() if members.issuperset(corners))


def mesh(element, count):
    """Both bodies of `count` elements over the radius, as a Gmsh file."""
    sys.path.insert(0, str(ROOT / "scripts" / "meshes"))
    make = import_module("hertz")

    def lift(x, y, z):
        return x, y, z + (make.BALL - (make.BALL**2 - x * x - y * y) ** 0.5) * (1 - z / 8.0)

    is_cut, is_second = element.startswith("tet"), element in ("hex27", "tet10", "tet10-sri")
    # As flat bodies, which are lifted onto the ball with all nodes.
    points, all_cells = [], []
    for name, n, way in (("block", count, -1), ("ball", count // 2, 1)):
        flat, hexahedra, contact = make.ball_body(n, 0, way, lambda r: 0.0)
        names = ("top", "base", "ball") if way < 0 else ("underside", "back", "ball")
        sets, middles, start = make.groups(flat, contact, names), {}, len(points) + 1

        def middle(i, j, flat=flat, middles=middles):
            if (key := (min(i, j), max(i, j))) not in middles:
                middles[key] = len(flat)
                flat.append(tuple((a + b) / 2 for a, b in zip(flat[i], flat[j])))
            return middles[key]

        found = cells(hexahedra, name, sets, is_cut, middle if is_second else None)
        all_cells += [(dimension, group, [start + k for k in nodes]) for dimension, group, nodes in found]
        points += [lift(*p) if way > 0 else p for p in flat]
    return gmsh.text(points, all_cells)


def main():
    parser = arguments(__doc__)
    parser.add_argument("--elements", nargs="+", default=list(ELEMENTS), choices=ELEMENTS)
    parser.add_argument("--finer", type=int, default=1, metavar="N", help="times the elements (%(default)s)")
    parser.add_argument("--ranks", type=int, default=2, metavar="N", help="(%(default)s)")
    args = parser.parse_args()
    study.setup()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for element in args.elements:
            path = Path(folder) / f"{element}.msh"
            path.write_text(mesh(element, args.finer * ELEMENTS[element]))
            sets = [f"--set=body.{body}.{key}" for body in ("block", "ball") for key in
                    (f"mesh={path}", f"element={element}")]
            for discretization in ("one-pass", "segment"):
                say(f"{element}, {discretization}")
                out = Path(folder) / f"{element}-{discretization}"
                way = f"--set=contact.spot.discretization={discretization}"
                run = study.Run(INPUTS / "hertz-sphere.toml", out, args.ranks, way, *sets)
                if run.code != 0:
                    sys.exit(run.code)
                result = hertz.Result(out, hertz.SPHERE)
                (a, p0), (fitted, _) = result.hertz, result.fitted()
                errors = [result.force / hertz.SPHERE.force_at(result.approach) - 1, fitted / a - 1,
                          result.pressure.max() / p0 - 1, result.pressure_error()]
                cost = [run.summary["dofs"], run.summary["iterations"]]
                rows.append([f"`{element}`", discretization, *cost, *(f"{e:+.2%}" for e in errors)])
    study.table(HEAD, rows)


if __name__ == "__main__":
    main()

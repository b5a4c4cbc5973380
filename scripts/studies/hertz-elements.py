#!/usr/bin/python3 -B
"""Runs the ball on a block and the rollers, pressed and with friction, of inputs/hertz-sphere.toml,
hertz-cylinder.toml and cattaneo-mindlin.toml with elements of several kinds, on about as many nodes as the scenes' own
meshes have, from node to surface and from segment to segment, and prints as Markdown tables by how much the results are
off, as scripts/studies/hertz.py does. Rollers and their blocks are one layer in space, without u_z on both its sides,
an eighth of the half-width of the contact thick. Tetrahedra are cut from the hexahedra, each side along the diagonal
from its lowest node; wedges are two of each, upright on the block of the ball, along the axes of the rollers; pyramids
are six about a node in the middle, with twice the nodes. Nodes in the middles of edges lie on ball and rollers where
their ends do."""

import math
import re
import sys
import tempfile
from importlib import import_module
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, ROOT, arguments, gmsh, hertz, say, study

# Elements of the block over the radius or half-width of the contact, over those of the scenes' own meshes.
ELEMENTS = {"hex8": 1, "hex8-fbar": 1, "hex8-sri": 1, "hex8-eas": 1, "wedge6": 1, "pyramid5": 1, "tet4": 1, "hex27": 2,
            "wedge18": 2, "tet10": 2, "tet10-sri": 2}
SCENES = {"hertz-sphere": 8, "hertz-cylinder": 12, "cattaneo-mindlin": 16}
HEAD = ["element", "discretization", "dofs", "increments / iterations", "force", "radius", "highest pressure",
        "pressure, rms", "half-width that sticks", "shear traction, rms", "its largest error"]
THICKNESS = 0.025  # of the rollers
ROLLER = hertz.roller_layer(THICKNESS)
PROBLEMS = {"hertz-sphere": hertz.SPHERE, "hertz-cylinder": ROLLER, "cattaneo-mindlin": ROLLER}


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


def parts(nodes, shape, middle):
    """What a hexahedron is cut into."""
    if shape == "tet":
        return list(tetrahedra(nodes))
    if shape == "wedge":
        return [[nodes[k] for k in half] for half in ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7))]
    if shape == "pyramid":
        apex = middle(*nodes)
        return [[nodes[k] for k in side[::-1]] + [apex] for side in gmsh.FACES]
    return [nodes]


def cells(hexahedra, group, sets, shape, is_second, middle):
    """Of a body: its elements, and the sides with all nodes in a set."""
    for nodes in (part for h in hexahedra for part in parts(h, shape, middle)):
        ends = gmsh.EDGES[len(nodes)] if is_second else ()
        yield 3, group, nodes + [middle(nodes[i], nodes[j]) for i, j in ends]
        for side in gmsh.SIDES[len(nodes)]:
            corners = [nodes[k] for k in side]
            halves = zip(corners, corners[1:] + corners[:1]) if is_second else ()
            between = [middle(i, j) for i, j in halves]
            yield from ((2, name, corners + between) for name, members in sets.items() if members.issuperset(corners))


def bodies(scene, count):
    """Flat bodies with `count` elements of the lower one over the contact: name, points, hexahedra, sets, and where
    points are lifted to."""
    sys.path.insert(0, str(ROOT / "scripts" / "meshes"))
    make = import_module("hertz")
    is_ball = scene == "hertz-sphere"
    problem = PROBLEMS[scene]
    upper = problem.body
    share = 1 if scene == "cattaneo-mindlin" else 2
    far = round(0.75 * count) if share == 1 else count
    for name, n, way in (("block", count, -1), (upper, count // share, 1)):
        build = make.ball_body if is_ball else make.roller_body
        points, hexahedra, contact = build(n, far, way, lambda r: 0.0)
        names = ("top", "base", upper) if way < 0 else ("underside", "back", upper)
        sets = make.groups(points, contact, names)
        if not is_ball:
            sets |= {key: {n for n, p in enumerate(points) if p[2] == at} for key, at in (("zmin", 0.0), ("zmax", 1.0))}
            points = [(x, y, THICKNESS * z) for x, y, z in points]

        def lift(x, y, z, way=way):
            across, up = (math.hypot(x, y), z) if is_ball else (x, y)
            sag = problem.radius - math.sqrt(problem.radius**2 - across**2) if way > 0 else 0.0
            sag *= 1 - up / problem.height
            return (x, y, z + sag) if is_ball else (x, y + sag, z)

        yield name, points, hexahedra, sets, lift


def mean(points, of):
    """The middle of some points."""
    return tuple(sum(a) / len(of) for a in zip(*(points[k] for k in of)))


def mesh(scene, element, count):
    """Both bodies, as a Gmsh file; they are flat as they are cut, and lifted with all nodes."""
    shape, is_second = re.match("[a-z]+", element)[0], element in ("hex27", "wedge18", "tet10", "tet10-sri")
    points, all_cells = [], []
    for name, flat, hexahedra, sets, lift in bodies(scene, count):
        middles, start = {}, len(points) + 1

        def middle(*ends, flat=flat, middles=middles):
            if (key := tuple(sorted(ends))) not in middles:
                middles[key] = len(flat)
                flat.append(mean(flat, ends))
            return middles[key]

        found = cells(hexahedra, name, sets, shape, is_second, middle)
        all_cells += [(dimension, group, [start + k for k in nodes]) for dimension, group, nodes in found]
        places = [lift(*p) for p in flat]
        for ends, k in middles.items():
            if len(ends) > 2:  # in hexahedra, which are long and bent far from the contact
                places[k] = mean(places, ends)
        points += places
    return gmsh.text(points, all_cells)


def main():
    parser = arguments(__doc__)
    parser.add_argument("--scenes", nargs="+", default=list(SCENES), choices=SCENES)
    parser.add_argument("--elements", nargs="+", default=list(ELEMENTS), choices=ELEMENTS)
    parser.add_argument("--finer", type=int, default=1, metavar="N", help="times the elements (%(default)s)")
    parser.add_argument("--ranks", type=int, default=2, metavar="N", help="(%(default)s)")
    parser.add_argument("--limit", type=int, default=1800, metavar="S", help="seconds for a run (%(default)s)")
    args = parser.parse_args()
    study.setup()
    codes = []
    for scene in args.scenes:
        rows = []
        problem = PROBLEMS[scene]
        with tempfile.TemporaryDirectory() as folder:
            for element in args.elements:
                path = Path(folder) / f"{element}.msh"
                path.write_text(mesh(scene, element, args.finer * SCENES[scene] // ELEMENTS[element]))
                keys = [f"mesh={path}", f"element={element}"]
                if problem is not hertz.SPHERE:
                    keys += ["plane_strain=false", 'symmetry=["zmin", "zmax"]']
                sets = [f"--set=body.{body}.{key}" for body in ("block", problem.body) for key in keys]
                for discretization in ("one-pass", "segment"):
                    say(f"{scene}, {element}, {discretization}")
                    out = Path(folder) / f"{element}-{discretization}"
                    way = f"--set=contact.{problem.contact}.discretization={discretization}"
                    run = study.Run(INPUTS / f"{scene}.toml", out, args.ranks, way, *sets, limit=args.limit)
                    codes.append(run.code)
                    found = [f"exit code {run.code}", *[""] * (len(HEAD) - 3)]
                    if run.code == 0:
                        errors = hertz.Result(out, problem).errors(scene == "cattaneo-mindlin")
                        found = [run.summary["dofs"], run.effort, *study.percents(errors)]
                    rows.append([f"`{element}`", discretization, *found])
        print(f"\n{scene}\n")
        study.table(HEAD, rows)
    sys.exit(max(codes))


if __name__ == "__main__":
    main()

#!/usr/bin/python3 -B
"""Runs cases on which other solvers were measured and prints the results beside theirs, as Markdown tables.

`ironing` is inputs/ironing-peers.toml: an elastic indenter is pressed into a slab and drawn along it by 50 mm.

A number n is inputs/sphere-on-block.toml: a rigid spherical cap on an elastic block of n x n x n/2 hexahedra. The cap
is taken as Nagata patches and as flat facets of a mesh that is refined with the block's, and as the exact sphere. F_n
and F_t are the forces of the cap on the block along -z and x, N; wall times contain the start of the processes.

`hertz` is a quarter of an elastic block with a spherical underside, 10 x 10 x 10 mm, that is pressed on a
rigid plate without friction: 44,616 displacements, elements of 0.125 mm in the contact, whose radius is 1 mm.
"""

import argparse
import itertools
import math
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import gmsh
from shared import study

IRONING = ROOT / "inputs" / "ironing-peers.toml"
SCENE = ROOT / "inputs" / "sphere-on-block.toml"
HEAD = ["n", "solver", "cap", "processes", "CPU s", "wall s", "increments / iterations", "F_n pressed",
        "F_n at the end", "F_t at the end", "peak MB"]
# Rows under HEAD of other solvers, measured with the same block, facets of the cap, steps and friction on a machine
# with 2 cores: CalculiX 2.20 and GetFEM 5.4.2 as Debian 12 has them, FrontISTR with MUMPS. Rows without a wall time
# were measured beside other work. CalculiX has a penalty of 1e3 N/mm^3 in its surface-to-surface contact, and one of
# 1e2 N/mm^3 in its friction.
PEERS = [
    (20, "FrontISTR, node to segment", "facets", 1, 15, 15.6, "8 / 34", "", 726, 200, ""),
    (20, "FrontISTR, node to segment", "facets", 2, 19, 9.7, "8 / 34", "", 726, 200, ""),
    (20, "GetFEM, augmented Lagrangian", "facets", 1, 25, 22.5, "8 / 36", "", 766.4, 227.6, 296),
    (20, "CalculiX, mortar", "facets", 1, 35, 35.2, "8 / 34", "", 767.1, 228.1, 249),
    (20, "CalculiX, mortar", "facets", 2, "", 25.1, "8 / 34", "", 767.1, 228.1, ""),
    (20, "CalculiX, surface to surface", "facets", 1, 44, "", "8 / 45", "", 775.9, 260.3, 157),
    (30, "GetFEM, augmented Lagrangian", "facets", 1, 174, "", "8 / 42", "", 796.1, 236.0, 1014),
    (40, "FrontISTR, node to segment", "facets", "", "", "> 420", "", "", "", "", ""),
]

HERTZ_HEAD = ["solver", "processes", "CPU s", "wall s", "increments / iterations", "F", "highest pressure", "peak MB"]
# CalculiX 2.20 with its penalty of 1e5 N/mm^3, Kratos with its algebraic multigrid solver; both on two threads.
HERTZ_PEERS = [
    ("CalculiX, node to surface", 2, 92, 55.5, "5 / 25", 19.27, "", 588),
    ("CalculiX, surface to surface", 2, 137, "", "5 / 37", 19.38, "", 588),
    ("Kratos, mortar", 2, 57, 30.1, "5 / 17", 19.48, "", 405),
]
HERTZ_SCENE = """
title = "Hertz: elastic ball on a rigid plate"
[body.ball]
mesh = "ball.msh"
material = "elastic"
[material.elastic]
model = "hooke"
young = 1000.0
poisson = 0.3
[tool.plate]
plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }
[contact.spot]
slave = "ball.underside"
master = "plate"
[[step]]
name = "press"
increments = 5
fix = [{ set = "ball.xmin", directions = "x" }, { set = "ball.ymin", directions = "y" }]
move = [{ target = "ball.back", by = [0.0, 0.0, -0.05], directions = "z" }]
[output]
every = 5
history = ["ball.back"]
"""


def graded(even, length=10.0, first=0.125, ratio=1.25):
    """Places from 0 to `length`: `even` elements of the size `first`, then larger ones that about keep the ratio."""
    places, size = [first * k for k in range(even + 1)], first
    while places[-1] < length:
        size *= ratio
        places.append(places[-1] + size)
    start, stretch = places[even], (length - places[even]) / (places[-1] - places[even])
    return places[: even + 1] + [start + (p - start) * stretch for p in places[even + 1:]]


def ball(radius=20.0):
    """The mesh of the block with the spherical underside."""
    across, up = graded(12), graded(8)
    points = []
    for z, y, x in itertools.product(up, across, across):
        points.append((x, y, z + (radius - math.sqrt(radius**2 - x * x - y * y)) * (1 - z / up[-1])))
    n = len(across)
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = itertools.product(range(len(up) - 1), range(n - 1), range(n - 1))
    hexes = [[i + a + n * (j + b + n * (k + c)) for a, b, c in corners] for k, j, i in cells]
    at = lambda axis: {m for m, p in enumerate(points) if p[axis] == 0.0}
    ends = {"underside": set(range(n * n)), "back": set(range(len(points) - n * n, len(points)))}
    return gmsh.of_bodies({"ball": (points, hexes, {**ends, "xmin": at(0), "ymin": at(1)})})


def hertz(folder, ranks):
    """The row of nagata under HERTZ_HEAD, and whether it failed."""
    (folder / "ball.msh").write_text(ball())
    (folder / "hertz.toml").write_text(HERTZ_SCENE)
    run = study.Run(folder / "hertz.toml", folder / "hertz", ranks)
    cells = ["nagata", ranks, f"{run.cpu:.1f}", f"{run.wall:.1f}"]
    if run.code != 0:
        return [*cells, "failed", "", "", ""], True
    results = f"{-run.last('ball.back.fz'):.2f}", f"{run.last('spot.max_pressure'):.2f}"
    return [*cells, run.effort, *results, f"{run.summary['peak_memory_mb']:.0f}"], False


IRONING_HEAD = ["solver", "master", "processes", "CPU s", "wall s", "increments / iterations", "F_n pressed",
                "F_n at the end", "F_t at the end", "F_t / F_n", "nodes that stick"]
# On the smooth master FrontISTR runs through only with contact parameters chosen for it, of which one softens friction.
IRONING_PEERS = [
    ("FrontISTR", "facets", 2, 178, 89.6, "71 / 579", 1196, 1230, 314, 0.255, "18 to 20"),
    ("FrontISTR, parameters chosen", "Nagata", 2, 126, 63.6, "71 / 400", 1208, 1243, 316, 0.254, "18 to 20"),
    ("FrontISTR, defaults", "Nagata", 2, 45, "", "stops at 6 mm down", "", "", "", "", ""),
    ("GetFEM, 20 mm of slide", "facets", 1, "", "", "40 / 271", "", 1219.8, 372.2, 0.305, ""),
    ("CalculiX, 10 mm of slide", "facets", 1, "42 to 70", "", "30 / 137 to 60 / 233", "", "1239 to 1228", "432 to 394",
     "0.349 to 0.321", ""),
]


def ironing(folder, ranks):
    """Rows under IRONING_HEAD, and whether a run failed."""
    rows, failed = list(IRONING_PEERS), False
    slide = ["--set=step.slide.move.0.by=[50.0, 0.0, 0.0]", "--set=step.slide.increments=50"]
    for master, smoothing in (("Nagata", "nagata"), ("facets", "facet")):
        say(f"ironing, {master}")
        run = study.Run(IRONING, folder / f"ironing-{smoothing}", ranks, *slide,
                        f"--set=contact.top.smoothing={smoothing}")
        row = ["nagata", master, ranks, f"{run.cpu:.1f}", f"{run.wall:.1f}"]
        failed |= run.code != 0
        if run.code != 0:
            rows.append(row + ["failed"] + [""] * (len(IRONING_HEAD) - len(row) - 1))
            continue
        pressed, down, along = (-run.last("indenter.top.fy", "press"), -run.last("indenter.top.fy"),
                                run.last("indenter.top.fx"))
        rows.append(row + [run.effort, f"{pressed:.1f}", f"{down:.1f}", f"{along:.1f}", f"{along / down:.3f}",
                           f"{run.last('top.stick'):.0f}"])
    return rows, failed


def caps(n, folder):
    """The caps with the overrides that select them; the mesh has the facets that the other solvers had."""
    k = max(4, round(16 * n / 40 / 2) * 2)
    mesh = folder / f"cap-{k}.msh"
    subprocess.run([ROOT / "scripts" / "make-sphere-cap", str(k), mesh], check=True)
    meshed = f"--set=tool.cap.mesh={mesh}"
    return {
        "Nagata": [meshed],
        "facets": [meshed, "--set=tool.cap.smoothing=facet"],
        "sphere": ["--set=tool.cap.smoothing=sphere"],
    }


def row(n, cap, ranks, run):
    """A row under HEAD."""
    if run.code != 0:
        return [n, "nagata", cap, ranks, f"{run.cpu:.1f}", f"{run.wall:.1f}", "failed", "", "", "", ""]
    forces = -run.last("cap.fz", "press"), -run.last("cap.fz"), run.last("cap.fx")
    return [n, "nagata", cap, ranks, f"{run.cpu:.1f}", f"{run.wall:.1f}", run.effort, *(f"{f:.1f}" for f in forces),
            f"{run.summary['peak_memory_mb']:.0f}"]


def main():
    parser = arguments(__doc__)
    parser.add_argument("case", nargs="*", default=["ironing", "20", "40", "hertz"], metavar="CASE",
                        help="`ironing`, elements along the block (even), or `hertz`; 30 was measured too "
                             "(ironing 20 40 hertz)")
    parser.add_argument("--ranks", type=int, default=2, help="(%(default)s)")
    args = parser.parse_args()
    sizes = [int(case) if case.isdigit() else 0 for case in args.case if case not in ("ironing", "hertz")]
    if any(n < 2 or n % 2 for n in sizes):
        parser.error("a case is `ironing`, `hertz`, or an even number, 2 or more")

    study.setup()
    rows, failed = [], False
    with tempfile.TemporaryDirectory() as folder:
        if "ironing" in args.case:
            ironed, failed = ironing(Path(folder), args.ranks)
            study.table(IRONING_HEAD, ironed)
            print()
        for n in sizes:
            rows += [peer for peer in PEERS if peer[0] == n]
            for cap, overrides in caps(n, Path(folder)).items():
                say(f"n = {n}, {cap}")
                block = f"--set=body.block.block.elements=[{n}, {n}, {n // 2}]"
                run = study.Run(SCENE, Path(folder) / f"{n}-{cap}", args.ranks, block, *overrides)
                failed |= run.code != 0
                rows.append(row(n, cap, args.ranks, run))
        if rows:
            study.table(HEAD, rows)
        if "hertz" in args.case:
            say("hertz")
            row_of_nagata, hertz_failed = hertz(Path(folder), args.ranks)
            print()
            study.table(HERTZ_HEAD, [row_of_nagata, *HERTZ_PEERS])
            failed |= hertz_failed
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())

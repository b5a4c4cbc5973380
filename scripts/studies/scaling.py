#!/usr/bin/python3 -B
"""Cost by size, ranks and linear solver, as a Markdown table: unknowns, wall time, time in each phase (of the slowest
rank), memory (of all ranks), iterations of Newton's method and of the linear solver for each of its systems, systems
that it could not solve, and how far the forces are from those of the first run of the size.

`sphere` is inputs/sphere-on-block.toml with n x n x n/2 elements; `blocks` an elastic block that is pressed onto
another, with friction, and drawn along it: unlike meshes, n/2 x n/2 x n/2 elements on n x n x n/2. One run at a time.
"""

import csv
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import ROOT, arguments, say, study

PHASES = ["assembly", "search", "factor", "solve"]
HEAD = ["n", "solver", "ranks", "unknowns", "wall s", *(f"{phase} s" for phase in PHASES), "MB", "iterations", "linear",
        "unsolved", "forces"]

BLOCKS = """
title = "Two elastic blocks"
[body.low]
block = {{ box = {{ size = [4.0, 4.0, 2.0] }}, elements = [{n}, {n}, {half}] }}
material = "soft"
[body.high]
block = {{ box = {{ origin = [0.9, 0.9, 2.0], size = [2.1, 2.1, 2.1] }}, elements = [{half}, {half}, {half}] }}
material = "soft"
[material.soft]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[contact.joint]
slave = "high.zmin"
master = "low.zmax"
friction = 0.3
[[step]]
name = "press"
increments = 3
fix = [{{ set = "low.zmin" }}]
move = [{{ target = "high.zmax", by = [0.0, 0.0, -0.1] }}]
[[step]]
name = "slide"
increments = 3
fix = [{{ set = "low.zmin" }}]
move = [{{ target = "high.zmax", by = [0.2, 0.1, 0.0] }}]
[output]
every = 100
history = ["low.zmin", "high.zmax"]
"""


def scene(name, n, folder):
    """Scene file, and further arguments."""
    if name == "sphere":
        return ROOT / "inputs/sphere-on-block.toml", [f"--set=body.block.block.elements=[{n}, {n}, {n // 2}]"]
    file = folder / f"blocks-{n}.toml"
    file.write_text(BLOCKS.format(n=n, half=n // 2))
    return file, []


def forces(history):
    return [[float(row[c]) for c in row if c.endswith((".fx", ".fy", ".fz"))] for row in history]


def difference(history, reference):
    """Of the forces, over the largest."""
    if len(history) != len(reference):
        return f"{len(history)} increments, not {len(reference)}"
    pairs = [(a, b) for row, other in zip(forces(history), forces(reference)) for a, b in zip(row, other)]
    return f"{max(abs(a - b) for a, b in pairs) / max(abs(b) for _, b in pairs):.1e}"


def main():
    parser = arguments(__doc__)
    parser.add_argument("scene", choices=["sphere", "blocks"])
    parser.add_argument("--sizes", type=int, nargs="+", default=[20, 30, 40], metavar="N", help="(20 30 40)")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2], metavar="N", help="(1 2)")
    parser.add_argument("--solvers", nargs="+", default=["direct", "iterative"], choices=["direct", "iterative"])
    parser.add_argument("--limit", type=int, default=3600, metavar="S", help="seconds a run may take (3600)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="as in `nagata run`")
    parser.add_argument("--out", type=Path, metavar="FILE", help="also write the table here, as CSV")
    args = parser.parse_args()

    study.setup()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for n in args.sizes:
            file, options = scene(args.scene, n, Path(folder))
            first = None
            for solver, ranks in ((solver, ranks) for solver in args.solvers for ranks in args.ranks):
                say(f"{args.scene}, n = {n}, {solver}, ranks: {ranks}")
                run = study.Run(file, Path(folder) / f"{n}-{solver}-{ranks}", ranks, *options,
                                f"--set=solver.linear={solver}", *(f"--set={entry}" for entry in args.set),
                                limit=args.limit)
                if run.code != 0:
                    rows.append([n, solver, ranks, f"exit code {run.code}"])
                    continue
                first = first or run
                summary = run.summary
                rows.append([n, solver, ranks, summary["dofs"], f"{summary['wall_s']:.1f}",
                             *(f"{summary['phases_s'][phase]:.1f}" for phase in PHASES),
                             f"{summary['peak_memory_mb']:.0f}", summary["iterations"],
                             f"{summary['linear_iterations'] / summary['iterations']:.1f}",
                             summary["linear_unsolved"], difference(run.history, first.history)])
    rows = [row + [""] * (len(HEAD) - len(row)) for row in rows]
    study.table(HEAD, rows)
    if args.out:
        with open(args.out, "w", newline="") as file:
            csv.writer(file).writerows([HEAD, *rows])


if __name__ == "__main__":
    main()

#!/usr/bin/python3 -B
"""What a run costs by size, number of ranks and linear solver; what it would ask of more ranks than there are cores.

    scaling.py run SCENE...      runs series, prints them as a Markdown table, writes a CSV
    scaling.py fit CSV...        draws the series and fits a model of the costs to them, with its error
    scaling.py count SCENE...    counts work and messages of each rank of many, without running them: table and plot
    scaling.py slurm FOLDER SCENE...    writes jobs for SLURM that each run one number of ranks of a series

A strong series keeps the size over all numbers of ranks, a weak one the unknowns of a rank. Scenes of size N: `sphere`,
inputs/sphere-on-block.toml with N x N x N/2 elements; `blocks`, an elastic block that is pressed onto another, with
friction, and drawn along it: unlike meshes, N/2 x N/2 x N/2 elements on N x N x N/2; `ironing`, the rigid indenter of
inputs/ironing-rigid.toml on a slab of N x N/2 x N/2. One run at a time. Costs are of the slowest rank, memory of all.
"""

import argparse
import csv
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, OUT, ROOT, add_out, arguments, say, study, written

SCENES = ["sphere", "blocks", "ironing"]
SERIES = ["strong", "weak"]
SOLVERS = ["direct", "reuse", "iterative"]
PHASES = ["read", "partition", "search", "watch", "assembly", "factor", "solve", "output"]
BY_RANK = ["peak_memory_mb", "messages", "sent_mb"]
COUNTS = ["elements", "dofs", "increments", "iterations", "factorizations", "linear_iterations",
          "linear_reused", "linear_unsolved"]
COLUMNS = ["scene", "series", "size", "n", "solver", "ranks", "code", *COUNTS, "wall_s", *PHASES, *BY_RANK, "forces"]

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

# A slab with room for the indenter, whose mesh is too narrow for it.
IRONING = {
    "body.slab.plane_strain": "false",
    "body.slab.block.box": "{ origin = [-25.0, -50.0, 0.0], size = [100.0, 50.0, 50.0] }",
    "tool.indenter.smoothing": "profile",
    "step.press.increments": 5,
    "step.press.move.0.by": "[0.0, -5.0, 0.0]",
    "step.slide.increments": 5,
    "step.slide.move.0.by": "[5.0, 0.0, 0.0]",
    "output.every": 100,
}


def scene(name, n, folder):
    """Scene file, and the entries that are set in it."""
    half = n // 2
    if name == "sphere":
        return INPUTS / "sphere-on-block.toml", [f"body.block.block.elements=[{n}, {n}, {half}]"]
    if name == "ironing":
        entries = {"body.slab.block.elements": f"[{n}, {half}, {half}]", **IRONING}
        return INPUTS / "ironing-rigid.toml", [f"{key}={value}" for key, value in entries.items()]
    file = folder / f"blocks-{n}.toml"
    file.write_text(BLOCKS.format(n=n, half=half))
    return file, []


def size_on(series, size, ranks):
    """Even elements along the block; of a weak series `size` is that on one rank."""
    return size if series == "strong" else 2 * round(size * ranks ** (1 / 3) / 2)


def cost(name, n, solver, ranks, args, folder, first):
    """What is written of one run; `first` has the history of the first run of each scene and size."""
    say(f"{name}, n = {n}, {solver}, ranks: {ranks}")
    file, entries = scene(name, n, folder)
    entries = [*entries, f"solver.linear={solver}", *args.set]
    run = study.Run(file, folder / f"{name}-{n}-{solver}-{ranks}", ranks, *(f"--set={entry}" for entry in entries),
                    limit=args.limit)
    row = {"scene": name, "n": n, "solver": solver, "ranks": ranks, "code": run.code}
    if run.code == 0:
        summary = run.summary
        row |= {key: summary[key] for key in (*COUNTS, "wall_s")} | {key: summary["phases_s"][key] for key in PHASES}
        row |= {key: " ".join(map(str, summary["by_rank"][key])) for key in BY_RANK}
        reference = first.setdefault((name, n), run.history)
        row["forces"] = f"{study.difference(run.history, reference, 'force')[0]:.1e}"
    return row


def run(args):
    if not args.as_built:
        study.setup()
    rows, done, first = [], {}, {}
    cases = [(name, series, size, solver, ranks) for name in args.scenes for series in args.series
             for size in args.sizes for solver in args.solvers for ranks in args.ranks]
    # Ranks on other nodes read the scene, too: not in a folder of this one.
    with tempfile.TemporaryDirectory(dir=written(args.out).parent) as folder:
        for name, series, size, solver, ranks in cases:
            key = name, size_on(series, size, ranks), solver, ranks
            if key not in done:
                done[key] = cost(*key, args, Path(folder), first)
            rows.append({**done[key], "series": series, "size": size})
            with open(args.out, "w", newline="") as file:  # after each run, for the next may be one too many
                writer = csv.DictWriter(file, COLUMNS)
                writer.writeheader()
                writer.writerows(rows)
    show(rows)
    return int(any(row["code"] for row in rows))


def of_ranks(row, key):
    return [float(value) for value in row[key].split()]


def show(rows):
    head = ["scene", "series", "n", "unknowns", "solver", "ranks", "wall s", *(f"{phase} s" for phase in PHASES[2:7]),
            "MB", "of a rank", "iterations", "factored", "linear", "unsolved", "messages", "MB sent", "forces"]
    cells = []
    for row in rows:
        cell = [row["scene"], row["series"], row["n"], row.get("dofs", ""), row["solver"], row["ranks"]]
        if row["code"]:
            cells.append([*cell, f"exit code {row['code']}", *[""] * (len(head) - len(cell) - 1)])
            continue
        memory, messages, sent = (of_ranks(row, key) for key in BY_RANK)
        cells.append([*cell, f"{row['wall_s']:.1f}", *(f"{row[phase]:.1f}" for phase in PHASES[2:7]),
                      f"{sum(memory):.0f}", f"{max(memory):.0f}", row["iterations"],
                      row["factorizations"], f"{row['linear_iterations'] / row['iterations']:.1f}",
                      row["linear_unsolved"], f"{max(messages):.0f}", f"{max(sent):.1f}", row["forces"]])
    study.table(head, cells)


def read(paths):
    """The rows of CSV files, each run once in a series."""
    rows = {}
    numbers = ("size", "n", "ranks", *COUNTS, "wall_s", *PHASES)
    for path in paths:
        with open(path, newline="") as file:
            for row in (row for row in csv.DictReader(file) if row["code"] == "0"):
                key = tuple(row[name] for name in ("scene", "series", "size", "solver", "ranks"))
                rows[key] = {**row, **{name: float(row[name]) for name in numbers},
                             **{name: of_ranks(row, name) for name in BY_RANK}}
    if not rows:
        sys.exit("no run has succeeded")
    return list(rows.values())


def fit(args):
    from shared import costs  # noqa: PLC0415 # it needs Matplotlib, and a cluster that only runs may have none

    rows = read(args.files)
    runs = list({tuple(row[key] for key in ("scene", "n", "solver", "ranks")): row for row in rows}.values())
    models = {solver: costs.Model(solver, [row for row in runs if row["solver"] == solver]) for solver in SOLVERS
              if any(row["solver"] == solver for row in runs)}
    study.table(costs.HEAD, [row for model in models.values() for row in model.table()])
    print(f"\nRuns: {len(runs)}. Left out: each is foretold from the others.")
    costs.draw(rows, models, written(args.out))


def pieces(name, n, ranks):
    """{ranks: {quantity: its values of all ranks}}."""
    say(f"{name}, n = {n}")
    with tempfile.TemporaryDirectory() as folder:
        file, entries = scene(name, n, Path(folder))
        command = study.on_ranks(1, study.example("pieces"), file, ",".join(map(str, ranks)), *entries)
        done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, text=True, check=True)
    found = {count: {} for count in ranks}
    for line in csv.DictReader(done.stdout.splitlines()):
        row = {key: int(value) for key, value in line.items()}
        # Three numbers of 8 bytes are sent a node.
        row |= {"kb": 0.024 * row["sent"], "contact_kb": 0.024 * row["contact_sent"]}
        for quantity, value in row.items():
            found[row["ranks"]].setdefault(quantity, []).append(value)
    return found


def number(value):
    return f"{value:,.0f}" if value >= 10 else f"{value:.1f}"


def count(args):
    from shared import costs  # noqa: PLC0415 # as above

    ranks = sorted({1, *args.ranks})
    found = {name: pieces(name, args.size, ranks) for name in args.scenes}
    for name, of_ranks in found.items():
        shown = [quantity for quantity in costs.COUNTED if any(of_ranks[ranks[-1]][quantity])]
        rows = [[count, *(f"{number(max(of[key]))} / {number(sum(of[key]) / count)}" for key in shown),
                 f"{costs.efficiency(of_ranks, count):.2f}"] for count, of in of_ranks.items()]
        print(f"\n{name}, n = {args.size}, counted, of the rank with most / mean:\n")
        study.table(["ranks", *(costs.COUNTED[key] for key in shown), "efficiency"], rows)
    costs.draw_counted(found, f"Counted, not run: n = {args.size}; rank with most (full), mean (dashed)",
                       written(args.out))


JOB = """#!/usr/bin/env bash
#SBATCH --job-name={name}
#SBATCH --nodes={nodes}
#SBATCH --ntasks-per-node={per_node}
#SBATCH --cpus-per-task=1
#SBATCH --exclusive
#SBATCH --time={time}
#SBATCH --output={folder}/{name}.log
{options}set -euo pipefail
exec {command}
"""


def slurm(args):
    folder = args.folder.resolve()
    if not folder.as_posix().isascii() or any(c.isspace() for c in folder.as_posix()):
        sys.exit("SLURM wants a folder without blanks")
    for name in args.scenes:
        for series in args.series:
            for nodes in args.nodes:
                ranks = nodes * args.per_node
                job = f"{name}-{series}-{ranks:05}"
                command = [ROOT / "scripts/studies/scaling.py", "run", name, "--series", series, "--sizes", *args.sizes,
                           "--ranks", ranks, "--solvers", *args.solvers, "--limit", args.limit,
                           *(f"--set={entry}" for entry in args.set), "--as-built", "--out", folder / f"{job}.csv"]
                text = JOB.format(name=job, nodes=nodes, per_node=args.per_node, time=args.time, folder=folder,
                                  options="".join(f"#SBATCH {option}\n" for option in args.sbatch),
                                  command=shlex.join(map(str, command)))
                written(folder / f"{job}.sbatch").write_text(text)
    print(f"for job in {shlex.quote(str(folder))}/*.sbatch; do sbatch \"$job\"; done")


def main():
    parser = arguments(__doc__)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    scenes = argparse.ArgumentParser(add_help=False)
    scenes.add_argument("scenes", nargs="+", choices=SCENES, metavar="SCENE", help=", ".join(SCENES))
    series = argparse.ArgumentParser(add_help=False)
    series.add_argument("--series", nargs="+", choices=SERIES, default=["strong"], help="(strong)")
    series.add_argument("--sizes", type=int, nargs="+", default=[20], metavar="N",
                        help="elements along the block, in a weak series on one rank (20)")
    series.add_argument("--solvers", nargs="+", choices=SOLVERS, default=SOLVERS, help="(all)")
    series.add_argument("--limit", type=int, default=3600, metavar="S", help="seconds a run may take (%(default)s)")
    series.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="as in `nagata run`")
    add = lambda does, told, *parents: commands.add_parser(does.__name__, help=told, description=told, parents=parents)

    command = add(run, "runs series", scenes, series)
    command.add_argument("--ranks", type=int, nargs="+", default=[1, 2], metavar="N", help="(1 2)")
    command.add_argument("--as-built", action="store_true", help="take the program as it is, without scripts/setup")
    add_out(command, OUT / "scaling.csv")
    command.set_defaults(does=run)

    command = add(fit, "draws series and fits a model to them")
    command.add_argument("files", type=Path, nargs="+", metavar="CSV", help="of `run`")
    add_out(command, OUT / "scaling.png")
    command.set_defaults(does=fit)

    command = add(count, "counts work and messages of many ranks", scenes)
    command.add_argument("--size", type=int, default=80, metavar="N", help="elements along the block (%(default)s)")
    command.add_argument("--ranks", type=int, nargs="+", default=[2**k for k in range(11)], metavar="N",
                         help="(1 2 4 ... 1024)")
    add_out(command, OUT / "counted.png")
    command.set_defaults(does=count)

    command = commands.add_parser("slurm", parents=[series], help=(told := "writes jobs for SLURM"), description=told)
    command.add_argument("folder", type=Path, metavar="FOLDER", help="for the jobs and what they write")
    command.add_argument("scenes", nargs="+", choices=SCENES, metavar="SCENE", help=", ".join(SCENES))
    command.add_argument("--nodes", type=int, nargs="+", default=[1, 2, 4, 8], metavar="N", help="(1 2 4 8)")
    command.add_argument("--per-node", type=int, default=32, metavar="N", help="ranks on a node (%(default)s)")
    command.add_argument("--time", default="01:00:00", help="of a job (%(default)s)")
    command.add_argument("--sbatch", action="append", default=[], metavar="OPTION",
                         help="of sbatch, as --sbatch=--partition=long; may be repeated")
    command.set_defaults(does=slurm)

    args = parser.parse_args()
    return args.does(args)


if __name__ == "__main__":
    sys.exit(main())

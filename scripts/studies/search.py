#!/usr/bin/python3 -B
"""Measures what the search for contact costs: wavy surfaces of N x N patches that move with their nodes under as many
slave nodes, cut so that no rank has what it needs. Prints, as Markdown tables, microseconds a slave node of processor
time and the exponents of their growth, what a rank holds and sends against the number of ranks, and the share of the
search in the ironing of one body on another."""

import csv
import math
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, arguments, say, study

PARTS = {"search": "global search", "fetch": "fetch of patches", "iterate": "positions and shapes",
         "first": "first projection", "project": "projection"}


def measure(ranks, smoothing, sizes, repeats):
    """The least of each number over some repeats, a row for each size."""
    command = study.on_ranks(ranks, study.example("search"), smoothing, *sizes)
    rows = None
    for _ in range(repeats):
        say(f"{ranks} ranks, {smoothing}")
        done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, text=True, check=True)
        again = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(done.stdout.splitlines())]
        rows = again if rows is None else [{k: min(a[k], b[k]) for k in a} for a, b in zip(rows, again)]
    return rows


def exponent(rows, part):
    """Slope of log(time) over log(nodes), by least squares."""
    points = [(math.log(row["nodes"]), math.log(row[part])) for row in rows if row[part] > 0.0]
    x, y = (sum(c) / len(points) for c in zip(*points))
    return sum((a - x) * (b - y) for a, b in points) / sum((a - x) ** 2 for a, _ in points)


def growth(ranks, args):
    rows = [row for n in ranks for row in measure(n, args.smoothing, args.sizes, args.repeats)]
    table = []
    for n in ranks:
        of_ranks = [row for row in rows if row["ranks"] == n]
        for row in of_ranks:
            table.append([n, f"{row['nodes']:.0f}", *(f"{row[part] / row['nodes'] * 1e6:.2f}" for part in PARTS)])
        table.append([n, "exponent", *(f"{exponent(of_ranks, part):.2f}" for part in PARTS)])
    study.table(["ranks", "slave nodes", *(f"{name}, µs a node" for name in PARTS.values())], table)


def sharing(args):
    table = []
    for n in args.ranks:
        row = measure(n, args.smoothing, [args.held], 1)[0]
        table.append([n, *(f"{row[key]:.0f}" for key in ("patches", "messages_search", "messages_iterate"))])
    study.table(["ranks", f"patches a rank holds, of {args.held ** 2}", "messages of a rank in a global search",
                 "in an iterate"], table)


def share_of_ironing(args):
    with tempfile.TemporaryDirectory() as folder:
        run = study.Run(args.scene, Path(folder) / "run", 2, "--set", "step.slide.increments=80",
                        "--set", "step.slide.move.0.by=[25.0, 0.0, 0.0]")
        if run.code != 0:
            sys.exit(run.code)
    summary = run.summary
    phases = summary["phases_s"]
    study.table(["scene", "wall s", "search s", "share", "fetches", "patterns built anew", "analyses"],
                [[args.scene.stem, f"{summary['wall_s']:.1f}", f"{phases['search']:.2f}",
                  f"{100.0 * phases['search'] / summary['wall_s']:.1f} %", summary["search_fetches"],
                  summary["pattern_rebuilds"], summary["analyses"]]])


def main():
    parser = arguments(__doc__)
    parser.add_argument("--sizes", type=int, nargs="+", default=[32, 100, 316, 1000], metavar="N",
                        help="patches along a side in the first table (32 100 316 1000)")
    parser.add_argument("--smoothing", choices=["nagata", "facet"], default="nagata", help="(%(default)s)")
    parser.add_argument("--repeats", type=int, default=3, metavar="N", help="the least time counts (%(default)s)")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2, 3, 4, 6, 8, 16, 32], metavar="N",
                        help="of the second table (1 2 3 4 6 8 16 32)")
    parser.add_argument("--held", type=int, default=200, metavar="N", help="patches along a side there (%(default)s)")
    parser.add_argument("--scene", type=Path, default=INPUTS / "ironing-deformable.toml",
                        help="whose share is measured (inputs/ironing-deformable.toml)")
    args = parser.parse_args()

    study.setup()
    growth([1, 2], args)
    print()
    sharing(args)
    print()
    share_of_ironing(args)


if __name__ == "__main__":
    main()

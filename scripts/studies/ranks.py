#!/usr/bin/python3 -B
"""Runs a scene on several numbers of ranks and prints, as a Markdown table, wall time, the seconds in each phase (of
the slowest rank), iterations, and how far the history is from that of the first run."""

import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import arguments, say, study


def told(difference, where):
    return f"{difference:.1e} ({where})" if where else f"{difference:.1e}"


def main():
    parser = arguments(__doc__)
    parser.add_argument("scene", type=Path)
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2, 3, 4], metavar="N", help="(1 2 3 4)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="as in `nagata run`")
    parser.add_argument("--steps", metavar="N", help="as in `nagata run`")
    args = parser.parse_args()
    options = [f"--set={entry}" for entry in args.set] + (["--steps", args.steps] if args.steps else [])

    study.setup()
    first, rows = None, []
    with tempfile.TemporaryDirectory() as folder:
        for ranks in args.ranks:
            say(f"{args.scene}, ranks: {ranks}")
            run = study.Run(args.scene, Path(folder) / str(ranks), ranks, *options)
            if run.code != 0:
                sys.exit(run.code)
            first = first or run
            phases = run.summary["phases_s"]
            rows.append([ranks, f"{run.summary['wall_s']:.1f}", *(f"{s:.2f}" for s in phases.values()),
                         run.effort, run.summary["cutbacks"], f"{run.summary['peak_memory_mb']:.0f}",
                         told(*study.difference(run.history, first.history))])
    head = ["ranks", "wall s", *(f"{phase} s" for phase in phases), "increments / iterations", "cutbacks", "peak MB",
            f"largest difference to the run on {args.ranks[0]}"]
    study.table(head, rows)


if __name__ == "__main__":
    main()

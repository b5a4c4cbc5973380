#!/usr/bin/python3 -B
"""Runs the ironing scenes, with rigid and elastic indenter, with the exact tangent and the fixed frame of the paper,
and with each transfer of contact forces. Prints, as Markdown tables, what that costs and how the iterations converge
in a few increments: residual over the largest force, with the number of status changes in brackets."""

import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, arguments, say, study

TRACE = "residual/force (status changes): "
CONTACT = "contact.top"
# Name, scene, overrides.
VARIANTS = [
    ("rigid", "ironing-rigid", {}),
    *(("elastic, " + transfer, "ironing-deformable", {"transfer": transfer})
      for transfer in ("patch", "bilinear", "variational")),
]


def traces(log):
    """Residuals of the increments that converged, in order."""
    found, last = [], ""
    for line in log.read_text().splitlines():
        if TRACE in line:
            last = line.split(TRACE)[1].strip()
        elif "  increment " in line:
            found.append(last)
    return found


def main():
    parser = arguments(__doc__)
    parser.add_argument("--slide", type=float, default=5.0, metavar="MM", help="(%(default)s)")
    parser.add_argument("--increments", type=int, nargs="+", default=[10, 15, 30], metavar="N",
                        help="whose residuals are printed; 20 are of the press (10 15 30)")
    parser.add_argument("--ranks", type=int, default=2, metavar="N", help="(%(default)s)")
    args = parser.parse_args()

    study.setup()
    costs, residuals = [], []
    with tempfile.TemporaryDirectory() as folder:
        for name, scene, keys in VARIANTS:
            for tangent in ("exact", "fixed-frame"):
                say(f"{name}, {tangent}")
                out = Path(folder) / f"{name}-{tangent}"
                settings = {**{f"{CONTACT}.{key}": value for key, value in keys.items()}, f"{CONTACT}.tangent": tangent,
                            "step.1.move.0.by.0": args.slide, "step.1.increments": round(3.2 * args.slide),
                            "output.every": 1000}
                options = [f"--set={key}={value}" for key, value in settings.items()]
                run = study.Run(INPUTS / f"{scene}.toml", out, args.ranks, *options)
                if run.code not in (0, 1):
                    sys.exit(run.code)
                if run.code == 1:
                    costs.append([name, tangent, "stopped", "", "", "", ""])
                    continue
                summary, phases = run.summary, run.summary["phases_s"]
                costs.append([name, tangent, run.effort, f"{summary['iterations'] / summary['increments']:.2f}",
                              summary["cutbacks"], f"{summary['wall_s']:.1f}",
                              f"{1e3 * phases['assembly'] / summary['iterations']:.1f}"])
                found = traces(out / "log.txt")
                residuals += [[name, tangent, k, found[k - 1]] for k in args.increments if k <= len(found)]
    study.table(["indenter, transfer", "tangent", "increments / iterations", "iterations an increment", "cutbacks",
                 f"wall s on {args.ranks} ranks", "assembly ms an iteration"], costs)
    print()
    study.table(["indenter, transfer", "tangent", "increment", "residual over force"], residuals)


if __name__ == "__main__":
    main()

#!/usr/bin/python3 -B
"""Runs a rigid ironing scene with one description of its tool after the other and prints, as Markdown tables, what that
does to the forces, their chatter, the iterations and the time."""

import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, arguments, ironing, say, study

DESCRIPTIONS = ["facet", "nagata", "bezier", "nurbs", "profile"]


def main():
    parser = arguments(__doc__)
    parser.add_argument("scene", type=Path, nargs="?", default=INPUTS / "ironing-rigid.toml",
                        help="(inputs/ironing-rigid.toml)")
    parser.add_argument("--smoothing", nargs="+", default=DESCRIPTIONS, metavar="NAME", help=" ".join(DESCRIPTIONS))
    parser.add_argument("--tool", default="indenter", help="(%(default)s)")
    parser.add_argument("--pitch", type=float, default=2.5, help="length of a slab element, mm (%(default)s)")
    parser.add_argument("--range", type=float, nargs=2, default=(25.0, 110.0), metavar=("FROM", "TO"),
                        help="slides over which chatter is measured, mm (25 110)")
    parser.add_argument("--ranks", type=int, default=2, metavar="N", help="(%(default)s)")
    args = parser.parse_args()

    study.setup()
    forces, costs = [], []
    with tempfile.TemporaryDirectory() as folder:
        for name in args.smoothing:
            say(f"{name}")
            out = Path(folder) / name
            run = study.Run(args.scene, out, args.ranks, f"--set=tool.{args.tool}.smoothing={name}")
            if run.code != 0:
                sys.exit(run.code)
            slide = ironing.Run(out, args.tool, args.pitch)
            mask = slide.window(*args.range, args.pitch)
            chatter = [ironing.detrend(grid)[mask] for grid in (slide.v_grid, slide.h_grid)]
            v, h = slide.at(0.0)
            means = f"{slide.v_grid[mask].mean():.1f}, {slide.h_grid[mask].mean():.1f}"
            forces.append([name, f"{v:.2f}, {h:.2f}", means,
                           *(f"{c.std():.2f}" for c in chatter), *(f"{c.max() - c.min():.1f}" for c in chatter)])
            phases, summary = run.summary["phases_s"], run.summary
            costs.append([name, run.effort, f"{summary['iterations'] / summary['increments']:.2f}", summary["cutbacks"],
                          f"{summary['wall_s']:.1f}", f"{phases['search']:.2f}", f"{phases['assembly']:.2f}"])
    study.table(["description", "V, H pressed, N", "V, H mean, N", "chatter of V rms, N", "chatter of H rms, N",
                 "of V peak to peak, N", "of H peak to peak, N"], forces)
    print()
    study.table(["description", "increments / iterations", "iterations an increment", "cutbacks",
                 f"wall s on {args.ranks} ranks", "search s", "assembly s"], costs)


if __name__ == "__main__":
    main()

#!/usr/bin/python3 -B
"""Two builds of nagata by turns over scenes of inputs/: what the newer takes of the time of the older, and how far its
forces are from the older's, at the end and at any time that both have, over the largest.

    scripts/studies/versions.py OLD NEW [--inputs FOLDER] [--scenes NAME ...] [--rounds 2] [--ranks 1]
"""

import statistics
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, arguments, say, study

# Name: scene of inputs/, settings.
SCENES = {
    "ironing-rigid": ("ironing-rigid", []),
    "ironing-deformable": ("ironing-deformable", []),
    "sphere, n = 20": ("sphere-on-block", ["body.block.block.elements=[20, 20, 10]"]),
    "sphere, n = 40": ("sphere-on-block", ["body.block.block.elements=[40, 40, 20]"]),
    "extrusion-rigid": ("extrusion-rigid", []),
    "extrusion": ("extrusion", []),
    "square-cup-small": ("square-cup-small", []),
}
PHASES = {"wall": None, "assembly": ["assembly"], "contact": ["search", "watch"], "systems": ["factor", "solve"]}
HEAD = ["scene", "increments", "iterations", "cuts", *PHASES, "forces at the end", "at any time"]


def seconds(run, phases):
    return sum(run.summary["phases_s"].get(phase, 0.0) for phase in phases) if phases else run.summary["wall_s"]


def forces(history):
    """By time, by column."""
    columns = [c for c in history[0] if c.endswith((".fx", ".fy", ".fz"))]
    return {row["time"]: {c: float(row[c]) for c in columns} for row in history}


def differences(old, new):
    """At the last time, and the largest at those that both have."""
    old, new = forces(old.history), forces(new.history)
    columns = set(next(iter(old.values()))) & set(next(iter(new.values())))
    largest = max((abs(row[c]) for row in old.values() for c in columns), default=0.0) or 1.0
    apart = {time: max(abs(old[time][c] - new[time][c]) for c in columns) / largest for time in old if time in new}
    last = next(reversed(old))
    return (f"{apart[last]:.0e}" if last in apart else "another time"), f"{max(apart.values(), default=0.0):.0e}"


def main():
    parser = arguments(__doc__)
    parser.add_argument("old", type=Path)
    parser.add_argument("new", type=Path)
    parser.add_argument("--inputs", type=Path, default=INPUTS, help="scenes of the older, if it has others")
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--ranks", type=int, default=1)
    args = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name in args.scenes:
            scene, settings = SCENES[name]
            sets = [f"--set={entry}" for entry in [*settings, "output.every=100000"]]
            pairs = []
            for k in range(args.rounds):
                say(f"{name}, {k + 1} of {args.rounds}")
                pairs.append([
                    study.Run(inputs / f"{scene}.toml", Path(folder) / build, args.ranks, *sets, program=program)
                    for build, program, inputs in [("old", args.old, args.inputs), ("new", args.new, INPUTS)]])
            if any(run.code != 0 for pair in pairs for run in pair):
                rows.append([name, "failed", *[""] * (len(HEAD) - 2)])
                continue
            old, new = pairs[-1]
            counts = [f"{old.summary[key]}, {new.summary[key]}" for key in ("increments", "iterations", "cutbacks")]
            ratios = [statistics.median(seconds(new, phases) / (seconds(old, phases) or float("nan"))
                                        for old, new in pairs) for phases in PHASES.values()]
            rows.append([name, *counts, *(f"{ratio:.2f}" for ratio in ratios), *differences(old, new)])
    study.table(HEAD, rows)


if __name__ == "__main__":
    main()

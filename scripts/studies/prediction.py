#!/usr/bin/python3 -B
"""Runs the scenes of inputs/, long ones in short forms, and prints, as a Markdown table, memory and wall time as
foretold when each began, as measured, and measured over foretold; then how many are within 25 % and a factor of 2, and
the spread.

What has run is kept in a CSV and not run again. Without --kept, rates are measured by `nagata calibrate` first, and
kept beside it. Under --cpu, on one rank, processor time counts instead of wall time: for a machine on which others
compute, too."""

import csv
import math
import os
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import ROOT, add_out, arguments, say, study


def short(step, by, increments=None, duration=None, item=0):
    """Overrides that shorten a step to a part of its motion."""
    sets = [f"step.{step}.move.{item}.by={by}"]
    sets += [f"step.{step}.increments={increments}"] if increments else []
    sets += [f"step.{step}.duration={duration}"] if duration else []
    return [f"--set={entry}" for entry in sets]


FORMS = {
    "c-strip": [],
    "cattaneo-mindlin": [],
    "disk-in-plate": ["--set=step.press.increments=20"],
    "extrusion": short("push", [15, 0, 0], increments=10),
    "extrusion-rigid": short("push", [30, 0, 0], increments=20),
    "hertz-cylinder": [],
    "hertz-sphere": [],
    "ironing-deformable": ["--steps=1"],
    "ironing-peers": short("slide", [40, 0, 0], increments=40),
    "ironing-rigid": short("slide", [31.25, 0, 0], increments=100),
    "patch-test": [],
    "shallow-ironing": ["--steps=1"],
    "sphere-on-block": [],
    "square-cup": ["--steps=1"],
    "square-cup-small": short("draw", [0, 0, -10], duration=10),
    "tube-buckling": short("crush", [0, 0, -2], duration=2),
    "tube-buckling-fine": short("crush", [0, 0, -0.5], duration=0.5),
}
COLUMNS = ["scene", "ranks", "unknowns", "increments", "iterations", "memory_mb", "peak_memory_mb", "predicted_s",
           "wall_s", "cpu_s"]
FACTORS = {"memory": 1.25, "time": 2.0}


def measured(scene, ranks, folder):
    """A row of what was foretold and what it was."""
    run = study.Run(ROOT / "inputs" / f"{scene}.toml", folder, ranks, *FORMS[scene], limit="600")
    if run.code != 0:
        sys.exit(f"{scene} on {ranks}: exit code {run.code}")
    s = run.summary
    foretold = s["predicted"]
    return {"scene": scene, "ranks": ranks, "unknowns": s["dofs"], "increments": s["increments"],
            "iterations": s["iterations"], "memory_mb": foretold["memory_mb"], "peak_memory_mb": s["peak_memory_mb"],
            "predicted_s": foretold["wall_s"], "wall_s": s["wall_s"], "cpu_s": round(run.cpu, 3)}


def started():
    """Processor time of a process that does nothing."""
    return min(study.Process(study.on_ranks(1, study.NAGATA, "--version"), stdout=-3).cpu for _ in range(5))


def within(ratios, factor):
    return sum(1 / factor <= ratio <= factor for ratio in ratios)


def main():
    parser = arguments(__doc__)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"only these of {', '.join(FORMS)}")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1], metavar="N", help="(1)")
    add_out(parser, ROOT / "out" / "prediction.csv")
    parser.add_argument("--kept", action="store_true", help="with the rates of the user's cache, or default ones")
    parser.add_argument("--cpu", action="store_true", help="judge by processor time, on one rank")
    args = parser.parse_args()
    if unknown := set(args.scenes).difference(FORMS):
        parser.error(f"there is no scene {', '.join(sorted(unknown))}; there are {', '.join(FORMS)}")
    study.setup()
    args.out.parent.mkdir(parents=True, exist_ok=True)
    if not args.kept:
        os.environ["XDG_CACHE_HOME"] = str(args.out.resolve().parent)
    rows = list(csv.DictReader(args.out.read_text().splitlines())) if args.out.exists() else []
    done = {(row["scene"], int(row["ranks"])) for row in rows}
    for ranks in args.ranks:
        wanted = [scene for scene in args.scenes or FORMS if (scene, ranks) not in done]
        if wanted and not args.kept:
            say(f"calibrate, ranks: {ranks}")
            study.Process(study.on_ranks(ranks, study.NAGATA, "calibrate"))
        for scene in wanted:
            say(f"{scene}, ranks: {ranks}")
            with tempfile.TemporaryDirectory() as folder:
                rows.append(measured(scene, ranks, Path(folder) / "out"))
            with open(args.out, "w", newline="") as file:
                writer = csv.DictWriter(file, COLUMNS)
                writer.writeheader()
                writer.writerows(rows)
    show([row for row in rows if int(row["ranks"]) in args.ranks], started() if args.cpu else None)


def show(rows, start):
    """The table; processor times are without that of a start, if it is given."""
    rows = [{key: value if key == "scene" else float(value) for key, value in row.items()} for row in rows]
    cells, ratios = [], {"memory": [], "time": []}
    for row in rows:
        time = row["wall_s"] if start is None else row["cpu_s"] - start
        ratios["memory"].append(row["peak_memory_mb"] / row["memory_mb"])
        ratios["time"].append(time / row["predicted_s"])
        cells.append([row["scene"], *(f"{row[key]:.0f}" for key in COLUMNS[1:5]), f"{row['memory_mb']:.0f}",
                      f"{row['peak_memory_mb']:.0f}", f"{ratios['memory'][-1]:.2f}", f"{row['predicted_s']:.2f}",
                      f"{time:.2f}", f"{ratios['time'][-1]:.2f}"])
    study.table(["scene", *COLUMNS[1:5], "MB foretold", "measured", "ratio", "s foretold", "measured", "ratio"], cells)
    for what, factor in FACTORS.items():
        logs = [math.log(ratio) for ratio in ratios[what]]
        spread = math.exp(math.sqrt(sum(log * log for log in logs) / len(logs)))
        count = within(ratios[what], factor)
        print(f"{what}: {count} of {len(rows)} within a factor of {factor}; root mean square {spread:.2f}")


if __name__ == "__main__":
    main()

#!/usr/bin/python3 -B
"""Kills runs at random moments, lets each go on from its last checkpoint until it is through, and prints, as a Markdown
table, the kills, the increments, and how far the history is from that of a run that nobody killed."""

import contextlib
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import ROOT, arguments, say, study

# Scenes in short form.
SCENES = {
    "ironing-rigid": ["step.slide.increments=40", "step.slide.move.0.by=[12.5, 0, 0]"],
    "square-cup-small": ["step.draw.duration=2", "step.draw.move.0.by=[0, 0, -2]"],
    "tube-buckling": ["step.crush.duration=2", "step.crush.move.0.by=[0, 0, -2]"],
}
CHECKPOINT = "output.checkpoint={ increments = 2 }"


def rows(out):
    """Whole rows of the history."""
    try:
        return max((out / "history.csv").read_text().count("\n") - 1, 0)
    except FileNotFoundError:
        return 0


def apart(run, whole):
    """The largest difference of histories; residuals are of rounding, and tries that failed depend on it."""
    def rest(history):
        return [{c: row[c] for c in row if c not in ("residual", "limit", "failures")} for row in history]

    return study.difference(rest(run.history), rest(whole.history))


def written(out):
    """When the history was written last."""
    history = out / "history.csv"
    return history.stat().st_mtime_ns if history.exists() else 0


def killed(scene, out, ranks, options, spare):
    """Starts a run or goes on with it, and kills a rank: of four kills one as it starts, the others within so many
    seconds after it has written something; whether it had not ended by then."""
    restart = ["--restart"] if (out / "checkpoint.h5").exists() else []
    command = study.on_ranks(ranks, study.NAGATA, "run", scene, "--out", out, "--quiet", *options, *restart)
    before, starts = written(out), random.random() < 0.25
    process = subprocess.Popen([str(word) for word in command], stderr=subprocess.DEVNULL)
    while not starts and process.poll() is None and written(out) == before:
        time.sleep(0.01)
    try:
        process.wait(random.uniform(0.0, spare))
        return False
    except subprocess.TimeoutExpired:
        children = subprocess.run(["pgrep", "-P", str(process.pid)], capture_output=True, text=True, check=False)
        with contextlib.suppress(ProcessLookupError):  # it has just ended
            os.kill(int(random.choice(children.stdout.split() or [process.pid])), signal.SIGKILL)
        process.wait()
        return True


def main():
    parser = arguments(__doc__)
    parser.add_argument("scene", nargs="*", default=list(SCENES), help=f"({' '.join(SCENES)})")
    parser.add_argument("--kills", type=int, default=20, metavar="N", help="of each scene (20)")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="(1)")
    args = parser.parse_args()
    random.seed(args.seed)

    study.setup()
    table = []
    for name in args.scene:
        scene = ROOT / "inputs" / f"{name}.toml"
        options = [f"--set={entry}" for entry in [*SCENES[name], CHECKPOINT]]
        with tempfile.TemporaryDirectory() as folder:
            whole = study.Run(scene, Path(folder) / "whole", 2, *options)
            if whole.code != 0:
                sys.exit(whole.code)
            out, kills = Path(folder) / "killed", 0
            for _ in range(args.kills):
                kills += killed(scene, out, random.choice([1, 2, 3]), options, 2.0 * whole.wall / args.kills)
                say(f"{name}: killed {kills} times, {rows(out)} increments")
            restart = ["--restart"] if (out / "checkpoint.h5").exists() else []
            last = study.Run(scene, out, 2, *options, *restart)
            worst, where = apart(last, whole) if last.code == 0 else (last.code, "exit code")
            table.append([name, kills, len(whole.history), f"{worst:.1e} {where}"])
    study.table(["scene", "kills", "increments", "largest difference"], table)


if __name__ == "__main__":
    main()

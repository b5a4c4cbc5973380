#!/usr/bin/python3 -B
"""Runs decks of CalculiX, and the scenes that `nagata convert` makes of them, and prints side by side the total forces
on the sets whose forces a deck asks for, at the end of each step, and the largest displacement in CalculiX where a deck
asks for those of all nodes. By default all decks of tests/decks that CalculiX can run. The elements are not the same:
C3D8 of CalculiX is B-bar, C3D8I is like hex8-eas; nor is contact, which is a penalty there. The forces of CalculiX
leave out what acts on the nodes of the set themselves, as gravity does.
"""

import re
import subprocess
import sys
import tempfile
from collections import defaultdict
from itertools import groupby
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import ROOT, arguments, install, study

NUMBER = r"[-+.\dE]+"
FORCE = rf"total force .* set (\S+) and time +({NUMBER})\s+({NUMBER}) +({NUMBER}) +({NUMBER})"
MOVED = rf"displacements .* set NALL and time +({NUMBER})\s+((?:\d+(?: +{NUMBER}){{3}}\s+)+)"


def calculix(deck, folder):
    """For each time the forces by set, and the largest displacement under ""."""
    text = deck.read_text().replace(", Solver=Pardiso", "")  # Debian's has no PARDISO
    (folder / "deck.inp").write_text(text)
    subprocess.run(["ccx", "deck"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    said, found = (folder / "deck.dat").read_text(), defaultdict(dict)
    for name, time, *force in re.findall(FORCE, said):
        found[round(float(time), 9)][name] = [float(part) for part in force]
    for time, rows in re.findall(MOVED, said):
        moved = [[float(part) for part in row.split()[1:]] for row in rows.splitlines() if row.strip()]
        found[round(float(time), 9)][""] = [max(sum(u * u for u in row) ** 0.5 for row in moved)]
    return dict(found)


def nagata(deck, folder):
    """For each time at the end of a step the forces by set in capitals."""
    scene, out = folder / "scene.toml", folder / "out"
    subprocess.run([study.NAGATA, "convert", deck, "--out", scene], check=True, capture_output=True)
    run = study.Run(scene, out, 1)
    if run.code:
        sys.exit(run.code)
    found = {}
    for _, rows in groupby(run.history, key=lambda row: row["step"]):
        last = list(rows)[-1]
        forces = defaultdict(lambda: [0.0] * 3)
        for column, value in last.items():
            *name, component = column.split(".")
            if component in ("fx", "fy", "fz"):
                forces[".".join(name[1:] or name).upper()]["xyz".index(component[1])] += float(value)
        found[round(float(last["time"]), 9)] = forces
    return found


def main():
    parser = arguments(__doc__)
    parser.add_argument("decks", nargs="*", type=Path)
    decks = parser.parse_args().decks or sorted((ROOT / "tests" / "decks").glob("[cfp]*.inp"))
    install("calculix-ccx")
    study.setup()
    rows = []
    for deck in decks:
        with tempfile.TemporaryDirectory() as name:
            ours, theirs = nagata(deck, Path(name)), calculix(deck, Path(name))
        for time in ours:
            for name, force in theirs.get(time, {}).items():
                own = ours[time].get(name)
                rows.append([deck.stem, f"{time:g}", name or "largest displacement",
                             " ".join(f"{part:.6g}" for part in force),
                             " ".join(f"{part:.6g}" for part in own) if own else ""])
    study.table(["deck", "time", "of", "CalculiX", "nagata"], rows)


if __name__ == "__main__":
    main()

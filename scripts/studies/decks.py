#!/usr/bin/python3 -B
"""Runs decks of CalculiX, and the scenes that `nagata convert` makes of them, and prints side by side the total forces
on the sets whose forces a deck asks for, at the end of each step, and the largest displacement where a deck asks for
those of all nodes. By default all decks of tests/decks that CalculiX can run. The elements are not the same: C3D8 of
CalculiX is B-bar, C3D8I is like hex8-eas; nor is contact, which is a penalty there. The forces of CalculiX leave out
what acts on the nodes of the set themselves, as gravity does. Of axisymmetric elements it prints those of a wedge of
two degrees, without what acts on its sides: shown is the force of the ring along its axis.
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
from shared.scientific import h5py, np

NUMBER = r"[-+.\dE]+"
FORCE = rf"total force .* set (\S+) and time +({NUMBER})\s+({NUMBER}) +({NUMBER}) +({NUMBER})"
MOVED = rf"displacements .* set NALL and time +({NUMBER})\s+((?:\d+(?: +{NUMBER}){{3}}\s+)+)"
LARGEST = "largest displacement"
WEDGES = 180


def calculix(deck, folder):
    """For each time the forces by set, and the largest displacement."""
    text = deck.read_text().replace(", Solver=Pardiso", "")  # Debian's has no PARDISO
    (folder / "deck.inp").write_text(text)
    subprocess.run(["ccx", "deck"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    said, found = (folder / "deck.dat").read_text(), defaultdict(dict)
    for name, time, *parts in re.findall(FORCE, said):
        force = [float(part) for part in parts]
        found[round(float(time), 9)][name] = [WEDGES * force[1]] if is_ring(deck) else force
    for time, rows in re.findall(MOVED, said):
        moved = [[float(part) for part in row.split()[1:]] for row in rows.splitlines() if row.strip()]
        found[round(float(time), 9)][LARGEST] = [max(sum(u * u for u in row) ** 0.5 for row in moved)]
    return dict(found)


def is_ring(deck):
    return "TYPE=CAX4" in deck.read_text().upper()


def nagata(deck, folder):
    """For each time at the end of a step the forces by set in capitals, and the largest displacement."""
    scene, out = folder / "scene.toml", folder / "out"
    subprocess.run([study.NAGATA, "convert", deck, "--out", scene], check=True, capture_output=True)
    run = study.Run(scene, out, 1)
    if run.code:
        sys.exit(f"{deck.stem}: exit code {run.code}")
    found, moved = {}, displacements(out)
    for _, rows in groupby(run.history, key=lambda row: row["step"]):
        last = list(rows)[-1]
        forces = defaultdict(lambda: [0.0] * 3)
        for column, value in last.items():
            *name, component = column.split(".")
            if component in ("fx", "fy", "fz"):
                forces[".".join(name[1:] or name).upper()]["xyz".index(component[1])] += float(value)
        time = round(float(last["time"]), 9)
        found[time] = {name: force[1:2] if is_ring(deck) else force for name, force in forces.items()}
        found[time][LARGEST] = [moved[time]]
    return found


def displacements(out):
    """By time the largest displacement in the bodies."""
    with h5py.File(out / "fields.h5") as file:
        def largest(fields):
            bodies = (fields[grid]["node/displacement"][:] for grid in fields if grid.startswith("body_"))
            return max(np.linalg.norm(moved, axis=1).max() for moved in bodies)
        return {round(float(fields["time"][0]), 9): largest(fields) for fields in file["increments"].values()}


def shown(values):
    """Five digits; what is nothing beside the largest is 0."""
    largest = max(map(abs, values))
    return ", ".join("0" if abs(value) < 1e-4 * largest else f"{value:.5g}" for value in values)


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
            for name, values in theirs.get(time, {}).items():
                own = ours[time][name]
                apart = max(abs(a - b) for a, b in zip(own, values)) / max(map(abs, values))
                rows.append([f"`{deck.stem}`", f"{time:g}", name.removeprefix("INTERNAL_SELECTION-1_").lower(),
                             shown(values), shown(own), f"{100 * apart:.2g} %"])
    study.table(["deck", "time", "force on, or", "CalculiX", "nagata", "apart"], rows)


if __name__ == "__main__":
    main()

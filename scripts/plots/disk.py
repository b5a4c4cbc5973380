#!/usr/bin/python3 -B
"""Draws the tractions of the disk in a bored plate (inputs/disk-in-plate.toml) at the end of runs against theory.

Redraws Fig. 50 of Neto, Oliveira and Menezes, "Surface smoothing procedures in computational contact mechanics" (doi
10.1007/s11831-015-9159-7): pressure and shear times R/Q by the angle, of the first run; and the shear of all runs,
which differ in their number of increments. A nodal pressure is the contact force of the node over its area; that of the
last node of the contact, whose area lies in part outside, is too small. Prints for each run where it sticks and how far
it is from theory, over the largest value of each.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import OUT, add_out, arguments, written
from shared.scientific import h5py, np, plt

RADIUS = 10.0
STICK, SLIP = 1, 2


class Run:
    """Nodes of the rim by rising angle from the lowest: angle, pressure and shear times R/Q, status."""

    def __init__(self, folder):
        self.increments = len((folder / "history.csv").read_text().splitlines()) - 1
        with h5py.File(folder / "fields.h5") as file:
            fields = file["increments"][max(file["increments"])]["contact_bore/node"]
            points = file["grids/contact_bore/points"][:]
            front = points[:, 2] == 0.0
            x, y = points[front, :2].T
            angle = np.degrees(np.arctan2(x, 0.5 * (y.min() + y.max()) - y))
            order = np.argsort(angle)
            pick = lambda name: fields[name][:][front][order]
            normal, traction, pressure = pick("normal"), pick("traction"), pick("pressure")
            self.status, self.angle = pick("status"), angle[order]
            half = abs(fields["force"][:][:, 1].sum())
        scale = RADIUS / (2.0 * half)
        self.p = pressure * scale
        self.s = (traction[:, 0] * normal[:, 1] - traction[:, 1] * normal[:, 0]) * scale

    def report(self, theory):
        touching = self.status > 0
        inside = touching & (self.angle < self.angle[touching].max() - 1e-6)
        off = [abs(found - np.interp(self.angle, theory["theta"], theory[name]))[inside].max() / theory[name].max()
               for name, found in (("p", self.p), ("s", self.s))]
        shears = " ".join(f"{np.interp(a, self.angle, self.s):.4f}" for a in (10, 20, 30, 40, 50))
        print(f"{self.increments:>4} increments: {touching.sum()} nodes touch, sticks to "
              f"{self.angle[self.status == STICK].max():.2f}, slips from {self.angle[self.status == SLIP].min():.2f} "
              f"degrees, pR/Q {self.p[0]:.4f}, shear R/Q at 10 ... 50 degrees {shears}, largest {self.s.max():.4f}; "
              f"off by {off[0]:.1%} of the pressure, {off[1]:.1%} of the shear")


def draw(theory, runs, path):
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4), constrained_layout=True)
    first = runs[0]
    nodes = first.status > 0
    for name, label, color, found in (("p", "pressure", "tab:blue", first.p), ("s", "shear", "tab:orange", first.s)):
        left.plot(theory["theta"], theory[name], color=color, linewidth=1.2, label=f"{label}, theory")
        left.plot(first.angle[nodes], found[nodes], "o", color=color, markersize=3.5, label=label)
    left.set_title(f"{first.increments} increments")
    right.plot(theory["theta"], theory["s"], color="black", linewidth=1.2, label="theory")
    for run in runs:
        nodes = run.status > 0
        right.plot(run.angle[nodes], run.s[nodes], marker="o", markersize=2.5, linewidth=0.8, label=str(run.increments))
    right.set_title("shear by the number of increments")
    for axes in (left, right):
        axes.set_xlabel("angle from the line of the force, degrees")
        axes.set_xlim(0, 62)
        axes.set_ylim(bottom=0)
        axes.grid(alpha=0.3)
        axes.legend()
    left.set_ylabel("traction times R/Q")
    figure.savefig(path, dpi=110)


def main():
    parser = arguments(__doc__)
    parser.add_argument("runs", type=Path, nargs="+", metavar="FOLDER", help="results of runs")
    parser.add_argument("--theory", type=Path, default=OUT / "disk.csv", metavar="CSV",
                        help="written by scripts/studies/disk-theory.py (out/disk.csv)")
    add_out(parser, OUT / "disk.png")
    args = parser.parse_args()
    theory = np.genfromtxt(args.theory, delimiter=",", names=True)
    runs = [Run(folder) for folder in args.runs]
    for run in runs:
        run.report(theory)
    draw(theory, runs, written(args.out))


if __name__ == "__main__":
    main()

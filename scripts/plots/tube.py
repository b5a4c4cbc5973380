#!/usr/bin/python3 -B
"""Draws the force on the tube of inputs/tube-buckling.toml, and prints what can be checked of its folding.

Redraws Fig. 63 of Neto, Oliveira and Menezes, "Surface smoothing procedures in computational contact mechanics" (doi
10.1007/s11831-015-9159-7). The force is that on the whole tube, four times that on the quarter; the shortening is that
of the whole length, twice that of the half.

    scripts/plots/tube.py Nagata=out/tube-buckling facets=out/facets
"""

import csv
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import OUT, add_out, arguments, labelled, written
from shared.scientific import h5py, np, plt

RADIUS, THICKNESS, YIELD = 20.0, 1.0, 240.0
SQUASH = 2 * math.pi * RADIUS * THICKNESS * YIELD
# Mean force of axisymmetric folding, rigid and perfectly plastic: Alexander, Q. J. Mech. Appl. Math. 13 (1960) 10-15.
ALEXANDER = 6.08 * YIELD * THICKNESS**1.5 * math.sqrt(2 * RADIUS)
TURN = 0.05  # of the squash load: smaller ups and downs of the force are none


def turns(force):
    """Drops and rises of a curve by more than TURN, in turn, as indices of its extremes."""
    found, best, rising = [], 0, True
    for k, value in enumerate(force):
        if (value > force[best]) == rising and value != force[best]:
            best = k
        elif abs(value - force[best]) > TURN * SQUASH:
            found.append(best)
            best, rising = k, not rising
    return found


class Run:
    """Force of the whole tube against its shortening, from the results of a run."""

    def __init__(self, folder):
        with open(folder / "history.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        column = lambda name: np.array([float(row[name]) for row in rows])
        half, quarter = -column("tube.zmax.uz"), -column("tube.zmax.fz")
        self.shortening, self.force = 2 * np.r_[0.0, half], 4 * np.r_[0.0, quarter]
        self.increments, self.iterations = len(rows), int(column("iterations").sum())
        work = np.cumsum(np.diff(self.shortening) * (self.force[1:] + self.force[:-1]) / 2) / 8
        self.energy = (column("tube.elastic_energy") + column("tube.plastic_work")) / work
        self.work = work
        self.penetration = max(column(name).max() for name in rows[0] if name.endswith("max_penetration"))
        self.touches = {
            name.removesuffix(".active"): next((2 * u for u, n in zip(half, column(name)) if n), None)
            for name in rows[0] if name.endswith(".active")
        }
        self.read_fields(folder / "fields.h5")

    def read_fields(self, path):
        """Largest plastic strain of an element, and spread of the radius of nodes that began on a circle."""
        self.strain, self.spread = [], []
        with h5py.File(path) as file:
            points = file["grids/body_tube/points"][:]
            circles = np.round(np.c_[np.hypot(points[:, 0], points[:, 1]), points[:, 2]], 6)
            _, circle = np.unique(circles, axis=0, return_inverse=True)
            circle = circle.ravel()
            for increment in sorted(file["increments"].values(), key=lambda i: i["time"][0]):
                body, shortening = increment["body_tube"], 2 * increment["time"][0]
                self.strain.append((shortening, body["cell/equivalent_plastic_strain"][:].max()))
                places = points + body["node/displacement"][:]
                radius = np.hypot(places[:, 0], places[:, 1])
                most, least = np.full(circle.max() + 1, -np.inf), np.full(circle.max() + 1, np.inf)
                np.maximum.at(most, circle, radius)
                np.minimum.at(least, circle, radius)
                self.spread.append((shortening, (most - least).max() / RADIUS))

    def report(self, name):
        shortening, force = self.shortening, self.force
        extremes = turns(force)
        print(f"{name}: {self.increments} increments, {self.iterations} iterations, to {shortening[-1]:.3f} mm")
        for k, at in enumerate(extremes):
            print(f"  {'minimum' if k % 2 else 'maximum'} {force[at] / 1e3:7.3f} kN at {shortening[at]:6.3f} mm")
        first = extremes[0] if extremes else -1
        print(f"  first peak over the squash load, {SQUASH / 1e3:.2f} kN: {force[first] / SQUASH:.4f}")
        mean = np.trapz(force, shortening) / shortening[-1]
        print(f"  mean force {mean / 1e3:.3f} kN, over Alexander's {ALEXANDER / 1e3:.2f} kN: {mean / ALEXANDER:.3f}")
        print(f"  drops {(len(extremes) + 1) // 2}, reversals {len(extremes) // 2}")
        print(f"  first touch, mm: {self.touches}")
        for at in (10, 20, 30, 40):
            if at <= shortening[-1] + 1e-6:
                near = min(self.strain, key=lambda s: abs(s[0] - at))
                print(f"  largest plastic strain of an element at {near[0]:.1f} mm: {near[1]:.3f}")
        print(f"  largest penetration over the thickness {self.penetration / THICKNESS:.1e}")
        late = self.work > 0.01 * self.work[-1]
        print(f"  stored and plastic work over work: at the end {self.energy[-1]:.5f}, "
              f"from {self.energy[late].min():.5f} to {self.energy[late].max():.5f}")
        touch = min((t for t in self.touches.values() if t), default=np.inf)
        before = max((s for u, s in self.spread if u < touch), default=0.0)
        print(f"  spread of the radius on circles: before the first touch {before:.1e} R, "
              f"at most {max(s for _, s in self.spread):.1e} R")


def main():
    parser = arguments(__doc__)
    parser.add_argument("runs", type=labelled, nargs="+", metavar="LABEL=FOLDER", help="results of runs")
    add_out(parser, OUT / "tube.png")
    args = parser.parse_args()
    figure, axes = plt.subplots(figsize=(8, 4.2), constrained_layout=True)
    for order, (label, folder) in enumerate(args.runs):
        run = Run(folder)
        run.report(label)
        axes.plot(run.shortening, run.force / 1e3, color=f"C{order}", linewidth=1.2, zorder=9 - order, label=label)
    axes.axhline(SQUASH / 1e3, color="k", linewidth=0.8, linestyle=":", label="squash load")
    axes.axhline(ALEXANDER / 1e3, color="k", linewidth=0.8, linestyle="--", label="Alexander, mean")
    axes.set_ylabel("force, kN")
    axes.set_xlabel("shortening, mm")
    axes.set_ylim(bottom=0.0)
    axes.set_xlim(left=0.0)
    axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(written(args.out), dpi=110)


if __name__ == "__main__":
    main()

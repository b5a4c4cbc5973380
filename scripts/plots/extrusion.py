#!/usr/bin/python3 -B
"""Compares the forces that push the billet of the extrusion example, with Nagata patches and with facets.

Redraws Fig. 59 of Neto, Oliveira and Menezes, "Surface smoothing procedures in computational contact mechanics" (doi
10.1007/s11831-015-9159-7), the axial force against the displacement of the billet's back, here on the whole of it,
beside the force of ideal work, and its oscillation. Prints forces, oscillation, and the plastic strain at the end.
"""

import csv
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import OUT, add_out, arguments, labelled, written
from shared.scientific import h5py, np, plt

RADIUS, LENGTH, SLOPE, ENTRY = 50.0, 100.0, 0.035, 20.0  # of scripts/meshes/extrusion.py
YIELD, HARDENING = 31.0, 261.2
PITCH, TAPS = 5.0, 9  # element of the billet, mm; samples of its moving average


def bore(x):
    beyond = np.maximum(0.0, x - LENGTH)
    return RADIUS - SLOPE * np.where(beyond < ENTRY, beyond**2 / (2 * ENTRY), beyond - ENTRY / 2)


def ideal(pushed):
    """Force and strain at the front of a billet that keeps its volume, plane sections remaining plane."""
    x = np.linspace(0.0, 300.0, 30001)
    r = bore(x)
    volume = np.r_[0.0, np.cumsum((r[1:] ** 2 + r[:-1] ** 2) / 2 * np.diff(x))]
    back = np.interp(pushed, x, r)
    front = np.interp(np.interp(np.interp(pushed, x, volume) + RADIUS**2 * LENGTH, volume, x), x, r)
    work = lambda e: YIELD * e + HARDENING / 2 * e**2
    strain = lambda r: 2 * np.log(RADIUS / r)
    return math.pi * back**2 * (work(strain(front)) - work(strain(back))), strain(front)


class Run:
    """Force of the whole billet against the displacement, from the results of a run."""

    def __init__(self, folder):
        with open(folder / "history.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        column = lambda name: np.array([float(row[name]) for row in rows])
        self.pushed, self.force = column("billet.back.ux"), 4 * column("billet.back.fx")
        other = "die.fx" if "die.fx" in rows[0] else "skin.fx"
        self.unbalance = np.abs(self.force / (4 * column(other)) + 1).max()
        if "die.outer.fx" in rows[0]:
            self.unbalance = max(self.unbalance, np.abs(self.force / (4 * column("die.outer.fx")) + 1).max())
        self.increments, self.iterations = len(rows), int(column("iterations").sum())
        work = 0.25 * np.trapz(np.r_[0.0, self.force], np.r_[0.0, self.pushed])
        names = [n for n in rows[0] if n.endswith((".elastic_energy", ".plastic_work"))]
        self.energy = sum(column(n)[-1] for n in names) / work
        self.grid = np.arange(0.0, self.pushed[-1] + 1e-9, PITCH / (TAPS - 1))
        smooth = np.interp(self.grid, np.r_[0.0, self.pushed], np.r_[0.0, self.force])
        weights = np.r_[0.5, np.ones(TAPS - 2), 0.5] / (TAPS - 1)
        self.oscillation = smooth - np.convolve(smooth, weights, "same")
        with h5py.File(folder / "fields.h5") as file:
            last = sorted(file["increments"])[-1]
            self.strain = file[f"increments/{last}/body_billet/cell/equivalent_plastic_strain"][:]

    def report(self, name):
        steady = (self.grid >= 20) & (self.grid <= self.pushed[-1] - PITCH)
        wave = self.oscillation[steady]
        print(f"{name}: {self.increments} increments, {self.iterations} iterations")
        for pushed in (25, 50, 75, 100, 125, 150):
            if pushed <= self.pushed[-1] + 1e-6:
                force = np.interp(pushed, self.pushed, self.force)
                print(f"  {pushed:4} mm: {force / 1e3:8.3f} kN, over ideal work {force / ideal(pushed)[0]:.4f}")
        within = self.pushed >= 20
        ratio = self.force[within] / ideal(self.pushed[within])[0]
        mean = np.trapz(self.force, self.pushed) / np.ptp(self.pushed)
        print(f"  over ideal work from 20 mm: {ratio.min():.4f} to {ratio.max():.4f}; mean force {mean:.1f} N")
        print(f"  oscillation: rms {wave.std():.2f} N, peak to peak {np.ptp(wave):.1f} N")
        print(f"  largest equivalent plastic strain {self.strain.max():.4f}; ideal {ideal(self.pushed[-1])[1]:.4f}")
        print(f"  forces out of balance by {self.unbalance:.1e}; stored and plastic work over work {self.energy:.5f}")


def main():
    parser = arguments(__doc__)
    parser.add_argument("runs", type=labelled, nargs="+", metavar="LABEL=FOLDER",
                        help="results of runs, the smooth one first")
    add_out(parser, OUT / "extrusion.png")
    args = parser.parse_args()
    runs = {label: Run(folder) for label, folder in args.runs}
    figure, (whole, detail) = plt.subplots(1, 2, figsize=(10, 4.2), constrained_layout=True)
    for order, (label, run) in enumerate(runs.items()):
        run.report(label)
        style = {"color": f"C{order}", "zorder": 9 - order, "linewidth": 1.2, "label": label}
        whole.plot(run.pushed, run.force / 1e3, **style)
        shown = run.grid <= run.pushed[-1] - PITCH
        detail.plot(run.grid[shown][TAPS:], run.oscillation[shown][TAPS:], **style)
    pushed = np.linspace(0.0, 150.0, 301)
    whole.plot(pushed, ideal(pushed)[0] / 1e3, "k:", linewidth=1.2, label="ideal work")
    whole.set_ylabel("force, kN")
    whole.set_title("Force on the back of the billet")
    detail.set_ylabel("force less its mean over 5 mm, N")
    detail.set_title("Oscillation")
    for axes in (whole, detail):
        axes.set_xlabel("displacement, mm")
        axes.grid(alpha=0.3)
        axes.legend()
    figure.savefig(written(args.out), dpi=120)


if __name__ == "__main__":
    main()

#!/usr/bin/python3 -B
"""Compares runs of the square cup: punch force and nodes in contact with the die against the stroke (Figs. 45 and 46 of
Neto, Oliveira and Menezes, doi 10.1007/s11831-015-9159-7), whose picture it writes. Prints strokes, increments,
iterations, oscillations, and the draw-in of the edges DX and DY and the corner DD beside those measured at
Numisheet'93. The last run is the one whose thickness is drawn."""

import csv
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import OUT, add_out, arguments, labelled, written
from shared.scientific import h5py, np, plt

SIZE = 75.0
MEASURED = {15.0: (6.17, 6.12, 3.24), 40.0: (27.96, 27.95, 15.36)}  # DX, DY, DD in mm by stroke
LATE = 20.0  # stroke from which on the force oscillates on facets
HOLD = 1.0  # time at which the draw begins; from there on the time is the stroke


class Run:
    """History and draw-in of a run, from its folder."""

    def __init__(self, folder):
        with open(folder / "history.csv", newline="") as file:
            rows = [row for row in csv.DictReader(file) if float(row["time"]) > HOLD]
        self.stroke, force, self.nodes, iterations = (
            np.array([float(row[name]) for row in rows])
            for name in ("punch.uz", "punch.fz", "die.active", "iterations"))
        self.stroke, self.force = -self.stroke, -force / 1e3
        self.iterations = int(iterations.sum())
        with h5py.File(folder / "fields.h5") as file:
            points = file["grids/body_blank/points"][:]
            edges = (SIZE, 0, 0), (0, SIZE, 0), (SIZE, SIZE, 0)
            ends = [np.argmin(np.linalg.norm(points - p, axis=1)) for p in edges]
            self.written, self.draw_in = [], []
            for name in sorted(file["increments"]):
                fields = file["increments"][name]
                u = fields["body_blank/node/displacement"][:][ends]
                self.written.append(float(np.ravel(fields["time"][()])[0]) - HOLD)
                self.draw_in.append((-u[0, 0], -u[1, 1], np.hypot(u[2, 0], u[2, 1])))
            cells = file["grids/body_blank/cells"][:]
            self.thickness(points, points + fields["body_blank/node/displacement"][:], cells)

    def thickness(self, points, places, cells):
        """Thickness of the stacks of elements, and where they are in the undeformed blank."""
        bottom, top = places[cells[:, :4]], places[cells[:, 4:]]
        middle = (bottom + top) / 2
        normal = np.cross(middle[:, 2] - middle[:, 0], middle[:, 3] - middle[:, 1])
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        each = np.einsum("ij,ij->i", normal, top.mean(axis=1) - bottom.mean(axis=1))
        centers = np.round(points[cells].mean(axis=1)[:, :2], 6)
        self.stacks, stack = np.unique(centers, axis=0, return_inverse=True)
        self.thick = np.bincount(stack.ravel(), each)

    def oscillation(self):
        """Of the force about its mean over 1 mm, from a stroke of 20 mm on: rms, and peak to peak within 1 mm, kN."""
        step, half = 0.05, 10
        window = 2 * half + 1
        stroke = np.arange(LATE, self.stroke[-1] + step / 2, step)
        force = np.interp(stroke, self.stroke, self.force)
        if len(force) < 2 * window:
            return None
        rest = force[half:-half] - np.convolve(force, np.full(window, 1 / window), "valid")
        return rest.std(), np.ptp(np.lib.stride_tricks.sliding_window_view(rest, window), axis=1).max()

    def at(self, stroke):
        """DX, DY and DD at a stroke, between the written increments."""
        return [np.interp(stroke, self.written, column) for column in np.transpose(self.draw_in)]


def main():
    parser = arguments(__doc__)
    parser.add_argument("runs", type=labelled, nargs="+", metavar="LABEL=FOLDER", help="results of runs")
    add_out(parser, OUT / "cup.png")
    args = parser.parse_args()
    runs = {label: Run(folder) for label, folder in args.runs}
    figure, (forces, counts, blank) = plt.subplots(1, 3, figsize=(14, 4), constrained_layout=True)
    for label, run in runs.items():
        print(f"{label}: stroke {run.stroke[-1]:.2f} mm in {len(run.stroke)} increments, {run.iterations} iterations")
        for stroke, measured in MEASURED.items():
            if run.written[-1] >= stroke:
                told = ", ".join(f"{a} {x:.2f} ({m})" for a, x, m in zip(("DX", "DY", "DD"), run.at(stroke), measured))
                force = np.interp(stroke, run.stroke, run.force)
                print(f"  at {stroke:g} mm: {told} mm, a quarter of the punch force {force:.2f} kN")
        if oscillation := run.oscillation():
            told = ", ".join(f"{1e3 * x:.0f}" for x in oscillation)
            print(f"  oscillation of the force from {LATE:g} mm on, rms, peak to peak within 1 mm: {told} N")
        forces.plot(run.stroke, run.force, label=label, linewidth=1.2)
        counts.plot(run.stroke, run.nodes, label=label, linewidth=1.2)
    colors = blank.tricontourf(*run.stacks.T, run.thick, levels=20)
    figure.colorbar(colors, ax=blank, label=f"thickness after {run.written[-1]:.3g} mm, {label}, mm")
    blank.set_aspect("equal")
    print(f"{label}: thickness {run.thick.min():.3f} to {run.thick.max():.3f} mm at the end")
    forces.set_ylabel("force of the punch on the quarter, kN")
    counts.set_ylabel("nodes in contact with the die")
    for axes in (forces, counts):
        axes.set_xlabel("stroke, mm")
        axes.grid(alpha=0.3)
        axes.legend()
    figure.savefig(written(args.out), dpi=130)


if __name__ == "__main__":
    main()

#!/usr/bin/python3 -B
"""Pressure on both sides of the joint of the contact patch test, and the shape of its faces, from runs of
inputs/patch-test.toml.

Redraws Figs. 17 and 18 of Neto, Oliveira and Menezes, "Surface smoothing procedures in computational contact
mechanics" (doi 10.1007/s11831-015-9159-7): one pass with the coarse and with the fine side as the slave, and two
passes. Prints the errors.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import OUT, add_out, arguments, labelled, written
from shared.scientific import h5py, np, plt


def exact_stress(young=100.0, poisson=0.3, stretch=0.95):
    """sigma_zz of W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J in uniaxial strain."""
    mu, lam = young / (2 + 2 * poisson), young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    return (mu * (stretch**2 - 1) + lam * np.log(stretch)) / stretch


class Side:
    """Elements of a body next to the joint: their corners on the joint, displaced, and sigma_zz over the exact one."""

    def __init__(self, file, body, top):
        last = file["increments"][sorted(file["increments"])[-1]]
        grid = file[f"grids/body_{body}"]
        points, moved = grid["points"][:], last[f"body_{body}/node/displacement"][:]
        self.stress = last[f"body_{body}/cell/stress"][:, 2] / exact_stress()
        cells = grid["cells"][:]
        corners = points[cells]
        plane = points[:, 2].max() if top else points[:, 2].min()
        on_joint = np.abs(corners[..., 2] - plane) < 1e-9
        self.next = np.flatnonzero(on_joint.any(axis=1))
        self.faces = [(points + moved)[cells[c][on_joint[c]]] for c in self.next]
        self.heights = np.concatenate([f[:, 2] for f in self.faces]) - 9.5


def draw_row(axes, label, sides, limits):
    for ax, side, name in zip(axes, sides, ("upper cube", "lower cube")):
        for face, value in zip(side.faces, side.stress[side.next]):
            lo, hi = face.min(axis=0), face.max(axis=0)
            color = plt.cm.coolwarm((value - limits[0]) / (limits[1] - limits[0]))
            corners = [lo[0], hi[0], hi[0], lo[0]], [lo[1], lo[1], hi[1], hi[1]]
            ax.fill(*corners, facecolor=color, edgecolor="0.4", lw=0.5)
            ax.text(*(0.5 * (lo + hi))[:2], f"{value:.3f}", ha="center", va="center", fontsize=6)
        ax.set(aspect="equal", xticks=[], yticks=[], xlim=(-0.2, 10.2), ylim=(-0.2, 10.2))
        ax.set_title(f"{label}: {name}", fontsize=8)
    for side, color, name in zip(sides, ("tab:blue", "tab:orange"), ("upper", "lower")):
        front = np.concatenate(side.faces)
        front = front[np.abs(front[:, 1] - front[:, 1].min()) < 1e-6]
        front = front[np.argsort(front[:, 0])]
        axes[2].plot(front[:, 0], 1e3 * (front[:, 2] - 9.5), color=color, marker="o", ms=3, lw=1, label=name)
    axes[2].set_ylim(-80, 130)
    axes[2].set_title("edge y = 0 of both faces: z - 9.5, µm", fontsize=8)
    axes[2].tick_params(labelsize=7)
    axes[2].grid(alpha=0.3)
    axes[2].legend(fontsize=7, loc="upper right")


def main():
    parser = arguments(__doc__)
    parser.add_argument("runs", type=labelled, nargs="+", metavar="LABEL=FOLDER", help="results of runs")
    add_out(parser, OUT / "patch-test.png")
    args = parser.parse_args()
    figure, rows = plt.subplots(len(args.runs), 3, figsize=(8.2, 2.6 * len(args.runs)), squeeze=False,
                                constrained_layout=True)
    print(f"{'':<24}{'max |szz/exact - 1|':>22}{'faces off the plane, mm':>28}")
    for axes, (label, folder) in zip(rows, args.runs):
        with h5py.File(folder / "fields.h5") as file:
            sides = [Side(file, "upper", False), Side(file, "lower", True)]
        error = max(np.abs(side.stress - 1).max() for side in sides)
        heights = np.concatenate([side.heights for side in sides])
        print(f"{label:<24}{error:22.3e}{heights.min():14.3e}{heights.max():14.3e}")
        draw_row(axes, label, sides, (0.6, 1.4))
    figure.savefig(written(args.out), dpi=90)


if __name__ == "__main__":
    main()

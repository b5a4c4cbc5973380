#!/usr/bin/python3 -B
"""Draws stages of a plane-strain run: the deformed bodies, coloured by a component of stress, and the contact forces.

Redraws Figs. 53 and 56 of Neto, Oliveira and Menezes, "Surface smoothing procedures in computational contact
mechanics" (doi 10.1007/s11831-015-9159-7). Reads fields.h5. Times are those written next to the ones asked for.

    scripts/plots/stages.py out/ironing-deformable --times 1 1.5 2
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import OUT, add_out, arguments, written
from shared.scientific import h5py, matplotlib, np, plt

STRESSES = {"xx": 0, "yy": 1, "zz": 2, "xy": 3}


def stage(file, time):
    """The increment written next to a time."""
    return min(file["increments"].values(), key=lambda increment: abs(increment["time"][0] - time))


def bodies(file, increment, component):
    """Corners and stress of all elements, seen along z."""
    corners, stresses = [], []
    for name in (name for name in file["grids"] if name.startswith("body_")):
        grid, state = file["grids"][name], increment[name]
        places = (grid["points"][:] + state["node/displacement"][:])[:, :2]
        corners.append(places[grid["cells"][:, :4]])
        stresses.append(state["cell/stress"][:, STRESSES[component]])
    return np.concatenate(corners), np.concatenate(stresses)


def forces(file, increment):
    """Places and contact forces of the nodes in contact; those above one another along z are added up."""
    places, values = [], []
    for name in (name for name in file["grids"] if name.startswith("contact_")):
        grid, state = file["grids"][name], increment[name]
        at = np.round((grid["points"][:] + state["node/displacement"][:])[:, :2], 9)
        at, index = np.unique(at, axis=0, return_inverse=True)
        total = np.zeros_like(at)
        np.add.at(total, index.ravel(), state["node/force"][:, :2])
        touching = np.abs(total).max(axis=1) > 0
        places.append(at[touching])
        values.append(total[touching])
    return np.concatenate(places), np.concatenate(values)


def main():
    parser = arguments(__doc__)
    parser.add_argument("results", type=Path, help="folder that a run wrote")
    parser.add_argument("--times", type=float, nargs="+", required=True, metavar="T", help="a picture each")
    parser.add_argument("--stress", choices=STRESSES, default="xy", help="component (%(default)s)")
    parser.add_argument("--around", type=float, metavar="LENGTH",
                        help="show only so much on either side of the contact, and as much below")
    add_out(parser, OUT / "stages.png")
    args = parser.parse_args()
    with h5py.File(args.results / "fields.h5") as file:
        stages = [stage(file, time) for time in args.times]
        drawn = [(s["time"][0], *bodies(file, s, args.stress), *forces(file, s)) for s in stages]
    limit = max(np.percentile(np.abs(stress), 99.7) for _, _, stress, _, _ in drawn)
    largest = max((np.hypot(*f.T).max() for *_, f in drawn if len(f)), default=1.0)
    every = np.concatenate([corners.reshape(-1, 2) for _, corners, *_ in drawn])
    (left, low), (right, high) = every.min(axis=0), every.max(axis=0)
    arrow = 0.8 * args.around if args.around else 0.35 * (high - low)
    shape = 0.9 if args.around else (high - low) / (right - left)
    across = len(drawn) if args.around else 1
    down = len(drawn) // across
    figure, axes = plt.subplots(down, across, squeeze=False, constrained_layout=True,
                                figsize=(8, 8 / across * down * shape + 0.6))
    for ax, (time, corners, stress, places, force) in zip(axes.flat, drawn):
        mesh = matplotlib.collections.PolyCollection(corners, array=stress, cmap="coolwarm", clim=(-limit, limit),
                                                     edgecolors="0.35", linewidths=0.4 if args.around else 0.1)
        ax.add_collection(mesh)
        tails = places - force / largest * arrow
        shafts = force / largest * arrow
        ax.quiver(*tails.T, *shafts.T, angles="xy", scale_units="xy", scale=1, color="k", width=0.003)
        middle = places.mean(axis=0) if len(places) else every.mean(axis=0)
        if args.around:
            ax.set_xlim(middle[0] - args.around, middle[0] + args.around)
            ax.set_ylim(middle[1] - 0.8 * args.around, middle[1] + args.around)
        else:
            ax.set_xlim(left - 2, right + 2)
            ax.set_ylim(low - 2, high + 2)
        ax.set_aspect("equal")
        ax.set_xticks([])
        ax.set_yticks([])
        ax.set_title(f"time {time:g}", fontsize=9, loc="left")
    figure.colorbar(mesh, ax=axes, label=f"stress {args.stress}", shrink=0.6)
    figure.savefig(written(args.out), dpi=110)


if __name__ == "__main__":
    main()

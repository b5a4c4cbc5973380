#!/usr/bin/python3 -B
"""Compares the forces of two runs of the frictional ironing problem, as with Nagata patches and with facets.

Redraws Figs. 42 and 43 of Neto, Oliveira and Menezes, "Surface smoothing procedures in computational contact
mechanics" (doi 10.1007/s11831-015-9159-7): vertical force V and horizontal force H against the slide of the
indenter, and a detail of H. Prints V and H at chosen slides and the chatter.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import OUT, add_out, arguments, labelled, written
from shared.ironing import TAPS, Run, detrend
from shared.scientific import np, plt

SAMPLES = (10, 25, 50, 100, 150, 200, 250)  # slides at which the forces are printed, mm


def dominant_period(y, spacing):
    """Period of the largest Fourier component of y, Hann window."""
    amplitude = np.abs(np.fft.rfft((y - y.mean()) * np.hanning(len(y))))[1:]
    return 1 / np.fft.rfftfreq(len(y), spacing)[1:][amplitude.argmax()]


def report(runs, span, pitch):
    """Prints forces and chatter of both runs, and the ratio of the first to the second."""
    first, second = runs.values()

    def line(label, values, digits=2):
        ratio = f"{values[0] / values[1]:12.4f}" if None not in values and values[1] else f"{'-':>12}"
        cells = "".join(f"{'-':>14}" if x is None else f"{x:14.{digits}f}" for x in values)
        print(f"{label:<34}{cells}{ratio}")

    print(f"{'':<34}" + "".join(f"{name:>14}" for name in runs) + f"{'ratio':>12}")
    line("increments", [r.increments for r in runs.values()], 0)
    line("iterations", [r.iterations for r in runs.values()], 0)
    line("slide reached, mm", [r.slide[-1] for r in runs.values()])
    line("depth, mm", [r.depth for r in runs.values()])
    for slide in (0,) + SAMPLES:
        label = "end of the press" if slide == 0 else f"u_x = {slide} mm"
        points = [r.at(slide) for r in runs.values()]
        for k, force in enumerate("VH"):
            line(f"{force}, N, {label}", [p[k] if p else None for p in points])

    masks = [r.window(*span, pitch) for r in runs.values()]
    if min(m.sum() for m in masks) < 4 * TAPS:
        print(f"\nNo chatter figures: a run ends before four pitches of u_x in {span[0]:g} to {span[1]:g} mm.")
        return
    ends = " / ".join(f"{r.grid[m][0]:g} to {r.grid[m][-1]:g}" for r, m in zip((first, second), masks))
    print(f"\nu_x from {ends} mm:")
    v, h = ([getattr(r, g)[m] for r, m in zip((first, second), masks)] for g in ("v_grid", "h_grid"))
    line("V mean, N", [x.mean() for x in v])
    line("H mean, N", [x.mean() for x in h])
    line("H/V mean", [(b / a).mean() for a, b in zip(v, h)], 4)
    for force, grid in (("V", "v_grid"), ("H", "h_grid")):
        chatter = [detrend(getattr(r, grid))[m] for r, m in zip((first, second), masks)]
        line(f"{force} chatter rms, N", [c.std() for c in chatter])
        line(f"{force} chatter peak to peak, N", [np.ptp(c) for c in chatter])
        line(f"{force} chatter dominant period, mm", [dominant_period(c, pitch / TAPS) for c in chatter], 3)


def draw(runs, zoom, path):
    """Fig. 42 (V and H over the whole slide) on the left, Fig. 43 (detail of H) on the right."""
    figure, (whole, detail) = plt.subplots(1, 2, figsize=(10, 4.2), constrained_layout=True)
    # The rougher curve behind.
    for color, order, (name, run) in zip(("tab:blue", "tab:orange"), (3, 2), runs.items()):
        style = {"color": color, "zorder": order, "linewidth": 1.2}
        whole.plot(run.slide, run.v / 1e3, label=name, **style)
        whole.plot(run.slide, run.h / 1e3, **style)
        shown = (run.slide >= zoom[0]) & (run.slide <= zoom[1])
        detail.plot(run.slide[shown], run.h[shown] / 1e3, label=name, marker=".", markersize=4, **style)
    run = next(iter(runs.values()))
    for name, force in (("vertical force V", run.v), ("horizontal force H", run.h)):
        middle = len(force) // 2
        whole.annotate(name, (run.slide[middle], force[middle] / 1e3), (0, -18), textcoords="offset points",
                       ha="center", va="top")
    for axes in (whole, detail):
        axes.set_xlabel("slide of the indenter, mm")
        axes.grid(alpha=0.3)
        axes.legend(loc="center right" if axes is whole else "upper left")
    whole.set_ylabel("force, kN")
    whole.set_ylim(bottom=0)
    whole.set_title("Force of the indenter on the slab")
    detail.set_ylim(top=detail.get_ylim()[1] + 0.25 * np.ptp(detail.get_ylim()))  # room for the legend
    detail.set_title("Detail: chatter of H")
    figure.savefig(path, dpi=150)


def main():
    parser = arguments(__doc__)
    parser.add_argument("runs", type=labelled, nargs=2, metavar="LABEL=FOLDER",
                        help="results of runs, the smooth one first")
    parser.add_argument("--tool", default="indenter", help="name before .ux and .fx in the columns (%(default)s)")
    parser.add_argument("--pitch", type=float, default=2.5, help="length of a slab element, mm (%(default)s)")
    parser.add_argument("--range", type=float, nargs=2, default=(25.0, 110.0), metavar=("FROM", "TO"),
                        help="slides over which chatter is measured, mm (25 110)")
    parser.add_argument("--zoom", type=float, nargs=2, default=(50.0, 80.0), metavar=("FROM", "TO"),
                        help="slides shown in the detail, mm (50 80)")
    add_out(parser, OUT / "ironing.png")
    args = parser.parse_args()
    runs = {label: Run(folder, args.tool, args.pitch) for label, folder in args.runs}
    report(runs, args.range, args.pitch)
    draw(runs, args.zoom, written(args.out))


if __name__ == "__main__":
    main()

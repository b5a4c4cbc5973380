#!/usr/bin/python3 -B
"""Draws the results of inputs/hertz-sphere.toml, hertz-cylinder.toml and cattaneo-mindlin.toml over the solutions of
Hertz, Cattaneo and Mindlin under the forces that were found, and prints by how much they differ."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import OUT, add_out, arguments, hertz, written
from shared.scientific import np, plt


def draw_pressure(axes, result, title, name):
    a, p0 = result.hertz
    left = -1.3 if result.place.min() < 0 else 0.0
    x = np.linspace(left, 1.3, 1001)
    shown = (result.place > left * a - 1e-9) & (result.place < 1.3 * a)
    axes.plot(x, hertz.arch(x, 1.0, 1.0), color="black", linewidth=1, label="Hertz")
    axes.plot(result.place[shown] / a, result.pressure[shown] / p0, ".", color="tab:blue", markersize=4,
              label="nodes of the block")
    axes.set_title(title)
    axes.set_xlabel(f"distance over {name}")
    axes.set_ylabel("pressure over p0")


def draw_shear(axes, result):
    b, p0 = result.hertz
    scale = hertz.FRICTION * p0
    x = np.linspace(-1.3, 1.3, 2001)
    shown = np.abs(result.place) < 1.3 * b
    axes.plot(x, hertz.arch(x, 1.0, 1.0), "--", color="grey", linewidth=1, label="μ p of Hertz")
    axes.plot(x, hertz.cattaneo_mindlin(x * b, result) / scale, color="black", linewidth=1, label="Cattaneo, Mindlin")
    axes.plot(result.place[shown] / b, result.shear[shown] / scale, ".", color="tab:orange", markersize=4,
              label="nodes of the block")
    axes.set_title("Roller pressed and drawn sideways")
    axes.set_xlabel("distance over b")
    axes.set_ylabel("shear traction over μ p0")


def report(name, result):
    (a, p0), (fitted, _) = result.hertz, result.fitted()
    highest = result.pressure.max()
    print(f"{name}: force {result.force:.6g}, radius {fitted:.6g} (Hertz {a:.6g}, {fitted / a - 1:+.2%}), "
          f"highest pressure {highest:.6g} ({p0:.6g}, {highest / p0 - 1:+.2%}), rms {result.pressure_error():.2%}")


def main():
    parser = arguments(__doc__)
    for name, scene in (("sphere", "hertz-sphere"), ("cylinder", "hertz-cylinder"), ("shear", "cattaneo-mindlin")):
        parser.add_argument(name, type=Path, nargs="?", default=OUT / scene, metavar=name.upper(),
                            help=f"results of {scene}.toml (out/{scene})")
    add_out(parser, OUT / "hertz.png")
    args = parser.parse_args()
    sphere = hertz.Result(args.sphere, hertz.SPHERE)
    cylinder, shear = (hertz.Result(folder, hertz.CYLINDER) for folder in (args.cylinder, args.shear))
    for name, result in (("ball", sphere), ("roller", cylinder), ("roller with friction", shear)):
        report(name, result)
    (found, c), (rms, most) = shear.stick(), shear.shear_errors()
    print(f"Q / mu P = {shear.shear_force / hertz.FRICTION / shear.force:.4f}: half-width that sticks {found:.6g} "
          f"({c:.6g}, {found / c - 1:+.2%}), shear traction rms {rms:.2%}, largest error {most:.2%} of the peak")

    figure, axes = plt.subplots(1, 3, figsize=(11, 3.4), constrained_layout=True)
    draw_pressure(axes[0], sphere, "Ball on a block", "a")
    draw_pressure(axes[1], cylinder, "Roller on a block", "b")
    draw_shear(axes[2], shear)
    for panel in axes:
        panel.set_ylim(0, 1.3)
        panel.grid(alpha=0.3)
        panel.legend(loc="upper right", fontsize=8)
    figure.savefig(written(args.out), dpi=110)


if __name__ == "__main__":
    main()

#!/usr/bin/python3 -B
"""Prints, as Markdown tables, what solid-shell elements make of the usual benchmarks of shells, beside another element
in one layer, over the known values; and the moment of a sheet that is bent into its plastic range, by the points
through its thickness.

Known values: MacNeal and Harder (Finite Elem. Anal. Des. 1, 1985) for the roof, the curved beam and the hemisphere
under small loads; Sze, Liu and Lo (Finite Elem. Anal. Des. 40, 2004) for the cantilever and the hemisphere under
large ones; Timoshenko's plate; Belytschko et al. (CMAME 51, 1985) for the pinched cylinder."""

import math
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import arguments, say, study

ELEMENTS = ("hex8-shell", "hex8-eas")
SCENE = """
[body.sheet]
mesh = "sheet.inp"
material = "m"
element = "{element}"
{shell}
[material.m]
model = "hooke"
young = {young}
poisson = {poisson}
[[step]]
{increments}
fix = [{fix}]
{loads}
[output]
history = [{probes}]
every = 1000
"""
TIMES = 1e-4  # of the loads of linear benchmarks


def mesh(folder, counts, place, groups):
    """One layer of elements with nodes at `place` of their parameters (s, t, h) in the unit cube, and groups of the
    nodes with some parameters."""
    nx, ny = counts
    nodes, number = [], {}
    for k in range(2):
        for j in range(ny + 1):
            for i in range(nx + 1):
                nodes.append((i / nx, j / ny, float(k)))
                number[i, j, k] = len(nodes)
    lines = ["*NODE"] + [f"{n}, " + ", ".join(f"{c:.16g}" for c in place(*at)) for n, at in enumerate(nodes, 1)]
    lines.append("*ELEMENT, TYPE=C3D8, ELSET=ALL")
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    for e, (i, j) in enumerate(((i, j) for j in range(ny) for i in range(nx)), 1):
        lines.append(f"{e}, " + ", ".join(str(number[i + a, j + b, k]) for k in range(2) for a, b in corners))
    for name, wanted in groups.items():
        chosen = [n for n, at in enumerate(nodes, 1) if all(w is None or abs(w - c) < 1e-9 for w, c in zip(wanted, at))]
        lines += [f"*NSET, NSET={name}"] + [str(n) for n in chosen]
    (folder / "sheet.inp").write_text("\n".join(lines) + "\n")


def solve(folder, element, young, poisson, fix, loads, probes, increments="increments = 1", shell="", more=()):
    """The run, or nothing where it does not converge."""
    fixed = ", ".join(f'{{ set = "sheet.{name}", directions = "{directions}" }}' for name, directions in fix)
    text = SCENE.format(element=element, young=young, poisson=poisson, fix=fixed, loads=loads, increments=increments,
                        probes=", ".join(f'"sheet.{p}"' for p in probes),
                        shell=shell if element == "hex8-shell" else "")
    (folder / "scene.toml").write_text(text)
    run = study.Run(folder / "scene.toml", folder / "out", 1, *more, limit=600)
    return run if run.code == 0 else None


def force(*loads):
    """Total forces on groups."""
    return "force = [" + ", ".join(f'{{ target = "sheet.{name}", total = {total} }}' for name, total in loads) + "]"


def ratio(run, column, exact):
    return f"{run.last(column) / exact:.3f}" if run else "fails"


def roof(folder, element, n):
    """Scordelis and Lo's roof: sinking of the middle of the free edge."""
    radius, angle, thick = 25.0, math.radians(40), 0.25
    mesh(folder, (n, n), lambda s, t, h: ((radius + thick * (h - 0.5)) * math.sin(angle * s), 25.0 * t,
                                         (radius + thick * (h - 0.5)) * math.cos(angle * s)),
         {"crown": (0, None, None), "middle": (None, 0, None), "wall": (None, 1, None), "a": (1, 0, None)})
    load = f'body_force = [{{ body = "sheet", per_volume = [0, 0, {-90 / thick * TIMES}] }}]'
    run = solve(folder, element, 4.32e8, 0.0, [("crown", "x"), ("middle", "y"), ("wall", "xz")], load, ["a"])
    return ratio(run, "sheet.a.uz", -0.3024 * TIMES)


def cylinder(folder, element, n):
    """Pinched cylinder with end diaphragms: the pinch."""
    radius, thick = 300.0, 3.0
    mesh(folder, (n, n), lambda s, t, h: ((radius + thick * (h - 0.5)) * math.sin(0.5 * math.pi * s), 300.0 * t,
                                         (radius + thick * (h - 0.5)) * math.cos(0.5 * math.pi * s)),
         {"crown": (0, None, None), "side": (1, None, None), "middle": (None, 0, None), "wall": (None, 1, None),
          "a": (0, 0, None)})
    fix = [("crown", "x"), ("side", "z"), ("middle", "y"), ("wall", "xz")]
    run = solve(folder, element, 3e6, 0.3, fix, force(("a", [0, 0, -0.25])), ["a"])
    return ratio(run, "sheet.a.uz", -1.8248e-5)


def hemisphere(folder, element, n, load, exact, increments="increments = 1"):
    """Hemisphere with a hole of 18 degrees between two pairs of forces: motion of the points in and out."""
    radius, thick, hole = 10.0, 0.04, math.radians(18)

    def place(s, t, h):
        r, polar, around = radius + thick * (h - 0.5), hole + (0.5 * math.pi - hole) * s, 0.5 * math.pi * t
        return (r * math.sin(polar) * math.cos(around), r * math.sin(polar) * math.sin(around), r * math.cos(polar))

    mesh(folder, (n, n), place, {"x": (None, 1, None), "y": (None, 0, None), "a": (1, 0, None), "b": (1, 1, None),
                                 "held": (1, 0.5, 0)})
    loads = force(("a", [load, 0, 0]), ("b", [0, -load, 0]))
    run = solve(folder, element, 6.825e7, 0.3, [("x", "x"), ("y", "y"), ("held", "z")], loads, ["a", "b"], increments)
    if not run:
        return "fails"
    return " ".join(f"{run.last(c) / e:.3f}" for c, e in zip(("sheet.a.ux", "sheet.b.uy"), exact))


def cantilever(folder, element, n):
    """A strip that a shear of 4 at its end turns up by more than half its length: motion of the end."""
    mesh(folder, (n, 1), lambda s, t, h: (10.0 * s, t, 0.1 * (h - 0.5)),
         {"root": (0, None, None), "end": (1, None, None)})
    run = solve(folder, element, 1.2e6, 0.0, [("root", "xyz")], force(("end", [0, 0, 4.0])), ["end"],
                "increment = { initial = 0.05, min = 1e-4, max = 0.2 }")
    return f"{ratio(run, 'sheet.end.ux', -3.286)} {ratio(run, 'sheet.end.uz', 6.698)}" if run else "fails"


def curved_beam(folder, element, n, across, load):
    """A quarter of a ring, 4.12 to 4.32, 0.1 wide, loaded at its end in its plane or across; the thickness of the sheet
    is radial or axial."""

    def place(s, t, h):
        # Turned so that elements are not inside out.
        r, z = (4.12 + 0.2 * h, -0.1 * t) if across == "radial" else (4.12 + 0.2 * t, 0.1 * h)
        angle = 0.5 * math.pi * s
        return (r * math.sin(angle), r * math.cos(angle), z)

    mesh(folder, (n, 1), place, {"root": (0, None, None), "end": (1, None, None)})
    total, column, exact = {"plane": ([1.0, 0, 0], "sheet.end.ux", 0.08734),
                            "across": ([0, 0, 1.0], "sheet.end.uz", 0.5022)}[load]
    text = (folder / "sheet.inp").read_text()
    face = [f"{e}, S2" for e in range(1, n + 1)]
    (folder / "sheet.inp").write_text(text + "*SURFACE, NAME=top, TYPE=ELEMENT\n" + "\n".join(face) + "\n")
    total = [TIMES * f for f in total]
    run = solve(folder, element, 1e7, 0.25, [("root", "xyz")], force(("end", total)), ["end"],
                shell='shell = { face = "top" }')
    return ratio(run, column, exact * TIMES)


def plate(folder, element, n, thick, skew):
    """A quarter of a clamped square plate of side 100 under a force in its middle, thin, of a mesh whose inner nodes
    are moved."""

    def place(s, t, h):
        bump = skew * math.sin(math.pi * s) * math.sin(math.pi * t)
        return (50 * (s + bump), 50 * (t - 0.6 * bump), thick * (h - 0.5))

    mesh(folder, (n, n), place, {"x": (0, None, None), "y": (None, 0, None), "a": (0, 0, None), "rx": (1, None, None),
                                 "ry": (None, 1, None)})
    stiffness = 1e4 * thick**3 / 12 / (1 - 0.09)
    load = 0.2 * thick * stiffness / 0.0056 / 100**2
    fix = [("x", "x"), ("y", "y"), ("rx", "xyz"), ("ry", "xyz")]
    run = solve(folder, element, 1e4, 0.3, fix, force(("a", [0, 0, 0.25 * load])), ["a"])
    return ratio(run, "sheet.a.uz", 0.2 * thick)


def bent(folder, points, times):
    """Moment of a narrow strip of a perfectly plastic metal bent to so many times the curvature at which it begins to
    flow, over the closed form."""
    thick, length, young, limit = 0.1, 0.5, 2e5, 200.0
    mesh(folder, (1, 1), lambda s, t, h: (length * s, t - 0.5, thick * (h - 0.5)),
         {"root": (0, None, None), "hinge": (0, None, 0), "pin": (0, 0, 0), "top": (1, None, 1),
          "bottom": (1, None, 0)})
    by = times * limit / young * length
    loads = "move = [" + ", ".join(f'{{ target = "sheet.{name}", by = [{end}, 0, 0], directions = "x" }}'
                                   for name, end in (("top", by), ("bottom", -by))) + "]"
    fix = [("root", "x"), ("hinge", "z"), ("pin", "y")]
    run = solve(folder, "hex8-shell", young, 0.3, fix, loads, ["top", "bottom"], "increments = 40",
                f"shell = {{ points = {points} }}",
                more=("--set", 'material.m={ model = "j2", young = 2e5, poisson = 0.3, yield_stress = 200.0 }'))
    if not run:
        return "fails"
    exact = limit * thick**2 / 6 * (1.5 - 0.5 / times**2)
    return f"{(run.last('sheet.top.fx') - run.last('sheet.bottom.fx')) * thick / 2 / exact:.3f}"


def main():
    arguments(__doc__).parse_args()
    study.setup()
    cases = [
        *((f"roof, {n} x {n}", lambda f, e, n=n: roof(f, e, n)) for n in (4, 8, 16)),
        *((f"pinched cylinder, {n} x {n}", lambda f, e, n=n: cylinder(f, e, n)) for n in (8, 16, 32)),
        *((f"hemisphere, {n} x {n}, small", lambda f, e, n=n: hemisphere(f, e, n, 0.01, [0.00093, -0.00093]))
          for n in (8, 16)),
        *((f"hemisphere, {n} x {n}, 400",
           lambda f, e, n=n: hemisphere(f, e, n, 200.0, [4.067, -8.178],
                                        "increment = { initial = 0.02, min = 1e-5, max = 0.1 }")) for n in (16, 32)),
        ("cantilever, 16", lambda f, e: cantilever(f, e, 16)),
        *((f"curved beam, 6, thickness {across}, load {load}",
           lambda f, e, across=across, load=load: curved_beam(f, e, 6, across, load))
          for across in ("radial", "axial") for load in ("plane", "across")),
        *((f"clamped plate, 8 x 8, t/L = {t / 100:g}{', skewed' * bool(k)}",
           lambda f, e, t=t, k=k: plate(f, e, 8, t, k))
          for t, k in ((1.0, 0.0), (0.1, 0.0), (0.1, 0.08))),
    ]
    with tempfile.TemporaryDirectory() as name:
        rows = [[label, *(say(f"{label}, {e}") or case(Path(name), e) for e in ELEMENTS)] for label, case in cases]
        study.table(["", *ELEMENTS], rows)
        print()
        counts = (2, 3, 4, 5, 7, 9)
        study.table(["curvature", *(f"{n} points" for n in counts)],
                    [[times, *(bent(Path(name), n, times) for n in counts)] for times in (1.0, 1.5, 2.0, 5.0)])


if __name__ == "__main__":
    main()

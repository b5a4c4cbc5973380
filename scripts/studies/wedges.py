#!/usr/bin/python3 -B
"""Prints, as Markdown tables, what wedges between hexahedra cost in stiffness where volume is nearly kept: Cook's
membrane and a cube between plates, by the share of wedges among the elements."""

import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import arguments, gmsh, say, study

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
RUBBER = 'model = "neo-hookean"\nyoung = 240.565\npoisson = 0.4999'
METAL = 'model = "j2"\nyoung = 1000.0\npoisson = 0.3\nyield_stress = 1.0\nhardening = { linear = 1.0 }'
COOK = """
[[step]]
increments = 5
fix = [{ set = "b.xmin" }, { set = "b.zmin", directions = "z" }, { set = "b.zmax", directions = "z" }]
force = [{ target = "b.xmax", total = [0.0, 200.0, 0.0] }]
[output]
history = ["b.xmax"]
"""
# The mesh is extruded across the load, along x.
CUBE = """
[[step]]
increments = 5
fix = [{ set = "b.zmin", directions = "x" }, { set = "b.xmin", directions = "y" },
       { set = "b.ymin", directions = "z" }, { set = "b.ymax", directions = "xy" }]
move = [{ target = "b.ymax", by = [0.0, 0.0, -0.1], directions = "z" }]
[output]
history = ["b.ymax"]
"""


def mesh(path, counts, place, every):
    """A block extruded along z, with every so manieth column as two wedges, none with 0; gives their share."""
    nx, ny, nz = counts
    number = lambda i, j, k: 1 + i + (nx + 1) * (j + (ny + 1) * k)
    points = [place(i / nx, j / ny, k / nz)
              for k in range(nz + 1) for j in range(ny + 1) for i in range(nx + 1)]
    halves = {}
    for i in range(nx):
        for j in range(ny):
            cut = every and (3 * i + 5 * j + i * j % 3) % every == 0
            turned = [(0, 1, 2), (0, 2, 3)] if (i + nx * j) // max(every, 1) % 2 else [(0, 1, 3), (1, 2, 3)]
            halves[i, j] = turned if cut else [(0, 1, 2, 3)]
    elements = []
    for i in range(nx):
        for j in range(ny):
            for part in halves[i, j]:
                ends = [[number(i + SQUARE[c][0], j + SQUARE[c][1], k) for c in part] for k in range(nz + 1)]
                elements += [(2, "zmin", ends[0][::-1]), (2, "zmax", ends[-1])]
                elements += [(3, "solid", low + high) for low, high in zip(ends, ends[1:])]
    for k in range(nz):
        for name, at in (("xmin", 0), ("xmax", nx)):
            elements += [(2, name, [number(at, j, k), number(at, j + 1, k), number(at, j + 1, k + 1),
                                    number(at, j, k + 1)]) for j in range(ny)]
        for name, at in (("ymin", 0), ("ymax", ny)):
            elements += [(2, name, [number(i, at, k), number(i + 1, at, k), number(i + 1, at, k + 1),
                                    number(i, at, k + 1)]) for i in range(nx)]
    path.write_text(gmsh.text(points, elements))
    solids = [len(nodes) for dimension, _, nodes in elements if dimension == 3]
    return solids.count(6) / len(solids)


def found(folder, element, material, steps, column):
    """The last value of a column of the history."""
    text = f'[body.b]\nmesh = "b.msh"\nmaterial = "m"\n{element}\n[material.m]\n{material}\n{steps}'
    scene = folder / "scene.toml"
    scene.write_text(text)
    return study.Run(scene, folder / "out", 1).last(column)


def membrane(x, y, z):
    """Cook's, 2 thick."""
    low, high = 44 * x, 44 + 16 * x
    return 48 * x, low + (high - low) * y, 2 * z


def rows(folder, counts, place, columns, steps, column):
    """Of each share of wedges what is found with each element and material."""
    for every in (0, 16, 8, 4, 3):
        say(f"every {every}")
        share = mesh(folder / "b.msh", counts, place, every)
        yield [f"{share:.0%}", *(f"{found(folder, *case, steps, column):.4g}" for case in columns)]


def main():
    arguments(__doc__).parse_args()
    study.setup()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        elements = ["hex8-fbar", "hex8-sri", "hex8-eas"]
        columns = [(f'element = "{element}"', RUBBER) for element in elements]
        for n in (8, 16):
            study.table([f"Cook, {n}", *elements], rows(folder, (n, n, 1), membrane, columns, COOK, "b.xmax.uy"))
            print()
        across = lambda x, y, z: (z, x, y)
        columns = [("", RUBBER), ('element = "hex8"', RUBBER), ("", METAL), ('element = "hex8"', METAL)]
        study.table(["cube, 8", "rubber", "its `hex8`", "metal", "its `hex8`"],
                    rows(folder, (8, 8, 8), across, columns, CUBE, "b.ymax.fz"))


if __name__ == "__main__":
    main()

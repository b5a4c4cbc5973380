#!/usr/bin/python3 -B
"""Prints, as a Markdown table, what wedges of 15 nodes make of problems without contact, as such and as eight linear
ones each, beside hexahedra of as many nodes: the deflection of a bar of one layer, its cells twice as long as high,
under a force at its end, over beam theory with shear, bent in the plane of the triangles and across it; and the force
of a cube that is pressed by a tenth between plates that hold it, of nearly incompressible rubber and of metal that
flows, over that of hexahedra with 13 nodes along each edge, by cells along an edge, each of two wedges."""

import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import arguments, study

TRIANGLES = [[(0, 0), (2, 0), (2, 2), (1, 0), (2, 1), (1, 1)], [(0, 0), (2, 2), (0, 2), (1, 1), (1, 2), (0, 1)]]
RUBBER = 'model = "neo-hookean"\nyoung = 1.0\npoisson = 0.4999'
METAL = 'model = "j2"\nyoung = 200.0\npoisson = 0.3\nyield_stress = 0.5\nhardening = { linear = 0.5 }'
STEEL = 'model = "hooke"\nyoung = 1000.0\npoisson = 0.3'
PRESSED = 'increments = 5\nfix = [{ set = "w.zmin" }]\nmove = [{ target = "w.zmax", by = [0, 0, -0.1] }]'
BENT = 'increments = 1\nfix = [{{ set = "w.xmin" }}]\nforce = [{{ target = "w.xmax", total = {force} }}]'


def mesh(cells, size):
    """A block of cells of two upright wedges each; its ends along x and z are surfaces."""
    nodes, elements, surfaces = {}, [], {"xmin": [], "xmax": [], "zmin": [], "zmax": []}
    counts = [2 * n + 1 for n in cells]
    for low in ((i, j, k) for k in range(cells[2]) for j in range(cells[1]) for i in range(cells[0])):
        for which, ring in enumerate(TRIANGLES):
            at = [(*p, z) for part, z in [(ring[:3], 0), (ring[:3], 2), (ring[3:], 0), (ring[3:], 2), (ring[:3], 1)]
                  for p in part]  # fmt: skip
            own = []
            for place in (tuple(2 * a + b for a, b in zip(low, p)) for p in at):
                number = 1 + place[0] + counts[0] * (place[1] + counts[1] * place[2])
                nodes[number] = [s * a / (c - 1) for s, a, c in zip(size, place, counts)]
                own.append(str(number))
            elements.append(f"{len(elements) + 1}, {', '.join(own[:8])},\n{', '.join(own[8:])}")
            sides = [("zmin", 1, low[2] == 0), ("zmax", 2, low[2] == cells[2] - 1)]
            sides.append(("xmin", 5, low[0] == 0) if which else ("xmax", 4, low[0] == cells[0] - 1))
            for name, face, is_there in sides:
                if is_there:
                    surfaces[name].append(f"{len(elements)}, S{face}")
    lines = ["*NODE", *(f"{n}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in sorted(nodes.items()))]
    lines += ["*ELEMENT, TYPE=C3D15, ELSET=w", *elements]
    for name, faces in surfaces.items():
        lines += [f"*SURFACE, NAME={name}", *faces]
    return "\n".join(lines) + "\n"


def run(body, element, material, step):
    """The history of a body, a mesh or a block."""
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "scene.toml"
        if body.startswith("*"):
            (Path(folder) / "w.inp").write_text(body)
            body = 'mesh = "w.inp"'
        asked = f'element = "{element}"\n' if element else ""
        scene.write_text(f'[body.w]\n{body}\nmaterial = "m"\n{asked}[material.m]\n{material}\n[[step]]\n{step}\n'
                         '[output]\nhistory = ["w.zmin", "w.xmax"]\nevery = 100\n')  # fmt: skip
        done = study.Run(scene, Path(folder) / "out", 1)
        if done.code != 0:
            sys.exit(done.code)
        return done.last


def cube(n):
    return f"block = {{ box = {{ size = [1, 1, 1] }}, elements = [{n}, {n}, {n}] }}"


def main():
    arguments(__doc__).parse_args()
    study.setup()
    beam = 0.01 * 1e3 / (3.0 * 1000.0 / 12.0) + 0.01 * 10.0 / (5.0 / 6.0 * 1000.0 / 2.6)
    fine = {material: run(cube(12), "hex27", material, PRESSED)("w.zmin.fz") for material in (RUBBER, METAL)}
    table = []
    for element, kept in [(None, None), ("wedge18", "wedge18-sri"), ("hex27", "hex27")]:
        row = [f"`{element}`, `{kept}`" if element != kept else f"`{element}`" if element else "eight linear ones"]
        bar = mesh([5, 1, 1], [10, 1, 1])
        if element == "hex27":
            bar = "block = { box = { size = [10, 1, 1] }, elements = [10, 2, 2] }"
        for axis, force in [("y", [0, 0.01, 0]), ("z", [0, 0, 0.01])]:
            row.append(f"{run(bar, element, STEEL, BENT.format(force=force))(f'w.xmax.u{axis}') / beam - 1:+.1%}")
        for material in (RUBBER, METAL):
            for n in (2, 4):
                body = cube(2 * n) if element == "hex27" else mesh([n, n, n], [1, 1, 1])
                row.append(f"{run(body, kept, material, PRESSED)('w.zmin.fz') / fine[material] - 1:+.1%}")
        table.append(row)
    study.table(["", "bar, in the plane", "across", "rubber, 2", "4", "metal, 2", "4"], table)


if __name__ == "__main__":
    main()

#!/usr/bin/python3 -B
"""Prints, as Markdown tables, what pyramids between hexahedra, and tetrahedra beside them, cost in stiffness: Cook's
membrane and a cube between plates, by the share of the hexahedra that are cut."""

import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from wedges import COOK, CUBE, METAL, RUBBER, found, membrane

from shared import arguments, gmsh, say, study

BOTTOM = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
CORNERS = BOTTOM + [(i, j, 1) for i, j, _ in BOTTOM]
COMPRESSIBLE = 'model = "hooke"\nyoung = 240.565\npoisson = 0.3'


def name_of(outward, at):
    """The name of the side of the unit cube that a free face is on."""
    sides = ((axis, end) for axis in range(3) for end in range(2))
    return next("xyz"[axis] + ("min", "max")[end] for axis, end in sides if all(at[n][axis] == end for n in outward))


def mesh(path, counts, place, cut):
    """A block of hexahedra, each of which `cut` says what it becomes of: "" for itself, "p" for six pyramids around a
    node in its middle, "t" for two tetrahedra on each side that is not another's, and pyramids on others."""
    nx, ny, nz = counts
    number = lambda i, j, k: 1 + i + (nx + 1) * (j + (ny + 1) * k)
    cells = [(i, j, k) for k in range(nz) for j in range(ny) for i in range(nx)]
    at = {number(i, j, k): (i / nx, j / ny, k / nz)
          for k in range(nz + 1) for j in range(ny + 1) for i in range(nx + 1)}
    whole, sides = set(), {}
    for i, j, k in cells:
        nodes = [number(i + a, j + b, k + c) for a, b, c in CORNERS]
        for face in gmsh.FACES:
            outward = [nodes[c] for c in face]
            key = frozenset(outward)
            if key in sides:
                del sides[key]
            else:
                sides[key] = outward
            if cut(i, j, k) != "t":
                whole.add(key)

    def parts(outward):
        if frozenset(outward) in whole:
            return [outward]
        first = outward.index(min(outward))
        a, b, c, d = outward[first:] + outward[:first]
        return [[a, b, c], [a, c, d]]

    elements = [(2, name_of(outward, at), part) for outward in sides.values() for part in parts(outward)]
    for i, j, k in cells:
        nodes = [number(i + a, j + b, k + c) for a, b, c in CORNERS]
        if not cut(i, j, k):
            elements.append((3, "solid", nodes))
            continue
        apex = len(at) + 1
        at[apex] = ((i + 0.5) / nx, (j + 0.5) / ny, (k + 0.5) / nz)
        for face in gmsh.FACES:
            elements += [(3, "solid", [*part[::-1], apex]) for part in parts([nodes[c] for c in face])]
    path.write_text(gmsh.text([place(*x) for x in at.values()], elements))


def rows(folder, counts, place, columns, steps, column):
    """Of each mesh what is found with each element and material."""
    n = counts[0]
    every = lambda m: lambda i, j, k: "p" if (i + 2 * j + 3 * k) % m == 0 else ""
    cases = [("none", lambda i, j, k: ""), ("an eighth in pyramids", every(8)), ("a quarter", every(4)),
             ("half", every(2)),
             ("half in tetrahedra", lambda i, j, k: "t" if 2 * i >= n else "")]
    for name, cut in cases:
        say(name)
        mesh(folder / "b.msh", counts, place, cut)
        yield [name, *(f"{found(folder, *case, steps, column):.4g}" for case in columns)]


def main():
    arguments(__doc__).parse_args()
    study.setup()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        columns = [("", COMPRESSIBLE), ("", RUBBER), ('element = "hex8-eas"', RUBBER)]
        for n in (8, 16):
            table = rows(folder, (n, n, 1), membrane, columns, COOK, "b.xmax.uy")
            study.table([f"Cook, {n}", "compressible", "rubber", "`hex8-eas`"], table)
            print()
        across = lambda x, y, z: (z, x, y)
        columns = [("", RUBBER), ("", METAL)]
        study.table(["cube, 8", "rubber", "metal"], rows(folder, (8, 8, 8), across, columns, CUBE, "b.ymax.fz"))


if __name__ == "__main__":
    main()

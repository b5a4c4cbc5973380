#!/usr/bin/python3 -B
"""Runs decks of C3D20 and C3D20R in CalculiX, and in nagata, where each element becomes eight `hex8-eas` between
its nodes, or one `hex27`, and prints errors side by side, as a Markdown table: of the deflection of a bar of one
layer, its elements twice as long as high, under a force at its end, against beam theory with shear; of the radial
displacement inside a quarter of a tube of radii 1 and 2 in plane strain under inner pressure; and of the forces
of two blocks, pressed and drawn over each other with friction, against those of nagata with elements a third as
large.
"""

import math
import re
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import arguments, install, study

# In half edges: corners, then the middles of edges.
HEX20 = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2),
         (1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2),
         (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]  # fmt: skip
# Of a side under an even traction by corners and middles of edges.
SHARES = [-1 / 12] * 4 + [1 / 3] * 4


class Block:
    """Elements of second order on the unit cube, which `place` takes to where they are."""

    def __init__(self, cells, place, first=0):
        self.cells, self.place, self.first = cells, place, first

    def node(self, at):
        nx, ny, _ = (2 * n + 1 for n in self.cells)
        return self.first + 1 + at[0] + nx * (at[1] + ny * at[2])

    def nodes(self):
        ranges = [range(2 * n + 1) for n in self.cells]
        every = ((i, j, k) for k in ranges[2] for j in ranges[1] for i in ranges[0])
        return [at for at in every if sum(i % 2 for i in at) < 2]

    def elements(self):
        nx, ny, nz = self.cells
        lows = ((2 * i, 2 * j, 2 * k) for k in range(nz) for j in range(ny) for i in range(nx))
        return [(self.first + 1 + e, low) for e, low in enumerate(lows)]

    def mesh(self, kind, name):
        lines = ["*NODE"]
        for at in self.nodes():
            x = self.place([i / (2 * n) for i, n in zip(at, self.cells)])
            lines.append(f"{self.node(at)}, " + ", ".join(f"{c:.15g}" for c in x))
        lines.append(f"*ELEMENT, TYPE={kind}, ELSET={name}")
        for number, low in self.elements():
            own = [str(self.node([a + b for a, b in zip(low, d)])) for d in HEX20]
            lines += [f"{number}, " + ", ".join(own[:15]) + ",", ", ".join(own[15:])]
        return "\n".join(lines) + "\n"

    def set(self, name, axis, side):
        at = side * 2 * self.cells[axis]
        own = [str(self.node(node)) for node in self.nodes() if node[axis] == at]
        return f"*NSET, NSET={name}\n" + ",\n".join(own) + "\n"

    def side(self, axis, side, end):
        low = 2 * (self.cells[axis] - 1) * side
        return "".join(f"{number}, {end}\n" for number, at in self.elements() if at[axis] == low)


def solid(name, young, poisson):
    return f"*MATERIAL, NAME=M{name}\n*ELASTIC\n{young}, {poisson}\n*SOLID SECTION, ELSET={name}, MATERIAL=M{name}\n"


def bar(kind):
    block = Block((5, 1, 1), lambda x: (10 * x[0], x[1], x[2]))
    forces = {}
    side = [k for k, d in enumerate(HEX20) if d[0] == 2]
    for share, k in zip(SHARES, side):
        at = [HEX20[k][0] + 8, *HEX20[k][1:]]
        forces[block.node(at)] = -0.01 * share
    loads = "".join(f"{node}, 3, {force:.15g}\n" for node, force in forces.items())
    return (block.mesh(kind, "BAR") + block.set("FIXED", 0, 0) + block.set("SEEN", 0, 1) + solid("BAR", 1000, 0.3)
            + f"*STEP\n*STATIC\n1., 1.\n*BOUNDARY\nFIXED, 1, 3\n*CLOAD\n{loads}")  # fmt: skip


def bar_error(moved):
    exact = 0.01 * (1e3 / (3 * 1000 / 12) + 10 / (5 / 6 * 1000 / 2.6))
    return -sum(u[2] for u in moved.values()) / len(moved) / exact - 1


def tube(kind):
    def place(x):
        angle, radius = math.pi / 2 * x[1], 1 + x[0]
        return [c if abs(c) > 1e-12 else 0.0 for c in (radius * math.cos(angle), radius * math.sin(angle), 0.2 * x[2])]

    block = Block((2, 4, 1), place)
    sides = {"YLOW": (1, 0), "XLOW": (1, 1), "ZLOW": (2, 0), "ZHIGH": (2, 1), "SEEN": (0, 0)}
    sets = "".join(block.set(name, *side) for name, side in sides.items())
    return (block.mesh(kind, "TUBE") + sets + solid("TUBE", 1000, 0.3)
            + "*STEP\n*STATIC\n1., 1.\n*BOUNDARY\nYLOW, 2\nXLOW, 1\nZLOW, 3\nZHIGH, 3\n*DLOAD\n"
            + block.side(0, 0, "P6, 0.1"))  # fmt: skip


def tube_error(moved, places):
    exact = 1.3 * 0.1 / 3000 * (0.4 + 4)
    radial = [sum(u * c for u, c in zip(u, places[n])) / math.hypot(*places[n][:2]) for n, u in moved.items()]
    return sum(radial) / len(radial) / exact - 1


def blocks(kind, n):
    lower = Block((3 * n, 3 * n, n), lambda x: (3 * x[0], 3 * x[1], x[2]))
    upper = Block((n, 2 * n, n), lambda x: (0.2 + 1.2 * x[0], 0.4 + 2 * x[1], 1 + 0.8 * x[2]), 10**6)
    return (lower.mesh(kind, "LOWER") + upper.mesh(kind, "UPPER") + lower.set("BASE", 2, 0) + upper.set("TOP", 2, 1)
            + solid("LOWER", 900, 0.2) + solid("UPPER", 200, 0.3)
            + "*SURFACE, NAME=SLAVE, TYPE=ELEMENT\n" + upper.side(2, 0, "S1")
            + "*SURFACE, NAME=MASTER, TYPE=ELEMENT\n" + lower.side(2, 1, "S2")
            + "*SURFACE INTERACTION, NAME=RUB\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n2e4\n"
            + "*FRICTION\n0.3, 2e4\n"
            + "*CONTACT PAIR, INTERACTION=RUB, TYPE=SURFACE TO SURFACE\nSLAVE, MASTER\n"
            + "*STEP, NLGEOM\n*STATIC\n.5, 1.\n*BOUNDARY\nBASE, 1, 3\nTOP, 3, 3, -0.02\nTOP, 1, 2\n*END STEP\n"
            + "*STEP, NLGEOM\n*STATIC\n.25, 1.\n*BOUNDARY\nTOP, 1, 1, 0.3\n")  # fmt: skip


def calculix(deck, folder, printed):
    (folder / "deck.inp").write_text(deck + printed + "*END STEP\n")
    subprocess.run(["ccx", "deck"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    return (folder / "deck.dat").read_text()


def by_calculix(deck, folder):
    """Displacements of the set SEEN by node."""
    said = calculix(deck, folder, "*NODE PRINT, NSET=SEEN\nU\n")
    rows = (line.split() for line in said.splitlines() if re.match(r"\s+\d+\s+[-+.\dE]+\s+\S+\s+\S+$", line))
    return {int(n): [float(u) for u in rest] for n, *rest in rows}


def force_of_calculix(deck, folder):
    said = calculix(deck, folder, "*NODE PRINT, NSET=TOP, TOTALS=ONLY\nRF\n")
    rows = [line.split() for line in said.splitlines() if re.match(r"\s+[-+.\dE]+\s+[-+.\dE]+\s+[-+.\dE]+$", line)]
    return [float(f) for f in rows[-1]]


def history_of_nagata(deck, element, folder):
    (folder / "deck.inp").write_text(deck + "*END STEP\n")
    subprocess.run([study.NAGATA, "convert", folder / "deck.inp", "--out", folder / "scene.toml"], check=True,
                   capture_output=True)  # fmt: skip
    kind = next(name for name in SEEN if f"ELSET={name}\n" in deck)
    more = ["--set", f'output.history=["{kind}.{SEEN[kind]}"]']
    if element:
        for body in re.findall(r"ELSET=(BAR|TUBE|UPPER|LOWER)$", deck, re.MULTILINE):
            more += ["--set", f'body.{body}.element="{element}"']
    run = study.Run(folder / "scene.toml", folder / "out", 1, *more)
    if run.code:
        sys.exit(f"exit code {run.code}")
    return run.last


# What is looked at of a body.
SEEN = {"BAR": "SEEN", "TUBE": "SEEN", "UPPER": "TOP"}


def main():
    arguments(__doc__).parse_args()
    install("calculix-ccx")

    def run(how, *rest):
        with tempfile.TemporaryDirectory() as folder:
            return how(*rest, Path(folder))

    places = {}
    for line in tube("C3D20").split("*ELEMENT")[0].splitlines()[1:]:
        n, *x = line.split(",")
        places[int(n)] = [float(c) for c in x]
    fine = run(history_of_nagata, blocks("C3D20", 3), None)
    exact = [fine(f"UPPER.TOP.f{c}") for c in "xz"]

    def off(forces):
        return [f / e - 1 for f, e in zip(forces, exact)]

    print("| | bar | tube | blocks, along | pressed |\n|---|---|---|---|---|")
    for kind in ["C3D20", "C3D20R"]:
        force = run(force_of_calculix, blocks(kind, 1))
        errors = [bar_error(run(by_calculix, bar(kind))), tube_error(run(by_calculix, tube(kind)), places)]
        print(f"| {kind}, CalculiX | " + " | ".join(f"{e:+.2%}" for e in errors + off([force[0], force[2]])) + " |")
    # The mean of u_x over its nodes, nine along the quarter of the circle.
    along = sum(math.cos(math.pi / 16 * k) for k in range(9)) / 9
    for element, words in [(None, "eight `hex8-eas` each"), ("hex27", "`hex27`")]:
        bent, widened, own = (run(history_of_nagata, deck, element)
                              for deck in [bar("C3D20"), tube("C3D20"), blocks("C3D20", 1)])  # fmt: skip
        errors = [
            bar_error({0: [bent(f"BAR.SEEN.u{c}") for c in "xyz"]}),
            widened("TUBE.SEEN.ux") / along / (1.3 * 0.1 / 3000 * (0.4 + 4)) - 1,
            *off([own(f"UPPER.TOP.f{c}") for c in "xz"]),
        ]
        print(f"| {words}, nagata | " + " | ".join(f"{e:+.2%}" for e in errors) + " |")


if __name__ == "__main__":
    main()

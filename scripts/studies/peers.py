#!/usr/bin/python3 -B
"""Runs nagata and the other solvers that Debian has on the same problems, in turn, and prints the results side by side,
as Markdown tables. CPU and wall time, with the start of the processes, are medians of the rounds.

A number n is inputs/sphere-on-block.toml: a rigid spherical cap on an elastic block of n x n x n/2 hexahedra, in nagata
with the cap as Nagata patches, as flat facets of a mesh that is refined with the block's, and as the exact sphere; in
CalculiX, by its mortar method, and in GetFEM, by its augmented Lagrangian, with the same facets. F_n and F_t are the
forces of the cap on the block along -z and x, N.

`hertz` is a quarter of an elastic block with a spherical underside, 10 x 10 x 10 mm, that is pressed on a rigid plate
without friction, in nagata and CalculiX (surface to surface with a penalty: its mortar method hangs on slave nodes that
are held in a plane of symmetry): 44,616 displacements, elements of 0.125 mm in the contact, whose radius is 1 mm.

`ironing` is inputs/ironing-peers.toml, in nagata alone: an elastic indenter is pressed into a slab and drawn along it
by 50 mm.
"""

import json
import math
import statistics
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import product
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, ROOT, arguments, calculix, gmsh, install, say, study

HEAD = ["n", "solver", "cap", "processes", "CPU s", "wall s", "increments / iterations", "F_n pressed",
        "F_n at the end", "F_t at the end", "peak MB"]
HERTZ_HEAD = ["solver", "processes", "CPU s", "wall s", "increments / iterations", "F", "highest pressure", "peak MB"]
IRONING_HEAD = ["solver", "master", "processes", "CPU s", "wall s", "increments / iterations", "F_n pressed",
                "F_n at the end", "F_t at the end", "F_t / F_n", "nodes that stick", "peak MB"]

HERTZ_SCENE = """
title = "Hertz: elastic ball on a rigid plate"
[body.ball]
mesh = "ball.msh"
material = "elastic"
[material.elastic]
model = "hooke"
young = 1000.0
poisson = 0.3
[tool.plate]
plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }
[contact.spot]
slave = "ball.underside"
master = "plate"
[[step]]
name = "press"
increments = 5
fix = [{ set = "ball.xmin", directions = "x" }, { set = "ball.ymin", directions = "y" }]
move = [{ target = "ball.back", by = [0.0, 0.0, -0.05], directions = "z" }]
[output]
every = 5
history = ["ball.back"]
"""


@dataclass
class Program:
    """What a row of a table is about, and what runs it: it returns the process and the further cells of the row."""

    labels: list
    run: Callable


def compare(programs, columns, args):
    """Rows of the programs, which take turns, and whether all of them went through."""
    times, cells, failed = [[] for _ in programs], [None] * len(programs), False
    for turn in range(args.rounds):
        for k, program in enumerate(programs):
            say(f"round {turn + 1} of {args.rounds}: {', '.join(map(str, program.labels))}")
            process, cells[k] = program.run()
            times[k].append((process.cpu, process.wall))
            if process.code != 0:
                failed = True
                limit = process.code == study.LIMIT
                cells[k] = [f"not finished in {args.limit} s" if limit else "failed"]
    rows = []
    for program, spent, found in zip(programs, times, cells):
        row = [*program.labels, *(f"{statistics.median(column):.1f}" for column in zip(*spent)), *found]
        rows.append(row + [""] * (columns - len(row)))
    return rows, not failed


def threads(count):
    return 1 if count == 1 else f"{count} threads"


def formatted(effort, *values, peak, digits=1):
    return [effort, *(f"{value:.{digits}f}" for value in values), f"{peak:.0f}"]


def grid(xs, ys, zs, place=lambda *at: at):
    """Points, row by row and layer by layer, and hexahedra."""
    points = [place(x, y, z) for z, y, x in product(zs, ys, xs)]
    row, layer = len(xs), len(xs) * len(ys)
    corners = [i + row * j + layer * k for i, j, k in
               ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))]
    cells = product(range(len(zs) - 1), range(len(ys) - 1), range(len(xs) - 1))
    return points, [[i + row * j + layer * k + corner for corner in corners] for k, j, i in cells]


def even(start, length, count):
    return [start + length * k / count for k in range(count + 1)]


def with_ends(points, hexes, layer):
    """A body of layers of so many points, with the lowest and the highest as sets."""
    every = range(len(points))
    return points, hexes, {"below": set(every[:layer]), "above": set(every[-layer:]), "all": set(every)}


def run_calculix(text, folder, last, args):
    """The process, and unless it failed the forces by time."""
    folder.mkdir(exist_ok=True)
    (folder / "job.inp").write_text(text)
    environment = {"OMP_NUM_THREADS": str(args.ranks), "OPENBLAS_NUM_THREADS": "1"}
    with open(folder / "log.txt", "w") as log:  # it writes more where it is run
        process = study.Process(["ccx", "-i", "job"], args.limit, environment, cwd=folder, stdout=log, stderr=log)
    forces = calculix.forces(folder, "job") if process.code == 0 else {}
    if process.code == 0 and last not in forces:  # it has given up, which is no error to it
        process.code = 1
    return process, forces


class Cap:
    """The cap on the block, with so many elements along it."""

    def __init__(self, n, folder, args):
        self.n, self.folder, self.args = n, folder, args
        self.path = INPUTS / "sphere-on-block.toml"
        self.scene = tomllib.loads(self.path.read_text())
        self.steps = [(step["name"], step["move"][0]["by"], step["increments"]) for step in self.scene["step"]]
        self.friction, self.material = self.scene["contact"]["top"]["friction"], self.scene["material"]["rubber"]
        box = self.scene["body"]["block"]["block"]["box"]
        xs, ys, zs = (even(*side) for side in zip(box["origin"], box["size"], (n, n, n // 2)))
        self.element = box["size"][0] / n
        self.block = with_ends(*grid(xs, ys, zs), len(xs) * len(ys))
        self.facets = max(4, 2 * round(0.2 * n))
        self.mesh = folder / f"cap-{n}.msh"
        make = ROOT / "scripts" / "meshes" / "sphere-cap.py"
        subprocess.run([make, "--facets", str(self.facets), "--out", self.mesh], check=True)

    def programs(self):
        peers = [("CalculiX", threads(self.args.ranks), self.calculix), ("GetFEM", 1, self.getfem)]
        return [
            *(Program([self.n, "nagata", name, self.args.ranks], partial(self.nagata, smoothing))
              for name, smoothing in (("Nagata", "nagata"), ("facets", "facet"), ("sphere", "sphere"))),
            *(Program([self.n, name, "facets", processes], run) for name, processes, run in peers),
        ]

    def nagata(self, smoothing):
        sets = {"body.block.block.elements": [self.n, self.n, self.n // 2], "tool.cap.mesh": self.mesh,
                "tool.cap.smoothing": smoothing}
        out = self.folder / f"{self.n}-{smoothing}"
        run = study.Run(self.path, out, self.args.ranks, *(f"--set={key}={value}" for key, value in sets.items()))
        if run.code != 0:
            return run, []
        forces = -run.last("cap.fz", self.steps[0][0]), -run.last("cap.fz"), run.last("cap.fx")
        return run, formatted(run.effort, *forces, peak=run.summary["peak_memory_mb"])

    def cap(self, thickness=10.0):
        """The facets of the cap with a layer of elements above, which is as rigid."""
        sphere = self.scene["tool"]["cap"]["sphere"]
        along, radius, height = even(-10.0, 20.0, self.facets), sphere["radius"], sphere["center"][2]
        place = lambda x, y, z: (x, y, height - math.sqrt(radius**2 - x * x - y * y) + z)
        return with_ends(*grid(along, along, [0.0, thickness], place), len(along) ** 2)

    def calculix(self):
        young, poisson = self.material["young"], self.material["poisson"]
        shear, bulk = young / (2 + 2 * poisson), young / (3 - 6 * poisson)
        material = ["*HYPERELASTIC, NEO HOOKE", f"{shear / 2:.15g}, {2 / bulk:.15g}"]
        place, steps = [0.0, 0.0, 0.0], []
        for _, by, increments in self.steps:
            place = [a + b for a, b in zip(place, by)]
            steps.append((increments, {("block", "below"): (0.0, 0.0, 0.0), ("cap", "all"): place}))
        bodies = {"block": self.block, "cap": self.cap()}
        # The slope of what sticks is one from which on the forces do not depend on it.
        contact = ["MORTAR", "HARD", "*FRICTION", f"{self.friction}, {10 * young / self.element:.9g}"]
        text = calculix.deck(bodies, material, ("block", "above"), ("cap", "below"), contact, steps,
                             ("block", "below"))
        folder = self.folder / f"{self.n}-calculix"
        process, forces = run_calculix(text, folder, len(steps), self.args)
        if process.code != 0:
            return process, []
        pressed, (along, _, down) = forces[1][2], forces[len(steps)]
        return process, formatted(calculix.effort(folder, "job"), pressed, down, -along, peak=process.peak)

    def getfem(self):
        case = {**self.material, "friction": self.friction, "element": self.element, "steps": self.steps}
        for name, (points, hexes, _) in (("block", self.block), ("cap", self.cap())):
            case[name] = str(self.folder / f"{self.n}-getfem-{name}.msh")
            Path(case[name]).write_text(gmsh.of_bodies({name: (points, hexes, {})}))
        question, answer = (self.folder / f"{self.n}-getfem-{name}.json" for name in ("case", "results"))
        question.write_text(json.dumps(case))
        command = ["/usr/bin/python3", "-B", ROOT / "scripts" / "shared" / "getfem_cap.py"]
        environment = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        with open(question) as read, open(answer, "w") as write:
            process = study.Process(command, self.args.limit, environment, stdin=read, stdout=write)
        if process.code != 0:
            return process, []
        rows = json.loads(answer.read_text())
        pressed = [force for step, _, force in rows if step == self.steps[0][0]][-1]
        end = rows[-1][2]
        effort = f"{len(rows)} / {sum(iterations for _, iterations, _ in rows)}"
        return process, formatted(effort, -pressed[2], -end[2], end[0], peak=process.peak)


ELEMENT = 0.125  # in the contact


def graded(count, length=10.0, first=ELEMENT, ratio=1.25):
    """Places from 0 to `length`: `count` elements of the size `first`, then larger ones that about keep the ratio."""
    places, size = [first * k for k in range(count + 1)], first
    while places[-1] < length:
        size *= ratio
        places.append(places[-1] + size)
    start, stretch = places[count], (length - places[count]) / (places[-1] - places[count])
    return places[: count + 1] + [start + (p - start) * stretch for p in places[count + 1:]]


def ball(radius=20.0):
    """The block with the spherical underside."""
    across, up = graded(12), graded(8)
    place = lambda x, y, z: (x, y, z + (radius - math.sqrt(radius**2 - x * x - y * y)) * (1 - z / up[-1]))
    points, hexes, ends = with_ends(*grid(across, across, up, place), len(across) ** 2)
    at = lambda axis: {m for m, p in enumerate(points) if p[axis] == 0.0}
    return points, hexes, {"underside": ends["below"], "back": ends["above"], "xmin": at(0), "ymin": at(1)}


def hertz(folder, args):
    scene, scene_file = tomllib.loads(HERTZ_SCENE), folder / "hertz.toml"
    (folder / "ball.msh").write_text(gmsh.of_bodies({"ball": ball()}))
    scene_file.write_text(HERTZ_SCENE)

    def nagata():
        run = study.Run(scene_file, folder / "hertz", args.ranks)
        if run.code != 0:
            return run, []
        results = -run.last("ball.back.fz"), run.last("spot.max_pressure")
        return run, formatted(run.effort, *results, peak=run.summary["peak_memory_mb"], digits=2)

    def of_calculix():
        step, material = scene["step"][0], scene["material"]["elastic"]
        plate = with_ends(*grid([-1.0, 11.0], [-1.0, 11.0], [-5.0, 0.0]), 4)
        displacements = {("plate", "all"): (0.0, 0.0, 0.0), ("ball", "xmin"): (0.0, None, None),
                         ("ball", "ymin"): (None, 0.0, None), ("ball", "back"): (None, None, step["move"][0]["by"][2])}
        law = ["*ELASTIC", f"{material['young']}, {material['poisson']}"]
        contact = ["SURFACE TO SURFACE", "LINEAR", f"{10 * material['young'] / ELEMENT:.9g}"]
        text = calculix.deck({"ball": ball(), "plate": plate}, law, ("ball", "underside"), ("plate", "above"), contact,
                             [(step["increments"], displacements)], ("ball", "back"))
        process, forces = run_calculix(text, folder / "hertz-calculix", 1, args)
        if process.code != 0:
            return process, []
        effort = calculix.effort(folder / "hertz-calculix", "job")
        return process, [effort, f"{-forces[1][2]:.2f}", "", f"{process.peak:.0f}"]

    return [Program(["nagata", args.ranks], nagata), Program(["CalculiX", threads(args.ranks)], of_calculix)]


def ironing(folder, args):
    slide = ["--set=step.slide.move.0.by=[50.0, 0.0, 0.0]", "--set=step.slide.increments=50"]

    def nagata(smoothing):
        run = study.Run(INPUTS / "ironing-peers.toml", folder / f"ironing-{smoothing}", args.ranks, *slide,
                        f"--set=contact.top.smoothing={smoothing}")
        if run.code != 0:
            return run, []
        forces = [-run.last("indenter.top.fy", "press"), -run.last("indenter.top.fy"), run.last("indenter.top.fx")]
        return run, [run.effort, *(f"{force:.1f}" for force in forces), f"{forces[2] / forces[1]:.3f}",
                     f"{run.last('top.stick'):.0f}", f"{run.summary['peak_memory_mb']:.0f}"]

    return [Program(["nagata", name, args.ranks], partial(nagata, smoothing))
            for name, smoothing in (("Nagata", "nagata"), ("facets", "facet"))]


def main():
    parser = arguments(__doc__)
    parser.add_argument("cases", nargs="*", default=["20", "hertz", "ironing"], metavar="CASE",
                        help="an even number of elements along the block, `hertz` or `ironing` (20 hertz ironing)")
    parser.add_argument("--ranks", type=int, default=2, metavar="N",
                        help="of nagata, and threads of CalculiX; GetFEM has one (%(default)s)")
    parser.add_argument("--rounds", type=int, default=3, metavar="N",
                        help="in each all programs run once (%(default)s)")
    parser.add_argument("--limit", type=int, default=3600, metavar="S",
                        help="seconds after which a run of a peer is ended (%(default)s)")
    args = parser.parse_args()
    sizes = [int(case) if case.isdigit() else 0 for case in args.cases if case not in ("ironing", "hertz")]
    if any(n < 2 or n % 2 for n in sizes):
        parser.error("a case is `ironing`, `hertz`, or an even number, 2 or more")
    if args.rounds < 1:
        parser.error("there is a round or more")

    study.setup()
    install("calculix-ccx", "python3-getfem")
    done = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        tables = [(HEAD, [program for n in sizes for program in Cap(n, folder, args).programs()])]
        tables += [(HERTZ_HEAD, hertz(folder, args))] if "hertz" in args.cases else []
        tables += [(IRONING_HEAD, ironing(folder, args))] if "ironing" in args.cases else []
        for head, programs in tables:
            if programs:
                rows, went_through = compare(programs, len(head), args)
                study.table(head, rows)
                print(flush=True)
                done.append(went_through)
    return int(not all(done))


if __name__ == "__main__":
    sys.exit(main())

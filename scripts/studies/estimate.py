#!/usr/bin/python3 -B
"""Prints, as a Markdown table, what runs estimate of their errors, and the errors themselves: of a thick cylinder
(Lame), a rigid ball on a block, an elastic ball and roller on a block (Hertz, on layers), a disk in a bore
(scripts/studies/disk-theory.py), and a sphere on a block of rubber (against a finer mesh). Errors of forces and
pressures depend on where the next node lies: of some scenes they are root mean squares over the ends of several
steps."""

import math
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, ROOT, arguments, hertz, say, study
from shared.scientific import h5py, np

HEAD = ["scene", "elements", "nodes to the middle", "energy, estimated", "force", "estimated", "ratio", "pressure, rms",
        "estimated", "ratio"]
DEPTHS = [0.7, 0.8, 0.9, 1.0]  # of the approach, at the ends of the steps
SIDES = """
fix = [
    { set = "block.xmin", directions = "x" }, { set = "block.xmax", directions = "x" },
    { set = "block.ymin", directions = "y" }, { set = "block.ymax", directions = "y" },
    { set = "block.zmin", directions = "z" },
]"""
HEXAHEDRA = """
title = "A rigid ball on a quarter of a block"
[body.block]
material = "soft"
element = "{element}"
[body.block.block]
box = {{ origin = [0.0, 0.0, {0}], size = [{1}, {1}, {1}] }}
elements = [{n}, {n}, {n}]
grading = [{grading}, {grading}, {inverse}]
[material.soft]
model = "{model}"
young = {young}
poisson = 0.3
[tool.ball]
sphere = {{ center = [0.0, 0.0, {radius}], radius = {radius} }}
[contact.spot]
slave = "block.zmax"
master = "ball"
"""
RING = """
title = "A thick cylinder under pressure from inside"
[body.ring]
material = "ring"
element = "{element}"
plane_strain = true
block = {{ sector = {{ radii = [0.5, 1.0], angles = [0.0, 90.0], length = 1.0 }}, elements = [{n}, {around}, 1] }}
[material.ring]
model = "hooke"
young = 1e6
poisson = 0.3
[[step]]
increments = 1
fix = [{{ set = "ring.amin", directions = "y" }}, {{ set = "ring.amax", directions = "x" }}]
pressure = [{{ set = "ring.rmin", value = 1.0 }}]
[output]
history = ["ring.rmin"]
"""


def rms(values):
    return math.sqrt(sum(value * value for value in values) / len(values))


class Case:
    """The runs of a scene, in a folder."""

    def __init__(self, folder, ranks):
        self.folder, self.ranks, self.count = Path(folder), ranks, 0

    def run(self, text):
        """Runs a scene; its summary has the estimates of each step. Also gives its folder of results."""
        self.count += 1
        scene, out = self.folder / "scene.toml", self.folder / f"out-{self.count}"
        scene.write_text(text)
        run = study.Run(scene, out, self.ranks)
        if run.code:
            sys.exit(run.code)
        return run, out


def steps(whole, how):
    """Steps to the parts DEPTHS of a motion; `how` gives the conditions of a part of it."""
    parts = [to - before for to, before in zip(DEPTHS, [0.0, *DEPTHS])]
    counts = [4, *[1] * (len(parts) - 1)]
    return "".join(f"\n[[step]]\nincrements = {n}{how(part * whole)}\n" for n, part in zip(counts, parts))


def contacts(out, name):
    """For the end of each step distance from the middle, pressure and area of each slave node of a contact."""
    found = []
    with h5py.File(out / "fields.h5") as file:
        grid = f"contact_{name}"
        points = file[f"grids/{grid}/points"][:].reshape(-1, 3)
        cells = file[f"grids/{grid}/cells"][:].reshape(-1, 4)
        a, b = points[cells[:, 2]] - points[cells[:, 0]], points[cells[:, 3]] - points[cells[:, 1]]
        areas = np.zeros(len(points))
        np.add.at(areas, cells, 0.125 * np.linalg.norm(np.cross(a, b), axis=1)[:, None])
        for key in sorted(file["increments"])[-len(DEPTHS):]:
            found.append((points, file[f"increments/{key}/{grid}/node/pressure"][:], areas))
    return found


def off(pressure, exact, areas):
    """Root mean square of what pressures are off by, over that of the exact ones."""
    return math.sqrt((areas * (pressure - exact) ** 2).sum() / (areas * exact**2).sum())


def row(name, elements, run, contact, force, pressure):
    """A row under HEAD: errors, one for each step, against their estimates."""
    estimates = run.summary["estimate"][-max(len(force), len(pressure)):]
    of = lambda key: [e["contacts"][contact][key] for e in estimates]
    energy = max(body["energy"] for body in estimates[-1]["bodies"].values())
    cells = [name, elements, estimates[-1]["contacts"][contact]["nodes_to_middle"], f"{energy:.3f}"]
    for errors, found in ((force, of("force")), (pressure, of("pressure"))):
        cells += [f"{rms(errors):.2%}", f"{rms(found):.2%}", f"{rms(found) / rms(errors):.2f}"] if errors else [""] * 3
    return cells


def cylinder(case):
    """||u||^2 - ||u_h||^2 = ||e||^2, as the force is given; ||u||^2 goes with the displacement of the bore."""
    exact = 1.3 / 1e6 * 0.125 / 0.75 * (0.4 + 4.0)
    for element in ("hex8", "hex8-fbar", "hex8-sri", "hex8-eas"):
        for n in (4, 8, 16):
            run, _ = case.run(RING.format(element=element, n=n, around=12 * n))
            mean = np.mean(np.cos(np.linspace(0, np.pi / 2, 12 * n + 1)))
            error = 1 - run.last("ring.rmin.ux") / mean / exact
            found = run.summary["estimate"][-1]["bodies"]["ring"]["energy"]
            yield [f"cylinder, {element}", n, "", f"{found:.4f}", f"{error:.3%}", f"{found**2:.3%}",
                   f"{found**2 / error:.2f}", "", "", ""]


def force_of(problem, approach):
    """The force at an approach, up to that at which the contact has a tenth of the width of the block."""
    low, high = 0.0, 4 / 3 * problem.modulus * (0.2 * problem.side) ** 3 / problem.radius
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if problem.approach(middle) < approach else (low, middle)
    return low


def rigid_ball(case):
    """As Hertz on a layer; the ball is so large that strains are small."""
    problem = hertz.Sphere(2000.0, 5000.0, 10.0, 10.0)  # two such bodies are as soft as one of half the modulus
    approach = 2e-4
    for element in ("hex8", "hex8-fbar"):
        for n, grading in ((10, 12.0), (14, 16.0), (20, 20.0)):
            down = lambda by: f'{SIDES}\nmove = [{{ target = "ball", by = [0.0, 0.0, {-by}] }}]'
            text = HEXAHEDRA.format(-10.0, 10.0, element=element, n=n, grading=grading, inverse=1 / grading,
                                    model="hooke", young=1000.0, radius=5000.0)
            run, out = case.run(text + steps(approach, down))
            force, pressure = [], []
            for k, (points, found, areas) in zip(DEPTHS, contacts(out, "spot")):
                exact = force_of(problem, k * approach)
                step = run.summary["estimate"][DEPTHS.index(k)]["step"]
                force.append(-4 * run.last("ball.fz", step) / exact - 1)
                a, p0 = problem.size(exact)
                pressure.append(off(found, hertz.arch(np.hypot(points[:, 0], points[:, 1]), a, p0), areas))
            yield row(f"rigid ball, {element}", f"{n}³", run, "spot", force, pressure)


def pushed(fix, target, axis, by):
    """Conditions that move a set down an axis."""
    way = str([-by if a == axis else 0.0 for a in "xyz"])
    return f'\n{fix}move = [{{ target = "{target}", by = {way}, directions = "{axis}" }}]'


def elastic(case):
    """The Hertz problems of inputs/."""
    for scene, problem, upper, axis, whole, factors in (
            ("hertz-cylinder", hertz.CYLINDER, "roller", "y", 0.00154, (0.5, 1.0, 2.0)),
            ("hertz-sphere", hertz.SPHERE, "ball", "z", 0.018, (0.5, 1.0, 1.5))):
        text = (INPUTS / f"{scene}.toml").read_text()
        head, step = text.split("[[step]]")
        fix = step[step.index("fix"):step.index("move")]
        down = partial(pushed, fix, f"{upper}.back", axis)
        for factor in factors:
            make = ROOT / "scripts" / "meshes" / "hertz.py"
            subprocess.run([make, "--out", case.folder, "--refine", str(factor)], check=True)
            watched = f'[output]\nhistory = ["block.base", "{upper}.back"]\n'
            run, out = case.run(head + steps(whole, down) + watched)
            force, pressure = [], []
            for k, (points, found, areas) in enumerate(contacts(out, problem.contact)):
                name = run.summary["estimate"][k]["step"]
                total = -run.last(problem.column, name) / problem.share
                approach = -run.last(problem.column.replace(".f", ".u"), name)
                force.append(total / problem.force_at(approach) - 1)
                a, p0 = problem.size(total)
                place_of = np.hypot(points[:, 0], points[:, 1]) if upper == "ball" else points[:, 0]
                pressure.append(off(found, hertz.arch(place_of, a, p0), areas))
            yield row(f"elastic {upper}", f"{factor:g}", run, problem.contact, force, pressure)


def disk(case):
    """inputs/disk-in-plate.toml in 20 increments, on meshes with so many edges on the half of the rim."""
    theory = case.folder / "theory.csv"
    subprocess.run([ROOT / "scripts" / "studies" / "disk-theory.py", "--out", theory], check=True,
                   stdout=subprocess.DEVNULL)
    angles, exact = np.loadtxt(theory, delimiter=",", skiprows=1, usecols=(0, 1)).T
    text = (INPUTS / "disk-in-plate.toml").read_text().replace("increments = 100", "increments = 20")
    for arc in (36, 72, 108):
        make = ROOT / "scripts" / "meshes" / "disk-in-plate.py"
        subprocess.run([make, "--arc", str(arc), "--out", case.folder / "disk-in-plate.msh"], check=True)
        run, out = case.run(text.replace("[30, 108, 1]", f"[{round(arc / 3.6)}, {arc}, 1]"))
        points, found, areas = contacts(out, "bore")[-1]
        angle = np.degrees(np.arctan2(points[:, 0], -points[:, 1] - 0.004))
        wanted = np.interp(angle, angles, exact, right=0.0)
        yield row("disk in a bore", arc, run, "bore", [], [off(found * 10.0 / (2 * 423.58), wanted, areas)])


def rubber(case):
    """A sphere of radius 20 pressed by 1 into a block of 20 x 20 x 20, neo-Hookean, against the finest mesh."""
    down = lambda by: f'{SIDES}\nmove = [{{ target = "ball", by = [0.0, 0.0, {-by}] }}]'
    forces, runs = {}, {}
    for n in (8, 12, 18, 30):
        text = HEXAHEDRA.format(-20.0, 20.0, element="hex8", n=n, grading=6.0, inverse=1 / 6.0, model="neo-hookean",
                                young=100.0, radius=20.0)
        run, _ = case.run(text + steps(1.0, down))
        forces[n] = [run.last("ball.fz", e["step"]) for e in run.summary["estimate"]]
        runs[n] = run
    for n in (8, 12, 18):
        yield row("sphere on rubber", f"{n}³", runs[n], "spot", [f / g - 1 for f, g in zip(forces[n], forces[30])], [])


CASES = {"cylinder": cylinder, "rigid-ball": rigid_ball, "elastic": elastic, "disk": disk, "rubber": rubber}


def main():
    parser = arguments(__doc__)
    parser.add_argument("cases", nargs="*", metavar="CASE", help=f"only these of {', '.join(CASES)}")
    parser.add_argument("--ranks", type=int, default=2, metavar="N", help="(%(default)s)")
    args = parser.parse_args()
    if unknown := set(args.cases).difference(CASES):
        parser.error(f"there is no case {', '.join(sorted(unknown))}; there are {', '.join(CASES)}")
    study.setup()
    rows = []
    for name in args.cases or CASES:
        with tempfile.TemporaryDirectory() as folder:
            say(name)
            rows += CASES[name](Case(folder, args.ranks))
    study.table(HEAD, rows)


if __name__ == "__main__":
    main()

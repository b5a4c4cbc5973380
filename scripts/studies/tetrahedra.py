#!/usr/bin/python3 -B
"""Prints, as Markdown tables, how well quadratic tetrahedra pass on pressure, on meshes of Gmsh: a ball on a plane
against Hertz, and blocks under an even pressure."""

import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import arguments, install, say, study
from shared.scientific import h5py, np

YOUNG, POISSON, RADIUS = 1000.0, 0.3, 10.0
BALL = """
[body.ball]
mesh = "ball.msh"
material = "soft"
[material.soft]
model = "hooke"
young = 1000.0
poisson = 0.3
[tool.plane]
plane = { point = [0.0, 0.0, -10.0], normal = [0.0, 0.0, 1.0] }
[contact.foot]
slave = "ball.round"
master = "plane"
method = "METHOD"
[[step]]
increments = 2
fix = [{ set = "ball.x", directions = "x" }, { set = "ball.y", directions = "y" }, { set = "ball.cut" }]
move = [{ target = "plane", by = [0.0, 0.0, APPROACH] }]
"""
BLOCKS = """
[body.upper]
UPPER
material = "soft"
[body.lower]
LOWER
material = "soft"
[material.soft]
model = "neo-hookean"
young = 1000.0
poisson = 0.0
[tool.plane]
plane = { point = [0.0, 0.0, 1.0], normal = [0.0, 0.0, -1.0] }
[contact.roof]
slave = "upper.zmax"
master = "plane"
[contact.between]
slave = "SLAVE"
master = "MASTER"
[[step]]
increments = 2
fix = [{ set = "upper.xmin", directions = "x" }, { set = "upper.ymin", directions = "y" },
       { set = "lower.xmin", directions = "x" }, { set = "lower.ymin", directions = "y" },
       { set = "lower.zmin", directions = "z" }]
move = [{ target = "plane", by = [0.0, 0.0, -0.2] }]
"""
# Each block is shortened to 0.9.
EVEN = 0.5 * YOUNG * (1 - 0.81) / 0.9


def mesh(folder, name, geometry):
    """A second-order mesh by Gmsh."""
    (folder / f"{name}.geo").write_text(f'SetFactory("OpenCASCADE");\n{geometry}')
    command = ["gmsh", "-3", "-order", "2", "-format", "msh2", "-v", "1", "-o", folder / f"{name}.msh",
               folder / f"{name}.geo"]
    subprocess.run(command, check=True)


def group(name, low, high):
    """The surface within a box as a group."""
    box = ", ".join(map(str, (*low, *high)))
    return f'{name}() = Surface In BoundingBox{{{box}}}; Physical Surface("{name}") = {{{name}()}};\n'


def ball(folder, size, fine):
    """A quarter of a half ball, of tetrahedra of a size as far as `fine` from the pole."""
    b, far = 1e-3, RADIUS + 1e-3
    depth = f"(Sqrt(x^2+y^2+(z+{RADIUS})^2)-{fine})"
    mesh(folder, "ball", f"Sphere(1) = {{0, 0, 0, {RADIUS}, -Pi/2, 0, Pi/2}};\n"
         f'Field[1] = MathEval; Field[1].F = "{size}+0.17*(Abs{depth}+{depth})"; Background Field = 1;\n'
         "Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0;\n"
         + group("x", (-b, -b, -far), (b, far, b)) + group("y", (-b, -b, -far), (far, b, b))
         + group("cut", (-b, -b, -b), (far, far, b))
         + "r() = Boundary{ Volume{1}; }; r() -= {x(), y(), cut()};\n"
         'Physical Surface("round") = {r()}; Physical Volume("solid") = {1};\n')


def block(folder, name, low, size):
    """A unit cube from z = `low` on."""
    text, b = f"Box(1) = {{0, 0, {low}, 1, 1, 1}};\nMesh.MeshSizeMax = {size}; Mesh.MeshSizeMin = {size};\n", 1e-6
    for axis, letter in enumerate("xyz"):
        for side, end in enumerate(("min", "max")):
            corners = [[0, 0, low], [1, 1, low + 1]]
            at = corners[side][axis]
            corners[0][axis] = corners[1][axis] = at
            text += group(letter + end, [c - b for c in corners[0]], [c + b for c in corners[1]])
    mesh(folder, name, text + 'Physical Volume("solid") = {1};\n')


def last(file, grid, kind, name):
    """A field of the last increment."""
    return file[f"increments/{max(file['increments'])}/{grid}/{kind}/{name}"][:]


def solve(folder, text):
    """The fields and history of a scene, or nothing where it does not converge."""
    (folder / "scene.toml").write_text(text)
    fields = 'output.fields=["displacement","pressure","stress"]'
    run = study.Run(folder / "scene.toml", folder / "out", 2, "--set", fields, limit=120)
    return (h5py.File(folder / "out" / "fields.h5"), run) if run.code == 0 else None


def hertz(folder, ratio, count, method):
    """A row: errors of the pressures over the highest under the force that was found, and of the radius."""
    radius = ratio * RADIUS
    ball(folder, radius / count, 1.3 * radius)
    approach = radius**2 / RADIUS
    file, run = solve(folder, BALL.replace("APPROACH", repr(approach)).replace("METHOD", method))
    modulus = YOUNG / (1 - POISSON**2)
    force = 4 * abs(run.last("plane.fz"))
    a = (0.75 * force * RADIUS / modulus) ** (1 / 3)
    highest = 1.5 * force / np.pi / a**2
    p, x = last(file, "contact_foot", "node", "pressure") / highest, file["grids/contact_foot/points"][:]
    r = np.hypot(x[:, 0], x[:, 1]) / a
    inner = r < 0.8
    (top, slope), *_ = np.linalg.lstsq(np.c_[np.ones(inner.sum()), -(r[inner] ** 2)], p[inner] ** 2, rcond=None)
    rms = np.sqrt(np.mean((p[inner] - np.sqrt(1 - r[inner] ** 2)) ** 2))
    errors = [p[r.argmin()] - 1, p.max() - 1, np.sqrt(top) - 1, np.sqrt(top / slope) - 1]
    return [f"{ratio:.1%}", count, method, *(f"{e:+.1%}" for e in errors), f"{rms:.1%}"]


def even(folder, upper, lower, slave):
    """A row: largest errors of pressure and stress. A number is the size of tetrahedra, a list counts hexahedra."""
    sides = {"upper": (upper, 0), "lower": (lower, -1)}
    text = BLOCKS.replace("SLAVE", slave).replace(
        "MASTER", "lower.zmax" if slave.startswith("upper") else "upper.zmin")
    for name, (size, low) in sides.items():
        if isinstance(size, list):
            box = f"{{ origin = [0.0, 0.0, {low}.0], size = [1.0, 1.0, 1.0] }}"
            source = f"block = {{ box = {box}, elements = {size} }}"
        else:
            block(folder, name, low, size)
            source = f'mesh = "{name}.msh"'
        text = text.replace(name.upper(), source)
    found = solve(folder, text)
    if not found:
        return [upper, lower, slave, "no convergence", "", ""]
    worst = [np.abs(last(found[0], "contact_between", "node", "pressure") / EVEN - 1).max()]
    for name in sides:
        worst.append(np.abs(last(found[0], f"body_{name}", "cell", "stress")[:, 2] / EVEN + 1).max())
    return [upper, lower, slave, *(f"{w:.1%}" for w in worst)]


def main():
    arguments(__doc__).parse_args()
    install("gmsh")
    study.setup()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        balls = [(0.05, 4, "augmented-lagrangian"), (0.05, 7, "augmented-lagrangian"), (0.05, 4, "penalty"),
                 (0.025, 5, "augmented-lagrangian")]
        study.table(["radius", "tetrahedra", "method", "pole", "highest", "fitted", "radius", "rms"],
                    [say(f"ball, {case}") or hertz(folder, *case) for case in balls])
        print()
        blocks = [(0.3, [2, 2, 2], "upper.zmin"), (0.3, [6, 6, 6], "upper.zmin"), (0.3, 0.45, "upper.zmin"),
                  (0.3, 0.2, "upper.zmin"), (0.3, [16, 16, 4], "lower.zmax"), (0.3, [8, 8, 4], "lower.zmax")]
        study.table(["upper", "lower", "slave", "pressure", "stress above", "below"],
                    [say(f"blocks, {case}") or even(folder, *case) for case in blocks])


if __name__ == "__main__":
    main()

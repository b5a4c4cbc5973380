#!/usr/bin/python3 -B
"""Runs scenes of rising complexity and prints, as a Markdown table, what each carries: unknowns, multipliers, the
matrix, bytes a slave node and an integration point, processor time and calls of the phases an increment."""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, arguments, say, study

# A block of 12 x 12 x 6 elements of 1 mm, stretched, or under a ball or another block.
BLOCK = """
[body.block]
material = "{material}"
block = {{ box = {{ size = [12, 12, 6] }}, elements = [12, 12, 6] }}
[material.rubber]
model = "neo-hookean"
young = 10.0
poisson = 0.3
[material.metal]
model = "j2"
young = 10.0
poisson = 0.3
yield_stress = 0.2
hardening = {{ linear = 1.0 }}
"""
STRETCH = """
[[step]]
increments = 5
fix = [{ set = "block.zmin" }]
move = [{ target = "block.zmax", by = [0, 0, 0.5] }]
"""
BALL = """
[tool.ball]
sphere = {{ center = [6, 6, 16.0], radius = 10.0 }}
[contact.top]
slave = "block.zmax"
master = "ball"
friction = {friction}
"""
BODY = """
[body.punch]
material = "rubber"
block = {{ box = {{ origin = [4.3, 4.3, 6.0], size = [4, 4, 3] }}, elements = [5, 5, 3] }}
[contact.top]
slave = "block.zmax"
master = "punch.zmin"
friction = {friction}
"""
PRESS = """
[[step]]
increments = 5
fix = [{ set = "block.zmin" }]
move = [{ target = "TARGET", by = [0, 0, -0.5] }]
[[step]]
name = "slide"
increments = 10
fix = [{ set = "block.zmin" }]
move = [{ target = "TARGET", by = [2, 0, 0] }]
"""


def on_block(contact="", target="", material="rubber", friction=0.3):
    loads = PRESS.replace("TARGET", target) if target else STRETCH
    return (BLOCK + contact).format(material=material, friction=friction) + loads


# In words, scene or its text, what is changed in it.
IRONING = ["step.press.increments=5", "step.slide.increments=80", "step.slide.move.0.by=[25,0,0]"]
SCENES = [
    ("elastic block", on_block(), []),
    ("under a ball, frictionless", on_block(BALL, "ball", friction=0.0), []),
    ("under a ball, friction", on_block(BALL, "ball"), []),
    ("the same, plastic", on_block(BALL, "ball", "metal"), []),
    ("under a block, frictionless", on_block(BODY, "punch.zmax", friction=0.0), []),
    ("under a block, friction", on_block(BODY, "punch.zmax"), []),
    ("ironing-rigid, 80 increments", INPUTS / "ironing-rigid.toml", IRONING),
    ("ironing-deformable, 80 increments", INPUTS / "ironing-deformable.toml", IRONING),
    ("c-strip, self-contact", INPUTS / "c-strip.toml", []),
    ("sphere-on-block", INPUTS / "sphere-on-block.toml", []),
]


def entries_by_check(scene, sets):
    """Entries of the largest matrix that `check` foresees, for programs that do not tell of theirs."""
    command = [str(study.NAGATA), "check", str(scene), *sets]
    check = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    return max(int(n) for n in re.findall(r"matrix with (\d+) entries", check.stdout))


def each(total, count):
    return round(total / count) if count else 0


def row(name, scene, sets, out):
    run = study.Run(scene, out, 1, *sets)
    if run.code != 0:
        sys.exit(run.code)
    s, n = run.summary, run.summary["increments"]
    carried, calls = s.get("carried"), s.get("phase_calls")
    told = ["", "", "", ""]
    if carried:
        told = [carried["slave_nodes"], each(carried["contact_bytes"], carried["slave_nodes"]),
                each(carried["history_bytes"], carried["points"]),
                " / ".join(f"{calls[phase] / n:.1f}" for phase in ("search", "assembly", "factor", "solve"))]
    entries = s.get("matrix_entries") or entries_by_check(scene, sets)
    return [name, s["dofs"], s["multipliers"], told[0], s["matrix"], entries, told[1], told[2], f"{run.cpu / n:.3f}",
            told[3], s.get("growths", "")]


def main():
    parser = arguments(__doc__)
    parser.add_argument("--program", type=Path, default=study.NAGATA, help="another build of nagata")
    args = parser.parse_args()
    if args.program == study.NAGATA:
        study.setup()
    study.NAGATA = args.program.resolve()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for k, (name, scene, changes) in enumerate(SCENES):
            say(name)
            file = scene
            if isinstance(scene, str):
                file = Path(folder) / f"{k}.toml"
                file.write_text(scene)
            rows.append(row(name, file, [word for entry in changes for word in ("--set", entry)],
                            Path(folder) / f"out-{k}"))
    study.table(["scene", "unknowns", "multipliers", "slave nodes", "matrix", "entries", "bytes a slave node",
                 "bytes a point", "CPU s an increment", "search / assembly / factor / solve, calls an increment",
                 "new equations, times"], rows)


if __name__ == "__main__":
    main()

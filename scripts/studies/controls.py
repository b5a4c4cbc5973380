#!/usr/bin/python3 -B
"""Half and twice of each control (src/controls.rs), over short forms of the scenes in inputs/, as a table in Markdown.

A control is tried in the scenes in which it is used. Forces are all in history.csv, at the last time and the largest of
each column, relative to the largest force of all; iterations, cuts and failures are sums over these scenes. A change of
the forces above 1e-6 at the same times is one of the result; with other increments, what depends on the path changes.
`--extremes` also runs the quick cases of tests/extremes with each control, and tells which of them end otherwise; on a
quiet machine, for cases are stopped after two minutes.
With `--results` a study that was ended goes on from what it has; `--doc` replaces the rows of what was tried.

    scripts/studies/controls.py [--only NAME ...] [--scenes NAME ...] [--factors 0.5 2] [--jobs 2]
                                [--extremes [PROGRAM] [--families NAME ...]]
                                [--results FILE] [--out FILE] [--doc docs/controls.md]
"""

import argparse
import collections
import concurrent.futures
import csv
import fnmatch
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OPENBLAS_NUM_THREADS": "1",
               "SCOTCH_PTHREAD_NUMBER": "1", "OMPI_MCA_pml": "ob1", "OMPI_MCA_btl": "self,vader",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "none"}

# A block that nothing else holds is pressed onto a floor, and the plate is lifted again.
RELEASE = """
[body.block]
block = { box = { size = [10.0, 10.0, 5.0] }, elements = [4, 4, 2] }
material = "soft"
[material.soft]
model = "neo-hookean"
young = 10.0
poisson = 0.3
[tool.floor]
plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }
[tool.plate]
plane = { point = [0.0, 0.0, 5.0], normal = [0.0, 0.0, -1.0] }
[contact.below]
slave = "block.zmin"
master = "floor"
friction = 0.1
[contact.above]
slave = "block.zmax"
master = "plate"
friction = 0.3
[[step]]
name = "press"
increments = 3
move = [{ target = "plate", by = [0.0, 0.0, -0.3] }]
[[step]]
name = "lift"
keep = true
increments = 2
move = [{ target = "plate", by = [0.0, 0.0, 1.0] }]
"""

# A block is drawn over the edge of a table, from which its nodes go at once.
EDGE = """
[body.table]
block = { box = { size = [6.0, 2.0, 1.0] }, elements = [6, 2, 1], faces = { rim = ["ymax"] } }
material = "soft"
plane_strain = true
[body.block]
block = { box = { origin = [2.0, 2.0, 0.0], size = [3.0, 1.5, 1.0] }, elements = [6, 3, 1] }
material = "soft"
plane_strain = true
[material.soft]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[contact.sole]
slave = "block.ymin"
master = "table.rim"
smoothing = "facet"
friction = 0.2
[[step]]
name = "press"
increments = 4
fix = [{ set = "table.ymin" }]
move = [{ target = "block.ymax", by = [0.0, -0.6, 0.0] }]
[[step]]
name = "slide"
increments = 20
fix = [{ set = "table.ymin" }]
move = [{ target = "block.ymax", by = [4.0, 0.0, 0.0] }]
[output]
every = 100
history = ["table.ymin", "block.ymax"]
"""

# A block bends another, from segment to segment, and is drawn over it.
SEGMENTS = """
[body.table]
block = { box = { size = [7.0, 4.0, 2.0] }, elements = [7, 4, 1] }
material = "soft"
[body.block]
block = { box = { origin = [1.2, 1.1, 2.0], size = [3.0, 2.0, 1.5] }, elements = [4, 3, 1] }
material = "hard"
[material.soft]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[material.hard]
model = "neo-hookean"
young = 200.0
poisson = 0.3
[contact.sole]
slave = "table.zmax"
master = "block.zmin"
discretization = "segment"
friction = 0.2
[[step]]
name = "press"
increments = 2
fix = [{ set = "table.zmin" }]
move = [{ target = "block.zmax", by = [0.0, 0.0, -0.2] }]
[[step]]
name = "drag"
increments = 4
fix = [{ set = "table.zmin" }]
move = [{ target = "block.zmax", by = [0.7, 0.2, 0.0] }]
[output]
every = 100
history = ["block.zmax", "table.zmin"]
"""

# The edges of a punch are between nodes of the slab, by 0.3 of a facet.
PUNCH = """
[body.slab]
block = { box = { size = [8.0, 4.0, 1.0] }, elements = [8, 4, 1] }
material = "soft"
plane_strain = true
[material.soft]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[tool.punch]
profile = { points = [[2.3, 8.0], [2.3, 4.0], [5.7, 4.0], [5.7, 8.0]] }
[contact.top]
slave = "slab.ymax"
master = "punch"
friction = 0.2
[[step]]
increments = 4
fix = [{ set = "slab.ymin" }]
move = [{ target = "punch", by = [0.0, -0.8, 0.0] }]
[output]
every = 100
history = ["slab.ymin"]
"""

# A sheet between die and holder is bent by a punch.
SHEET = """
[body.blank]
material = "steel"
element = "hex8-fbar"
plane_strain = true
block = { box = { size = [75.0, 0.78, 1.0] }, elements = [120, 2, 1] }
[material.steel]
model = "neo-hookean"
young = 206e3
poisson = 0.3
[tool]
die = { profile = { points = [[37.0, -60.0], [37.0, 0.0], [150.0, 0.0]], fillets = 5.0 }, flip = true }
holder = { profile = { points = [[150.0, 0.78], [37.0, 0.78], [37.0, 60.0]], fillets = 5.0 }, flip = true }
punch = { profile = { points = [[35.0, 60.0], [35.0, 0.78], [-10.0, 0.78]], fillets = 8.0 }, flip = true }
[contact]
die = { slave = "blank.ymin", master = "die" }
holder = { slave = "blank.ymax", master = "holder" }
punch = { slave = "blank.ymax", master = "punch" }
[[step]]
increments = 2
fix = [{ set = "blank.xmin", directions = "x" }]
force = [{ target = "holder", total = [0.0, -65.0, 0.0], directions = "y" }]
[[step]]
increments = 4
fix = [{ set = "blank.xmin", directions = "x" }]
force = [{ target = "holder", total = [0.0, -65.0, 0.0], directions = "y" }]
move = [{ target = "punch", by = [0.0, -0.2, 0.0] }]
[output]
every = 100
history = ["blank.xmin"]
"""

# A leaf of a spring lies on another, which active sets bend.
LEAVES = """
[body.low]
material = "steel"
plane_strain = true
element = "hex8-eas"
block = { box = { size = [20.0, 0.5, 1.0] }, elements = [40, 1, 1] }
[body.high]
material = "steel"
plane_strain = true
element = "hex8-eas"
block = { box = { origin = [0.0, 0.5, 0.0], size = [20.0, 0.5, 1.0] }, elements = [40, 1, 1] }
[material.steel]
model = "neo-hookean"
young = 200e3
poisson = 0.3
[contact.between]
slave = "low.ymax"
master = "high.ymin"
[[step]]
increments = 2
fix = [{ set = "low.xmin" }, { set = "high.xmin" }]
force = [{ target = "high.xmax", total = [0.0, -4.0, 0.0] }]
[output]
every = 100
history = ["low.xmin", "high.xmin"]
"""

# A ring that is crushed between two plates, of which the friction alone holds it.
RING = """
[body.ring]
material = "soft"
plane_strain = true
element = "hex8-eas"
block = { sector = { radii = [9.0, 10.0], angles = [-90, 270], length = 1.0 }, elements = [2, 36, 1] }
[material.soft]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[tool.high]
plane = { point = [0.0, 10.0, 0.0], normal = [0.0, -1.0, 0.0] }
[tool.low]
plane = { point = [0.0, -10.0, 0.0], normal = [0.0, 1.0, 0.0] }
[contact.above]
slave = "ring.rmax"
master = "high"
friction = 0.2
[contact.below]
slave = "ring.rmax"
master = "low"
friction = 0.2
[[step]]
increments = 16
move = [{ target = "high", by = [0.0, -8.0, 0.0] }, { target = "low", by = [0.0, 8.0, 0.0] }]
[output]
every = 100
"""

# A square column that buckles under a rough plate.
COLUMN = """
[body.column]
material = "soft"
element = "hex8-eas"
block = { box = { size = [1.0, 1.0, 20.0] }, elements = [2, 2, 20] }
[material.soft]
model = "neo-hookean"
young = 1000.0
poisson = 0.3
[tool.plate]
plane = { point = [0.0, 0.0, 20.0], normal = [0.0, 0.0, -1.0] }
[contact.top]
slave = "column.zmax"
master = "plate"
friction = 0.5
[[step]]
increments = 5
fix = [{ set = "column.zmin" }]
move = [{ target = "plate", by = [0.0, 0.0, -0.5] }]
force = [{ target = "column.xmax", total = [0.05, 0.02, 0.0] }]
[output]
every = 100
"""

# A block between platens as wide as itself.
PLATEN = """
[body.block]
block = { box = { size = [1.0, 1.0, 1.0] }, elements = [4, 4, 4] }
material = "soft"
[material.soft]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[tool.platen]
profile = { points = [[0.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]], closed = true, extrude = { length = 1.0 } }
[contact.top]
slave = "block.ymax"
master = "platen"
friction = 0.5
[[step]]
increments = 4
fix = [{ set = "block.ymin" }]
move = [{ target = "platen", by = [0.0, -0.2, 0.0] }]
[output]
every = 100
history = ["block.ymin"]
"""

# A torque turns a roller on a pad of rubber, by more in an iteration than it may.
ROLLER = """
[body.pad]
block = { box = { origin = [-8.0, -3.0, -4.0], size = [16.0, 6.0, 4.0] }, elements = [16, 1, 2] }
material = "rubber"
[material.rubber]
model = "neo-hookean"
young = 2.0
poisson = 0.3
[tool.roller]
cylinder = { point = [0.0, 0.0, 5.0], axis = [0.0, 1.0, 0.0], radius = 5.0 }
[contact.tread]
slave = "pad.zmax"
master = "roller"
friction = 4.0
[[step]]
name = "press"
increments = 2
fix = [{ set = "pad.zmin" }]
move = [{ target = "roller", by = [0.0, 0.0, -0.5] }]
[[step]]
name = "turn"
increments = 2
keep = true
force = [{ target = "roller", total = [0.0, 0.0, -4.0], directions = "z" }]
torque = [{ tool = "roller", total = 40.0, point = [0.0, 0.0, 4.5], axis = [0.0, 2.0, 0.0] }]
[output]
every = 100
history = ["pad.zmin"]
"""

IRONING = ["body.slab.block.elements=[40, 8, 1]", "step.press.increments=4", "step.slide.increments=5",
           "step.slide.move.0.by=[12.0, 0.0, 0.0]"]
# Name: scene of inputs/ or text, settings, what occurs in it.
SCENES = {
    "ironing": ("ironing-rigid", IRONING, "plain kinks"),
    "ironing-facet": ("ironing-rigid", ["tool.indenter.smoothing=facet", *IRONING], "faceted"),
    "ironing-lagrange": ("ironing-rigid", ["contact.top.method=lagrange", *IRONING],
                         "lagrange"),
    "ironing-uzawa": ("ironing-rigid", ["contact.top.method=uzawa", *IRONING], "uzawa"),
    "ironing-at-once": ("ironing-rigid", [IRONING[0], "step.press.increments=1", "step.slide.increments=1",
                                          "step.slide.move.0.by=[30.0, 0.0, 0.0]", "solver.max_iterations=8"],
                        "at-once failing"),
    "sphere": ("sphere-on-block", ["body.block.block.elements=[8, 8, 3]", "contact.top.method=penalty",
                                   "step.press.increments=2", "step.slide.increments=2"],
               "penalty kinks"),
    "sphere-turned": ("sphere-on-block", ["body.block.block.elements=[8, 8, 3]", "step.press.increments=1",
                                          "step.slide.increments=2", "step.slide.move.0.by=[0.0, 0.0, 0.0]",
                                          "step.slide.move.0.rotate={ point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], "
                                          "angle = 40.0 }"], "turning"),
    "edge": (EDGE, [], "failing jumping sharp"),
    "segments": (SEGMENTS, [], "segments"),
    "platen": (PLATEN, [], "rim"),
    "punch": (PUNCH, [], "between sharp"),
    "sheet": (SHEET, [], "central failing"),
    "leaves": (LEAVES, [], "lagrange failing"),
    "release": (RELEASE, [], "released failing"),
    "ring": (RING, [], "crushed"),
    "column": (COLUMN, [], "buckling"),
    "ironing-deformable": ("ironing-deformable", ["body.slab.block.elements=[60, 10, 1]", "step.press.increments=4",
                                                  "step.slide.increments=4", "step.slide.move.0.by=[4.0, 0.0, 0.0]"],
                           "body kinks"),
    "shallow": ("shallow-ironing", ["body.block.block.elements=[40, 10, 1]", "step.press.increments=5",
                                    "step.slide.increments=4", "step.slide.move.0.by=[0.2, 0.0, 0.0]"],
                "body"),
    "ironing-peers": ("ironing-peers", ["body.slab.block.elements=[90, 10, 1]", "step.press.increments=4",
                                        "step.slide.increments=3", "step.slide.move.0.by=[3.0, 0.0, 0.0]"],
                      "body plain"),
    "cattaneo": ("cattaneo-mindlin", ["step.press.increments=2", "step.shear.increments=3"], "body"),
    "disk": ("disk-in-plate", ["body.plate.block.elements=[10, 54, 1]", "step.press.increments=5",
                               "step.press.force.0.total=[0.0, -100.0, 0.0]"], "body rim"),
    "seal": ("face-seal", ["step.squeeze.increments=8", "step.pressure.increments=4"], "sharp"),
    "roller": (ROLLER, [], "torque"),
    "c-strip": ("c-strip", ["step.close.increments=6", "step.roll.increments=4"],
                "self kinks"),
    "c-strip-facet": ("c-strip", ["contact.inside.smoothing=facet", "contact.inside.friction=0.0",
                                  "step.close.increments=5", "step.roll.increments=5"], "self failing"),
    "c-strip-segments": ("c-strip", ["contact.inside.discretization=segment", "step.close.increments=6",
                                     "step.roll.increments=4", "step.draw.increments=8"], "own"),
    "patch-test": ("patch-test", [], "two-pass"),
    "patch-nodes": ("patch-test", ["body.lower.block.elements=[5, 5, 5]", "contact.joint.discretization=node-to-node"],
                    "nodes"),
    "hertz-ball": ("hertz-sphere", ["step.press.increments=1"], "kinks"),
    "hertz": ("hertz-cylinder", ["step.press.increments=1"], "kinks"),
    "extrusion": ("extrusion-rigid", ["step.push.increments=2", "step.push.move.0.by=[3.0, 0.0, 0.0]"],
                  "plastic kinks"),
    "extrusion-body": ("extrusion", ["step.push.increments=2", "step.push.move.0.by=[3.0, 0.0, 0.0]"],
                       "plastic kinks"),
    "tube": ("tube-buckling", ["body.tube.block.elements=[1, 4, 15]", "step.crush.duration=1.0",
                               "step.crush.move.0.by=[0.0, 0.0, -1.0]"], "self plastic"),
    "cup": ("square-cup-small", ["body.blank.block.elements=[6, 6, 1]", "step.draw.duration=0.3",
                                 "step.draw.move.0.by=[0.0, 0.0, -0.3]", "step.draw.increment.max=0.1"],
            "plastic driven failing"),
}
STEPS = {"c-strip": 2, "c-strip-facet": 2}
LIMIT = 600  # seconds

# In which scenes a control is tried: those with one of these words, in which it is used.
USED = [
    ("settling_*", "failing driven"), ("calm_*", "at-once sharp driven plain"), ("line_search_*", "plastic"),
    ("loose_*", "lagrange failing driven"), ("outer_rounds", "lagrange uzawa self failing"), ("uzawa_*", "uzawa"),
    ("singular_*", "failing"), ("short_increment", "failing"), ("remedy_period", "failing"), ("jump_*", "jumping"),
    ("penalty_method", "penalty"), ("two_pass_*", "two-pass"), ("repeat_*", "two-pass"),
    ("slack", "self failing"), ("slack_segments", "own"), ("slack_left", "own self failing"),
    ("wide_slack", "self"), ("kink_*", "kinks"), ("edge_aside", "rim sharp faceted plain"),
    ("edge_beside", "sharp"), ("self_*", "self"),
    ("friction_steep", "driven"), ("watch_around_self", "self"),
    ("step_turn", "torque"), ("segment_*", "segments"),
    ("watch_turn", "turning"), ("watch_segment", "segments"), ("watch_unfelt", "segments"),
    ("watch_between*", "between"), ("watch_*", "at-once sharp turning"), ("central_*", "central"),
    ("soft_augmentation", "failing driven"), ("end_*", "kinks"),
    ("coplanar", "kinks"), ("straight_misfit", "kinks"), ("step_halvings", "plastic at-once"),
    ("extrapolate*", "plain faceted sharp plastic self"), ("augmentation", "plain sharp self driven lagrange"),
    ("creep", "crushed"), ("linger*", "released"), ("stability_checks", "buckling crushed"),
    ("touching_gap", "driven sharp plain lagrange"), ("no_gap", "lagrange sharp"),
    ("*", "at-once sharp self plastic faceted"),
]


def controls():
    """Group, name, unit, default, range, whether an integer, reason: from src/controls.rs."""
    text = (ROOT / "src/controls.rs").read_text()
    text = text[text.index("\ncontrols! {"):]
    found, group = [], ""
    entry = re.compile(r'(\w+): (f64|usize) = ([^,]+), \[([^,]+), ([^\]]+)\], "([^"]*)",\s+"((?:[^"])*)";')
    for match in re.finditer(r'^    "(\w+)" \{$|' + entry.pattern, text, re.M):
        if match.group(1):
            group = match.group(1)
        else:
            name, kind, default, low, high, unit, reason = match.groups()[1:]
            found.append((group, name, unit, float(default), (float(low), float(high)), kind == "usize", reason))
    return found


def run(binary, scene, setting):
    """Exit code, columns of forces, iterations, cuts, times."""
    source, sets, _ = SCENES[scene]
    with tempfile.TemporaryDirectory() as folder:
        path = ROOT / "inputs" / f"{source}.toml"
        if "\n" in source:
            path = Path(folder) / "scene.toml"
            path.write_text(source)
        command = [binary, "run", path, "--out", f"{folder}/out", "--quiet"]
        command += ["--steps", str(STEPS[scene])] if scene in STEPS else []
        for entry in sets + setting:
            command += ["--set", entry]
        try:
            code = subprocess.run(command, capture_output=True, timeout=LIMIT, check=False).returncode
        except subprocess.TimeoutExpired:
            code = -1
        try:
            with open(f"{folder}/out/history.csv", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
            summary = json.loads(Path(f"{folder}/out/summary.json").read_text(encoding="utf-8"))
        except (OSError, json.JSONDecodeError):
            return code, {}, 0, 0, []
    is_force = re.compile(r"\.(fx|fy|fz|normal_force|friction_force|force_[xyz])$")
    forces = {}
    for column in rows[0] if rows else []:
        if is_force.search(column):
            values = [float(row[column]) for row in rows]
            forces[column] = (values[-1], max(map(abs, values)))
    times = [float(row["time"]) for row in rows]
    return code, forces, summary["iterations"], summary["cutbacks"] + summary["jumps"], times


def difference(base, other):
    """Of the final and the largest forces, over the largest of all."""
    largest = max((most for _, most in base.values()), default=0.0)
    if largest == 0.0 or base.keys() != other.keys():
        return 0.0
    return max(abs(a - b) for column in base for a, b in zip(base[column], other[column])) / largest


def used_in(name, chosen):
    words = next(words for pattern, words in USED if fnmatch.fnmatch(name, pattern))
    return [s for s in chosen if set(words.split()) & set(SCENES[s][2].split())]


def extremes(program, families, setting):
    """Words by rows of the quick cases of tests/extremes, or of some families of them."""
    environment = {**os.environ, "NAGATA_CONTROLS": " ".join(setting)}
    command = [program] if program else ["cargo", "test", "--release", "--test", "extremes", "--"]
    command += [f"{family}::quick" for family in families or [""]] + ["--nocapture"]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    row = re.compile(r"^(?:test \S+ \.\.\. )?(\S.*?): (right|refused|WRONG|FAILED|CRASH|HANG), ", re.M)
    return dict(row.findall(done.stdout))


def otherwise(base, rows):
    """How many rows end otherwise, by how."""
    count = collections.Counter(f"{word}, {rows.get(name, 'none')}" for name, word in base.items()
                                if rows.get(name) != word)
    return "; ".join(f"{number} {change}" for change, number in count.items()) or "0"


def figure(value):
    return "0" if value == 0.0 else "< 1e-9" if value < 1e-9 else f"{value:.0e}".replace("e-0", "e-")


def number(value):
    return f"{value:g}"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", help="names of controls, or patterns")
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--factors", nargs="+", type=float, default=[0.5, 2.0])
    parser.add_argument("--jobs", type=int, default=1, help="runs at a time")
    parser.add_argument("--extremes", nargs="?", const="", metavar="PROGRAM",
                        help="also the quick cases of tests/extremes, by a program that cargo has built of them")
    parser.add_argument("--families", nargs="+", default=[], help="of the extremes, such as `edges`; all unless given")
    parser.add_argument("--binary", default=str(ROOT / "target/release/nagata"))
    parser.add_argument("--out", type=Path, help="also write the table here")
    parser.add_argument("--doc", type=Path, help="write the tables of docs/controls.md here")
    parser.add_argument("--results", type=Path, help="keep the results here, and go on from them")
    return parser.parse_args()


def settings(args):
    """Names of controls with the values to try."""
    tried = []
    for _, name, _, default, (low, high), is_integer, _ in controls():
        if args.only and not any(fnmatch.fnmatch(name, pattern) for pattern in args.only):
            continue
        for factor in args.factors:
            value = default * factor
            value = float(round(value + 0.01) if default > 1 else int(value)) if is_integer else value
            value = min(max(value, low), high)
            if value != default and (name, value) not in tried:
                tried.append((name, value))
    return tried


class Results:
    """What is known of runs, by their names; kept in a file if there is one."""

    def __init__(self, path):
        self.path = path
        self.known = json.loads(path.read_text()) if path and path.exists() else {}

    def of(self, key, make):
        if key not in self.known:
            self.known[key] = make()
            if self.path:
                self.path.write_text(json.dumps(dict(self.known)))
        return self.known[key]


def run_all(args, tried, results):
    """The outcome of each scene with each setting."""
    jobs = [(scene, []) for scene in args.scenes if any(scene in used_in(name, args.scenes) for name, _ in tried)]
    for name, value in tried:
        jobs += [(scene, [entry_of(name, value)]) for scene in used_in(name, args.scenes)]

    def result(job):
        key = " ".join([job[0], *job[1]])
        return key, results.of(key, lambda: run(args.binary, *job))

    done = {}
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        for k, (key, outcome) in enumerate(pool.map(result, jobs)):
            done[key] = outcome
            print(f"{k + 1}/{len(jobs)} {key}: {outcome[0]}, {outcome[2]} iterations", file=sys.stderr)
    return done


def run_extremes(args, tried, results):
    """By setting, in which rows the quick extremes end otherwise; what is told of each is how many."""
    told, which = {}, " ".join(["extremes", *args.families])
    base = results.of(which, lambda: extremes(args.extremes, args.families, []))
    for name, value in tried:
        entry = entry_of(name, value)
        rows = results.of(f"{which} {entry}", lambda entry=entry: extremes(args.extremes, args.families, [entry]))
        told[entry] = otherwise(base, rows)
        for row, word in base.items():
            if rows.get(row) != word:
                print(f"{entry}: {row}: {word}, {rows.get(row, 'none')}", file=sys.stderr)
    return told


def entry_of(name, value):
    return f"controls.{name}={value!r}"


def row_of(entry, value, scenes, done):
    """Changes by a setting, as cells."""
    pairs = [(s, done[s], done[f"{s} {entry}"]) for s in scenes]
    converged = [(s, a, b) for s, a, b in pairs if a[0] == b[0] == 0]
    both = [(difference(a[1], b[1]), s) for s, a, b in converged]
    worst, where = max(both, default=(0.0, ""))
    # Other increments are another discretization in time.
    alike = [change for change, (_, a, b) in zip(both, converged) if list(a[4]) == list(b[4])]
    same = max(alike, default=(0.0, ""))
    more = [sum(b[k] - a[k] for _, a, b in pairs) for k in (2, 3)]
    total = sum(a[2] for _, a, _ in pairs)
    failed = sum(b[0] != 0 for _, _, b in pairs) - sum(a[0] != 0 for _, a, _ in pairs)
    word = lambda change: f"{figure(change[0])} {change[1]}" if change[0] > 1e-9 else figure(change[0])
    return [number(value), word(same), word((worst, where)) if worst > same[0] and worst > 1e-9 else "",
            f"{100.0 * more[0] / total:+.0f} %" if more[0] else "0", f"{more[1]:+d}" if more[1] else "0",
            f"{failed:+d}" if failed else "0"]


def main():
    args = arguments()
    for key, value in ENVIRONMENT.items():
        os.environ.setdefault(key, value)
    tried, results = settings(args), Results(args.results)
    done = run_all(args, tried, results)
    told = run_extremes(args, tried, results) if args.extremes is not None else {}
    table = {}
    for name, value in tried:
        entry = entry_of(name, value)
        row = row_of(entry, value, used_in(name, args.scenes), done)
        table.setdefault(name, []).append(row + [told[entry]] if told else row)
    head = ["control", "value", "change of forces", "with other increments", "iterations", "cuts", "failures"]
    head += ["extremes"] if told else []
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    lines += ["| " + " | ".join([f"`{name}`", *row]) + " |" for name, rows in table.items() for row in rows]
    print("\n".join(lines))
    if args.out:
        args.out.write_text("\n".join(lines) + "\n")
    if args.doc:
        document(args.doc, table)


HEAD = ["control", "default", "in", "reason", "tried", "change of forces", "with other increments", "iterations",
        "cuts", "failures"]


def document(path, table):
    """Replaces the tables of a document between its marks; what was not tried keeps its cells."""
    text = path.read_text()
    head, _, rest = text.partition("<!-- table -->\n")
    old, _, tail = rest.partition("<!-- end -->\n")
    rows = [[cell.strip() for cell in line[1:-1].split("|")] for line in old.splitlines() if line.startswith("| `")]
    cells = {row[0].strip("`"): row[4:] for row in rows}
    width = max([len(row) for row in cells.values()] + [len(row) for new in table.values() for row in new])
    padded = lambda row: (row + [""] * width)[:width]
    for name, new in table.items():
        cells[name] = [cells_of(new, k) or old for k, old in enumerate(padded(cells.get(name, [])))]
    columns = [*HEAD, "extremes"][:4 + width]
    lines, last = [], ""
    for group, name, unit, default, _, _, reason in controls():
        if group != last:
            last = group
            lines += ["", f"## {group}", "", "| " + " | ".join(columns) + " |", "|---" * len(columns) + "|"]
        row = [f"`{name}`", number(default), unit, reason, *padded(cells.get(name, []))]
        lines.append("| " + " | ".join(row) + " |")
    path.write_text(f"{head}<!-- table -->\n" + "\n".join(lines[1:]) + f"\n\n<!-- end -->\n{tail}")


def cells_of(rows, column):
    """What a cell of the document has of the rows of a control; nothing if they have no such column."""
    return "<br>".join(row[column] for row in rows if column < len(row))


if __name__ == "__main__":
    main()

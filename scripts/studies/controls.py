#!/usr/bin/python3 -B
"""Half and twice of each control (src/controls.rs), over short forms of the scenes in inputs/, as a table in Markdown.

A control is tried in the scenes in which it is used. Forces are all in history.csv, at the last time and the largest of
each column, relative to the largest force of all; iterations, cuts and failures are sums over these scenes. A change of
the forces above 1e-6 at the same times is one of the result; with other increments, what depends on the path changes.
`--extremes` also runs the quick cases of tests/extremes with each control.

    scripts/studies/controls.py [--only NAME ...] [--scenes NAME ...] [--factors 0.5 2] [--jobs 2] [--extremes]
                                [--out FILE] [--doc docs/controls.md]
"""

import argparse
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
    "ironing-deformable": ("ironing-deformable", ["body.slab.block.elements=[60, 10, 1]", "step.press.increments=4",
                                                  "step.slide.increments=4", "step.slide.move.0.by=[4.0, 0.0, 0.0]"],
                           "body kinks"),
    "shallow": ("shallow-ironing", ["body.block.block.elements=[40, 10, 1]", "step.press.increments=5",
                                    "step.slide.increments=4", "step.slide.move.0.by=[0.2, 0.0, 0.0]"],
                "body"),
    "c-strip": ("c-strip", ["step.close.increments=6", "step.roll.increments=4"],
                "self kinks"),
    "c-strip-facet": ("c-strip", ["contact.inside.smoothing=facet", "contact.inside.friction=0.0",
                                  "step.close.increments=5", "step.roll.increments=5"], "self failing"),
    "patch-test": ("patch-test", [], "two-pass"),
    "patch-nodes": ("patch-test", ["body.lower.block.elements=[5, 5, 5]", "contact.joint.discretization=node-to-node"],
                    "nodes"),
    "hertz": ("hertz-cylinder", ["step.press.increments=1"], "kinks"),
    "extrusion": ("extrusion-rigid", ["step.push.increments=2", "step.push.move.0.by=[3.0, 0.0, 0.0]"],
                  "plastic kinks"),
    "tube": ("tube-buckling", ["body.tube.block.elements=[1, 4, 15]", "step.crush.duration=1.0",
                               "step.crush.move.0.by=[0.0, 0.0, -1.0]"], "self plastic"),
    "cup": ("square-cup-small", ["body.blank.block.elements=[6, 6, 1]", "step.draw.duration=0.3",
                                 "step.draw.move.0.by=[0.0, 0.0, -0.3]", "step.draw.increment.max=0.1"],
            "plastic driven failing"),
}
STEPS = {"c-strip": 2, "c-strip-facet": 2}
LIMIT = 90  # seconds

# In which scenes a control is tried: those with one of these words, in which it is used.
USED = [
    ("settling_*", "failing driven"), ("calm_*", "at-once sharp driven plain"), ("line_search_*", "plastic"),
    ("loose_*", "lagrange failing driven"), ("outer_rounds", "lagrange uzawa self failing"), ("uzawa_*", "uzawa"),
    ("singular_*", "failing"), ("short_increment", "failing"), ("remedy_period", "failing"), ("jump_*", "jumping"),
    ("penalty_method", "penalty"), ("two_pass_*", "two-pass"), ("repeat_*", "two-pass"), ("slack", "self failing"),
    ("wide_slack", "self"), ("kink_*", "kinks"), ("edge_beside", "sharp"), ("self_*", "self"),
    ("friction_steep", "driven"), ("watch_around_self", "self"),
    ("watch_turn", "turning"), ("watch_*", "at-once sharp turning"), ("end_*", "kinks"),
    ("coplanar", "kinks"), ("straight_misfit", "kinks"), ("step_halvings", "plastic at-once"),
    ("extrapolate*", "plain faceted sharp plastic self"), ("augmentation", "plain sharp self driven lagrange"),
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


def extremes(setting):
    """How many quick cases of tests/extremes are bad."""
    environment = {**os.environ, "NAGATA_CONTROLS": " ".join(setting)}
    command = ["cargo", "test", "--release", "--test", "extremes", "--", "--nocapture"]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    return len(re.findall(r": (?:WRONG|FAILED|CRASH|HANG), ", done.stdout))


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
    parser.add_argument("--extremes", action="store_true", help="also the quick cases of tests/extremes")
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


def run_all(args, tried):
    """The outcome of each scene with each setting."""
    known = json.loads(args.results.read_text()) if args.results and args.results.exists() else {}
    jobs = [(scene, []) for scene in args.scenes]
    for name, value in tried:
        jobs += [(scene, [entry_of(name, value)]) for scene in used_in(name, args.scenes)]

    def result(job):
        key = " ".join([job[0], *job[1]])
        if key not in known:
            known[key] = run(args.binary, *job)
            if args.results:
                args.results.write_text(json.dumps(dict(known)))
        return key, known[key]

    done = {}
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        for k, (key, outcome) in enumerate(pool.map(result, jobs)):
            done[key] = outcome
            print(f"{k + 1}/{len(jobs)} {key}: {outcome[0]}, {outcome[2]} iterations", file=sys.stderr)
    return done


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
    tried = settings(args)
    done = run_all(args, tried)
    bad = extremes([]) if args.extremes else 0
    table = {}
    for name, value in tried:
        entry = entry_of(name, value)
        row = row_of(entry, value, used_in(name, args.scenes), done)
        if args.extremes:
            worse = extremes([entry]) - bad
            row.append(f"{worse:+d}" if worse else "0")
        table.setdefault(name, []).append(row)
    head = ["control", "value", "change of forces", "with other increments", "iterations", "cuts", "failures"]
    head += ["extremes"] if args.extremes else []
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    lines += ["| " + " | ".join([f"`{name}`", *row]) + " |" for name, rows in table.items() for row in rows]
    print("\n".join(lines))
    if args.out:
        args.out.write_text("\n".join(lines) + "\n")
    if args.doc:
        document(args.doc, table)


def document(path, table):
    """Replaces the tables of a document between its marks."""
    text = path.read_text()
    head, _, rest = text.partition("<!-- table -->\n")
    _, _, tail = rest.partition("<!-- end -->\n")
    lines, last = [], ""
    for group, name, unit, default, _, _, reason in controls():
        if group != last:
            last = group
            lines += ["", f"## {group}", "",
                      "| control | default | in | reason | tried | change of forces | with other increments "
                      "| iterations | cuts | failures |", "|---" * 10 + "|"]
        rows = table.get(name, [])
        cells = ["<br>".join(row[k] for row in rows) for k in range(6)]
        lines.append("| " + " | ".join([f"`{name}`", number(default), unit, reason, *cells]) + " |")
    path.write_text(f"{head}<!-- table -->\n" + "\n".join(lines[1:]) + f"\n\n<!-- end -->\n{tail}")


if __name__ == "__main__":
    main()

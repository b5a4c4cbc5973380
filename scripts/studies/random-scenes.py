#!/usr/bin/python3 -B
"""Looks for runs that end with exit code 0 and are wrong: makes random scenes, runs each in several ways that must give
the same history (ranks, frames, units, names, numbers, methods, a restart and more), and holds it to laws: balance, no
pull, Coulomb's bound, no penetration. Prints a line a seed with what disagrees, and a summary; exit code 1 if a run
was wrong, or ended by another code than 0, 1 and 2.

    scripts/studies/random-scenes.py --seeds 1..50 [--keep FOLDER] [--variants NAME ...]

What disagrees is WRONG, or has an excuse: `warned`, the run says itself that there is no one solution; `increments`,
friction and flow depend on increments, which were cut otherwise; `ridges`, on facets there may be several solutions;
`shared`, what friction at a node of two contacts bears is not determined. `alone` is a variant that fails, `refused` a
scene, `slow` a run that a signal ended at the limit of time.
"""

import collections
import copy
import csv
import json
import math
import random
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import arguments, chance, say, study
from shared.chance import AXES, Frame, Grid, Name, Problem

TOLERANCE = 1e-6  # of the largest force of the run, or motion; that of the solver is 1e-10 of forces
OF_FIELDS = 1e-5  # pressures and stresses, over the largest
# What says that a state is not the only one, or not known as well.
EXCUSES = re.compile("not stable|a jump took|slid off|can move freely|say what others say|folded over|are still there|"
                     "past an end|free to turn|was let through|nothing touches|jumped|stands on one of the other side")
ROUNDED = 1e-8  # residuals that were let through are an excuse above this
JUMP = 2  # in the column `found`
SILENT = "nothing is said"
PATIENT = 60  # seconds; whoever says nothing when a signal ends it after so long hangs
EVEN = 0.06  # up to this strain no side folds onto a plane
COLUMNS = {"f": ("fx", "fy", "fz"), "u": ("ux", "uy", "uz"), "e": ("moment", "elastic_energy", "plastic_work"),
           "p": ("max_pressure",), "s": ("mean", "max")}
KINDS = {column: kind for kind, columns in COLUMNS.items() for column in columns}
# What changes the way to a solution alone.
CONTROLS = ["solver.tolerance=1e-11", "controls.segment_settled=1", "controls.augmentation=0.05",
            "controls.augmentation=0.4", "controls.extrapolate=0", "controls.step_facets=0.5",
            'solver.linear="direct"', 'solver.linear="iterative"']


@dataclass
class Variant:
    """The same problem, told in another way."""

    name: str
    frame: Frame = Frame()
    edit: Callable[[Problem], None] | None = None
    ranks: int = 1
    names: dict = field(default_factory=dict)
    options: list = field(default_factory=list)
    is_shuffled: bool = False  # other numbers of nodes and elements
    is_restarted: bool = False
    times: float = 1  # forces are so many times as large
    components: str = AXES
    kinds: str = "fueps"  # of COLUMNS
    tolerance: float = TOLERANCE
    is_other_way: bool = False  # to the same solution, if there is one


BASE = Variant("base")


def written(problem, variant, folder):
    """Writes the scene of a variant with its meshes."""
    problem = copy.deepcopy(problem)
    if variant.edit:
        variant.edit(problem)
    folder.mkdir(parents=True)
    order, scene, frame = random.Random(problem.seed), problem.scene, variant.frame
    for name, body in scene["body"].items():
        body["mesh"] = f"{name}.msh"
        problem.grids[name].write(folder / f"{name}.msh", frame, order if variant.is_shuffled else None)
    for name, grid in problem.surfaces.items():
        scene["tool"][name]["mesh"] = f"{name}.msh"
        grid.write(folder / f"{name}.msh", frame)
    entries = lambda table: [f"{key} = {chance.toml(value)}" for key, value in frame.of(table, variant.names).items()]
    lines = [f'title = "seed {problem.seed}, {variant.name}"']
    for kind in ("body", "material", "tool", "contact", "tie"):
        tables = list(scene[kind].items())
        if variant.names:
            order.shuffle(tables)
        for name, table in tables:
            lines += ["", f"[{kind}.{variant.names.get(name, name)}]", *entries(table)]
    for step in scene["step"]:
        lines += ["", "[[step]]", *entries({k: v for k, v in step.items() if v != []})]
    path = folder / "scene.toml"
    path.write_text("\n".join([*lines, "", "[output]", *entries(scene["output"]), ""]))
    return path


@dataclass
class Result:
    """What a run has left."""

    code: int
    reason: str
    at: dict = field(default_factory=dict)
    excuses: list = field(default_factory=list)


def rows_of(path):
    with open(path, newline="") as file:
        rows = [{k: v if k == "step" else float(v) for k, v in row.items()} for row in csv.DictReader(file)]
    return {round(row["time"], 9): row for row in rows}


def history(out, variant):
    """Rows by their times, with those of probes, as the base would have them."""
    frame, names, at = variant.frame, {new: old for old, new in variant.names.items()}, {}
    probes = {path.stem: rows_of(path) for path in out.glob("probe-*.csv")}
    force = frame.stress * frame.length ** 2 * variant.times
    sizes = {"f": force, "u": frame.length, "e": force * frame.length, "p": frame.stress, "s": frame.stress}
    for time, row in rows_of(out / "history.csv").items():
        at[time] = {}
        parts = {f"{name}.{key}": value for name, rows in probes.items() for key, value in rows.get(time, {}).items()}
        for key, value in (row | parts).items():
            head, dot, last = key.rpartition(".")
            size = sizes.get(KINDS.get(last), 1) * (frame.sign if last == "moment" else 1)
            at[time][names.get(head, head) + dot + last] = value if last == "step" else value / size
        for key in [key[:-1] for key in at[time] if key.endswith((".fx", ".ux"))]:
            at[time] |= zip([key + axis for axis in AXES], frame.back([at[time][key + axis] for axis in AXES]))
    return at


def run(scene, variant, args):
    """Runs a scene to its end."""
    out, errors = scene.parent / "out", scene.parent / "errors.txt"
    for more in ([["--steps", "1"], ["--restart"]] if variant.is_restarted else [[]]):
        options = [*(f"--set={option}" for option in variant.options), *more]
        command = study.on_ranks(variant.ranks, args.binary, "run", scene, "--out", out, "--quiet", *options)
        with open(errors, "w") as file:
            process = study.Process(command, str(args.limit), stdout=subprocess.DEVNULL, stderr=file)
        if process.code != 0:
            lines = [line.strip() for line in errors.read_text().splitlines() if "error" in line]
            return Result(process.code, lines[0] if lines else SILENT)
    summary, rows = json.loads((out / "summary.json").read_text()), history(out, variant)
    told = [*summary["warnings"], *(["jumped"] * any(row["found"] == JUMP for row in rows.values()))]
    if summary["rounded"] and summary["rounded"]["residual"] > ROUNDED:
        told.append(f"a residual of {summary['rounded']['residual']:.0e} was let through")
    return Result(0, "", rows, [text for text in told if EXCUSES.search(text)])


# Variants: what they do to a problem.


def in_space(problem):
    """A layer in plane strain as hexahedra that are held along z."""
    held = [{"set": Name(name), "directions": "z"} for name in problem.scene["body"]]
    for body in problem.scene["body"].values():
        del body["plane_strain"]
    for step in problem.scene["step"]:
        if not step.get("keep"):
            step["fix"] = [*step.get("fix", []), *held]


def whole(problem):
    """What is one half beside a plane of symmetry, z = 0, as the whole."""
    for name, grid in problem.grids.items():
        points, image = list(grid.points), list(range(len(grid.points)))
        for k, (x, y, z) in enumerate(grid.points):
            if z != 0.0:
                image[k] = len(points)
                points.append((x, y, -z))
        double = lambda parts, image=image: [
            *parts, *((kind, [image[nodes[k]] for k in chance.MIRRORED[kind]]) for kind, nodes in parts)]
        groups = {group: double(faces) for group, faces in grid.groups.items() if group != "zmin"}
        problem.grids[name] = Grid(points, double(grid.cells), groups)
        del problem.scene["body"][name]["symmetry"]
    for step in problem.scene["step"]:
        step["force"] = [force | {"total": force["total"].times(2.0)} for force in step.get("force", [])]


def variants(problem, dice):
    """All that suit the problem."""
    scene, space, contacts = problem.scene, problem.space, problem.contacts
    is_solid = space == "solid"
    far = tuple(dice.uniform(-5, 5) * size_of(problem) * (space != "ring" or k > 0) for k in range(3))
    across = dice.choice({"solid": [0, 1, 2], "layer": [0, 1], "ring": [1]}[space])
    axis = dice.choice([(1, 0, 0), (0, 1, 0), (0, 0, 1)]) if is_solid else (0, 0, 1)
    odd = dice.choice([(0, 1, 0), tuple(dice.uniform(-1, 1) for _ in range(3))]) if is_solid else (0, 0, 1)
    units = Frame(length=dice.choice([1e-3, 25.4, 1e3]), stress=dice.choice([1e-6, 6.895, 1e6]))
    names = [*scene["body"], *scene["tool"]]
    others = dict(zip(names, dice.sample(["zeta", "alpha", "mu", "beta", "omega", "chi"], len(names))))
    can_turn = space != "ring" and not any("directions" in force for force in problem.all("force"))
    has_path = problem.is_rough or not problem.is_elastic
    # The sides of what a plane presses are in the slave if they were not, and the other way around.
    other = {"top": "skin", "skin": "top"}
    sides = [f'contact.{name}.slave="{body}.{other[group]}"' for name, contact in scene["contact"].items()
             for body, group in [contact["slave"].split(".")] if contact["master"] == "punch" and group in other
             and "plane" in scene["tool"]["punch"] and contact["method"] != "penalty"]
    finer = [f"step.{step['name']}.increments={2 * step['increments']}" for step in scene["step"]]
    methods = {method: [f'contact.{name}.method="{method}"' for name, contact in scene["contact"].items()
                        if contact["method"] not in (method, "penalty")]
               for method in ("augmented-lagrangian", "lagrange", "uzawa")}
    found = [
        (True, Variant("ranks-2", ranks=2)), (True, Variant("ranks-3", ranks=3)),
        (True, Variant("renumbered", is_shuffled=True)),
        (True, Variant("renamed", names=others)),
        (True, Variant("units", units)),
        (True, Variant("shifted", Frame(shift=far))),
        (True, Variant("mirrored", chance.mirrored(across))),
        (can_turn, Variant("quarter", chance.turned(axis, dice.choice([-90, 90])))),
        (can_turn, Variant("turned", chance.turned(odd, dice.uniform(5, 170)))),
        (len(scene["step"]) > 1, Variant("restarted", is_restarted=True, ranks=dice.choice([1, 2]),
                                         options=["output.checkpoint={ increments = 1000 }"])),
        (True, Variant("controls", options=[dice.choice(CONTROLS)], is_other_way=True)),
        (sides and problem.strain < EVEN and not scene["tie"], Variant("sides", options=sides, is_other_way=True)),
        (space == "layer" and all(contact["method"] != "penalty" for contact in contacts)
         and not any("eas" in body["element"] for body in scene["body"].values()),
         Variant("space", edit=in_space, components="xy", kinds="fuep")),
        (all("symmetry" in body for body in scene["body"].values()) and not problem.has("spring"),
         Variant("whole", edit=whole, times=2, components="xy", kinds="fep")),
        (not has_path, Variant("finer", options=finer, is_other_way=True))]
    found += [(options, Variant(method, options=options, tolerance=1e-5 if method == "uzawa" else TOLERANCE,
                                is_other_way=True)) for method, options in methods.items()]
    return [variant for suits, variant in found if suits]


# What must be.


class Worst(dict):
    """By kind the worst that is above its limit: its share of the largest, and a text."""

    def add(self, kind, share, text, limit=TOLERANCE):
        if not share <= max(limit, self.get(kind, (0.0,))[0]):  # also when it is not a number
            self[kind] = share, text


def size_of(problem):
    return max(max(map(abs, place)) for grid in problem.grids.values() for place in grid.points)


def largest(problem, result, kind):
    """The largest force or motion of a run, or what counts as one."""
    return max([problem.least[kind], *(abs(value) for row in result.at.values() for key, value in row.items()
                                       if key.endswith(COLUMNS[kind]))])


def differences(problem, base, other, variant):
    """What is apart at times that both have."""
    worst, rows = Worst(), base.at.values()
    in_segments = any(contact["discretization"] == "segment" for contact in problem.contacts)
    limits = {"p": OF_FIELDS * (100 if in_segments else 1), "s": OF_FIELDS}
    force, moved = (largest(problem, base, kind) for kind in "fu")
    for key in next(iter(rows)):
        head, _, last = key.rpartition(".")
        kind = KINDS.get(last, "none")
        if kind not in variant.kinds or (kind in "fu" and last[-1] not in variant.components) or (
                kind == "u" and head in problem.turning):
            continue
        peak = max(abs(row.get(key, 0.0)) for row in rows)
        scale = {"f": force, "u": moved, "e": peak + force * moved}.get(kind, max(peak, 1e-2 * problem.least["s"]))
        for time in sorted(base.at.keys() & other.at.keys()):
            ours, theirs = (result.at[time].get(key) for result in (base, other))
            if None not in (ours, theirs):
                worst.add(kind, abs(ours - theirs) / scale, f"{key} at {time:g}: {ours:.8g}, {theirs:.8g}",
                          limits.get(kind, variant.tolerance))
    return worst


def loads(problem):
    """The load on all bodies at the ends of steps: forces on sets, body forces, gravity. Nothing if it is not known."""
    acting, ends, scene = {}, [], problem.scene
    if problem.has("pressure"):
        return []
    for step in scene["step"]:
        now = {force["target"]: force["total"].value for force in step.get("force", []) if "directions" not in force}
        volumes = {("force", load["body"]): load["per_volume"] for load in step.get("body_force", [])}
        if "gravity" in step:
            volumes |= {("gravity", name): step["gravity"].times(scene["material"][f"{name}-stuff"]["density"].value)
                        for name in scene["body"]}
        if not {name for _, name in volumes} <= problem.volumes.keys():
            return []
        now |= {key: load.times(problem.volumes[key[1]]).value for key, load in volumes.items()}
        acting = acting | now if step.get("keep") else now
        ends.append([sum(load[k] for load in acting.values()) for k in range(3)])
    return ends


def laws(problem, result):
    """What cannot be, whatever the problem."""
    worst, scene, rows = Worst(), problem.scene, list(result.at.values())
    force = largest(problem, result, "f")
    last = [next(row for row in reversed(rows) if row["step"] == step["name"]) for step in scene["step"]]
    for row, load in zip(last, loads(problem)):
        for axis in {"solid": "xyz", "layer": "xy", "ring": "y"}[problem.space]:
            borne = sum(row[f"{name}.f{axis}"] for name in scene["body"] | scene["tool"])
            total = load[AXES.index(axis)] + borne
            worst.add("balance", abs(total) / force, f"{axis} at {row['time']:g}: {total:.6g} of {force:.6g}")
    held = None
    for row, step in zip(last, scene["step"]):
        given = [one["total"].value[1] for one in step.get("force", []) if one["target"] == "punch"]
        held = given[0] if given else held if step.get("keep") else None
        if held is not None:
            worst.add("given force", abs(row["punch.fy"] - held) / force, f"{row['punch.fy']:.8g}, not {held}")
    for name, tool in scene["tool"].items():
        if "plane" in tool and name not in problem.turning:
            friction = max(contact.get("friction", 0.0) for contact in problem.contacts if contact["master"] == name)
            for row in rows:
                ours = [row[f"{name}.f{axis}"] for axis in AXES]
                across = sum(f * n for f, n in zip(ours, tool["plane"]["normal"].value))
                along = math.sqrt(max(sum(f * f for f in ours) - across ** 2, 0.0)) * (problem.space != "ring")
                text = f"{name} at {row['time']:g}: {along:.6g} along, {across:.6g} across"
                worst.add("pull", -across / force, text)
                worst.add("Coulomb", (along * (1 - 1e-7) - friction * max(across, 0.0)) / force, text)
    for name, contact in scene["contact"].items():
        is_exact = contact["method"] != "penalty" and contact["discretization"] != "segment"
        if contact["master"] in scene["tool"] and is_exact:
            deep = max(row[f"{name}.max_penetration"] for row in rows)
            worst.add("penetration", deep / size_of(problem), f"{name}: {deep:.3g}")
    return worst


def verdict(problem, base, other, variant):
    """What a disagreement with the base may be excused by."""
    contacts, tools = problem.contacts, problem.scene["tool"]
    slaves = [contact["slave"].split(".")[0] for contact in contacts if contact["master"] in tools]
    excuses = base.excuses + other.excuses
    if (problem.is_rough or not problem.is_elastic) and base.at.keys() != other.at.keys():
        return "increments"
    if excuses:
        return f"warned ({excuses[0][:70]})"
    if variant.is_other_way and any(part.get("smoothing") == "facet" for part in [*contacts, *tools.values()]):
        return "ridges"
    if variant.is_other_way and problem.is_rough and (len(set(slaves)) < len(slaves) or any(
            contact["discretization"] == "two-pass" for contact in contacts)):
        return "shared"
    return "WRONG"


def judged(problem, base, result, variant, limit):
    """What there is to say of a run, as pairs of a verdict and a text."""
    if result.code == study.LIMIT and (result.reason != SILENT or limit < PATIENT):
        return [("slow", result.reason)]
    if result.code not in (0, 1, 2):
        return [("WRONG", f"exit code {result.code}: {result.reason}")]
    if result.code != 0:
        return [("alone" if base else "refused", result.reason)]
    if base:
        kind, worst = verdict(problem, base, result, variant), differences(problem, base, result, variant)
        return [(kind, f"{share:.1e}, {text}") for share, text in worst.values()]
    kind, worst = "warned" if result.excuses else "WRONG", laws(problem, result)
    return [(kind, f"{law}: {share:.1e}, {text}") for law, (share, text) in worst.items()]


# Seeds.


def seed_done(seed, folder, args, tally):
    """Runs a seed; prints its line, and what disagrees."""
    problem, dice = chance.Maker(seed).made(), random.Random(seed)
    pool = variants(problem, dice)
    chosen = [v for v in pool if v.name in args.variants] if args.variants else dice.sample(
        pool, min(args.number, len(pool)))
    base, lines, done = None, [], []
    for variant in [BASE, *chosen]:
        result = run(written(problem, variant, folder / variant.name), variant, args)
        tally["runs"] += 1
        done.append(variant.name if result.code == 0 else f"({variant.name}: {result.code})")
        found = judged(problem, base, result, variant, args.limit)
        for kind, text in found:
            tally[kind.split()[0]] += 1
            lines.append(f"    {kind}: {variant.name}: {text}")
        if args.keep and any(kind not in ("alone", "refused") for kind, _ in found):
            lines.append(kept(folder, variant, args.keep / str(seed)))
        if result.code != 0 and base is None:
            break
        base = base or result
    print(f"{seed}: {told(problem)}: {', '.join(done)}", *lines, sep="\n", flush=True)


def kept(made, variant, folder):
    """Keeps the scenes of a disagreement, and says how to run them."""
    for name in ("base", variant.name):
        shutil.copytree(made / name, folder / name, dirs_exist_ok=True, ignore=shutil.ignore_patterns("*.h5", "*.xdmf"))
    options = [f"--set '{option}'" for option in variant.options]
    return " ".join([f"      scripts/run {folder / variant.name / 'scene.toml'} -n {variant.ranks}", *options])


def told(problem):
    scene = problem.scene
    bodies = [f"{body['element']} {scene['material'][body['material']]['model']}" for body in scene["body"].values()]
    contacts = [" ".join([name, *map(str, list(one.values())[2:])]) for name, one in scene["contact"].items()]
    return ", ".join([problem.space, *bodies, *contacts, " ".join(step["name"] for step in scene["step"])])


def main():
    parser = arguments(__doc__)
    parser.add_argument("--seeds", default="1..20", metavar="A..B", help="(1..20)")
    parser.add_argument("--number", type=int, default=5, metavar="N", help="variants of a seed (5)")
    parser.add_argument("--variants", nargs="+", metavar="NAME", help="these instead")
    parser.add_argument("--binary", type=Path, default=study.NAGATA, help="(target/release/nagata)")
    parser.add_argument("--limit", type=int, default=60, metavar="SECONDS", help="of a run (60)")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="for scenes that disagree")
    args = parser.parse_args()
    low, _, high = args.seeds.partition("..")
    tally = collections.Counter()
    for seed in range(int(low), int(high or low) + 1):
        with tempfile.TemporaryDirectory() as folder:
            seed_done(seed, Path(folder), args, tally)
    print("", *(f"{count:5} {what}" for what, count in tally.most_common()), sep="\n")
    if tally["WRONG"]:
        say(f"{tally['WRONG']} wrong")
        sys.exit(1)


if __name__ == "__main__":
    main()

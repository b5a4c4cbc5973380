#!/usr/bin/python3 -B
"""How many flat facets to a quarter circle make the force as exact as a few Nagata patches do, and at what cost.

Two problems, the meshes of whose tools have 2, 4, 8 ... edges on each quarter circle:

- ironing: inputs/ironing-rigid.toml with a slide of 100 mm in place of 250, in increments of the same size, against
  the exact profile;
- cup: inputs/square-cup-small.toml drawn by 2.5 mm in place of 40, in 25 even increments, against the exact Bezier
  patches.

The error is that of the forces (of the indenter along y and x; of the punch along z) at the times of the reference,
over the largest force of the reference: largest, rms over the path, and the chatter, which is the rms of what is left
of it without its mean over 2.5 mm of the slide, an element of the slab, or 1 mm of the stroke. For each number of
patches, facets of the same rms error are found between the numbers that were run, and run. Writes facets.csv and
facets.png and prints Markdown tables; runs that are in the folder of an earlier call are not made again.
"""

import csv
import json
import math
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, OUT, ROOT, add_out, arguments, say, study, written
from shared.scientific import np, plt

COLUMNS = ["case", "tool", "edges", "increments", "cutbacks", "iterations", "cpu_s", "largest", "rms", "chatter"]
KINDS = {"nagata": ("Nagata patches", "tab:blue"), "facet": ("facets", "tab:orange")}


@dataclass
class Case:
    """A problem: its scene, script of meshes, tools with their files, the exact description, overrides, the forces that
    count, and the increments without whose mean they chatter."""
    scene: str
    make: str
    tools: dict
    exact: str
    overrides: list
    forces: list
    span: int

    def settings(self, folder, smoothing):
        """Overrides for one description of all tools. Two edges turn by 45 degrees at a node."""
        found = list(self.overrides)
        for name, mesh in self.tools.items():
            found += [f"tool.{name}.smoothing={smoothing}"]
            if smoothing in KINDS:
                found += [f"tool.{name}.mesh={folder}/{mesh}", f"tool.{name}.feature_angle=50"]
        return [f"--set={text}" for text in found]


CASES = {
    "ironing": Case("ironing-rigid", "ironing-indenter", {"indenter": "ironing-indenter.msh"}, "profile",
                    ["step.slide.increments=320", "step.slide.move.0.by=[100.0, 0.0, 0.0]", "output.every=1000"],
                    ["indenter.fy", "indenter.fx"], 8),
    "cup": Case("square-cup-small", "square-cup", {t: f"square-cup-{t}.msh" for t in ("die", "holder", "punch")},
                "bezier", ["step.draw.duration=2.5", "step.draw.move.0.by=[0.0, 0.0, -2.5]",
                           "step.draw.increment={ initial = 0.1, min = 0.001, max = 0.1 }", "output.every=1000"],
                ["punch.fz"], 10),
}


class Result:
    """One run: its effort, and forces by time."""

    def __init__(self, case, folder, smoothing, edges, ranks):
        out, cost = folder / f"{smoothing}-{edges}", folder / f"{smoothing}-{edges}.json"
        if not cost.exists():
            say(out.relative_to(folder.parent))
            if smoothing in KINDS:
                make = ROOT / "scripts" / "meshes" / f"{case.make}.py"
                subprocess.run([make, "--arc", str(edges), "--out", folder / f"meshes-{edges}"], check=True)
            settings = case.settings(folder / f"meshes-{edges}", smoothing)
            run = study.Run(INPUTS / f"{case.scene}.toml", out, ranks, *settings)
            if run.code != 0:
                sys.exit(f"{out} ended with code {run.code}")
            cost.write_text(json.dumps({"cpu": run.cpu, **{k: run.summary[k] for k in COLUMNS[3:6]}}))
        self.cost = json.loads(cost.read_text())
        with open(out / "history.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.times = np.array([float(row["time"]) for row in rows])
        self.forces = np.array([[float(row[name]) for row in rows] for name in case.forces])

    def errors(self, reference, span):
        """Largest, rms and chatter of the forces' error over the largest force of the reference."""
        here = np.array([np.interp(reference.times, self.times, force) for force in self.forces])
        off = (here - reference.forces) / np.linalg.norm(reference.forces, axis=0).max()
        weights = np.full(span, 1 / span)
        rest = np.array([row[span // 2:][:row.size - span + 1] - np.convolve(row, weights, "valid") for row in off])
        size = np.linalg.norm(off, axis=0)
        return size.max(), math.sqrt(np.mean(size ** 2)), math.sqrt(np.mean(np.sum(rest ** 2, axis=0)))


def rows_of(name, args):
    """A row for each run of a case, and for each number of patches that of facets with the same rms error."""
    case, folder = CASES[name], args.out.resolve() / name
    reference = Result(case, folder, case.exact, 0, args.ranks)

    def row(kind, edges):
        result = Result(case, folder, kind, edges, args.ranks)
        cost = [result.cost[key] for key in ("increments", "cutbacks", "iterations", "cpu")]
        return dict(zip(COLUMNS, [name, kind, edges, *cost, *result.errors(reference, case.span)]))

    rows = [dict(zip(COLUMNS, [name, case.exact, "", *(reference.cost[k] for k in COLUMNS[3:6]),
                               reference.cost["cpu"], 0.0, 0.0, 0.0]))]
    rows += [row("nagata", n) for n in args.patches]
    facets = {n: row("facet", n) for n in args.facets}
    alike = {}
    for patches in rows[1:]:
        edges = equal([(n, found["rms"]) for n, found in facets.items()], patches["rms"])
        if edges:
            facets.setdefault(edges, None)
            facets[edges] = facets[edges] or row("facet", edges)
            alike[patches["edges"]] = edges
    return rows + [facets[n] for n in sorted(facets)], alike


def equal(points, error):
    """The number of edges with an error, on straight lines between the points in logarithms; none beyond them."""
    points = sorted(points)
    for (n, high), (m, low) in zip(points, points[1:]):
        if low <= error <= high:
            share = math.log(high / error) / math.log(high / low)
            return round(n * (m / n) ** share)
    return None


def draw(rows, path):
    """Errors against edges, and against iterations."""
    names = list(dict.fromkeys(row["case"] for row in rows))
    figure, axes = plt.subplots(len(names), 2, figsize=(9, 3.6 * len(names)), constrained_layout=True, squeeze=False)
    for name, (edges, cost) in zip(names, axes):
        for kind, (label, color) in KINDS.items():
            own = [row for row in rows if row["case"] == name and row["tool"] == kind]
            for quantity, style in (("rms", "-o"), ("chatter", ":s")):
                errors = [row[quantity] for row in own]
                told = {"label": f"{label}, {quantity}", "color": color, "markersize": 4, "linewidth": 1.2}
                edges.loglog([row["edges"] for row in own], errors, style, **told)
                cost.semilogy([row["iterations"] for row in own], errors, style, **told)
            for row in own:
                cost.annotate(row["edges"], (row["iterations"], row["rms"]), (4, 4), textcoords="offset points",
                              fontsize=7)
        edges.set_xlabel("edges of the tool to a quarter circle")
        cost.set_xlabel("Newton iterations")
        edges.set_ylabel(f"{name}: error of the force over its largest")
        edges.legend(fontsize=8)
        for axis in (edges, cost):
            axis.grid(alpha=0.3, which="both")
    figure.savefig(written(path), dpi=130)


def main():
    parser = arguments(__doc__)
    parser.add_argument("--case", nargs="+", choices=CASES, default=list(CASES), help="(all)")
    parser.add_argument("--patches", type=int, nargs="+", default=[2, 4, 8], metavar="N", help="(2 4 8)")
    parser.add_argument("--facets", type=int, nargs="+", default=[2, 4, 8, 16, 32, 64, 128], metavar="N",
                        help="(2 4 8 16 32 64 128)")
    parser.add_argument("--ranks", type=int, default=1, metavar="N", help="(%(default)s)")
    add_out(parser, OUT / "facets")
    args = parser.parse_args()
    study.setup()
    everything = []
    for name in args.case:
        rows, alike = rows_of(name, args)
        everything += rows
        print(f"\n{name}\n")
        shown = [[row["tool"], row["edges"], *(f"{row[key]:.1e}" for key in ("largest", "rms", "chatter")),
                  f"{row['increments']}, {row['cutbacks']}", row["iterations"], f"{row['cpu_s']:.0f}"] for row in rows]
        study.table(["tool", "edges", "largest error", "rms", "chatter", "increments, cutbacks", "iterations", "CPU s"],
                    shown)
        print()
        for patches, facets in alike.items():
            print(f"{patches} patches are as exact as {facets} facets")
    with open(written(args.out / "facets.csv"), "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        writer.writerows(everything)
    draw(everything, args.out / "facets.png")


if __name__ == "__main__":
    main()

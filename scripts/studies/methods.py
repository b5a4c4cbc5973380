#!/usr/bin/python3 -B
"""Runs a scene with every way to enforce contact and prints, as Markdown tables, what that costs and what error it
leaves, and the iterations over seven decades of the penalty, with and without friction. With --everywhere, instead:
what the methods cost over scenes, materials and elements, and how far their forces are apart."""

import re
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, arguments, say, study

METHODS = ["penalty", "lagrange", "augmented-lagrangian", "uzawa"]
PENALIZED = ["augmented-lagrangian", "uzawa", "penalty"]

RUBBER = ["material.rubber.poisson=0.4999"]
# On patches a node at the seam of two may end on either, by rounding; forces differ by 1e-4 then.
BALL = ["body.block.block.elements=[8,8,4]", "tool.cap.smoothing=sphere"]
IRONING = ["body.slab.block.elements=[30,8,1]", "step.press.increments=5", "step.slide.increments=10",
           "step.press.move.0.by=[0,-5,0]", "step.slide.move.0.by=[20,0,0]"]
# Scenes of inputs/, what is changed in them, and in words.
SCENES = [
    ("patch-test", [], ""),
    ("sphere-on-block", [*BALL, "body.block.element=hex8"], "hex8"),
    *(("sphere-on-block", [*BALL, f"body.block.element={e}", *RUBBER], f"{e}, ν = 0.4999")
      for e in ("hex8-fbar", "hex8-sri", "hex8-eas")),
    ("ironing-rigid", IRONING, "short, hex8"),
    ("ironing-rigid", [*IRONING, "body.slab.element=hex8-fbar", *RUBBER], "short, hex8-fbar, ν = 0.4999"),
    ("hertz-cylinder", [], ""),
    ("cattaneo-mindlin", [], ""),
    ("disk-in-plate", [], ""),
    ("c-strip", [], "self-contact"),
    ("extrusion-rigid", ["step.push.increments=40"], "elastic-plastic"),
]


class Study:
    """Runs of one scene; `unit` is the penalty by which others are measured, `largest` a column of the history."""

    def __init__(self, args, folder):
        self.args, self.folder, self.count = args, Path(folder), 0

    def run(self, **keys):
        self.count += 1
        sets = [f"--set=contact.{self.args.contact}.{key}={value}" for key, value in keys.items()]
        sets += [f"--set={entry}" for entry in self.args.set] + ["--set=output.every=1000"]
        say(f"{' '.join(f'{k}={v}' for k, v in keys.items())}")
        return study.Run(self.args.scene, self.folder / str(self.count), self.args.ranks, *sets)

    def largest(self, run, quantity):
        return max(float(row[f"{self.args.contact}.{quantity}"]) for row in run.history)

    def costs(self):
        """One row a method, at the automatic penalty."""
        rows = []
        for method in METHODS:
            run = self.run(method=method)
            if run.code != 0:
                rows.append([method, "failed"] + [""] * 7)
                continue
            s = run.summary
            forces = ", ".join(f"{run.last(f'{self.args.force}.{c}'):.6f}" for c in self.args.components)
            rows.append([method, s["multipliers"], f"{self.largest(run, 'max_penetration'):.1e}", run.effort,
                         f"{s['iterations'] / s['increments']:.2f}", s["outer_iterations"], s["cutbacks"],
                         f"{s['wall_s']:.1f}", forces])
        study.table(["method", "multipliers", "largest penetration", "increments / iterations", "an increment", "outer",
                     "cutbacks", f"wall s on {self.args.ranks} ranks", f"force {' '.join(self.args.components)}"], rows)

    def decades(self):
        """Iterations, outer ones and cutbacks in brackets, by method and friction; and the error of the penalty."""
        exact = self.run(friction=self.args.friction)
        cases = [(method, friction) for method in PENALIZED for friction in (0.0, self.args.friction)]
        rows = []
        for decade in range(-3, 5):
            penalty = self.args.unit * 10.0**decade
            cells = []
            for method, friction in cases:
                run = self.run(method=method, friction=friction, penalty=penalty)
                if run.code != 0:
                    cells.append("failed")
                    continue
                s = run.summary
                extra = [f"{s[k]} {name}" for k, name in (("outer_iterations", "outer"), ("cutbacks", "cut")) if s[k]]
                cells.append(str(s["iterations"]) + (f" ({', '.join(extra)})" if extra else ""))
            apart = "" if run.code != 0 else f"{self.apart(run, exact):.1e}"
            rows.append([f"1e{decade}", *cells, apart])
        heads = [f"{method}, friction {friction}" for method, friction in cases]
        study.table([f"penalty over {self.args.unit:g}", *heads, "error of the force with penalty"], rows)

    def everywhere(self):
        """One row a scene: increments, iterations and cuts of each method, its forces against those of the default."""
        rows = []
        for name, changes, words in SCENES:
            scene = INPUTS / f"{name}.toml"
            contacts = re.findall(r"^\[contact\.([\w-]+)\]", scene.read_text(), re.MULTILINE)
            runs = {}
            for method in ["augmented-lagrangian", "lagrange", "uzawa", "penalty"]:
                self.count += 1
                say(f"{name} {words} {method}")
                sets = [f"--set=contact.{c}.method={method}" for c in contacts] + [f"--set={c}" for c in changes]
                runs[method] = study.Run(scene, self.folder / str(self.count), self.args.ranks, *sets,
                                         "--set=output.every=1000")
            exact, cells = runs["augmented-lagrangian"], []
            for run in runs.values():
                if run.code != 0:
                    cells.append("failed")
                    continue
                cuts = f", {run.summary['cutbacks']} cut" if run.summary["cutbacks"] else ""
                off = f", {forces_apart(run, exact):.0e}" if exact.code == 0 and run is not exact else ""
                cells.append(f"{run.effort}{cuts}{off}")
            rows.append([f"{name}{', ' if words else ''}{words}", *cells])
        study.table(["scene", *(f"`{method}`" for method in runs)], rows)

    def apart(self, run, exact):
        """Largest difference of the force over its largest value."""
        columns = [f"{self.args.force}.{c}" for c in self.args.components]
        value = lambda row, c: float(row[c])  # noqa: E731
        scale = max(abs(value(row, c)) for row in exact.history for c in columns)
        if len(run.history) != len(exact.history):
            return abs(max(value(run.history[-1], c) - value(exact.history[-1], c) for c in columns)) / scale
        pairs = zip(run.history, exact.history)
        return max(abs(value(a, c) - value(b, c)) for a, b in pairs for c in columns) / scale


def forces_apart(run, exact):
    """Largest difference of the forces at the end over the largest of them."""
    forces = [c for c in exact.history[-1] if c.endswith((".fx", ".fy", ".fz"))]
    return max(abs(run.last(c) - exact.last(c)) for c in forces) / max(abs(exact.last(c)) for c in forces)


def main():
    parser = arguments(__doc__)
    parser.add_argument("scene", type=Path, nargs="?", default=INPUTS / "sphere-on-block.toml",
                        help="(inputs/sphere-on-block.toml)")
    parser.add_argument("--contact", default="top", help="the contact whose method changes (%(default)s)")
    parser.add_argument("--force", default="cap", help="tool or set whose force is compared (%(default)s)")
    parser.add_argument("--components", nargs="+", default=["fx", "fz"], help="of the force (fx fz)")
    parser.add_argument("--friction", type=float, default=0.3, help="(%(default)s)")
    parser.add_argument("--unit", type=float, default=333.0, metavar="PENALTY",
                        help="by which others are measured: Young's modulus times the size of an element (%(default)s)")
    parser.add_argument("--set", action="append", metavar="KEY=VALUE", help="as in `nagata run`, of all runs "
                        "(body.block.block.elements=[12,12,6])")
    parser.add_argument("--everywhere", action="store_true", help="the methods over many scenes")
    parser.add_argument("--ranks", type=int, default=2, metavar="N", help="(%(default)s)")
    args = parser.parse_args()
    args.set = ["body.block.block.elements=[12,12,6]"] if args.set is None else args.set

    study.setup()
    with tempfile.TemporaryDirectory() as folder:
        runs = Study(args, folder)
        if args.everywhere:
            runs.everywhere()
            return
        runs.costs()
        print()
        runs.decades()


if __name__ == "__main__":
    main()

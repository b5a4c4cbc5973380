#!/usr/bin/python3 -B
"""Measures with `nagata trade` what speed costs in accuracy, on eight scenes of inputs/ in short forms, and writes
table and figure of each into the page docs/validation/trade.md. Takes two to four minutes a scene on a machine where
nothing else computes; a study that was ended goes on where it was.

    scripts/studies/trade.py                      # all scenes
    scripts/studies/trade.py ironing-rigid tube   # some, named by their beginnings
    scripts/studies/trade.py --presets            # instead: the presets of `solver.accuracy`, by increments alone
    scripts/studies/trade.py --page               # only writes the page, of what has been measured
"""

import csv
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, LIBRARY, OUT, ROOT, add_out, arguments, say
from shared.study import IN_MPI_ENVIRONMENT, NAGATA, setup

# Presets are compared at an eighth of the increments' size, on the mesh as it is; the finest of them tells the error.
PRESETS = ["--vary", "solver.accuracy=draft,reference", "--reference", "solver.pace=0.125", "--reference",
           "solver.tolerance=1e-12", "--next", "solver.accuracy=reference", "--no-combined"]
QUANTITIES = ["force", "end_force", "displacement", "penetration", "pressure", "stress", "strain"]


@dataclass
class Case:
    """A scene with what makes it short, in words and as overrides."""

    scene: str
    words: str
    overrides: list

    @property
    def arguments(self):
        return [INPUTS / f"{self.scene}.toml", *(word for text in self.overrides for word in ("--set", text))]

    @property
    def command(self):
        sets = "".join(f" --set '{text}'" if "[" in text else f" --set {text}" for text in self.overrides)
        return f"target/release/nagata trade inputs/{self.scene}.toml{sets}"


CASES = [
    Case("ironing-rigid", "31 mm of slide",
         ["step.slide.increments=100", "step.slide.move.0.by=[31.25,0,0]"]),
    Case("ironing-deformable", "19 mm of slide",
         ["step.slide.increments=60", "step.slide.move.0.by=[18.75,0,0]"]),
    Case("hertz-sphere", "as it is", []),
    Case("disk-in-plate", "50 increments", ["step.press.increments=50"]),
    Case("sphere-on-block", "as it is", []),
    Case("extrusion-rigid", "75 mm", ["step.push.increments=50", "step.push.move.0.by=[75,0,0]"]),
    Case("square-cup-small", "2 mm of draw", ["step.draw.duration=2", "step.draw.move.0.by=[0,0,-2]"]),
    Case("tube-buckling", "8 mm", ["step.crush.duration=8", "step.crush.move.0.by=[0,0,-8]"]),
]


def trade(case, folder, ranks, *further):
    """Runs a study; its exit code."""
    command = [NAGATA, "trade", *case.arguments, "--ranks", ranks, "--out", folder, *further]
    words = ["bash", "-c", IN_MPI_ENVIRONMENT, LIBRARY, *command]
    return subprocess.run([str(word) for word in words], check=False).returncode


def rows(folder):
    """`trade.csv` of a study; none if there is none."""
    path = folder / "trade.csv"
    if not path.exists():
        return []
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def short(value):
    return f"{float(value):.1e}".replace("e-0", "e-").replace("e+0", "e") if value else ""


def presets(folder):
    """A table: of each scene the presets with cost and errors, and in brackets how far the reference may be off."""
    heads = ["scene", "preset", "wall s", "iterations", *(of.replace("_", " ") for of in QUANTITIES)]
    lines = [f"| {' | '.join(heads)} |", "|" + " --- |" * len(heads)]
    for case in CASES:
        study = rows(folder / f"{case.scene}-presets")
        own = next((row for row in study if row["kind"] == "reference error"), {})
        names = {"solver.accuracy=draft": "draft", "": "balanced", "solver.accuracy=reference": "reference"}
        found = {names[row["overrides"]]: row for row in study if row["kind"] == "run" and row["overrides"] in names}
        for name in (name for name in names.values() if name in found):
            row = found[name]
            cells = [short(row.get(of, "")) for of in QUANTITIES]
            lines.append(f"| {case.scene} | {name} | {float(row['wall_s']):.1f} | {row['iterations']} | "
                         + " | ".join(cells) + " |")
        if found:
            cells = [f"± {short(own.get(of, ''))}" if own.get(of) else "" for of in QUANTITIES]
            lines.append(f"| {case.scene} | *error of the reference* | | | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def figure(path):
    """The text of a figure, smaller: what is so anyway is left out, what is so everywhere stands once."""
    text, font = path.read_text(), ' font-family="sans-serif"'
    for word in (' opacity="1"', ' fill-opacity="1"', ' stroke="none"', font):
        text = text.replace(word, "")
    text = text.replace("<svg", f"<svg{font}", 1)
    text = re.sub(r"<[^>]*>", lambda tag: re.sub(r"(\d\.\d)\d+", r"\1", tag[0]), text)  # not the labels
    return re.sub(r">\s+", ">", re.sub(r"\s+<", "<", text)) + "\n"


def section(case, folder, page):
    """What the page says of a scene; empty without a study."""
    table = folder / case.scene / "trade.md"
    if not table.exists():
        return ""
    name = f"trade-{case.scene}.svg"
    (page.parent / name).write_text(figure(folder / case.scene / "wall.svg"))
    text = table.read_text().split("\n", 1)[1].split("\nWhat the runs change:")[0].strip()
    return f"`inputs/{case.scene}.toml`, {case.words}:\n\n    {case.command}\n\n" \
           f"![Errors against wall time]({name})\n\n{text}"


def filled(text, name, content):
    """The page with the part of a name replaced, or added at its end."""
    begin, end = f"<!-- {name} -->", f"<!-- end of {name} -->"
    block = f"{begin}\n\n{content}\n\n{end}"
    if begin not in text:
        return f"{text.rstrip()}\n\n## {name}\n\n{block}\n"
    return re.sub(f"{re.escape(begin)}.*?{re.escape(end)}", lambda _: block, text, flags=re.DOTALL)


def write_page(folder, page):
    text = page.read_text()
    for case in CASES:
        content = section(case, folder, page)
        text = filled(text, case.scene, content) if content else text
    if any(rows(folder / f"{case.scene}-presets") for case in CASES):
        text = filled(text, "presets", presets(folder))
    page.write_text(text)


def main():
    parser = arguments(__doc__)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=", ".join(case.scene for case in CASES))
    parser.add_argument("--presets", action="store_true", help="measure the presets in the place of the settings")
    parser.add_argument("--page", action="store_true", help="measure nothing")
    parser.add_argument("--ranks", type=int, default=1, metavar="N", help="(%(default)s)")
    parser.add_argument("--budget", type=float, default=20, metavar="N",
                        help="what a study may take, times the scene (%(default)s)")
    add_out(parser, OUT / "trade")
    args = parser.parse_args()
    chosen = [case for case in CASES if not args.scenes or any(case.scene.startswith(s) for s in args.scenes)]
    if not chosen:
        parser.error(f"no scene begins with {' or '.join(args.scenes)}")
    page = ROOT / "docs" / "validation" / "trade.md"
    failed = []
    if not args.page:
        setup()
        for case in chosen:
            say(case.scene)
            kind, further = ("-presets", PRESETS) if args.presets else ("", ["--budget", args.budget])
            code = trade(case, args.out / f"{case.scene}{kind}", args.ranks, *further)
            if code in (4, 130):  # a signal
                sys.exit(code)
            failed += [case.scene] if code else []
            write_page(args.out, page)
    write_page(args.out, page)
    if args.presets:
        print(presets(args.out))
    if failed:
        sys.exit(f"failed: {', '.join(failed)}")


if __name__ == "__main__":
    main()

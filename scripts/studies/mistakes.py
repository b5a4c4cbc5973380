#!/usr/bin/python3 -B
"""Makes the likeliest mistakes of a new user, those of tests/mistakes.toml, and writes what nagata says of each."""

import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import ROOT, add_out, arguments, say, study, written

HEAD = """# Mistakes

The likeliest mistakes of a first scene, each made on purpose in the scene that `nagata new first.toml` writes, and what
is said of it, once on any number of ranks, with exit code 2; 1 where only the first increment shows it. Written by
`scripts/studies/mistakes.py`; what a run says that has begun is in [trouble](trouble.md).
"""


def run(folder, words):
    done = subprocess.run([str(word) for word in study.on_ranks(1, study.NAGATA, *words)], cwd=folder,
                          capture_output=True, text=True, check=False)
    return done.returncode, done.stderr.rstrip()


def made(mistake, scene, folder):
    """Exit code and answer."""
    old, new = mistake.get("change", ("", ""))
    if old not in scene:
        sys.exit(f"the scene of `nagata new` does not have: {old}")
    (folder / "first.toml").write_text(scene.replace(old, new))
    if "file" in mistake:
        name, text = mistake["file"]
        written(folder / name).write_text(text)
    return run(folder, mistake.get("arguments", ["check", "first.toml"]))


def shown(mistake):
    lines = []
    if "change" in mistake:
        before, after = (text.strip().split("\n") for text in mistake["change"])
        lines += [f"    - {line}" for line in before if line and line not in after]
        lines += [f"    + {line}" for line in after if line and line not in before]
    if "arguments" in mistake:
        lines.append(f"    $ nagata {' '.join(mistake['arguments'])}")
    return "\n".join([*lines, ""])


def main():
    parser = arguments(__doc__)
    add_out(parser, ROOT / "docs" / "mistakes.md")
    args = parser.parse_args()
    study.setup()
    mistakes = tomllib.loads((ROOT / "tests" / "mistakes.toml").read_text())["mistake"]
    parts, missed = [], 0
    with tempfile.TemporaryDirectory() as scratch:
        for k, mistake in enumerate(mistakes, 1):
            folder = Path(scratch) / str(k)
            folder.mkdir()
            run(folder, ["new", "first.toml"])
            code, answer = made(mistake, (folder / "first.toml").read_text(), folder)
            what = mistake["what"][0].upper() + mistake["what"][1:]
            parts.append(f"## {k}. {what}\n\n{shown(mistake)}\n```text\n{answer}\n```\n")
            if mistake["says"] not in answer or code != mistake.get("code", 2):
                say(f"{mistake['what']}: exit code {code}, not `{mistake['says']}`:\n{answer}")
                missed = 1
    written(args.out).write_text("\n".join([HEAD, *parts]))
    return missed


sys.exit(main())

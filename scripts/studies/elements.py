#!/usr/bin/python3 -B
"""Prints, as Markdown tables, how the elements bend, lock and stay stable, and what they cost (examples/elements.rs).
All of it takes some minutes."""

import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import arguments, study

PARTS = ["bending", "ring", "roll", "cook", "local", "stability", "cost"]


def main():
    parser = arguments(__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"only these of {', '.join(PARTS)}")
    args = parser.parse_args()
    if unknown := set(args.parts).difference(PARTS):
        parser.error(f"there is no part {', '.join(sorted(unknown))}; there are {', '.join(PARTS)}")
    study.setup()
    return subprocess.run([study.example("elements"), *args.parts], check=False).returncode


if __name__ == "__main__":
    sys.exit(main())

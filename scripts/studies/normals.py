#!/usr/bin/python3 -B
"""Prints, as Markdown tables, the errors of nodal normals and of the Nagata patches that they give on meshes of known
surfaces, for each weight of the mean (examples/normals.rs). The same in every run."""

import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import arguments, study


def main():
    arguments(__doc__).parse_args()
    study.setup()
    return subprocess.run([study.example("normals")], check=False).returncode


if __name__ == "__main__":
    sys.exit(main())

"""What scripts of more than one folder share."""

import argparse
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
INPUTS, OUT = ROOT / "inputs", ROOT / "out"
LIBRARY = ROOT / "scripts" / "lib.sh"


def say(text):
    """A message to the terminal, that is no result."""
    script = Path(sys.argv[0]).resolve()
    print(f"{script.relative_to(ROOT) if script.is_relative_to(ROOT) else script.name}: {text}", file=sys.stderr)


def install(*packages):
    """Installs the Debian packages that are missing, as scripts/setup does."""
    command = ["bash", "-c", '. "$1"; install_packages "${@:2}"', sys.argv[0], LIBRARY, *packages]
    code = subprocess.run(command, check=False).returncode
    if code:
        sys.exit(code)


def written(path):
    """The path of a file to be written, in a folder that exists."""
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def arguments(description):
    """A parser of arguments that prints the description as it stands."""
    return argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)


def add_out(parser, path):
    """The option for the file, or folder, that is written; `path` unless given."""
    kind = "FILE" if path.suffix else "FOLDER"
    parser.add_argument("--out", type=Path, default=path, metavar=kind, help=f"({path.relative_to(ROOT)})")


def labelled(argument):
    """LABEL=FOLDER as a pair; a folder alone is its own label."""
    label, _, folder = argument.partition("=")
    return label, Path(folder or label)

"""What the studies beside this file share: runs of nagata with their cost and results, and Markdown tables."""

import csv
import json
import os
import resource
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# The environment of scripts/run. A pinned set of BLAS kernels can be 1.7 times slower than OpenBLAS's own choice.
IN_MPI_ENVIRONMENT = '. "$0"; mpi_environment; unset OPENBLAS_CORETYPE; exec "$@"'


class Run:
    """Runs a scene on so many ranks with further arguments of `nagata run`; the results go to the folder `out`."""

    def __init__(self, scene, out, ranks, *arguments):
        program = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "nagata"
        command = ["bash", "-c", IN_MPI_ENVIRONMENT, ROOT / "scripts" / "lib.sh", "mpirun", "--quiet", "-n", ranks,
                   program, "run", scene, "--out", out, "--quiet", *arguments]
        before, start = cpu_of_children(), time.monotonic()
        self.code = subprocess.run([str(word) for word in command]).returncode
        self.wall, self.cpu = time.monotonic() - start, cpu_of_children() - before
        if self.code != 0:
            return
        self.summary = json.loads((Path(out) / "summary.json").read_text())
        with open(Path(out) / "history.csv", newline="") as file:
            self.history = list(csv.DictReader(file))

    @property
    def effort(self):
        return f"{self.summary['increments']} / {self.summary['iterations']}"

    def last(self, column, step=None):
        """Value of a column at the end of a step, or of the run."""
        return float([row[column] for row in self.history if step in (None, row["step"])][-1])


def cpu_of_children():
    """CPU seconds, user and system, of all processes that were waited for: mpirun and through it all ranks."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def setup():
    """Builds nagata if needed."""
    code = subprocess.run([ROOT / "scripts" / "setup"]).returncode
    if code != 0:
        sys.exit(code)


def table(head, rows):
    """Prints a Markdown table; columns are as wide as their widest cell."""
    cells = [[str(cell) for cell in row] for row in (head, *rows)]
    widths = [max(map(len, column)) for column in zip(*cells)]
    cells.insert(1, ["-" * width for width in widths])
    for row in cells:
        print("| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths)) + " |")

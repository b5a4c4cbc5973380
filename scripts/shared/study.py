"""What the studies share: runs of nagata with their cost and results, and Markdown tables."""

import csv
import json
import os
import resource
import subprocess
import sys
import time

from shared import LIBRARY, ROOT

BUILT = ROOT / os.environ.get("CARGO_TARGET_DIR", "target") / "release"
NAGATA = BUILT / "nagata"
# The environment of scripts/run. A pinned set of BLAS kernels can be 1.7 times slower than OpenBLAS's own choice.
IN_MPI_ENVIRONMENT = '. "$0"; mpi_environment; unset OPENBLAS_CORETYPE; exec "$@"'


class Process:
    """A command that is run to its end, with its exit code, wall time and CPU time."""

    def __init__(self, command, **options):
        before, start = cpu_of_children(), time.monotonic()
        self.done = subprocess.run([str(word) for word in command], check=False, **options)
        self.code = self.done.returncode
        self.wall, self.cpu = time.monotonic() - start, cpu_of_children() - before


class Run(Process):
    """Runs a scene on so many ranks with further arguments of `nagata run`; the results go to the folder `out`."""

    def __init__(self, scene, out, ranks, *arguments):
        super().__init__(on_ranks(ranks, NAGATA, "run", scene, "--out", out, "--quiet", *arguments))
        if self.code != 0:
            return
        self.summary = json.loads((out / "summary.json").read_text())
        with open(out / "history.csv", newline="") as file:
            self.history = list(csv.DictReader(file))

    @property
    def effort(self):
        return f"{self.summary['increments']} / {self.summary['iterations']}"

    def last(self, column, step=None):
        """Value of a column at the end of a step, or of the run."""
        return float([row[column] for row in self.history if step in (None, row["step"])][-1])


def on_ranks(ranks, *command):
    """A command on so many MPI ranks."""
    return ["bash", "-c", IN_MPI_ENVIRONMENT, LIBRARY, "mpirun", "--quiet", "-n", ranks, *command]


def cpu_of_children():
    """CPU seconds, user and system, of all processes that were waited for: mpirun and through it all ranks."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def setup():
    """Builds nagata if needed."""
    code = subprocess.run([ROOT / "scripts" / "setup"], check=False).returncode
    if code != 0:
        sys.exit(code)


def example(name):
    """Builds a program of examples/, whose path it returns."""
    subprocess.run(["cargo", "build", "--release", "--locked", "--quiet", "--example", name], cwd=ROOT, check=True)
    return BUILT / "examples" / name


def table(head, rows):
    """Prints a Markdown table; columns are as wide as their widest cell."""
    cells = [[str(cell) for cell in row] for row in (head, *rows)]
    widths = [max(map(len, column)) for column in zip(*cells)]
    cells.insert(1, ["-" * width for width in widths])
    for row in cells:
        print("| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths)) + " |")

"""What the studies share: runs of nagata with their cost and results, and Markdown tables."""

import csv
import json
import os
import subprocess
import sys
import time

from shared import LIBRARY, ROOT

BUILT = ROOT / os.environ.get("CARGO_TARGET_DIR", "target") / "release"
NAGATA = BUILT / "nagata"
# The environment of scripts/run. A pinned set of BLAS kernels can be 1.7 times slower than OpenBLAS's own choice.
IN_MPI_ENVIRONMENT = '. "$0"; mpi_environment; unset OPENBLAS_CORETYPE; exec "$@"'


LIMIT = 124  # exit code of a process that has reached its limit
QUANTITIES = {"length": ("ux", "uy", "uz", "max_penetration"), "force": ("fx", "fy", "fz")}


class Process:
    """A command that is run to its end, or for so many seconds: exit code, wall and CPU time in seconds, the memory of
    its largest process in MB."""

    def __init__(self, command, limit=None, environment=None, **options):
        command = ["timeout", "--foreground", limit, *command] if limit else command
        start = time.monotonic()
        # The one who waits learns what a process and its children have used.
        options["env"] = {**os.environ, **(environment or {})}
        process = subprocess.Popen([str(word) for word in command], **options)
        _, status, usage = os.wait4(process.pid, 0)
        self.wall, self.cpu = time.monotonic() - start, usage.ru_utime + usage.ru_stime
        self.code = process.returncode = os.waitstatus_to_exitcode(status)
        self.peak = usage.ru_maxrss / 1024


class Run(Process):
    """Runs a scene on so many ranks with further arguments of `nagata run`, for so many seconds at most; the results go
    to the folder `out`. By the build of the repository, or another program."""

    def __init__(self, scene, out, ranks, *arguments, limit=None, program=NAGATA):
        super().__init__(on_ranks(ranks, program, "run", scene, "--out", out, "--quiet", *arguments), limit)
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


def quantity(column):
    """Columns of one quantity share a scale: a component that is zero is compared with its neighbours."""
    last = column.rsplit(".")[-1]
    return next((name for name, columns in QUANTITIES.items() if last in columns), last)


def difference(history, reference, wanted=None):
    """Largest difference of a value, or of one of a wanted quantity, over the largest value of its quantity, and where;
    iterations do not count."""
    if [row["step"] for row in history] != [row["step"] for row in reference]:
        return float("inf"), f"{len(history)} increments, not {len(reference)}"
    columns = [c for c in reference[0] if c not in ("step", "iterations") and wanted in (None, quantity(c))]
    scale = {}
    for row in reference:
        for c in columns:
            scale[quantity(c)] = max(scale.get(quantity(c), 0.0), abs(float(row[c])))
    worst, where = 0.0, ""
    for row, other in zip(history, reference):
        for c in columns:
            relative = abs(float(row[c]) - float(other[c])) / (scale[quantity(c)] or 1.0)
            if not relative <= worst:  # also when it is not a number
                worst, where = relative, f"{c}, increment {row['increment']}"
    return worst, where


def on_ranks(ranks, *command):
    """A command on so many MPI ranks."""
    return ["bash", "-c", IN_MPI_ENVIRONMENT, LIBRARY, "mpirun", "--quiet", "-n", ranks, *command]


def setup():
    """Builds nagata if needed."""
    code = subprocess.run([ROOT / "scripts" / "setup"], check=False).returncode
    if code != 0:
        sys.exit(code)


def example(name):
    """Builds a program of examples/, whose path it returns."""
    subprocess.run(["cargo", "build", "--release", "--locked", "--quiet", "--example", name], cwd=ROOT, check=True)
    return BUILT / "examples" / name


def percents(errors):
    """Cells of a table; empty for None."""
    return ["" if e is None else f"{e:+.2%}" for e in errors]


def table(head, rows):
    """Prints a Markdown table; columns are as wide as their widest cell."""
    cells = [[str(cell) for cell in row] for row in (head, *rows)]
    widths = [max(map(len, column)) for column in zip(*cells)]
    cells.insert(1, ["-" * width for width in widths])
    for row in cells:
        print("| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths)) + " |")

#!/usr/bin/python3 -B
"""Times the way of a new user: from an empty folder to a report in a browser. Prints a Markdown table.

It clones this repository, builds it, writes a first scene, checks and runs it, and opens its report in Chromium without
a screen. Packages that are there are not installed again, and crates that cargo has are not downloaded again: on a new
machine these take as long as its network does. Nothing else should run meanwhile.
"""

import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import ROOT, arguments, install, study

BROWSER = ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--window-size=1280,1600"]


def main():
    arguments(__doc__).parse_args()
    install("chromium")
    rows, whole = [], 0.0
    with tempfile.TemporaryDirectory() as folder:
        clone = Path(folder) / "nagata"
        page = clone / "out" / "first" / "report.html"
        for told, command in [
            ("git clone", ["git", "clone", "--quiet", ROOT, clone]),
            ("scripts/setup", ["scripts/setup"]),
            ("nagata new first.toml", ["target/release/nagata", "new", "first.toml"]),
            ("nagata check first.toml", ["target/release/nagata", "check", "first.toml"]),
            ("scripts/run first.toml --report", ["scripts/run", "first.toml", "--report"]),
            ("out/first/report.html in a browser", [*BROWSER, f"--screenshot={folder}/page.png", page.as_uri()]),
        ]:
            # The clone has its own target.
            where = clone if clone.exists() else folder
            done = study.Process(command, cwd=where, environment={"CARGO_TARGET_DIR": "target"})
            if done.code:
                sys.exit(f"{told}: exit code {done.code}")
            rows.append([f"`{told}`", f"{done.wall:.1f}"])
            whole += done.wall
    study.table(["step", "s"], [*rows, ["all", f"{whole:.0f}"]])


main()

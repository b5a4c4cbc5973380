#!/usr/bin/python3 -B
"""Makes the tables of docs/validation/extremes.md of what `scripts/test --extremes` and `--oracles` have printed.

    scripts/test --extremes >extremes.log 2>&1
    scripts/test --oracles >oracles.log 2>&1
    scripts/studies/extremes.py extremes.log --oracles oracles.log

Without a log of the oracles their table stays as it is.
"""

import collections
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import arguments

PAGE = Path(__file__).resolve().parents[2] / "docs/validation/extremes.md"
# Of the lines that tell what has ended.
CASE = re.compile(
    r"^\d+/\d+ (?P<test>\w+/\w+): .*?: (?P<outcome>right|warned|refused|[A-Z]{4,}): (?P<text>.*) \([\d.]+ s\)$"
)
ERROR = re.compile(r"off by ([\d.]+e-?\d+)")


def of_extremes(log):
    """A row a test: cases, how many are right, warned of and refused, and the largest error of those that are right."""
    tests = collections.OrderedDict()
    for line in log.splitlines():
        if found := CASE.match(line):
            outcomes, errors = tests.setdefault(found["test"], (collections.Counter(), []))
            outcomes[found["outcome"]] += 1
            if found["outcome"] == "right":
                errors += map(float, ERROR.findall(found["text"]))
    rows = ["| test | cases | right | warned | refused | largest error |", "|---|---|---|---|---|---|"]
    total = collections.Counter()
    for name, (outcomes, errors) in sorted(tests.items()):
        total += outcomes
        largest = f"{max(errors):.0e}" if errors else ""
        count = sum(outcomes.values())
        right, warned, refused = (outcomes[word] for word in ("right", "warned", "refused"))
        others = count - right - warned - refused
        mark = f" **{others} neither**" if others else ""
        rows.append(f"| `{name}` | {count} | {right} | {warned} | {refused}{mark} | {largest} |")
    rows.append(f"| all | {sum(total.values())} | {total['right']} | {total['warned']} | {total['refused']} | |")
    return rows


def of_oracles(log):
    rows = ["| scene | quantity | found | expected | error | tolerance |", "|---|---|---|---|---|---|"]
    found = [line for line in log.splitlines() if line.startswith("| ") and line.count("|") in (7, 8)]
    return rows + [re.sub(" +", " ", line) for line in sorted(found)]


def main():
    parser = arguments(__doc__)
    parser.add_argument("extremes", type=Path)
    parser.add_argument("--oracles", type=Path)
    given = parser.parse_args()
    page = PAGE.read_text()
    tables = {"extremes": of_extremes(given.extremes.read_text())}
    if given.oracles:
        tables["oracles"] = of_oracles(given.oracles.read_text())
    for name, rows in tables.items():
        begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
        before, rest = page.split(begin)
        page = before + begin + "\n" + "\n".join(rows) + "\n\n" + end + rest.split(end)[1]
    PAGE.write_text(page)


if __name__ == "__main__":
    sys.exit(main())

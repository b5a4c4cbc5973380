#!/usr/bin/python3 -B
"""Runs the Hertz problems and that of Cattaneo and Mindlin on meshes of several finenesses and prints, as a Markdown
table, by how much the results differ from the solutions: the force at the approach from that of the finite bodies; the
radius of contact and the highest pressure from those under the force."""

import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import INPUTS, ROOT, arguments, hertz, say, study

SCENES = {  # with the elements of the block over the radius of contact
    "hertz-sphere": (hertz.SPHERE, "ball", 8),
    "hertz-cylinder": (hertz.CYLINDER, "roller", 12),
    "cattaneo-mindlin": (hertz.CYLINDER, "roller", 16),
}
HEAD = ["scene", "elements over the radius", "dofs", "increments / iterations", "force", "radius", "highest pressure",
        "pressure, rms", "half-width that sticks", "shear traction, rms", "at most"]


def row(scene, factor, result, run):
    """A row under HEAD."""
    elements = SCENES[scene][2]
    cells = study.percents(result.errors(scene == "cattaneo-mindlin"))
    return [scene, 4 * round(elements / 4 * factor), run.summary["dofs"], run.effort, *cells]


def main():
    parser = arguments(__doc__)
    parser.add_argument("--refine", type=float, nargs="+", default=[0.5, 1.0, 1.5, 2.0], metavar="F",
                        help="times the elements of the scenes' own meshes (0.5 1 1.5 2); 2 only in plane strain")
    parser.add_argument("--ranks", type=int, default=2, metavar="N", help="(%(default)s)")
    args = parser.parse_args()
    study.setup()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for scene, (problem, body, _) in SCENES.items():
            for factor in args.refine if problem is hertz.CYLINDER else [f for f in args.refine if f < 2]:
                say(f"{scene}, {factor:g}")
                make = ROOT / "scripts" / "meshes" / "hertz.py"
                subprocess.run([make, "--out", folder, "--refine", str(factor)], check=True)
                meshes = [f"--set=body.{name}.mesh={folder}/{scene}.msh" for name in ("block", body)]
                out = Path(folder) / f"{scene}-{factor:g}"
                run = study.Run(INPUTS / f"{scene}.toml", out, args.ranks, *meshes)
                if run.code != 0:
                    sys.exit(run.code)
                rows.append(row(scene, factor, hertz.Result(out, problem), run))
    study.table(HEAD, rows)


if __name__ == "__main__":
    main()

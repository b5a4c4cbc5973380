"""Contact of two bodies in CalculiX: its deck, and what it prints of a run."""

import re

from shared import gmsh


def deck(bodies, material, slave, master, contact, steps, print_forces):
    """Text of a deck. Bodies by name: points, hexahedra by the numbers of their points from 0, and sets of points by
    name; slave and master are (body, set). Contact is the type of the pair, the behaviour of the surfaces, and the
    further lines of their interaction. A step is its number of increments and displacements by (body, set), None where
    a body is free. Forces are printed of a set."""
    lines, points, cells = [], 0, 0
    surfaces = {slave: "SLAVE", master: "MASTER"}
    for name, (places, hexes, sets) in bodies.items():
        lines.append("*NODE")
        lines += [f"{n}, {x:.15g}, {y:.15g}, {z:.15g}" for n, (x, y, z) in enumerate(places, points + 1)]
        lines.append(f"*ELEMENT, TYPE=C3D8, ELSET={name}")
        for n, nodes in enumerate(hexes, cells + 1):
            lines.append(", ".join(map(str, (n, *(points + 1 + p for p in nodes)))))
        lines.append(f"*SOLID SECTION, ELSET={name}, MATERIAL=MATERIAL")
        for group, members in sets.items():
            lines += [f"*NSET, NSET={name}-{group}", *(f"{points + 1 + p}," for p in sorted(members))]
            if (name, group) in surfaces:
                lines.append(f"*SURFACE, NAME={surfaces[name, group]}")
                for n, nodes in enumerate(hexes, cells + 1):
                    lines += [f"{n}, S{side}" for side, face in enumerate(gmsh.FACES, 1)
                              if members.issuperset(nodes[k] for k in face)]
        points, cells = points + len(places), cells + len(hexes)
    lines += ["*MATERIAL, NAME=MATERIAL", *material]
    kind, behaviour, *more = contact
    lines += ["*SURFACE INTERACTION, NAME=CONTACT", f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE={behaviour}", *more]
    lines += [f"*CONTACT PAIR, INTERACTION=CONTACT, TYPE={kind}", "SLAVE, MASTER"]
    for increments, displacements in steps:
        lines += ["*STEP, NLGEOM, INC=1000", "*STATIC", f"{1 / increments:.15g}, 1., 1e-6, {1 / increments:.15g}"]
        lines.append("*BOUNDARY")
        for (name, group), by in displacements.items():
            lines += [f"{name}-{group}, {k}, {k}, {u:.15g}" for k, u in enumerate(by, 1) if u is not None]
        lines += ["*NODE PRINT, NSET={}-{}, TOTALS=ONLY".format(*print_forces), "RF", "*END STEP"]
    return "\n".join([*lines, ""])


def forces(folder, job):
    """By time, the force on the set whose forces are printed."""
    number = r"[-+.\dE]+"
    pattern = rf"total force .* and time +({number})\s+({number}) +({number}) +({number})"
    found = re.findall(pattern, (folder / f"{job}.dat").read_text())
    return {round(float(time), 9): [float(f) for f in force] for time, *force in found}


def effort(folder, job):
    """Increments, and iterations of all attempts."""
    texts = [(folder / f"{job}.{kind}").read_text() for kind in ("sta", "cvg")]
    return "{} / {}".format(*(len(re.findall(r"^ +\d+ +\d+ +\d", text, re.MULTILINE)) for text in texts))

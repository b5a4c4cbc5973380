"""Meshes as Gmsh writes them."""

FACES = (0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)
# Sides by number of corners, which turn to the left as seen from outside.
SIDES = {8: FACES, 6: ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
         5: ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)), 4: ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))}
# Types by dimension and number of nodes.
TYPES = {(0, 1): 15, (1, 2): 1, (2, 3): 2, (2, 4): 3, (3, 4): 4, (3, 5): 7, (3, 6): 6, (3, 8): 5,
         (2, 6): 9, (2, 8): 16, (3, 10): 11, (3, 15): 18, (3, 20): 17}
# Ends of the edges whose middles follow the corners of a cell of second order, by number of corners.
EDGES = {8: ((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)),
         6: ((0, 1), (0, 2), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (3, 5), (4, 5)),
         4: ((0, 1), (1, 2), (2, 0), (0, 3), (2, 3), (1, 3))}


def text(points, cells):
    """A Gmsh 2.2 file of points, each as coordinates or as text, and of cells, each as its dimension, the name of its
    group, or None, and the numbers of its points from 1. Groups are numbered as they come up."""
    tags, elements = {}, []
    for number, (dimension, group, nodes) in enumerate(cells, 1):
        tag = tags.setdefault((dimension, group), len(tags) + 1) if group else 0
        kind = TYPES[dimension, len(nodes)]
        elements.append(" ".join(map(str, (number, kind, 2, tag, tag or 1, *nodes))))
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat"]
    if tags:
        names = [f'{dimension} {tag} "{group}"' for (dimension, group), tag in tags.items()]
        lines += ["$PhysicalNames", str(len(tags)), *names, "$EndPhysicalNames"]
    lines += ["$Nodes", str(len(points))]
    places = (p if isinstance(p, str) else "{:.17g} {:.17g} {:.17g}".format(*p) for p in points)
    lines += [f"{n} {place}" for n, place in enumerate(places, 1)]
    return "\n".join(lines + ["$EndNodes", "$Elements", str(len(elements)), *elements, "$EndElements", ""])


def of_bodies(bodies):
    """The file of bodies by name: points, hexahedra by the numbers of their points from 0, and sets of points by name.
    Bodies become volume groups, the faces with all points in a set its surface group; bodies may share names."""
    places, cells = [], []
    for name, (points, hexes, sets) in bodies.items():
        start = len(places) + 1
        for group, members in sets.items():
            for nodes in hexes:
                if sum(n in members for n in nodes) >= 4:
                    faces = ([nodes[k] for k in face] for face in FACES)
                    cells += [(2, group, [start + n for n in f]) for f in faces if members.issuperset(f)]
        cells += [(3, name, [start + n for n in nodes]) for nodes in hexes]
        places += ["{:.9g} {:.9g} {:.9g}".format(*p) for p in points]
    return text(places, cells)

"""What the scripts beside this file that make meshes share."""

FACES = (0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)


def text(bodies):
    """A Gmsh 2.2 file of bodies by name: points, hexahedra by the numbers of their points from 0, and sets of points by
    name. Bodies become volume groups, the faces with all points in a set its surface group; bodies may share names."""
    tags, lines, elements, start = {}, [], [], 1
    for name, (points, hexes, sets) in bodies.items():
        for group, members in sets.items():
            tag = tags.setdefault((2, group), len(tags) + 1)
            for nodes in hexes:
                if sum(n in members for n in nodes) >= 4:
                    faces = ([nodes[k] for k in face] for face in FACES)
                    elements += [(3, tag, [start + n for n in f]) for f in faces if members.issuperset(f)]
        tag = tags.setdefault((3, name), len(tags) + 1)
        elements += [(5, tag, [start + n for n in nodes]) for nodes in hexes]
        lines += ["%d %.9g %.9g %.9g" % (start + n, *p) for n, p in enumerate(points)]
        start += len(points)
    head = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(tags))]
    head += ['%d %d "%s"' % (dimension, tag, name) for (dimension, name), tag in tags.items()]
    head += ["$EndPhysicalNames", "$Nodes", str(len(lines))]
    lines += ["$EndNodes", "$Elements", str(len(elements))]
    lines += ["%d %d 2 %d %d %s" % (e, kind, tag, tag, " ".join(map(str, nodes)))
              for e, (kind, tag, nodes) in enumerate(elements, 1)]
    return "\n".join(head + lines + ["$EndElements", ""])

"""Random scenes of contact from seeds, and the same problem in another frame and in other units.

Numbers of a scene carry what they are, lengths, forces, points or directions, so that it can be written as seen from
any `Frame`.
"""

import itertools
import json
import math
import random
from dataclasses import dataclass, field, replace

HEXAHEDRON, WEDGE, TETRAHEDRON, QUADRATIC, QUADRILATERAL, TRIANGLE, CURVED = 5, 6, 4, 11, 3, 2, 9  # types of Gmsh
MIRRORED = {  # the order of nodes of an element's mirror image
    HEXAHEDRON: (4, 5, 6, 7, 0, 1, 2, 3), WEDGE: (3, 4, 5, 0, 1, 2), TETRAHEDRON: (1, 0, 2, 3),
    QUADRATIC: (1, 0, 2, 3, 4, 6, 5, 9, 8, 7), QUADRILATERAL: (0, 3, 2, 1), TRIANGLE: (0, 2, 1),
    CURVED: (0, 2, 1, 5, 4, 3)}
TURNED = (1, 2, 3, 0, 5, 6, 7, 4)  # another order of a hexahedron's nodes
CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
# Faces by axis and end, from their lowest corner on.
FACES = {(0, 0): (0, 4, 7, 3), (0, 1): (1, 2, 6, 5), (1, 0): (0, 1, 5, 4), (1, 1): (3, 7, 6, 2),
         (2, 0): (0, 3, 2, 1), (2, 1): (4, 5, 6, 7)}
PARTS = {  # what fills a hexahedron
    HEXAHEDRON: (range(8),), WEDGE: ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)),
    TETRAHEDRON: ((0, 1, 2, 6), (0, 5, 1, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 4, 5, 6), (0, 7, 4, 6))}
AXES = "xyz"


@dataclass(frozen=True)
class Quantity:
    """A number or a vector with its unit. About an axis, its sign changes in a mirror; a point is shifted, too."""

    value: float | tuple
    length: int = 0
    force: int = 0
    is_axial: bool = False
    is_point: bool = False

    def times(self, factor):
        value = tuple(factor * v for v in self.value) if isinstance(self.value, tuple) else factor * self.value
        return replace(self, value=value)


class Name(str):
    """Of a body, a tool, or a set or faces of a body."""


length = lambda value: Quantity(value, 1)
stress = lambda value: Quantity(value, -2, 1)
point = lambda *values: Quantity(values, 1, is_point=True)
way = lambda *values: Quantity(values, 1)
push = lambda *values: Quantity(values, 0, 1)
direction = lambda *values: Quantity(values)


@dataclass(frozen=True)
class Frame:
    """Another view of the same problem: x -> length * matrix x + shift, all stresses times `stress`; a mirror has the
    sign -1."""

    matrix: tuple = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    sign: int = 1
    shift: tuple = (0, 0, 0)
    length: float = 1
    stress: float = 1

    def turned(self, values):
        return [sum(m * v for m, v in zip(row, values)) for row in self.matrix]

    def back(self, values):
        return [sum(m * v for m, v in zip(column, values)) for column in zip(*self.matrix)]

    def place(self, values):
        return [self.length * v + s for v, s in zip(self.turned(values), self.shift)]

    def of(self, node, names=None):
        """A part of a scene as it reads in this frame, with other names."""
        seen = node
        match node:
            case Quantity():
                factor = self.length ** node.length * (self.stress * self.length ** 2) ** node.force
                if not isinstance(node.value, tuple):
                    seen = node.value * factor * (self.sign if node.is_axial else 1)
                else:
                    seen = self.place(node.value) if node.is_point else self.turned(node.times(factor).value)
            case Name():
                head, dot, group = node.partition(".")
                seen = (names or {}).get(head, head) + dot + group
            case dict():
                seen = {k: self.of(v, names) for k, v in node.items()}
            case list():
                seen = [self.of(v, names) for v in node]
        return seen


def mirrored(axis):
    """The frame in a mirror across an axis."""
    return Frame(tuple(tuple((-1 if i == axis else 1) * (i == j) for j in range(3)) for i in range(3)), -1)


def turned(axis, degrees):
    """The frame that is turned about an axis through the origin."""
    size, c, s = math.hypot(*axis), math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    c, s = (round(v) if abs(v - round(v)) < 1e-12 else v for v in (c, s))
    x, y, z = (v / size for v in axis)
    return Frame(((c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s),
                  (y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s),
                  (z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c))))


def toml(value):
    """A value of TOML in one line."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{k} = {toml(v)}" for k, v in value.items()) + " }"
    return "[" + ", ".join(map(toml, value)) + "]" if isinstance(value, list) else json.dumps(value)


@dataclass
class Grid:
    """A mesh: elements with their types, and groups of faces."""

    points: list
    cells: list
    groups: dict

    def write(self, path, frame, order=None):
        """As seen from the frame, for Gmsh 2.2; an `order` shuffles numbers."""
        numbers, cells = list(range(1, len(self.points) + 1)), list(self.cells)
        if order:
            order.shuffle(numbers)
            order.shuffle(cells)
            cells = [(kind, [nodes[k] for k in TURNED] if kind == HEXAHEDRON and order.random() < 0.5 else nodes)
                     for kind, nodes in cells]
        groups = [(2, name, faces) for name, faces in self.groups.items() if faces]
        groups += [(3, "volume", cells)] if cells else []
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", len(groups)]
        lines += [f'{dimension} {tag} "{name}"' for tag, (dimension, name, _) in enumerate(groups, 1)]
        lines += ["$EndPhysicalNames", "$Nodes", len(numbers)]
        lines += [" ".join([str(number), *(repr(float(x)) for x in frame.place(place))])
                  for number, place in sorted(zip(numbers, self.points))]
        rows = [(tag, *part) for tag, (_, _, parts) in enumerate(groups, 1) for part in parts]
        lines += ["$EndNodes", "$Elements", len(rows)]
        for number, (tag, kind, nodes) in enumerate(rows, 1):
            ordered = [nodes[k] for k in MIRRORED[kind]] if frame.sign < 0 else nodes
            lines.append(f"{number} {kind} 2 {tag} {tag} " + " ".join(str(numbers[node]) for node in ordered))
        path.write_text("\n".join(map(str, [*lines, "$EndElements", ""])))


def lattice(counts, place, names, kind):
    """A grid of hexahedra, or of what they are split into; `place` maps numbers of nodes along the axes, `names` are
    those of the groups at the two ends of each."""
    index = {node: k for k, node in enumerate(itertools.product(*(range(n + 1) for n in counts)))}
    linear = TETRAHEDRON if kind == QUADRATIC else kind
    cells, groups = [], {name: [] for pair in names for name in pair}
    for cell in itertools.product(*map(range, counts)):
        nodes = [index[tuple(c + d for c, d in zip(cell, corner))] for corner in CORNERS]
        cells += [(linear, [nodes[k] for k in part]) for part in PARTS[linear]]
        for (axis, end), face in FACES.items():
            if cell[axis] == (counts[axis] - 1) * end:
                is_split = linear == TETRAHEDRON or (linear == WEDGE and axis == 2)
                groups[names[axis][end]] += faces([nodes[k] for k in face], is_split)
    grid = Grid([place(*node) for node in index], cells, groups)
    return curved(grid) if kind == QUADRATIC else grid


def curved(grid):
    """Tetrahedra of second order."""
    middles, points = {}, list(grid.points)

    def middle(a, b):
        edge = (min(a, b), max(a, b))
        if edge not in middles:
            middles[edge] = len(points)
            points.append(tuple((x + y) / 2 for x, y in zip(points[a], points[b])))
        return middles[edge]

    more = lambda nodes, edges: [*nodes, *(middle(nodes[a], nodes[b]) for a, b in edges)]
    cells = [(QUADRATIC, more(n, ((0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3)))) for _, n in grid.cells]
    groups = {name: [(CURVED, more(n, ((0, 1), (1, 2), (2, 0)))) for _, n in faces]
              for name, faces in grid.groups.items()}
    return Grid(points, cells, groups)


def faces(corners, is_split):
    """A quadrilateral, or its two triangles."""
    a, b, c, d = corners
    return [(TRIANGLE, [a, b, c]), (TRIANGLE, [a, c, d])] if is_split else [(QUADRILATERAL, [a, b, c, d])]


def sheet(n, m, place, is_split=False):
    """A surface of n times m facets, whose normals are the first way times the second."""
    corners = [[(i + a) * (m + 1) + k + b for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
               for i, k in itertools.product(range(n), range(m))]
    points = [place(i / n, k / m) for i in range(n + 1) for k in range(m + 1)]
    return Grid(points, [], {"surface": [face for quad in corners for face in faces(quad, is_split)]})


class Chance(random.Random):
    def between(self, low, high):
        """A number of few digits."""
        return float(f"{self.uniform(low, high):.3g}")

    def maybe(self, share):
        return self.random() < share

    def weighted(self, **weights):
        return self.choices(list(weights), list(weights.values()))[0].replace("_", "-")


@dataclass
class Body:
    """The box around a body, and its shape."""

    name: str
    shape: str
    low: list
    size: list
    high: list
    middle: list
    young: float

    def faces(self, group):
        return Name(f"{self.name}.{group}")


@dataclass
class Problem:
    """A scene with its meshes; `space` is solid, layer or ring."""

    seed: int
    space: str
    scene: dict = field(default_factory=lambda: {kind: {} for kind in ("body", "material", "tool", "contact", "tie")})
    grids: dict = field(default_factory=dict)
    surfaces: dict = field(default_factory=dict)
    volumes: dict = field(default_factory=dict)
    strain: float = 0.0
    least: dict = field(default_factory=dict)  # what counts as a force, a motion and a stress

    @property
    def contacts(self):
        return list(self.scene["contact"].values())

    @property
    def is_rough(self):
        return any("friction" in contact for contact in self.contacts)

    @property
    def is_elastic(self):
        return not any("yield_stress" in material for material in self.scene["material"].values())

    @property
    def turning(self):
        """What turns in some step."""
        return {move["target"] for move in self.all("move") if "rotate" in move}

    def all(self, kind):
        """Conditions of a kind in all steps."""
        return [one for step in self.scene["step"] for one in step.get(kind, [])]

    def has(self, *kinds):
        """Whether a step has conditions of one of these kinds."""
        return any(step.get(kind) for step in self.scene["step"] for kind in kinds)


class Maker:
    """Makes a problem of random numbers: bodies that stand on each other along y, and what drives them from above."""

    def __init__(self, seed):
        self.chance = Chance(seed)
        self.space = self.chance.weighted(solid=50, layer=35, ring=15)
        self.is_solid, self.is_ring = self.space == "solid", self.space == "ring"
        self.is_half = self.is_solid and self.chance.maybe(0.25)  # symmetry about z = 0
        self.problem = Problem(seed, self.space)
        self.scene = self.problem.scene
        self.bodies, self.held, self.springs = [], [], []

    def made(self):
        self.stack()
        self.supports()
        self.drive()
        names = [Name(body.name) for body in self.bodies]
        self.scene["output"] = {"every": 1000, "history": names, "probe": [
            {"name": f"all-{k}", "set": name, "fields": ["nodal_von_mises"]} for k, name in enumerate(names)]}
        return self.problem

    def stack(self):
        """Bodies upon each other, tied or in contact."""
        c = self.chance
        number = c.choices([1, 2, 3], [50, 38, 12])[0]
        width, height, depth = c.between(2, 20), c.between(1, 10), c.between(1, 10) if self.is_solid else 1.0
        start, level = c.choice([0.0, c.between(0.5, 2) * width]) * self.is_ring, 0.0
        # Gaps between bodies, or overlaps.
        apart = [height * c.choice([0.0, 0.0, c.between(-0.01, 0.005)]) for _ in range(number - 1)]
        for k in range(number):
            shape = "box"
            if number == 1:
                thin = 13 * (not self.is_ring)
                shape = c.weighted(box=60, arch=15 * (start == 0.0), loop=thin, strip=thin)
            elif k == number - 1 and start == 0.0 and c.maybe(0.35):
                shape = "barrel"
            spread = width * (1.0 if k == 0 else c.choice([1.0, c.between(0.3, 0.9), c.between(1.1, 1.6)]))
            tall = {"box": height * (1.0 if k == 0 else c.between(0.3, 1.2)), "strip": spread / c.between(8, 30),
                    "loop": spread}.get(shape, spread if self.is_ring else spread / 2)
            aside = 0.0 if k == 0 or shape == "barrel" or c.maybe(0.7) else width * c.between(-0.2, 0.2)
            deep = depth * (1.0 if k == 0 or not self.is_solid or c.maybe(0.6) else c.between(0.5, 1.5))
            low = [start if self.is_ring else (width - spread) / 2 + aside, level,
                   0.0 if self.is_half else (depth - deep) / 2]
            self.body(("base", "middle", "cap")[k], shape, low, [spread, tall, deep])
            level += tall + sum(apart[k:k + 1])
        for (lower, upper), gap in zip(itertools.pairwise(self.bodies), apart):
            under, over = lower.faces("top"), upper.faces("outside" if upper.shape == "barrel" else "bottom")
            fits = all(lower.low[k] <= upper.low[k] + 1e-9 and upper.high[k] <= lower.high[k] + 1e-9 for k in (0, 2))
            name = f"{lower.name}-{upper.name}"
            if fits and gap == 0.0 and upper.shape == "box" and not self.scene["tie"] and c.maybe(0.2):
                self.scene["tie"][name] = {"slave": over, "master": under}
            else:
                self.pair(name, *((over, under) if c.maybe(0.6) else (under, over)))

    def body(self, name, shape, low, size):
        """A box or a strip, or a sector: an arch that stands on its ends, a barrel that hangs on them, an open loop."""
        c = self.chance
        young, ratio, model = self.material(name)
        kind = self.element(shape, ratio, model)
        fine = c.choice([1, 1, 2] if self.is_solid else [1, 2, 3])
        counts = [c.randint(2, 4) * fine, c.randint(1, 3) * fine, c.randint(2, 4) if self.is_solid else 1]
        if kind.startswith("tet10"):
            counts = [min(n, 3) for n in counts]
        if shape == "strip":
            counts = [2 * c.randint(3, 8), 1, counts[2]]
        filling = {"tet1": QUADRATIC, "tet4": TETRAHEDRON, "wedg": WEDGE}.get(kind[:4], HEXAHEDRON)
        made = self.box if shape in ("box", "strip") else self.sector
        counts, place, names = made(shape, low, size, counts)
        grid = self.problem.grids[name] = lattice(counts, place, [*names, ("zmin", "zmax")], filling)
        group, parts = "skin", ["top", "xmax", *(["xmin"] * (not self.is_ring or low[0] > 0)), *(
            ["zmax"] * self.is_solid), *(["zmin"] * (self.is_solid and not self.is_half))]
        if made == self.sector:  # of a ring one end is in the plane of symmetry
            group, parts = "ends", ["amax" if shape == "barrel" else "amin"] if self.is_ring else ["amin", "amax"]
        grid.groups[group] = [face for part in parts for face in grid.groups[part]]
        if shape == "box":
            ring = math.pi * (2 * low[0] + size[0]) / size[2] if self.is_ring else 1.0
            self.problem.volumes[name] = math.prod(size) * ring
        entry = {"layer": {"plane_strain": True}, "ring": {"axisymmetric": True}}.get(self.space, {})
        entry |= {"symmetry": ["zmin"]} if self.is_half else {}
        self.scene["body"][name] = {"material": f"{name}-stuff", "element": kind} | entry
        high, middle = ([a + share * b for a, b in zip(low, size)] for share in (1, 0.5))
        self.bodies.append(Body(name, shape, low, size, high, middle, young))

    def material(self, name):
        c = self.chance
        model = c.weighted(neo_hookean=40, hooke=15, j2=18, mooney_rivlin=6, ogden=6, orthotropic=7, hill=8)
        young = c.between(1, 10) * 10 ** c.randint(0, 2)
        angle = math.radians(0.0 if self.is_ring else c.choice([0.0, 90.0, c.between(-60, 60)]))
        axes = {"x": direction(math.cos(angle), math.sin(angle), 0.0),
                "y": direction(-math.sin(angle), math.cos(angle), 0.0)}
        ratio = {"neo-hookean": c.choice([0.0, 0.3, 0.3, 0.4, 0.49, 0.499]), "hooke": c.choice([0.0, 0.3, 0.4, 0.49]),
                 "mooney-rivlin": c.choice([0.3, 0.45, 0.49]), "ogden": c.choice([0.3, 0.45, 0.49])}.get(model, 0.3)
        entry = {"young": stress(young), "poisson": ratio}
        if model in ("j2", "hill"):
            voce = {"saturation": stress(young * 0.05), "rate": c.between(2, 20), "linear": stress(young * 0.02)}
            entry |= {"yield_stress": stress(young * c.between(0.005, 0.03)), "hardening": c.choice([
                {"linear": stress(young * c.between(0.02, 0.2))}, {"voce": voce}])}
        elif model == "mooney-rivlin":
            entry = {"c10": stress(young / 8), "c01": stress(young / 24), "poisson": ratio}
        elif model == "ogden":
            entry = {"terms": [[stress(young / 5), 2.0], [stress(-young / 30), -2.0]], "poisson": ratio}
        elif model == "orthotropic":
            entry = {model: axes | {"e1": stress(young), "e2": stress(young * c.between(0.2, 1)), "nu12": 0.3,
                                    "e3": stress(young / 2), "nu13": 0.2, "nu23": 0.1}
                     | {shear: stress(0.3 * young) for shear in ("g12", "g13", "g23")}}
        if model == "hill":
            entry[model] = axes | {"f": c.between(0.3, 0.7), "g": 0.5, "h": c.between(0.3, 0.7), "n": c.between(1, 2)}
        # A density with which gravity is about 1.
        self.scene["material"][f"{name}-stuff"] = {"model": model, "density": Quantity(1e-3 * young, -4, 1)} | entry
        return young, ratio, model

    def element(self, shape, ratio, model):
        """One that does not lock."""
        c = self.chance
        if shape == "strip":
            return "hex8-shell" if self.is_solid and c.maybe(0.6) else "hex8-eas"
        kind = c.weighted(hex8=40, hex8_fbar=20, hex8_sri=20, hex8_eas=10 * (not self.is_ring), tet10=5 * self.is_solid,
                          tet4=4 * self.is_solid, wedge6=6 * self.is_solid)
        if model in ("j2", "hill") or ratio > 0.45:
            kind = {"hex8": "hex8-sri" if ratio < 0.45 else "hex8-fbar", "tet4": "hex8-sri", "tet10": "tet10-sri",
                    "wedge6": "wedge6-sri"}.get(kind, kind)
        return kind

    def box(self, _, low, size, counts):
        """Numbers of elements, places of nodes, names of ends."""
        c, moved = self.chance, {}
        grading = [*(c.choice([1.0, 1.0, c.between(0.4, 2.5)]) for _ in counts[:2]), 1.0]
        lengths = [[ratio ** (k / max(n - 1, 1)) for k in range(n)] for n, ratio in zip(counts, grading)]
        shares = [[sum(part[:k]) / sum(part) for k in range(len(part) + 1)] for part in lengths]
        if c.maybe(0.25):  # inner nodes are not where they should be
            for i, j in itertools.product(range(1, counts[0]), range(1, counts[1])):
                by = [c.uniform(-0.15, 0.15) * s / n for s, n in zip(size, counts)]
                for k in range(1, counts[2]) if self.is_solid else (0, 1):
                    moved[i, j, k] = by if self.is_solid else [*by[:2], 0.0]
        place = lambda *n: tuple(o + s * share[k] + d for o, s, share, k, d in zip(
            low, size, shares, n, moved.get(n, (0.0, 0.0, 0.0))))
        return counts, place, [("xmin", "xmax"), ("bottom", "top")]

    def sector(self, shape, low, size, counts):
        """The same of a part of a tube along z."""
        c = self.chance
        gape = c.between(3, 15)
        radius = size[1] / 2 if shape == "loop" else size[1]
        start, end = {"barrel": (270.0 if self.is_ring else 180.0, 360.0), "loop": (gape, 360.0 - gape),
                      "arch": (0.0, 90.0 if self.is_ring else 180.0)}[shape]
        inner = radius * (c.between(0.7, 0.9) if shape == "loop" else c.between(0.3, 0.7))
        counts = [min(counts[0], 3), max(counts[1], 4) + (10 if shape == "loop" else 2), counts[2]]
        center = (low[0] + (0.0 if self.is_ring else radius),
                  low[1] + {"barrel": size[1], "loop": radius}.get(shape, 0.0), low[2])
        spots = [math.radians(start + (end - start) * k / counts[1]) for k in range(counts[1] + 1)]
        far = lambda i: inner + (radius - inner) * i / counts[0]
        place = lambda i, j, k: (center[0] + far(i) * math.cos(spots[j]), center[1] + far(i) * math.sin(spots[j]),
                                 low[2] + size[2] * k / counts[2])
        return counts, place, [("inside", "outside"), ("amin", "amax")]

    def pair(self, name, slave, master, *, is_plain=False):
        """A contact of random kind; a plain one has multipliers at nodes."""
        c, is_tool = self.chance, "." not in master
        sides = [slave] if is_tool else [slave, master]
        kind = c.weighted(one_pass=70, segment=30) if is_tool else c.weighted(
            one_pass=42, two_pass=25, segment=28, node_to_node=5)
        if is_plain or any(self.scene["body"][side.split(".")[0]]["element"].startswith("tet10") for side in sides):
            kind = "one-pass"
        method = c.weighted(augmented_lagrangian=55, lagrange=20, uzawa=15, penalty=10)
        if is_plain and method in ("uzawa", "penalty"):
            method = "augmented-lagrangian"
        one = {"slave": Name(slave), "master": Name(master), "discretization": kind, "method": method}
        if c.maybe(0.6):
            one["friction"] = c.between(0.05, 1.0) if c.maybe(0.7) else c.choice([0.02, 0.3, 1.0])
        if not is_tool and kind != "node-to-node" and c.maybe(0.4):
            one["smoothing"] = "facet"
        if not is_tool and kind in ("one-pass", "two-pass") and c.maybe(0.2):
            one["transfer"] = c.choice(["variational", "bilinear"])
        self.scene["contact"][name] = one

    def supports(self):
        """What holds the bodies, and walls."""
        c, base = self.chance, self.bodies[0]
        spring = lambda body, share: {"set": Name(body.name), "stiffness": [Quantity(body.young * share, -1, 1)] * 3}
        self.springs += [spring(body, c.choice([5e-3, 5e-2])) for body in self.bodies[1:] if body.shape == "box"]
        bottom = base.faces({"arch": "ends", "loop": "outside"}.get(base.shape, "bottom"))
        if base.shape == "strip":
            self.held = [{"set": base.faces("xmin")}, {"set": base.faces("xmax")}]
        elif base.shape == "loop" or (base.shape == "box" and c.maybe(0.25)):
            self.scene["tool"]["floor"] = plane((0.0, 0.0, 0.0), (0.0, 1.0, 0.0))
            self.pair("floor-base", bottom, "floor")
            self.springs.append(spring(base, 0.05))
            if base.shape == "loop":
                self.pair("lips", base.faces("amin"), base.faces("amax"), is_plain=True)
        else:
            self.held = [{"set": bottom}]
        if base.shape == "box" and not self.is_ring and self.springs and c.maybe(0.2):  # it bulges into a wall
            gap = base.size[0] * c.choice([0.0, 0.002])
            self.scene["tool"]["wall"] = plane((base.high[0] + gap, 0.0, 0.0), (-1.0, 0.0, 0.0))
            self.pair("wall-base", base.faces("xmax"), "wall")

    def drive(self):
        """What presses from above: a tool, by a motion or a force, or the upper faces of the last body."""
        c, base, last = self.chance, self.bodies[0], self.bodies[-1]
        width, tall, young = last.size[0], last.high[1], min(body.young for body in self.bodies)
        is_thin = base.shape in ("strip", "loop")
        deep = c.between(0.02, 0.15) * width if is_thin else min(tall, 2 * width) * c.choice(
            [c.between(0.01, 0.06), c.between(0.01, 0.06), c.between(0.05, 0.3)])
        ring = 2 * math.pi * last.middle[0] / last.size[2] if self.is_ring else 1.0
        total = float(f"{0.4 * young * width * last.size[2] * ring * deep / tall:.3g}")
        self.problem.strain = deep / tall
        self.problem.least = {"f": 1e-3 * total, "u": 1e-2 * deep, "s": young * deep / tall}
        target, middle, force = last.faces("ends" if last.shape == "barrel" else "top"), last.middle, []
        kind, axis = "", (0.0, 1.0, 0.0) if self.is_solid else (0.0, 0.0, 1.0)
        if last.shape != "barrel" and (last is base or c.maybe(0.7)):
            target, is_forced = Name("punch"), c.maybe(0.3) and not is_thin
            kind, middle = self.tool(last, 0.0 if is_forced else c.choice([0.0, 0.1, 0.5, -0.1]) * deep)
            axis = (0.0, 0.0, 1.0) if kind == "cylinder" else axis
            slave = last.faces("outside" if last.shape in ("arch", "loop") else c.choice(
                ["top", "top" if self.scene["tie"] else "skin"]))
            self.pair(f"punch-{last.name}", slave, "punch")
            if is_forced:
                force = [{"target": target, "total": push(0.0, -total, 0.0), "directions": "y"}]
        can_turn = not self.is_ring and not (self.is_half and axis[1]) and (self.is_solid or kind != "plane")
        more = ["press-again"] if self.is_ring else ["slide", "back", "press-again", *(["turn"] * can_turn)]
        plan = ["press", *c.sample(more, c.randint(0, min(3, len(more)))), *(["lift"] * (not force and c.maybe(0.4)))]
        self.scene["step"] = []
        for number, name in enumerate(plan):
            step = {"name": name, "increments": c.randint(2, 6), "duration": 1.0}
            move = self.move(name, deep, width, [point(*middle), direction(*axis)], bool(force))
            step["move"] = [{"target": target} | move] if move or "." in target else []
            if "wall" in self.scene["tool"] and c.maybe(0.4):
                step["move"].append({"target": Name("wall"), "by": way(-0.01 * width, 0.0, 0.0)})
            step |= {"keep": True} if number and c.maybe(0.4) else {
                "fix": self.held, "spring": self.springs, "force": force}
            step |= self.loads(number, base, young, step.get("force", []))
            self.scene["step"].append({k: v for k, v in step.items() if v})

    def tool(self, body, gap):
        """A punch above a body: its kind, and the middle of what is round."""
        c = self.chance
        width, depth, (x, _, z) = body.size[0], body.size[2], body.middle
        x = 0.0 if self.is_ring and body.low[0] == 0.0 else x + width * c.choice([0.0, c.between(-0.3, 0.3)])
        z = 0.0 if self.is_half else z + depth * c.choice([0.0, c.between(-0.2, 0.2)]) * self.is_solid
        top, radius = body.high[1] + gap, width * c.between(0.3, 1.5)
        middle = (x, top + radius, z)
        kind = c.weighted(plane=30, cylinder=20, profile=15, mesh=28, sphere=22 * self.is_solid)
        match kind:
            case "plane":
                punch = plane((x, top, z), (0.0, -1.0, 0.0))
            case "cylinder":
                punch = {kind: {"point": point(*middle), "axis": direction(0.0, 0.0, 1.0), "radius": length(radius)}}
            case "sphere":
                punch = {kind: {"center": point(*middle), "radius": length(radius)}}
            case "profile":
                half = width * c.between(0.15, 0.8)
                corners = [(-half, width), (-half, 0.0), (half, 0.0), (half, width)]
                frame = {"origin": point(x, top, 0.0), "x": direction(1.0, 0.0, 0.0), "y": direction(0.0, 1.0, 0.0)}
                punch = {kind: {"points": [[length(v) for v in corner] for corner in corners], "extrude": frame,
                                "fillets": length(min(0.6 * half, width * c.between(0.05, 0.15)))}}
            case "mesh":
                punch = {kind: "", "smoothing": c.choice(["nagata", "facet"])}
                n, m = 2 * c.randint(3, 8), c.randint(2, 5) if self.is_solid else 1
                edge = depth * (-0.2 if c.maybe(0.3) and self.is_solid else 0.5)
                back, front = (-1.5 * depth, 1.5 * depth) if self.is_half else (
                    body.low[2] - edge, body.high[2] + edge)
                roller = lambda s, t: (x - radius * math.cos(math.pi * s), middle[1] - radius * math.sin(math.pi * s),
                                       back + (front - back) * t)
                cap = lambda s, t: (3.4 * s - 1.7, -1.0, 3.4 * t - 1.7)
                dome = lambda s, t: tuple(a + radius * b / math.hypot(*cap(s, t)) for a, b in zip(middle, cap(s, t)))
                is_dome = self.is_solid and c.maybe(0.4)
                self.problem.surfaces["punch"] = sheet(n, n if is_dome else m, dome if is_dome else roller,
                                                       self.is_solid and not self.is_half and c.maybe(0.4))
        self.scene["tool"]["punch"] = punch
        return kind, middle

    def move(self, name, deep, width, axis, is_forced):
        """How a step moves what is driven."""
        c = self.chance
        if is_forced and name.startswith("press"):
            return {}
        if name in ("press", "press-again", "lift"):
            far = {"press": -1.0, "press-again": -0.3}.get(name, c.choice([0.5, 2.0]))
            table = [[0.0, 0.0], [0.5, 1.0], [1.0, c.between(0.5, 1.2)]]
            return {"by": way(0.0, far * deep, 0.0)} | ({"table": table} if name == "press" and c.maybe(0.15) else {})
        if name == "turn":
            return {"rotate": {"point": axis[0], "axis": axis[1], "angle": Quantity(c.between(-10, 10), is_axial=True)}}
        far = c.choice([0.15, 0.15, 0.5])
        aside = c.choice([0.0, c.between(-0.1, 0.1)]) if self.is_solid and not self.is_half else 0.0
        return {"by": way(width * c.between(-far, far), 0.0, width * aside)}

    def loads(self, number, base, young, force):
        """Further loads of a step."""
        c, loads, name = self.chance, {}, Name(base.name)
        if c.maybe(0.1):
            across = 0.0 if self.is_ring else c.choice([0.0, 0.2])
            loads["gravity"] = Quantity((across, -c.between(0.5, 2), 0.0), 1)
        if c.maybe(0.1) and number == 0:
            loads["body_force"] = [{"body": name, "per_volume": Quantity((0.0, -young * 1e-3, 0.0), -3, 1),
                                    "table": [[0.0, 0.0], [0.4, c.between(0.5, 2)], [1.0, 1.0]]}]
        if base.shape == "box" and not self.is_ring and c.maybe(0.12):
            loads["pressure"] = [{"set": base.faces("xmin"), "value": stress(young * c.between(0.005, 0.02))}]
        if base.shape == "box" and not self.is_ring and c.maybe(0.12):
            total = young * base.size[1] * base.size[2] * c.between(-0.01, 0.01)
            loads["force"] = [*force, {"target": base.faces("xmin"), "total": push(total, 0.0, 0.0)}]
        return loads


def plane(place, normal):
    return {"plane": {"point": point(*place), "normal": direction(*normal)}}

#!/usr/bin/python3 -B
"""Redraws the geometry study of Neto, Oliveira and Menezes, "Surface smoothing procedures in computational contact
mechanics" (doi 10.1007/s11831-015-9159-7): how well facets and Nagata patches describe circles and spheres (section
5.4, Figs. 25 to 29), and where points have no normal projection on them (section 6.1.2, Figs. 33 and 34).

Writes meshes and scenes, measures them with `nagata surface`, draws, and writes the table geometry.md. Every number is
compared with a closed form or with one computed independently; a difference above the limit ends the study with exit
code 1.
"""

import csv
import itertools
import json
import math
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import OUT, add_out, arguments, gmsh
from shared.scientific import Image, h5py, matplotlib, np, plt
from shared.study import NAGATA as PROGRAM
from shared.study import setup

LIMIT = 1e-6  # relative difference from a reference
LINEAR, NAGATA, BEZIER = "#b0302c", "#1f5b8f", "#3c8d5a"

# Sphere of radius 1 sampled by an independent computation, 13 x 13 samples a patch, n x n squares:
# {(mesh, kind, description): {n: (largest |radial error|, largest normal error in degrees)}}. The band of two triangles
# has normals 139 degrees apart, where nagata flattens the curve and the independent computation does not.
SPHERE = {
    ("cubed", "quads", "facet"): {
        1: (0.42264973081037416, 54.735610317245346),
        2: (0.12643419147609913, 32.443079377655536),
        4: (0.03614923825924987, 18.44863370770318),
        8: (0.009473597731205374, 9.900432838821118),
        16: (0.002399017591656949, 5.127188183943781),
        32: (0.0006017289988002883, 2.6078685378609165),
    },
    ("cubed", "quads", "nagata"): {
        1: (0.13397459621556151, 23.198590513648185),
        2: (0.006294706035881892, 3.2720880489915376),
        4: (0.0006253369704841694, 0.5647881068339212),
        8: (4.442758004630232e-05, 0.07831616581479565),
        16: (2.8706484365148555e-06, 0.010068439683798646),
        32: (1.8092959741533576e-07, 0.0012676189833333343),
    },
    ("cubed", "triangles", "facet"): {
        1: (0.42264973081037416, 54.735610317245346),
        2: (0.13701722136780414, 32.443079377655536),
        4: (0.040317017739332606, 18.44863370770318),
        8: (0.01131551186234836, 9.900432838821118),
        16: (0.0030114477759607405, 5.127188183943781),
        32: (0.0007774563002418411, 2.6078685378609165),
    },
    ("cubed", "triangles", "nagata"): {
        1: (0.15470053837925146, 25.23940182067891),
        2: (0.01036297108184514, 4.543137765104596),
        4: (0.0008468744103207193, 0.7550333210171694),
        8: (6.475311904008407e-05, 0.11251657388512554),
        16: (4.548105235091526e-06, 0.015458294714616279),
        32: (3.024542944984887e-07, 0.0020281166090211794),
    },
    ("band", "quads", "facet"): {
        1: (0.6464466094067262, 69.29518894536457),
        2: (0.18442592857578843, 35.396364846555905),
        4: (0.05137953586232924, 18.454411262864994),
        8: (0.013247686834129246, 9.336861676266448),
        16: (0.0033378969608337528, 4.682693932405388),
        32: (0.0008361102691830657, 2.343148016639411),
    },
    ("band", "quads", "nagata"): {
        1: (0.25, 41.729512076816455),
        2: (0.010362971081845362, 5.439617121467973),
        4: (0.0009798968496433913, 1.027017063045583),
        8: (7.205823388567456e-05, 0.14046647912382068),
        16: (4.667774773925437e-06, 0.017942929265082126),
        32: (2.942741283984418e-07, 0.0022549429207839445),
    },
    ("band", "triangles", "facet"): {
        1: (0.6464466094067262, 69.29518894536457),
        2: (0.18457397945702525, 35.396364846555905),
        4: (0.05137417576593173, 18.454411262864994),
        8: (0.01324627378822485, 9.336861676266487),
        16: (0.003337874860078527, 4.682693932405388),
        32: (0.0008361099237766956, 2.343148016639411),
    },
    ("band", "triangles", "nagata"): {
        2: (0.0191134560696804, 6.195535694293847),
        4: (0.0013864161106653672, 0.9144397296925831),
        8: (8.890960561491745e-05, 0.11891523785596085),
        16: (5.5893608781332205e-06, 0.01501079694509636),
        32: (3.498324008255338e-07, 0.0018809445328441257),
    },
}

# Fractions of the points above the sphere without a normal projection, of a 301 x 301 grid over |x|, |y| <= 0.9 inside
# the pyramid |x|, |y| < z; independent computation: {z: (facets, Nagata, Nagata extended by 0.01)}.
BLIND = {
    1.02: (0.28570, 0.00662, 0.0),
    1.10: (0.34495, 0.01845, 0.0),
    1.30: (0.53427, 0.01634, 0.0),
    1.60: (0.75289, 0.02552, 0.00057),
}
BLIND_LIMIT = 1e-3
# Largest angle between the normals of neighbouring patches of the 4 x 4 sphere, degrees; its sine is computed likewise.
JUMP = math.degrees(math.asin(math.radians(1.1295030422197359)))


@dataclass
class Mesh:
    """Points (n, 3) and facets: tuples of 3 or 4 numbers of points, counter-clockwise seen from outside."""

    points: np.ndarray
    facets: list

    def write(self, path):
        """Gmsh 2.2 text."""
        path.write_text(gmsh.text(self.points, [(2, None, [n + 1 for n in facet]) for facet in self.facets]))

    def split(self):
        """Every square cut along its first diagonal."""
        return Mesh(self.points, [t for a, b, c, d in self.facets for t in ((a, b, c), (a, c, d))])

    def largest_area(self):
        """Largest area of a facet, of squares half the vector product of their diagonals."""
        def area(facet):
            p = self.points[list(facet)]
            d, e = (p[1] - p[0], p[2] - p[0]) if len(facet) == 3 else (p[2] - p[0], p[3] - p[1])
            return 0.5 * np.linalg.norm(np.cross(d, e))
        return max(map(area, self.facets))


def grid(m, n, point):
    """m x n squares over point(i, j); outwards is to the left of i, behind j."""
    points = np.array([point(i, j) for j in range(n + 1) for i in range(m + 1)])
    corner = [(m + 1) * j + i for j in range(n) for i in range(m)]
    return Mesh(points, [(k, k + 1, k + m + 2, k + m + 1) for k in corner])


def arc(elements, angle):
    """A strip of facets over a part of the unit cylinder, 0 <= z <= 1."""
    return grid(elements, 1, lambda i, j: (math.cos(angle * i / elements), math.sin(angle * i / elements), j))


def cubed_sphere(n):
    """The face z > 0 of a cube blown up to the unit sphere, n x n squares of equal angles."""
    def point(i, j):
        x = np.array([math.tan(math.pi / 4 * (2 * k / n - 1)) for k in (i, j)] + [1.0])
        return x / np.linalg.norm(x)
    return grid(n, n, point)


def band(n):
    """A quarter of the unit sphere's band between 60 degrees south and north, n x n squares."""
    def point(i, j):
        longitude, latitude = math.pi / 2 * i / n, math.radians(60) * (2 * j / n - 1)
        return (math.cos(latitude) * math.cos(longitude), math.cos(latitude) * math.sin(longitude), math.sin(latitude))
    return grid(n, n, point)


class Study:
    """Measures in a folder and keeps the comparisons."""

    def __init__(self, folder):
        self.folder = folder
        self.checks = []  # (what, found, expected, difference, limit)

    def scene(self, name, shape, mesh=None, bezier=None):
        """A tool that is given as a mesh with exact normals or as Bézier patches, and by its closed form."""
        lines = ["[tool.part]"]
        if mesh:
            mesh.write(self.folder / f"{name}.msh")
            lines += [f'mesh = "{name}.msh"', f'normals = "{shape}"', "feature_angle = 180.0"]
        if bezier:
            (self.folder / f"{name}.bpt").write_text(bezier)
            lines += [f'bezier = "{name}.bpt"', 'smoothing = "bezier"']
        forms = {"cylinder": "{ point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 1.0 }",
                 "sphere": "{ center = [0.0, 0.0, 0.0], radius = 1.0 }"}
        lines.append(f"{shape} = {forms[shape]}")
        path = self.folder / f"{name}.toml"
        path.write_text("\n".join(lines + [""]))
        return path

    def measure(self, scene, description, *options):
        """The folder with the results of `nagata surface`, and its summary."""
        out = self.folder / f"{scene.stem}-{description}"
        command = [PROGRAM, "surface", scene, "--description", description, "--out", out, *options]
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False,
                              env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
        if done.returncode:
            sys.exit(f"{' '.join(map(str, command))}\n{done.stderr}")
        return out, json.loads((out / "summary.json").read_text())

    def check(self, what, found, expected, limit=LIMIT, absolute=False):
        difference = abs(found - expected) if absolute else abs(found / expected - 1)
        self.checks.append((what, found, expected, difference, limit))

    def claim(self, what, holds):
        self.checks.append((what, holds, True, 0.0 if holds else math.inf, 0.0))

    def failures(self):
        return [check for check in self.checks if not check[3] <= check[4]]


def closed_forms(beta):
    """Largest radial and normal errors (degrees) of a straight and a Nagata edge over the angle beta of the circle.

    With C = cos(beta/2) and T = tan(beta/2): straight 1 - C and beta/2; Nagata (1 - C)^2 / (2 C) and the maximum over
    0 <= s <= 1 of |atan(T s) - atan(T s / (1 + T^2 (1 - s^2) / 2))|.
    """
    c, t = math.cos(beta / 2), math.tan(beta / 2)

    def angle(s):
        return abs(math.atan(t * s) - math.atan(t * s / (1 + t * t * (1 - s * s) / 2)))

    low, high = 0.0, 1.0
    for _ in range(200):  # the maximum is the only one
        a, b = low + (high - low) * 0.382, low + (high - low) * 0.618
        low, high = (a, high) if angle(a) < angle(b) else (low, b)
    return {"facet": (1 - c, math.degrees(beta / 2)),
            "nagata": ((1 - c) ** 2 / (2 * c), math.degrees(angle(0.5 * (low + high))))}


def bezier_arc():
    """The quarter of the unit circle as a cubic with its middle on the circle, drawn out along z; its largest error.

    Control points (1, 0), (1, k), (k, 1), (0, 1) with k = 4/3 (sqrt 2 - 1). The radial error is zero at both ends and
    in the middle, with one maximum in each half.
    """
    k = 4 / 3 * (math.sqrt(2) - 1)
    control = [(1, 0), (1, k), (k, 1), (0, 1)]
    text = "\n".join(["1", "3 1"] + [f"{x:.17g} {y:.17g} {z}" for z in (0, 1) for x, y in control] + [""])

    def error(t):
        b = [(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t ** 3]
        return math.hypot(*(sum(w * p[i] for w, p in zip(b, control)) for i in (0, 1))) - 1

    low, high = 0.0, 0.5
    for _ in range(200):
        a, b = low + (high - low) * 0.382, low + (high - low) * 0.618
        low, high = (a, high) if error(a) < error(b) else (low, b)
    return text, error(0.5 * (low + high))


def profile(out):
    """Along the arc z = 0: angles in degrees, radial errors, normal errors in degrees; nan between the pieces."""
    with h5py.File(out / "surface.h5") as file:
        (name, points), = ((name, grid["points"][:]) for name, grid in file["grids"].items())
        fields = file["increments/000001"][name]["node"]
        radial, normals = fields["distance_error"][:], fields["normal"][:]
    side = math.isqrt(len(points) // pieces_in(out))
    first_rows = (field.reshape(-1, side, side, *field.shape[1:])[:, 0] for field in (points, radial, normals))
    points, radial, normals = first_rows
    angles = np.degrees(np.arctan2(points[..., 1], points[..., 0]))
    turned = np.degrees(np.arctan2(normals[..., 1], normals[..., 0])) - angles
    below = np.flatnonzero((abs(points[..., 2]) < 1e-9).all(axis=1))
    below = below[np.argsort(angles[below, 0])]
    gap = np.full((len(below), 1), np.nan)
    return [np.hstack([field[below], gap]).ravel() for field in (angles, radial, turned)]


def pieces_in(out):
    with open(out / "errors.csv", newline="") as file:
        return sum(1 for _ in csv.DictReader(file))


def largest(summary):
    """Largest |distance error|, and normal error in degrees."""
    ends = [abs(summary[key]["value"]) for key in ("distance_max", "distance_min")]
    return max(ends), summary["normal_max_deg"]["value"]


def order(x, y):
    """Convergence order from the last two points that are an octave apart."""
    return math.log(y[-2] / y[-1]) / math.log(x[-2] / x[-1])


def style(axes, xlabel, ylabel, title=None):
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    axes.grid(True, which="major", color="0.9", linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    if title:
        axes.set_title(title, loc="left")


def figure_25(study, axes):
    """A quarter of a circle in 34 straight segments, in 4 Nagata edges, and as one cubic."""
    text, bezier_error = bezier_arc()
    cases = [("34 straight segments", LINEAR, "facet", study.scene("quarter-34", "cylinder", arc(34, math.pi / 2)),
              closed_forms(math.pi / 68)["facet"][0]),
             ("4 Nagata edges", NAGATA, "nagata", study.scene("quarter-4", "cylinder", arc(4, math.pi / 2)),
              closed_forms(math.pi / 8)["nagata"][0]),
             ("1 cubic Bézier curve", BEZIER, "bezier", study.scene("quarter-bezier", "cylinder", bezier=text),
              bezier_error)]
    for label, color, description, scene, expected in cases:
        out, summary = study.measure(scene, description, "--against", "cylinder", "--samples", 97, "--refine")
        angles, radial, _ = profile(out)
        axes.plot(angles, 1e4 * radial, color=color, linewidth=1.2, label=label)
        study.check(f"Fig. 25, {label}: largest radial error", largest(summary)[0], expected)
    style(axes, "angle along the arc, degrees", "radial error / r, 10$^{-4}$", "Fig. 25  Quarter of a circle")
    axes.set_xlim(0, 90)
    axes.set_ylim(-3.2, 3.9)
    axes.set_xticks(range(0, 91, 15))
    axes.legend(loc="upper center", ncols=3, fontsize=7)


def figures_26_27(study, radial_axes, normal_axes):
    """Two neighbouring elements of a half circle in 8, 10 and 12."""
    for column, description in enumerate(("facet", "nagata")):
        for count, shade in zip((8, 10, 12), (1.0, 0.65, 0.35)):
            beta = math.pi / count
            scene = study.scene(f"half-{count}", "cylinder", arc(count, math.pi))
            out, summary = study.measure(scene, description, "--against", "cylinder", "--samples", 97, "--refine")
            angles, radial, turned = profile(out)
            first = slice(2 * 98, 4 * 98)  # the third and fourth element
            s = (angles[first] - math.degrees(2 * beta)) / math.degrees(beta)
            label = rf"$\beta$ = {180 / count:g}°"
            color = LINEAR if description == "facet" else NAGATA
            options = {"color": color, "alpha": shade, "linewidth": 1.3, "label": label}
            radial_axes[column].plot(s, (1e2 if column == 0 else 1e4) * radial[first], **options)
            normal_axes[column].plot(s, turned[first], **options)
            expected = closed_forms(beta)[description]
            for name, found, value in zip(("radial", "normal"), largest(summary), expected):
                study.check(f"Figs. 26, 27, half circle in {count}, {description}: largest {name} error", found, value)
    for column, (name, power) in enumerate((("straight", 2), ("Nagata", 4))):
        style(radial_axes[column], "element", rf"radial error / r, 10$^{{-{power}}}$", f"Fig. 26  {name}")
        style(normal_axes[column], "element", "normal error, degrees", f"Fig. 27  {name}")
        for axes in (radial_axes[column], normal_axes[column]):
            low, high = axes.get_ylim()
            axes.set_ylim(low, high + 0.15 * (high - low))  # room for the legend
            axes.set_xlim(0, 2)
            axes.set_xticks((0, 0.5, 1, 1.5, 2))
            axes.legend(fontsize=7, loc="upper center", ncols=3)


def figure_28(study, axes):
    """Largest errors of 1 to 20 elements a quarter."""
    counts = range(1, 21)
    lengths = [math.pi / 2 / n for n in counts]
    found = {"facet": ([], []), "nagata": ([], [])}
    for n in counts:
        scene = study.scene(f"arc-{n}", "cylinder", arc(n, math.pi / 2))
        expected = closed_forms(math.pi / 2 / n)
        for description, values in found.items():
            _, summary = study.measure(scene, description, "--against", "cylinder", "--refine")
            truths = expected[description]
            for name, series, value, truth in zip(("radial", "normal"), values, largest(summary), truths):
                series.append(value)
                study.check(f"Fig. 28, {n} a quarter, {description}: largest {name} error", value, truth)
    for column, (name, unit) in enumerate((("radial error / r", ""), ("normal error", ", degrees"))):
        lines = (("facet", LINEAR, "o", 2 - column), ("nagata", NAGATA, "s", 4 - column))
        for description, color, marker, slope in lines:
            y = found[description][column]
            rate = order(lengths[9::10], y[9::10])
            label = f"{'straight' if description == 'facet' else 'Nagata'}, order {rate:.2f}"
            axes[column].loglog(lengths, y, color=color, marker=marker, markersize=3, linewidth=1, label=label)
            study.check(f"Fig. 28, {description}: order of the {name.split()[0]} error", rate, slope, 0.1, True)
        style(axes[column], "length of an element / r", f"largest {name}{unit}", "Fig. 28  Circle")
        axes[column].legend(fontsize=7, loc="upper left")
    study.claim("Fig. 28b: straight elements stay above 2 degrees", min(found["facet"][1]) > 2)
    study.claim("Fig. 28b: Nagata elements stay below 1 degree but for one a quarter", max(found["nagata"][1][1:]) < 1)


def figure_29(study, axes, mesh):
    """Largest errors on a sphere against the square root of the largest area of a facet."""
    make, title = (cubed_sphere, "cubed sphere") if mesh == "cubed" else (band, "band to 60° latitude")
    curves = {}
    for kind, description in itertools.product(("quads", "triangles"), ("facet", "nagata")):
        x, series = [], ([], [])
        for n, expected in SPHERE[mesh, kind, description].items():
            squares = make(n)
            facets = squares if kind == "quads" else squares.split()
            scene = study.scene(f"{mesh}-{kind}-{n}", "sphere", facets)
            _, summary = study.measure(scene, description, "--against", "sphere", "--samples", 13)
            x.append(math.sqrt(facets.largest_area()))
            for name, values, value, truth in zip(("radial", "normal"), series, largest(summary), expected):
                values.append(value)
                study.check(f"Fig. 29, {title}, {kind}, {description}, n = {n}: largest {name} error", value, truth)
        curves[kind, description] = x, series
        color, marker = LINEAR if description == "facet" else NAGATA, "s" if kind == "quads" else "^"
        for column, values in enumerate(series):
            slope = (2 if description == "facet" else 4) - column
            rate = order(x, values)
            label = f"{'facets' if description == 'facet' else 'Nagata'}, {kind}, order {rate:.2f}"
            axes[column].loglog(x, values, color=color, marker=marker, markersize=4, linewidth=1, label=label,
                                linestyle="-" if kind == "quads" else "--", markerfacecolor="white")
            study.check(f"Fig. 29, {title}, {kind}, {description}: order of the {('radial', 'normal')[column]} error",
                        rate, slope, 0.1, True)
    for column, name in enumerate(("radial error / R", "normal error, degrees")):
        style(axes[column], r"$\sqrt{A_{\mathrm{max}}}$ / R", f"largest {name}", f"Fig. 29  Sphere, {title}")
        axes[column].set_ylim(bottom=axes[column].get_ylim()[0] / (200, 50)[column])  # room for the legend
        axes[column].legend(fontsize=7, loc="lower right")
    if mesh == "cubed":
        for description in ("facet", "nagata"):
            (xq, (rq, _)), (xt, (rt, _)) = curves["quads", description], curves["triangles", description]
            low, high = math.log(max(xq[-1], xt[-1])), math.log(min(xq[0], xt[0]))
            at = np.linspace(low, high, 200)
            quads, triangles = (np.interp(at, np.log(x[::-1]), np.log(r[::-1])) for x, r in ((xq, rq), (xt, rt)))
            below = bool((quads < triangles).all())
            study.claim(f"Fig. 29a: quads are below triangles at equal area, {description}", below)


def blind_spots(study):
    """The patch that each point of a plane is projected on, -1 for none: {(z, description, extension): 301 x 301}."""
    line = np.linspace(-0.9, 0.9, 301)
    x, y = np.meshgrid(line, line)
    scene = study.scene("blind-spots", "sphere", cubed_sphere(4))
    patches = {}
    for z, expected in BLIND.items():
        points = study.folder / "points.csv"
        columns = np.stack([x.ravel(), y.ravel(), np.full(x.size, z)], 1)
        np.savetxt(points, columns, "%.17g", ",", header="x,y,z", comments="")
        inside = (np.abs(x) < z) & (np.abs(y) < z)
        cases = [("facet", 0.0, expected[0]), ("nagata", 0.0, expected[1]), ("nagata", 0.01, expected[2])]
        for description, extension, fraction in cases + [("facet", 0.01, None)]:
            out, summary = study.measure(scene, description, "--points", points, "--extension", extension)
            with open(out / "projections.csv", newline="") as file:
                rows = [(row["kind"], int(row["patch"])) for row in csv.DictReader(file)]
            found = np.array([patch if kind in ("normal", "extended") else -1 for kind, patch in rows]).reshape(x.shape)
            patches[z, description, extension] = found
            if fraction is not None:
                name = f"Fig. 34, z / R = {z}, {description}, extension {extension}: points without normal projection"
                study.check(name, float((found[inside] < 0).mean()), fraction, BLIND_LIMIT, True)
            if description == "nagata" and z == 1.1 and extension == 0:
                study.check("Fig. 34: largest angle between neighbouring patches, degrees",
                            summary["normal_jump_deg"]["smooth"], JUMP)
    return patches


def draw_section(axes, z):
    """The middle section of the sphere with its facets, and the plane z; white wedges are seen by no facet."""
    angle = np.radians(np.linspace(-45, 45, 5))
    fine = np.radians(np.linspace(-45, 45, 200))
    for a, b in zip(angle, angle[1:]):
        start, end, normal = (np.array((math.sin(c), math.cos(c))) for c in (a, b, (a + b) / 2))
        prism = [start, *(corner + normal * (z - corner[1]) / normal[1] for corner in (start, end)), end]
        axes.fill(*zip(*prism), color="#f0d9d2", linewidth=0)
    axes.plot(np.sin(fine), np.cos(fine), color=NAGATA, linewidth=1.4, label="sphere")
    axes.plot(np.sin(angle), np.cos(angle), color=LINEAR, linewidth=1, marker="o", markersize=3, label="facets")
    axes.plot((-0.9, 0.9), (z, z), color="0.25", linewidth=2, label="points, z = 1.1 R")
    axes.set_aspect("equal")
    axes.set_xlim(-0.95, 0.95)
    axes.set_ylim(0.1, 1.75)
    axes.set_axis_off()
    axes.legend(loc="lower center", fontsize=8)
    axes.set_title("Fig. 33  Section, and what facets see", fontsize=9, loc="left")


def figures_33_34(study, folder, docs):
    patches = blind_spots(study)
    z = 1.1
    shades = (0, 2, 4, 6, 8, 10, 12, 16, 18, 1, 3, 5, 7, 9, 11, 13)
    colors = matplotlib.colors.ListedColormap(["white"] + [plt.get_cmap("tab20")(k) for k in shades])
    figure, axes = plt.subplots(1, 5, figsize=(12.5, 2.9), width_ratios=(1.15, 1, 1, 1, 1), constrained_layout=True)
    draw_section(axes[0], z)
    panels = [("facet", 0.0, "facets"), ("facet", 0.01, "facets, extension 0.01"),
              ("nagata", 0.0, "Nagata"), ("nagata", 0.01, "Nagata, extension 0.01")]
    for panel, (description, extension, name) in zip(axes[1:], panels):
        found = patches[z, description, extension]
        panel.imshow(found + 1, cmap=colors, vmin=-0.5, vmax=16.5, origin="lower", interpolation="nearest",
                     extent=(-0.9, 0.9, -0.9, 0.9))
        panel.set_xticks(())
        panel.set_yticks(())
        panel.set_title(f"Fig. 34  {name}", fontsize=9, loc="left")
        panel.set_xlabel(f"white: {100 * (found < 0).mean():.2f} % without projection", fontsize=8)
    save(figure, folder, "blind-spots", docs)


def save(figure, folder, name, docs):
    figure.savefig(folder / f"{name}.svg")
    figure.savefig(folder / f"{name}.png", dpi=150)
    if docs:
        small = docs / f"{name}.png"
        figure.savefig(small, dpi=100)
        with Image.open(small) as image:
            image.convert("RGB").quantize(256, dither=Image.Dither.NONE).save(small, optimize=True)
    plt.close(figure)


def draw(study, folder, docs):
    plt.rcParams.update({"font.size": 8, "axes.titlesize": 9, "legend.frameon": False, "svg.hashsalt": "nagata"})
    figure = plt.figure(figsize=(13, 9), constrained_layout=True)
    cells = figure.add_gridspec(3, 4)
    axes = [[figure.add_subplot(cells[row, column]) for column in range(2 if row == 0 else 0, 4)] for row in range(3)]
    figure_25(study, figure.add_subplot(cells[0, :2]))
    figures_26_27(study, axes[0], axes[1][:2])
    figure_28(study, axes[1][2:])
    figure_29(study, axes[2][:2], "cubed")
    figure_29(study, axes[2][2:], "band")
    save(figure, folder, "geometry", docs)
    figures_33_34(study, folder, docs)


def report(study, folder):
    """Writes geometry.md and prints what differs."""
    lines = ["# Geometry study", "", "| what | found | expected | difference | limit |", "|---|---|---|---|---|"]
    for what, found, expected, difference, limit in study.checks:
        if isinstance(found, bool):
            lines.append(f"| {what} | {'holds' if found else 'does not hold'} | | | |")
        else:
            lines.append(f"| {what} | {found:.9e} | {expected:.9e} | {difference:.1e} | {limit:.0e} |")
    (folder / "geometry.md").write_text("\n".join(lines + [""]))
    numbers = [check for check in study.checks if check[4] == LIMIT]
    worst = max(numbers, key=lambda check: check[3])
    print(f"{len(study.checks)} comparisons; largest relative difference {worst[3]:.1e}: {worst[0]}")
    for what, found, expected, difference, limit in study.failures():
        print(f"FAILED {what}: {found}, expected {expected}, difference {difference:.1e}, limit {limit:.0e}")


def main():
    parser = arguments(__doc__)
    add_out(parser, OUT / "geometry")
    parser.add_argument("--docs", type=Path, metavar="FOLDER", help="also write small pictures for the documents there")
    args = parser.parse_args()
    setup()
    runs = args.out / "runs"
    runs.mkdir(parents=True, exist_ok=True)
    study = Study(runs.resolve())
    draw(study, args.out, args.docs)
    report(study, args.out)
    return int(bool(study.failures()))


if __name__ == "__main__":
    sys.exit(main())

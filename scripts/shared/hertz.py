"""What the studies of the Hertz problems share: results of a run, and the solutions of Hertz, Cattaneo and Mindlin.

Both bodies are of one material: E* = E / 2 (1 - nu^2). Between smooth walls and on a smooth base a body is one cell of
a layer under a periodic array of loads, whose sinking is a Fourier series.
"""

import csv
from dataclasses import dataclass

from shared.scientific import h5py, np

POISSON = 0.3


@dataclass
class Problem:
    """Young's modulus, radius of the upper body, sides (half of the width) and heights of both bodies."""
    young: float
    radius: float
    side: float
    height: float

    @property
    def body(self):
        """The upper one."""
        return self.column.partition(".")[0]

    @property
    def modulus(self):
        return self.young / 2 / (1 - POISSON**2)

    def layer(self, k):
        """By how much a layer sinks under a pressure cos(k x) of one: Johnson, Contact Mechanics, 5.8."""
        w = np.minimum(2 * k * self.height, 100.0)
        return 1 / (self.modulus * k) * (np.cosh(w) - 1) / (np.sinh(w) + w)

    @property
    def uniform(self):
        """The same for an even pressure, between smooth walls."""
        return self.height * (1 + POISSON) * (1 - 2 * POISSON) / (self.young * (1 - POISSON))

    def force_at(self, approach):
        """The inverse of `approach`."""
        low, high = 0.0, self.young * self.side * self.height
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if self.approach(middle) < approach else (low, middle)
        return low


class Sphere(Problem):
    contact, column, share = "spot", "ball.back.fz", 0.25  # a quarter of the ball

    def size(self, force):
        """Radius of contact and highest pressure."""
        a = (0.75 * force * self.radius / self.modulus) ** (1 / 3)
        return a, 1.5 * force / (np.pi * a**2)

    def approach(self, force):
        """a^2 / R + F c. c is the limit of a narrow Gaussian load's centre on the layers, less that on half spaces."""
        spread = 0.02 * self.side
        waves = np.pi / self.side * np.arange(int(8 * self.side / (np.pi * spread)) + 1)
        k = np.hypot(*np.meshgrid(waves, waves))
        times = np.outer(*2 * [np.r_[1, 2 * np.ones(len(waves) - 1)]])
        k[0, 0], times[0, 0] = 1, 0
        series = 2 * self.uniform + 2 * (times * self.layer(k) * np.exp(-((k * spread) ** 2) / 2)).sum()
        softness = series / (4 * self.side**2) - 1 / (self.modulus * spread * np.sqrt(2 * np.pi))
        return self.size(force)[0] ** 2 / self.radius + force * softness


class Cylinder(Problem):
    contact, column, share = "strip", "roller.back.fy", 1.0  # thickness of the layer

    def size(self, force):
        b = 2 * np.sqrt(force * self.radius / (np.pi * self.modulus))
        return b, 2 * force / (np.pi * b)

    def approach(self, force):
        """Sum over the waves of the array of 2 J1(k b) / (k b), the transform of Hertz's pressure."""
        k = np.pi / self.side * np.arange(1, int(200 * self.side / self.size(force)[0]))
        angle = np.pi * (np.arange(1, 401) - 0.5) / 800  # the transform by Chebyshev's rule
        kb = k * self.size(force)[0]
        shape = (np.sin(angle) ** 2 * np.cos(np.outer(kb, np.cos(angle)))).sum(axis=1) / (np.sin(angle) ** 2).sum()
        return force / (2 * self.side) * 2 * (self.uniform + 2 * (self.layer(k) * shape).sum())


SPHERE = Sphere(1000.0, 50.0, 8.0, 8.0)
CYLINDER = Cylinder(210e3, 50.0, 6.0, 6.0)
FRICTION = 0.3


def roller_layer(thickness):
    """The roller, of which a layer so thick is modelled."""
    problem = Cylinder(CYLINDER.young, CYLINDER.radius, CYLINDER.side, CYLINDER.height)
    problem.share = thickness
    return problem


class Result:
    """The end of a run: force, approach, and pressure and shear traction over the distance from the middle."""

    def __init__(self, folder, problem):
        self.problem = problem
        with open(folder / "history.csv", newline="") as file:
            row = list(csv.DictReader(file))[-1]
        self.force = -float(row[problem.column]) / problem.share
        self.shear_force = float(row[problem.column[:-1] + "x"]) / problem.share
        self.approach = -float(row[problem.column.replace(".f", ".u")])
        with h5py.File(folder / "fields.h5") as file:
            grid = f"contact_{problem.contact}"
            points = file[f"grids/{grid}/points"][:].reshape(-1, 3)
            fields = file[f"increments/{max(file['increments'])}/{grid}/node"]
            pressure = fields["pressure"][:]
            traction, normal = (fields[name][:].reshape(-1, 3) for name in ("traction", "normal"))
        spherical = isinstance(problem, Sphere)
        place = np.hypot(points[:, 0], points[:, 1]) if spherical else points[:, 0]
        order = np.flatnonzero(spherical | (points[:, 2] == 0))
        order = order[np.argsort(place[order])]
        along = normal[:, 1] * traction[:, 0] - normal[:, 0] * traction[:, 1]
        self.place, self.pressure, self.shear = place[order], pressure[order], np.abs(along[order])

    @property
    def hertz(self):
        """Radius and highest pressure of Hertz under the force that was found."""
        return self.problem.size(self.force)

    def pressure_error(self):
        """Root of the mean square of the pressures in the contact less Hertz's, over his highest."""
        a, p0 = self.hertz
        inside = np.abs(self.place) < a
        return np.sqrt(np.mean((self.pressure - arch(self.place, a, p0))[inside] ** 2)) / p0

    def shear_errors(self):
        """The same of the shear tractions, and the largest."""
        exact = cattaneo_mindlin(self.place, self)
        off = (self.shear - exact)[np.abs(self.place) < self.hertz[0]] / exact.max()
        return np.sqrt(np.mean(off**2)), np.abs(off).max()

    def errors(self, with_shear):
        """By how much they are off: force, fitted radius, highest pressure, pressures; with shear, and then without the
        force, the half-width that sticks, shear tractions and the largest of their errors. None where there is none."""
        (a, p0), (fitted, _) = self.hertz, self.fitted()
        errors = [None if with_shear else self.force / self.problem.force_at(self.approach) - 1, fitted / a - 1,
                  self.pressure.max() / p0 - 1, self.pressure_error()]
        if not with_shear:
            return errors + [None] * 3
        found, exact = self.stick()
        return [*errors, found / exact - 1, *self.shear_errors()]

    def fitted(self):
        """The same from the ellipse through the pressures."""
        return ellipse(self.place, self.pressure)

    def stick(self):
        """Half-width of the strip that sticks, from the ellipse through mu p - q, and that of Cattaneo and Mindlin."""
        b, _ = self.hertz
        found, _ = ellipse(self.place, FRICTION * self.pressure - self.shear)
        return found, b * np.sqrt(1 - self.shear_force / (FRICTION * self.force))


def ellipse(place, value):
    """Half-axes (a, v0) of value^2 = v0^2 (1 - place^2 / a^2) through the upper half of the values."""
    used = value > 0.5 * value.max()
    slope, top = np.polyfit(place[used] ** 2, value[used] ** 2, 1)
    return np.sqrt(-top / slope), np.sqrt(top)


def arch(place, half, height):
    """height sqrt(1 - (place / half)^2), zero outside."""
    return height * np.sqrt(np.maximum(0.0, 1 - (place / half) ** 2))


def cattaneo_mindlin(place, result):
    """Shear traction under the forces that were found."""
    b, p0 = result.hertz
    c = result.stick()[1]
    return arch(place, b, FRICTION * p0) - arch(place, c, FRICTION * p0 * c / b)

#!/usr/bin/python3 -B
"""Frictional contact of an elastic disk of radius R - c in a bore of radius R of a plate of the same material, c << R,
under a growing force Q at the centre of the disk: pressure p and shear s of the rim by the angle from the line of the
force. Writes them as CSV with the columns theta (degrees), p R/Q and s R/Q, at the load at which the contact reaches to
--angle, and prints some.

Method. Linear elasticity with the boundary conditions on r = R for both bodies. Stress and displacement in an annulus
follow from Kolosov's potentials phi and psi (Muskhelishvili, Basic Problems of the Mathematical Theory of Elasticity):

    s_rr - i s_rt   = phi' + (phi')* - exp(2 i t) (z* phi'' + psi')
    2 G (u_r - i u_t) = exp(i t) (kappa phi* - z* phi' - psi)

For z^k with real coefficients both are sums of exp(i n t) and exp(-i n t) with n = |k - 1| for phi and n = |k + 1| for
psi, so that each Fourier mode n of the tractions gives a system of at most four equations; n = 1 has the logarithms of
the force, too. With tractions (p cos n t, s sin n t), for n >= 2 and an infinite plate, plate less disk is

    E* u_r = (2 n p + 2 s) / (n^2 - 1) cos n t,     E* u_t = -(2 p + 2 n s) / (n^2 - 1) sin n t

Tractions are piecewise linear between nodes of equal spacing h, their modes are summed until they vanish, and the
conditions hold at the nodes:

    gap     c - D cos t + u_r(plate) - u_r(disk) = 0        D the translation of the disk towards the contact
    stick   v = v0, v = -D sin t + u_t(disk) - u_t(plate), v0 its value at the last load
    slip    s = mu p

The load grows so that one node after the other touches: its gap and its pressure vanish. As h goes to 0 this is the
limit of infinitely many increments. Lengths are in c, tractions in E* c / R with E* = E / (2 (1 - nu^2)).

Checked against the closed form of frictionless contact in an infinite plate: Q = 1.8741 E* c and p(0) R/Q = 0.71172 at
60 degrees (Persson 1964; Ciavarella and Decuzzi, Int. J. Solids Struct. 38 (2001) 4507-4523): --friction 0 --outer 0.
"""

import csv
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shared import OUT, add_out, arguments, written
from shared.scientific import np

FULL = 32  # modes are summed to FULL times as many as nodes around the rim
OUTER_MODES = 40  # beyond, the outer rim of a plate is not felt


def phi(k, kappa, r):
    """Stress and 2 G times displacement of phi = z^k at r: coefficients of exp(i (k - 1) t) and exp(-i (k - 1) t)."""
    return k * r ** (k - 1.0) * np.array([2.0 - k, 1.0]), r ** float(k) * np.array([-k, kappa])


def psi(k, r):
    """The same of psi = z^k: of exp(i (k + 1) t) and exp(-i (k + 1) t)."""
    return -k * r ** (k - 1.0) * np.array([1.0, 0.0]), -r ** float(k) * np.array([1.0, 0.0])


def basis(n, kappa, r, outer):
    """Stresses and displacements at r of phi = (z/outer)^(1+n), psi = (z/outer)^(n-1), phi = z^(1-n), psi = z^(-n-1):
    columns of coefficients of exp(i n t) and exp(-i n t)."""
    grown = [[x * outer ** -power for x in pair] for pair, power in
             ((phi(1 + n, kappa, r), 1.0 + n), (psi(n - 1, r), n - 1.0))]
    turned = [[x[::-1] for x in pair] for pair in (phi(1 - n, kappa, r), psi(-n - 1, r))]
    return [np.array([pair[part] for pair in grown + turned]).T for part in (0, 1)]


def mode(n, stress, kappa, outer):
    """2 G (u_r - i u_t) of plate less disk on r = 1 under a stress there, n >= 2, as coefficients like those."""
    stresses, moves = basis(n, kappa, 1.0, 1.0)
    disk = moves[:, :2] @ np.linalg.solve(stresses[:, :2], stress)
    if not outer:
        return moves[:, 2:] @ np.linalg.solve(stresses[:, 2:], stress) - disk
    (stresses, moves), (_, rim) = basis(n, kappa, 1.0, outer), basis(n, kappa, outer, outer)
    return moves @ np.linalg.solve(np.vstack([stresses, rim]), np.r_[stress, 0.0, 0.0]) - disk


def first_mode(stress, kappa, outer):
    """The same for n = 1, but for translations. phi = -q log z, psi = kappa q log z have the resultant."""
    q = -stress[0] / (1.0 + kappa)
    rest = stress[1] + 2.0 * q
    disk, a, b = rest / 2.0, 0.0, rest / 2.0  # phi = disk z^2; phi = a z^2, psi = b / z^2 of the plate
    if outer:
        a, b = np.linalg.solve([[2.0, 2.0], [kappa * outer ** 2, -outer ** -2.0]], [rest, -q])
    return np.array([-2.0 * (a - disk), kappa * (a - disk) - b])


def uniform(kappa, outer):
    """2 G u_r of plate less disk under a pressure 1 all around: phi = a z, psi = b / z."""
    a, b = 0.0, -1.0
    if outer:
        a, b = np.linalg.solve([[2.0, 1.0], [(kappa - 1.0) * outer, -1.0 / outer]], [-1.0, 0.0])
    return (kappa - 1.0) * (a + 0.5) - b


def compliances(count, poisson, outer):
    """E* (u_r, u_t) of plate less disk by (p, s) for the modes 0 ... count - 1; in all u_t and s are sines."""
    kappa = 3.0 - 4.0 * poisson
    n = np.arange(count)
    with np.errstate(divide="ignore", invalid="ignore"):
        result = (2.0 / (n ** 2.0 - 1.0) * np.array([[n, 1.0 + 0 * n], [-1.0 - 0 * n, -n]])).transpose(2, 0, 1)
    per_shear = 2.0 / (kappa + 1.0)  # E* / 2 G
    result[0] = [[per_shear * uniform(kappa, outer), 0.0], [0.0, 0.0]]
    for k in range(1, OUTER_MODES + 1 if outer else 2):
        for column, stress in enumerate(([-0.5, -0.5], [-0.5, 0.5])):
            given = np.array(stress), kappa, outer
            one, other = first_mode(*given) if k == 1 else mode(k, *given)
            result[k, :, column] = per_shear * (one + other), per_shear * (other - one)
    return result


class Rim:
    """Influence of the tractions at nodes t = i h, i = 0 ... count - 1, on gap and slip there, and on the force."""

    def __init__(self, cells, count, poisson, outer):
        self.h, around = np.radians(1.0 / cells), 360 * cells
        self.t = self.h * np.arange(count)
        n = np.arange(FULL * around)
        hat = self.h / np.pi * np.sinc(n * self.h / (2 * np.pi)) ** 2
        hat[0] *= 0.5
        by_mode = compliances(len(n), poisson, outer) * hat[:, None, None]
        i, j = np.meshgrid(np.arange(count), np.arange(count), indexing="ij")
        mirrored = np.where(np.arange(count) > 0, 2.0, 1.0)

        def waves(row, column):
            """Sums of values_n cos(n m h) and values_n sin(n m h), by m."""
            sums = np.fft.fft(by_mode[:, row, column].reshape(FULL, around).sum(0))
            return sums.real, -sums.imag

        cosines, sines = waves(0, 0)[0], waves(0, 1)[1]
        self.gap_by_p = (cosines[i - j] + cosines[i + j]) / 2 * mirrored
        self.gap_by_s = sines[i + j] - sines[i - j]
        sines, cosines = waves(1, 0)[1], waves(1, 1)[0]
        self.slip_by_p = -(sines[i + j] + sines[i - j]) / 2 * mirrored
        self.slip_by_s = -(cosines[i - j] - cosines[i + j])
        weight = self.h * np.sinc(self.h / (2 * np.pi)) ** 2
        self.force_by_p, self.force_by_s = weight * mirrored * np.cos(self.t), weight * 2 * np.sin(self.t)


class State:
    """Contact of the nodes 0 ... edge - 1: status 0 of nodes that stick, else the sign of their shear."""

    def __init__(self, rim, friction):
        self.rim, self.friction, self.edge, self.force = rim, friction, 2, 0.0
        self.p, self.s = np.zeros(len(rim.t)), np.zeros(len(rim.t))
        self.status = np.full(len(rim.t), 0 if friction else 1)
        self.slip = -np.sin(rim.t)  # the disk touches at t = 0

    def solve(self, edge, status, force):
        """Tractions, slip and gap with so many nodes in contact; without a force that at which node `edge` touches."""
        rim, n, free = self.rim, edge + (force is None), np.arange(1, edge)
        matrix, right = np.zeros((2 * edge, 2 * edge)), np.zeros(2 * edge)
        shear = slice(edge, 2 * edge - 1)  # unknowns: p of 0 ... edge - 1, s of 1 ... edge - 1, D
        matrix[:n, :edge], matrix[:n, shear] = rim.gap_by_p[:n, :edge], rim.gap_by_s[:n, 1:edge]
        matrix[:n, -1], right[:n] = -np.cos(rim.t[:n]), -1.0
        stuck, slips = free[status[free] == 0], free[status[free] != 0]
        row = n + stuck - 1
        matrix[row, :edge], matrix[row, shear] = rim.slip_by_p[stuck, :edge], rim.slip_by_s[stuck, 1:edge]
        matrix[row, -1], right[row] = -np.sin(rim.t[stuck]), self.slip[stuck]
        row = n + slips - 1
        matrix[row, edge + slips - 1], matrix[row, slips] = 1.0, -self.friction * status[slips]
        if force is not None:
            matrix[-1, :edge], matrix[-1, shear], right[-1] = rim.force_by_p[:edge], rim.force_by_s[1:edge], force
        found = np.linalg.solve(matrix, right)
        p, s = np.zeros(len(rim.t)), np.zeros(len(rim.t))
        p[:edge], s[1:edge] = found[:edge], found[shear]
        slip = -np.sin(rim.t) * found[-1] + rim.slip_by_p @ p + rim.slip_by_s @ s
        gap = 1.0 - found[-1] * np.cos(rim.t) + rim.gap_by_p @ p + rim.gap_by_s @ s
        return p, s, slip, gap

    def go_on(self, edge=None, force=None):
        """To the load at which node `edge` touches, or to a force: finds what is in contact and what sticks."""
        edge, status, seen = edge or self.edge, self.status.copy(), set()
        for _ in range(4 * len(self.p)):
            p, s, slip, gap = self.solve(edge, status, force)
            new = np.where((status == 0) & (np.abs(s) > self.friction * p + 1e-12), np.sign(s).astype(int), status)
            new[(status != 0) & ((slip - self.slip) * status > 1e-12)] = 0
            changed = np.flatnonzero((new != status)[:edge] & (np.arange(edge) > 0)) if self.friction else []
            grow = int(force is not None and gap[edge] < -1e-12) - int(force is not None and p[edge - 1] < -1e-12)
            if not grow and not len(changed):
                self.edge, self.status, self.p, self.s, self.slip = edge, status, p, s, slip
                self.force = self.rim.force_by_p @ p + self.rim.force_by_s @ s
                return
            key = (edge, status.tobytes())
            changed = changed[-1:] if key in seen else changed
            seen.add(key)
            edge += grow
            status[changed] = new[changed]
        sys.exit("no state of contact was found; take fewer --cells or more increments")

    def stick(self):
        """The outermost node that sticks."""
        return max(np.flatnonzero(self.status[:self.edge] == 0), default=0)


def press(cells, given):
    """The state at which the contact has grown to the angle, node by node."""
    edge = round(given.angle * cells)
    state = State(Rim(cells, edge + 2, given.poisson, given.outer), given.friction)
    for k in range(2, edge + 1):
        state.go_on(edge=k)
    return state


def summary(label, state, force):
    """A line of a table: the angle to which nodes stick, and tractions times R/Q."""
    cells = round(np.radians(1.0) / state.rim.h)
    at = [state.s[angle * cells] for angle in (10, 20, 30, 40, 50) if angle * cells < len(state.s)]
    values = np.array([state.p[0], *at, state.s.max()]) / state.force
    print(f"{label:<28}{force:9.5f}{state.stick() / cells:8.2f} " + "".join(f"{x:9.4f}" for x in values))


def write(path, state):
    with open(written(path), "w", newline="", encoding="ascii") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(("theta", "p", "s"))
        for t, p, s in zip(state.rim.t, state.p, state.s):
            table.writerow(f"{x:.9g}" for x in (np.degrees(t), p / state.force, s / state.force))


def main():
    parser = arguments(__doc__)
    for name, default, meaning in (
        ("angle", 60.0, "half contact angle at the end, degrees"),
        ("friction", 0.4, "Coulomb's coefficient"),
        ("poisson", 0.3, "Poisson's ratio, plane strain"),
        ("outer", 10.0, "outer radius of the plate over R, fixed there; 0 for an infinite plate"),
    ):
        parser.add_argument(f"--{name}", type=float, default=default, metavar="X", help=f"{meaning} (%(default)g)")
    parser.add_argument("--cells", type=int, nargs="+", default=[2, 4], metavar="N",
                        help="nodes a degree, each twice the one before; Q and p(0) of the last two are extrapolated "
                        "(2 4)")
    parser.add_argument("--increments", type=int, nargs="*", default=[1, 5, 20, 100], metavar="N",
                        help="also, with a node a degree, the same load in so many equal increments (1 5 20 100)")
    parser.add_argument("--concentric", action="store_true",
                        help="these start from the middle of the bore, not from where the disk touches it")
    add_out(parser, OUT / "disk.csv")
    given = parser.parse_args()
    print(f"{'':<28}{'Q/E*c':>9}{'stick':>8} " +
          "".join(f"{x:>9}" for x in ("pR/Q 0", "sR/Q 10", "20", "30", "40", "50", "max")))
    states = [press(cells, given) for cells in given.cells]
    for cells, state in zip(given.cells, states):
        summary(f"{cells} nodes a degree", state, state.force)
    force = states[-1].force
    if len(states) > 1:
        coarse, fine = states[-2:]
        force = 2 * fine.force - coarse.force
        print(f"{'extrapolated':<28}{force:9.5f}{'':>9}{2 * fine.p[0] / fine.force - coarse.p[0] / coarse.force:9.4f}")
    write(given.out, states[-1])
    if not given.increments or not given.friction:
        return
    rim = Rim(1, int(given.angle) + 20, given.poisson, given.outer)
    for count in given.increments:
        state = State(rim, given.friction)
        state.slip *= not given.concentric
        for k in range(1, count + 1):
            state.go_on(force=states[0].force * k / count)
        summary(f"{count} equal increments", state, state.force)


if __name__ == "__main__":
    main()

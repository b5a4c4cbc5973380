"""What the studies of the frictional ironing problem share: forces against the slide, and their chatter.

The chatter is the force minus its moving average over one pitch of the slab's mesh, resampled linearly at an eighth of
the pitch.
"""

import csv
import sys

from shared.scientific import np

TAPS = 8  # samples a pitch


class Run:
    """Forces against the slide, from the results of a run."""

    def __init__(self, folder, tool, pitch):
        path = folder / "history.csv"
        with open(path, newline="") as file:
            rows = list(csv.DictReader(file))
        names = [f"{tool}.{c}" for c in ("ux", "uy", "fx", "fy")]
        missing = [n for n in names if not rows or n not in rows[0]]
        if missing:
            sys.exit(f"{path} has no rows or no column {missing[0]} (is the tool called so?)")
        ux, uy, fx, fy = (np.array([float(r[n]) for r in rows]) for n in names)
        self.iterations = sum(int(r["iterations"]) for r in rows)
        self.increments = len(rows)

        # The slide starts at the last row of the press, where u_x is still zero.
        sliding = np.flatnonzero(np.abs(ux) > 1e-9 * max(np.abs(ux).max(), pitch))
        start = max(sliding[0] - 1, 0) if sliding.size else len(ux) - 1
        self.depth = -uy[start]
        self.slide, self.v, self.h = ux[start:], -fy[start:], fx[start:]

        self.grid = np.arange(0.0, self.slide[-1] + 1e-9, pitch / TAPS)
        self.v_grid = np.interp(self.grid, self.slide, self.v)
        self.h_grid = np.interp(self.grid, self.slide, self.h)

    def at(self, slide):
        """V and H at a slide, or None beyond the end of the run."""
        if slide > self.slide[-1] + 1e-6:
            return None
        return np.interp(slide, self.slide, self.v), np.interp(slide, self.slide, self.h)

    def window(self, begin, end, pitch):
        """The samples between two slides, half a pitch and more away from the ends of the run."""
        end = min(end, self.grid[-1] - pitch)
        return (self.grid >= max(begin, pitch) - 1e-9) & (self.grid <= end + 1e-9)


def detrend(y):
    """y minus its centred moving average over one pitch: 9 taps, half weights at the ends."""
    weights = np.r_[0.5, np.ones(TAPS - 1), 0.5] / TAPS
    return y - np.convolve(y, weights, "same")

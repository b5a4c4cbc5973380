"""What scripts/studies/scaling.py makes of its runs and counts: a model of the costs, and plots."""

import math

from shared.scientific import matplotlib, np, plt

PROCESS = 60.0  # MB of a rank without a model
SHORT = 1e-3  # s, as exact as times are written


def rest(row):
    return row["wall_s"] - sum(row[phase] for phase in ("search", "watch", "assembly", "factor", "solve"))


def laws(**of_systems):
    """Of each phase what it takes, how often it is done, by what size it grows; `of_systems` are a solver's own."""
    return {
        "assembly": (lambda row: row["assembly"], "iterations", "elements"),
        "search": (lambda row: row["search"] + row["watch"], "iterations", "elements"),
        **{name.replace("_", " "): (lambda row, phase=phase: row[phase], often, "dofs")
           for name, (phase, often) in of_systems.items()},
        "rest": (rest, "increments", "elements"),
    }


LAWS = {
    "direct": laws(factor=("factor", "factorizations"), solve=("solve", "factorizations")),
    "reuse": laws(factor=("factor", "factorizations"), solve=("solve", "linear_iterations")),
    "iterative": laws(set_up=("factor", "iterations"), solve=("solve", "linear_iterations")),
}
MEMORY = (lambda row: sum(row["peak_memory_mb"]) - PROCESS * row["ranks"], None, "dofs")
NAMES = {"dofs": "unknowns", "linear_iterations": "linear iterations"}


class Law:
    """A cost = a * times * size^p * ranks^q, by least squares in logarithms; what does not vary has no exponent."""

    def __init__(self, rows, value, times, size):
        self.value, self.times, self.size = value, times, size
        x = np.array([self.place(row) for row in rows])
        y = np.array([math.log(max(value(row), SHORT) / self.often(row)) for row in rows])
        self.exponents = np.linalg.lstsq(x - x.mean(axis=0), y - y.mean(), rcond=1e-9)[0]
        self.constant = y.mean() - x.mean(axis=0) @ self.exponents

    def often(self, row):
        return max(row[self.times], 1.0) if self.times else 1.0

    def place(self, row):
        return math.log(row[self.size]), math.log(row["ranks"])

    def __call__(self, row):
        return self.often(row) * math.exp(self.constant + np.dot(self.place(row), self.exponents))

    def __str__(self):
        (p, q), times = self.exponents, f"{NAMES.get(self.times, self.times)} × " if self.times else ""
        size = NAMES.get(self.size, self.size)
        return f"{math.exp(self.constant):.1e} × {times}{size}^{p:.2f} × ranks^{q:.2f}"


HEAD = ["solver", "cost", "model", "error, median", "largest", "left out, median", "largest"]


class Model:
    """Laws of the phases and of the memory of one solver."""

    def __init__(self, solver, rows):
        self.solver, self.rows = solver, rows
        self.phases = {name: Law(rows, *law) for name, law in LAWS[solver].items()}
        self.memory = Law(rows, *MEMORY)

    def wall(self, row):
        return sum(law(row) for law in self.phases.values())

    def megabytes(self, row):
        return self.memory(row) + PROCESS * row["ranks"]

    def errors(self, row):
        """Relative ones: of each phase, of the wall time, of the memory."""
        ratios = [law(row) / max(law.value(row), SHORT) for law in self.phases.values()]
        ratios += [self.wall(row) / row["wall_s"], self.megabytes(row) / sum(row["peak_memory_mb"])]
        return [abs(ratio - 1) for ratio in ratios]

    def table(self):
        """A row for each cost: its law, its error, and that of runs foretold from the others."""
        others = [(row, [other for other in self.rows if other is not row]) for row in self.rows]
        left_out = [Model(self.solver, rows).errors(row) for row, rows in others if rows]
        laws = [(f"{name} s", str(law)) for name, law in self.phases.items()]
        laws += [("wall s", "their sum"), ("MB", f"{PROCESS:.0f} × ranks + {self.memory}")]
        columns = [pick(errors, axis=0) if errors else [math.nan] * len(laws)
                   for errors in ([self.errors(row) for row in self.rows], left_out) for pick in (np.median, np.max)]
        return [[SHOWN[self.solver], *law, *("" if math.isnan(error) else f"{100 * error:.0f} %" for error in errors)]
                for law, *errors in zip(laws, *columns)]


COLOURS = {"assembly": "#3b75af", "search": "#8d69b8", "factor": "#c53a32", "solve": "#ef8636", "rest": "#9d9d9d"}
SHOWN = {"direct": "factors", "reuse": "old factors", "iterative": "multigrid"}
MARKERS = {"direct": "s", "reuse": "^", "iterative": "o"}
HATCHES = {"direct": "", "reuse": "....", "iterative": "////"}
SHIFT = {"direct": -0.28, "reuse": 0.0, "iterative": 0.28}  # beside each other


def draw(rows, models, path):
    """A column for each series of a scene: time by phase, memory of each rank, iterations, messages; bars and marks of
    the solvers side by side."""
    series = list(dict.fromkeys((row["scene"], row["series"]) for row in rows))
    figure, axes = plt.subplots(4, len(series), figsize=(1.5 + 2.3 * len(series), 10.5), squeeze=False, sharey="row",
                                sharex="col", constrained_layout=True)
    for column, of_series in zip(axes.T, series):
        runs = [row for row in rows if (row["scene"], row["series"]) == of_series]
        places = sorted({(row["size"], row["n"], row["ranks"]) for row in runs})
        for row in runs:
            x = places.index((row["size"], row["n"], row["ranks"])) + SHIFT[row["solver"]]
            draw_run(column, x, row, models[row["solver"]])
        column[0].set_title(", ".join(of_series), fontsize=10)
        column[-1].set_xticks(range(len(places)), [f"{n:.0f}\n{ranks:.0f}" for _, n, ranks in places], fontsize=8)
        column[-1].set_xlim(-0.6, len(places) - 0.4)
    axes[-1, 0].set_xlabel("elements along the block\nranks", fontsize=8)
    labels = ["core time, µs\nan unknown and iteration", "memory of each rank, MB", "iterations",
              "messages of a rank\nan iteration"]
    for panels, label in zip(axes, labels):
        panels[0].set_ylabel(label)
        for panel in panels:
            panel.grid(alpha=0.3, axis="y")
            panel.set_axisbelow(True)
    axes[2, 0].set_ylim(bottom=0)
    for panel in axes[[1, 3], 0]:
        panel.set_yscale("log")
        panel.yaxis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1, 2, 5)))
        panel.yaxis.set_major_formatter("{x:g}")
        panel.yaxis.set_minor_formatter("")
    figure.legend(handles=key(), loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=5, fontsize=8, frameon=False)
    figure.savefig(path, dpi=110, bbox_inches="tight")


def draw_run(panels, x, row, model):
    time, memory, iterations, messages = panels
    scale = row["ranks"] / row["dofs"] / row["iterations"] * 1e6
    bottom = 0.0
    for phase, colour in COLOURS.items():
        height = (rest(row) if phase == "rest" else row[phase]) * scale
        time.bar(x, height, 0.26, bottom, color=colour, edgecolor="white", linewidth=0, hatch=HATCHES[row["solver"]])
        bottom += height
    time.plot(x, model.wall(row) * scale, "_", color="black", markersize=11)
    mark = {"marker": MARKERS[row["solver"]], "linestyle": "", "markersize": 4}
    of_ranks = row["peak_memory_mb"]
    memory.plot([x] * len(of_ranks), of_ranks, **mark, color="black", markerfacecolor="none")
    memory.plot(x, model.megabytes(row) / row["ranks"], "_", color="black", markersize=11)
    iterations.plot(x, row["iterations"], **mark, color="black")
    if row["linear_iterations"]:
        iterations.plot(x, row["linear_iterations"] / row["iterations"], **mark, color=COLOURS["solve"])
    if row["ranks"] > 1:
        messages.plot(x, max(row["messages"]) / row["iterations"], **mark, color="black")


def key():
    patch, line = matplotlib.patches.Patch, matplotlib.lines.Line2D
    phases = [patch(color=colour, label="factor or set up" if phase == "factor" else phase)
              for phase, colour in COLOURS.items()]
    solvers = [line([], [], color="black", marker=MARKERS[s], linestyle="", markersize=4, label=f"{shown} ({side})")
               for (s, shown), side in zip(SHOWN.items(), ("left", "middle", "right"))]
    return [*phases, *solvers,
            line([], [], color="black", marker="_", linestyle="", markersize=11, label="model"),
            line([], [], color="black", marker=".", linestyle="", label="iterations of Newton's method"),
            line([], [], color=COLOURS["solve"], marker=".", linestyle="", label="of the linear solver, a system")]


# Quantities of a rank that are counted, and how they are called.
COUNTED = {
    "elements": "elements assembled",
    "unknowns": "unknowns",
    "entries": "entries of the matrix",
    "neighbours": "messages an exchange",
    "kb": "kB an exchange",
    "slaves": "slave nodes",
    "patches": "master patches held",
    "contact_neighbours": "messages for contact",
}
EVEN = ("neighbours", "kb", "contact_neighbours")  # zero on one rank, and of about one size then


def draw_counted(found, title, path):
    """A panel for each quantity, a line for each scene, of {scene: {ranks: {quantity: values of all ranks}}}."""
    figure, axes = plt.subplots(3, 3, figsize=(11, 9), constrained_layout=True, sharex=True)
    *panels, last = axes.flat
    for (scene, of_ranks), colour in zip(found.items(), ("#3b75af", "#c53a32", "#3c8d5a")):
        ranks = list(of_ranks)
        for quantity, panel in zip(COUNTED, panels):
            values = [of[quantity] for of in of_ranks.values()]
            if any(map(any, values)):
                panel.plot(ranks, [max(v) for v in values], "-", color=colour, marker=".", label=scene)
                panel.plot(ranks, [np.mean(v) for v in values], "--", color=colour, linewidth=1)
        for quantity, style in (("elements", ".-"), ("entries", ":")):
            last.plot(ranks, [efficiency(of_ranks, count, quantity) for count in ranks], style, color=colour)
    for (quantity, name), panel in zip(COUNTED.items(), panels):
        panel.set_title(name, fontsize=10)
        if quantity in EVEN:
            panel.set_ylim(bottom=0)
        else:
            panel.set_yscale("log")
    last.set_title("even share over most: elements (full), entries (dotted)", fontsize=8)
    last.set_ylim(0, 1.05)
    ticks = ranks[::2]
    for panel in axes.flat:
        panel.set_xscale("log", base=2)
        panel.set_xticks(ticks, [str(tick) for tick in ticks])
        panel.grid(alpha=0.3)
    for panel in axes[-1]:
        panel.set_xlabel("ranks")
    panels[0].legend(fontsize=8)
    figure.suptitle(title)
    figure.savefig(path, dpi=110)


def efficiency(of_ranks, ranks, quantity="elements"):
    """What a rank would have of a quantity if it were shared out evenly, over what the busiest has."""
    return sum(of_ranks[1][quantity]) / ranks / max(of_ranks[ranks][quantity])

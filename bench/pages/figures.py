# Figures of a report, drawn by matplotlib and embedded in the page.
import base64
import io
import math
import re
from collections import namedtuple
from dataclasses import dataclass
from itertools import product

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from .results import plain
from .table import TEXTS

matplotlib.rcParams.update({
    "svg.fonttype": "none", "svg.hashsalt": "controlspace", "font.size": 9, "axes.grid": True,
    "grid.color": "#dddddd", "axes.axisbelow": True, "legend.frameon": False,
    "text.parse_math": False})

# Errors below it are drawn at the edge: 0 has no place on a logarithmic axis.
SMALLEST_ERROR = 1e-4
# Okabe and Ito's palette for all kinds of colour vision, without yellow, which is lost on white; and
# marks, as many as share no divisor with the colours, so that 70 structures differ.
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
MARKS = [(m, full) for full in (True, False) for m in "os^vD"]
DASHES = {"s_G": "--", "s_Gx": "--", "s_M": ":"}
PIXELS = 100  # per inch


# What is to be drawn: `plot(figure)` draws it, and `words` fill the texts of `kind` in texts.toml.
Spec = namedtuple("Spec", "kind words plot width height raster", defaults=[760, 520, False])


@dataclass
class Figure:
    name: str
    title: str
    caption: str
    made_by: str
    width: int
    height: int
    kind: str  # "svg" or "png"
    bytes: bytes

    @property
    def address(self):
        kind = "svg+xml" if self.kind == "svg" else "png"
        return f"data:image/{kind};base64,{base64.b64encode(self.bytes).decode()}"


def draw(specs, prefix, made_by):
    """Figures named PREFIXKIND-NUMBER."""
    figures = []
    for number, spec in enumerate(specs, 1):
        texts = TEXTS["figures"][spec.kind]
        title = texts["title"].format(**spec.words)
        kind, scale = ("png", 2) if spec.raster else ("svg", 1)
        figure = plt.figure(figsize=(spec.width / PIXELS, spec.height / PIXELS), dpi=PIXELS,
                            layout="constrained")
        figure.suptitle(title.replace(": ", ":\n", 1), fontsize=10)
        spec.plot(figure)
        file = io.BytesIO()
        figure.savefig(file, format=kind, dpi=PIXELS * scale,
                       metadata={"Software" if spec.raster else "Date": None})
        plt.close(figure)
        figures.append(Figure(f"{prefix}{spec.kind}-{number:02}", title,
                              texts["caption"].format(smallest=SMALLEST_ERROR, **spec.words),
                              made_by, spec.width, spec.height, kind, file.getvalue()))
    return figures


class Styles:
    """One colour and one mark for each structure in all figures of a report."""

    def __init__(self, rows):
        self.order = list(dict.fromkeys(map(structure_of, rows)))

    def __call__(self, structure):
        i = self.order.index(structure)
        colour = COLOURS[i % len(COLOURS)]
        mark, full = MARKS[i % len(MARKS)]
        return {"color": colour, "marker": mark, "markerfacecolor": colour if full else "none"}


def log_ticks(low, high):
    """Every power of ten and, the fewer these are, the more places between them."""
    subs = [1] if high > 1000 * low else [1, 2, 5] if high > 4 * low else \
        [1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8]
    return LogLocator(subs=subs, numticks=40)


def log_axis(axis, label, low=None, high=None):
    axis.axes.set(**{f"{axis.axis_name}scale": "log", f"{axis.axis_name}label": label})
    axis.set_major_locator(log_ticks(*((low, high) if low else axis.get_view_interval())))
    axis.set_major_formatter(StrMethodFormatter("{x:.7g}"))
    axis.set_minor_formatter(NullFormatter())


def colour_bar(image, axes):
    figure = image.axes.figure
    bar = figure.colorbar(image, ax=axes, shrink=0.8, ticks=log_ticks(*image.get_clim()),
                          format=StrMethodFormatter("{x:.4g}"))
    bar.ax.minorticks_off()


def lines_axis(ax, labels):
    """A line for each label, from above."""
    ax.set_yticks(range(len(labels), 0, -1), labels)
    ax.set_ylim(0.4, len(labels) + 0.6)
    ax.grid(False, axis="y")
    ax.tick_params(axis="y", length=0)


def height_of(lines, line):
    return min(150 + lines * line, 12000)


def drawn(error):
    return max(error, SMALLEST_ERROR)


def legend_outside(ax):
    ax.legend(loc="upper left", bbox_to_anchor=(1, 1), borderaxespad=0.2)


def legend_above(ax):
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1), ncols=4)


def structure_of(row):
    return row.setting["structure"]


def group_of(row):
    return row.group


def grouped(rows, key):
    groups = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return groups


# ---- Fronts

COSTS = [("memory", "memory [MB]", "memory_MB"),
         ("access time", "access at random places [ns/query]", "t_access_ns_random")]
FRONT_ERRORS = [("Largest", "largest δ_R at the finer probes", "delta_R_fine_max"),
                ("Mean", "mean δ_R at the finer probes", "delta_R_fine_mean")]


def fronts(rows):
    """Rows of the same work, each with at least two rows."""
    rows = [row for row in rows if math.isfinite(row["delta_R_fine_max"])]
    return {work: found for work, found in grouped(rows, lambda r: r.work).items()
            if len(found) > 1}


def front_of(rows, cost, error):
    """The rows that no other beats: none is at most as large in both, and smaller in one."""
    points = [(row[cost], row[error]) for row in rows]
    return [row for row, (c, e) in zip(rows, points)
            if not any(x <= c and y <= e and (x < c or y < e) for x, y in points)]


def pareto_figures(rows, styles):
    for work, members in fronts(rows).items():
        for (against, cost_label, cost), (which, error_label, error) in product(COSTS, FRONT_ERRORS):
            def plot(figure):
                ax = figure.subplots()
                front = sorted(front_of(members, cost, error), key=lambda r: r[cost])
                ax.step([r[cost] for r in front], [drawn(r[error]) for r in front], where="post",
                        color="#888888", label="front")
                for structure, same in grouped(members, structure_of).items():
                    ax.plot([r[cost] for r in same], [drawn(r[error]) for r in same], linestyle="",
                            label=structure, **styles(structure))
                ax.margins(x=0.2, y=0.1)
                log_axis(ax.xaxis, cost_label)
                log_axis(ax.yaxis, error_label)
                label_apart(ax, [(r[cost], drawn(r[error]), r.method) for r in front])
                legend_outside(ax)
            yield Spec("pareto", {"which": which, "against": against, "work": work}, plot)


def label_apart(ax, points):
    """Labels of those points that no label is near yet."""
    taken = []
    for x, y, text in points:
        px, py = ax.transData.transform((x, y)) / ax.figure.bbox.size
        if all(abs(px - qx) > 0.2 or abs(py - qy) > 0.03 for qx, qy in taken):
            taken.append((px, py))
            ax.annotate(text, (x, y), (-5, -9), textcoords="offset points", ha="right", fontsize=7)


def paper_figures(evidence, styles):
    cells = [cell for cell in evidence.measured_cells if cell.row["size_MB"]]
    for rho, found in sorted(grouped(cells, lambda c: c.paper.rho).items()):
        def plot(figure):
            ax = figure.subplots()
            for structure, same in grouped(found, lambda c: c.paper.structure).items():
                style = styles(structure)
                ours = [(c.row["size_MB"], c.row["delta_R_max"]) for c in same]
                theirs = [(c.paper.size_MB, c.paper.delta_R_max) for c in same]
                for pair in zip(ours, theirs):
                    ax.plot(*zip(*pair), color="#aaaaaa", linewidth=0.8)
                ax.plot(*zip(*theirs), "x", color=style["color"])
                ax.plot(*zip(*ours), linestyle="", label=structure, **style)
            ax.plot([], [], "kx", label="the paper's")
            log_axis(ax.xaxis, "size in the paper's accounting [MB]")
            log_axis(ax.yaxis, "largest δ_R")
            legend_outside(ax)
        yield Spec("paper", {"rho": plain(rho)}, plot)


# ---- Times

ACCESS = [("at random places", "t_access_ns_random_samples", 0.2, "#0072B2"),
          ("in the order of a grid", "t_access_ns_grid_samples", -0.2, "#E69F00")]


def access_figures(rows):
    for group, members in grouped(rows, group_of).items():
        def plot(figure):
            ax = figure.subplots()
            for title, key, above, colour in ACCESS:
                places = [len(members) - i + above for i in range(len(members))]
                samples = [row[key] for row in members]
                lines = {"color": colour}
                parts = ax.boxplot(samples, vert=False, positions=places, widths=0.34,
                                   whis=(0, 100), patch_artist=True, manage_ticks=False,
                                   medianprops={**lines, "linewidth": 2}, whiskerprops=lines,
                                   capprops=lines, boxprops={"facecolor": colour, "alpha": 0.4})
                parts["boxes"][0].set_label(title)
                for y, list_ in zip(places, samples):
                    ax.plot(list_, [y] * len(list_), "k.", markersize=1.5)
            lines_axis(ax, [row.label for row in members])
            log_axis(ax.xaxis, "access time [ns/query]")
            legend_above(ax)
        yield Spec("access", {"group": group}, plot, height=height_of(len(members), 26))


def creation_figures(rows, styles):
    for group, members in grouped(rows, lambda r: re.sub(r"\brho [^,]+, ", "", r.group)).items():
        if len({row.sources for row in members}) < 2:
            continue

        def plot(figure):
            ax = figure.subplots()
            named = set()
            for same in grouped(sorted(members, key=lambda r: r.sources), lambda r: r.label).values():
                structure = structure_of(same[0])
                ax.plot([r.sources for r in same], [r["creation_s"] for r in same],
                        DASHES.get(same[0].setting.get("split"), "-"), **styles(structure),
                        label=None if structure in named else structure)
                named.add(structure)
            log_axis(ax.xaxis, "sources")
            log_axis(ax.yaxis, "creation time [s]")
            legend_outside(ax)
        yield Spec("creation", {"group": group}, plot)

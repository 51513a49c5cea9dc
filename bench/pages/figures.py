# Figures of a report, drawn by matplotlib and embedded in the page.
import base64
import io
import math
from dataclasses import dataclass
from itertools import groupby

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from .results import plain

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


@dataclass
class Figure:
    name: str
    title: str
    caption: str
    made_by: str
    width: int
    height: int
    kind: str    # "svg" or "png"
    bytes: bytes

    @property
    def address(self):
        kind = "svg+xml" if self.kind == "svg" else "png"
        return f"data:image/{kind};base64,{base64.b64encode(self.bytes).decode()}"


def draw(name, title, caption, made_by, plot, width=760, height=520, kind="svg"):
    """A figure of what `plot(figure)` draws."""
    figure = plt.figure(figsize=(width / PIXELS, height / PIXELS), dpi=PIXELS,
                        layout="constrained")
    try:
        figure.suptitle(title.replace(": ", ":\n", 1), fontsize=10)
        plot(figure)
        file = io.BytesIO()
        figure.savefig(file, format=kind, dpi=PIXELS * (2 if kind == "png" else 1),
                       metadata={"Date": None} if kind == "svg" else {"Software": None})
    finally:
        plt.close(figure)
    return Figure(name, title, caption, made_by, width, height, kind, file.getvalue())


class Styles:
    """One colour and one mark for each structure in all figures of a report."""

    def __init__(self, rows):
        self.order = list(dict.fromkeys(row.setting["structure"] for row in rows))

    def __call__(self, structure):
        i = self.order.index(structure)
        colour = COLOURS[i % len(COLOURS)]
        mark, full = MARKS[i % len(MARKS)]
        return {"color": colour, "marker": mark, "markerfacecolor": colour if full else "none"}


def log_axis(axis, label, low=None, high=None):
    axis.axes.set(**{f"{axis.axis_name}scale": "log", f"{axis.axis_name}label": label})
    low, high = (low, high) if low else axis.get_view_interval()
    subs = [1] if high > 1000 * low else [1, 2, 5] if high > 4 * low else \
        [1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8]
    axis.set_major_locator(LogLocator(subs=subs, numticks=40))
    axis.set_major_formatter(StrMethodFormatter("{x:.7g}"))
    axis.set_minor_formatter(NullFormatter())


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


def grouped(rows, key):
    groups = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return groups


# ---- Fronts

COSTS = [("memory", "memory [MB]", lambda row: row["bytes_total"] / 1e6),
         ("access time", "access at random places [ns/query]",
          lambda row: row["t_access_ns_random"])]
FRONT_ERRORS = [("Largest", "largest δ_R at the finer probes", "delta_R_fine_max"),
                ("Mean", "mean δ_R at the finer probes", "delta_R_fine_mean")]


def fronts(rows):
    """Rows of the same work, each with at least two rows."""
    rows = [row for row in rows if math.isfinite(row["delta_R_fine_max"])]
    return {work: found for work, found in grouped(rows, lambda r: r.work()).items()
            if len(found) > 1}


def front_of(rows, cost, error):
    """The rows that no other beats: none is at most as large in both, and smaller in one."""
    points = [(cost(row), row[error]) for row in rows]
    return [row for row, (c, e) in zip(rows, points)
            if not any(x <= c and y <= e and (x < c or y < e) for x, y in points)]


def pareto_figures(rows, styles, prefix, made_by):
    figures = []
    for work, members in fronts(rows).items():
        for against, cost_label, cost in COSTS:
            for which, error_label, error in FRONT_ERRORS:
                def plot(figure):
                    ax = figure.subplots()
                    front = sorted(front_of(members, cost, error), key=cost)
                    ax.step([cost(r) for r in front], [drawn(r[error]) for r in front],
                            where="post", color="#888888", label="front")
                    for structure, same in grouped(members, lambda r:
                                                   r.setting["structure"]).items():
                        ax.plot([cost(r) for r in same], [drawn(r[error]) for r in same],
                                linestyle="", label=structure, **styles(structure))
                    ax.margins(x=0.2, y=0.1)
                    log_axis(ax.xaxis, cost_label)
                    log_axis(ax.yaxis, error_label)
                    label_apart(ax, [(cost(r), drawn(r[error]), r.front_label()) for r in front])
                    legend_outside(ax)
                figures.append(draw(
                    f"{prefix}pareto-{len(figures) + 1:02}", f"{which} error against {against}: "
                    f"{work}", "Below and to the left is better. The line is the front: no other "
                    "row is at most as large in both. Labels that would cover each other are left "
                    "out: the table below has all. Errors below "
                    f"{SMALLEST_ERROR} are drawn at the lower edge.", made_by, plot))
    return figures


def label_apart(ax, points):
    """Labels of those points that no label is near yet."""
    taken = []
    for x, y, text in points:
        px, py = ax.transData.transform((x, y)) / ax.figure.bbox.size
        if all(abs(px - qx) > 0.2 or abs(py - qy) > 0.03 for qx, qy in taken):
            taken.append((px, py))
            ax.annotate(text, (x, y), (-5, -9), textcoords="offset points", ha="right", fontsize=7)


def paper_figures(evidence, styles, prefix, made_by):
    cells = [cell for cell in evidence.measured_cells if cell.row["bytes_published_accounting"]]
    figures = []
    for rho, found in groupby(sorted(cells, key=lambda c: c.paper.rho), lambda c: c.paper.rho):
        found = list(found)

        def plot(figure):
            ax = figure.subplots()
            for structure, same in grouped(found, lambda c: c.paper.structure).items():
                style = styles(structure)
                ours = [(c.row["bytes_published_accounting"] / 1e6, c.row["delta_R_max"])
                        for c in same]
                theirs = [(c.paper.size_MB, c.paper.delta_R_max) for c in same]
                for a, b in zip(ours, theirs):
                    ax.plot(*zip(a, b), color="#aaaaaa", linewidth=0.8)
                ax.plot(*zip(*theirs), "x", color=style["color"])
                ax.plot(*zip(*ours), linestyle="", label=structure, **style)
            ax.plot([], [], "kx", label="the paper's")
            log_axis(ax.xaxis, "size in the paper's accounting [MB]")
            log_axis(ax.yaxis, "largest δ_R")
            legend_outside(ax)
        figures.append(draw(
            f"{prefix}paper-{len(figures) + 1:02}",
            f"Largest δ_R against size, ours and the paper's: ρ {plain(rho)}",
            "Tables 1 and 4 together: size in the paper's accounting, δ_R at 30 x 30 x 30 probes. "
            "Marks: ours; crosses: the paper's, with a line to ours.", made_by, plot))
    return figures


# ---- Times

ACCESS = [("at random places", "t_access_ns_random_samples", 0.2, "#0072B2"),
          ("in the order of a grid", "t_access_ns_grid_samples", -0.2, "#E69F00")]


def access_figures(rows, prefix, made_by):
    figures = []
    for group, members in grouped(rows, lambda r: r.group()).items():
        def plot(figure):
            ax = figure.subplots()
            for title, key, above, colour in ACCESS:
                places = [len(members) - i + above for i in range(len(members))]
                samples = [row[key] for row in members]
                parts = ax.boxplot(samples, vert=False, positions=places, widths=0.34,
                                   whis=(0, 100), patch_artist=True, manage_ticks=False,
                                   medianprops={"color": colour, "linewidth": 2},
                                   boxprops={"facecolor": colour, "alpha": 0.4},
                                   whiskerprops={"color": colour}, capprops={"color": colour})
                parts["boxes"][0].set_label(title)
                ax.plot([s for list_ in samples for s in list_],
                        [y for y, list_ in zip(places, samples) for _ in list_],
                        "k.", markersize=1.5)
            lines_axis(ax, [row.label() for row in members])
            log_axis(ax.xaxis, "access time [ns/query]")
            legend_above(ax)
        figures.append(draw(
            f"{prefix}access-{len(figures) + 1:02}", f"Access time: {group}",
            "Boxes hold the middle half of the samples, with the median as a line; whiskers reach "
            "to the fastest and the slowest sample; dots are samples, each the mean of a batch.",
            made_by, plot, height=height_of(len(members), 26)))
    return figures


def creation_figures(rows, styles, prefix, made_by):
    figures = []
    for group, members in grouped(rows, lambda r: r.group(with_density=False)).items():
        if len({row.sources for row in members}) < 2:
            continue

        def plot(figure):
            ax = figure.subplots()
            named = set()
            for (structure, split, _), same in grouped(
                    members, lambda r: (r.setting["structure"], r.split, r.label())).items():
                same = sorted(same, key=lambda r: r.sources)
                ax.plot([r.sources for r in same], [r.creation_s for r in same],
                        DASHES.get(split, "-"), **styles(structure),
                        label=None if structure in named else structure)
                named.add(structure)
            log_axis(ax.xaxis, "sources")
            log_axis(ax.yaxis, "creation time [s]")
            legend_outside(ax)
        figures.append(draw(
            f"{prefix}creation-{len(figures) + 1:02}", f"Creation time against sources: {group}",
            "Insertion and gradation together. Marks are rows; lines join those of one structure: "
            "solid with s_L and without a split, dashed with s_G, dotted with s_M.", made_by, plot))
    return figures

# SPDX-License-Identifier: Apache-2.0
# Figures of a report, drawn by matplotlib and embedded in the page.
import base64
import io
import math
import re
import textwrap
from collections import namedtuple
from dataclasses import dataclass
from itertools import product

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import FixedLocator, NullFormatter, NullLocator, StrMethodFormatter

from .fronts import COSTS, FRONT_ERRORS, front_of, fronts
from .results import grouped, plain
from .table import TEXTS

matplotlib.rcParams.update({
    "svg.fonttype": "none", "svg.hashsalt": "controlspace", "font.size": 10.5, "axes.grid": True,
    "grid.color": "#dddddd", "axes.axisbelow": True, "legend.frameon": False,
    "text.parse_math": False})
# Pictures keep their colours on a dark page, so that their texts must be read on both.
ON_ANY_PAGE = {key: "#777777" for key in (
    "text.color", "axes.labelcolor", "axes.edgecolor", "axes.titlecolor", "xtick.color",
    "ytick.color")}

# Errors below it are drawn at the edge: 0 has no place on a logarithmic axis.
SMALLEST_ERROR = 1e-4
# Okabe and Ito's palette for all kinds of colour vision, without yellow, which is lost on white; and
# marks, as many as share no divisor with the colours, so that 70 structures differ. The splits of a
# structure fill its mark differently.
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
MARKS = "os^vDPX<>p"
FILLS = {"s_G": "left", "s_Gx": "top", "s_M": "none"}
DASHES = {"s_G": "--", "s_Gx": "--", "s_M": ":"}
PIXELS = 100  # per inch
SMALL = 500   # pixels: three beside each other on a wide page


# What is to be drawn: `plot(figure)` draws it, and `words` fill the title of `kind` in texts.toml.
Spec = namedtuple("Spec", "kind words plot width height raster", defaults=[620, 520, False])


@dataclass
class Figure:
    name: str
    title: str
    caption: str  # the same for all of a kind
    width: int
    height: int
    kind: str  # "svg" or "png"
    bytes: bytes
    is_small: bool = False

    @property
    def address(self):
        kind = "svg+xml" if self.kind == "svg" else "png"
        return f"data:image/{kind};base64,{base64.b64encode(self.bytes).decode()}"


def draw(specs, prefix=""):
    """Figures named PREFIXKIND-NUMBER."""
    figures = []
    for number, spec in enumerate(specs, 1):
        texts = TEXTS["figures"][spec.kind]
        title = texts["title"].format(**spec.words)
        kind, scale = ("png", 1.5) if spec.raster else ("svg", 1)
        with matplotlib.rc_context(ON_ANY_PAGE if spec.raster else {}):
            figure = plt.figure(figsize=(spec.width / PIXELS, spec.height / PIXELS), dpi=PIXELS,
                                layout="constrained")
            spec.plot(figure)
            for ax in figure.axes:
                ax.patch.set_visible(False)
            file = io.BytesIO()
            figure.savefig(file, format=kind, dpi=PIXELS * scale, transparent=True,
                           metadata={"Software" if spec.raster else "Date": None})
            plt.close(figure)
        figures.append(Figure(f"{prefix}{spec.kind}-{number:02}", title,
                              texts["caption"].format(smallest=SMALLEST_ERROR), spec.width,
                              spec.height, kind, file.getvalue(), spec.width < SMALL))
    return figures


class Styles:
    """One colour and one mark for each structure in all figures of a report; its splits fill it."""

    def __init__(self, rows):
        self.order = list(dict.fromkeys(map(structure_of, rows)))

    def __call__(self, structure, split=None):
        i = self.order.index(structure)
        return {"color": COLOURS[i % len(COLOURS)], "marker": MARKS[i % len(MARKS)],
                **fill_of(split)}


def fill_of(split):
    return {"fillstyle": FILLS.get(split, "full"), "markerfacecoloralt": "none"}


def split_of(row):
    """None for adapted trees, which are the same with all."""
    return None if row.setting.get("target_delta") else row.setting.get("split")


def split_structure(row):
    """"K_L s_M", the structure and its split."""
    return f"{structure_of(row)} {split_of(row) or ''}"


def log_ticks(low, high):
    """Every power of ten and, the fewer these are, the more places between them; at least three
    numbers, for however narrow an interval."""
    subs = [1] if high > 1000 * low else [1, 2, 5] if high > 8 * low else \
        [1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8]
    places = [sub * 10.0 ** power for power in range(math.floor(math.log10(low)),
                                                     math.ceil(math.log10(high)) + 1)
              for sub in subs]
    inside = [x for x in places if low <= x <= high]
    return FixedLocator(inside if len(inside) >= 3 else [low, math.sqrt(low * high), high])


def log_axis(axis, label, low=None, high=None):
    axis.axes.set(**{f"{axis.axis_name}scale": "log", f"{axis.axis_name}label": label})
    axis.set_major_locator(log_ticks(*((low, high) if low else axis.get_view_interval())))
    axis.set_major_formatter(StrMethodFormatter("{x:.4g}"))
    axis.set_minor_formatter(NullFormatter())
    axis.set_minor_locator(NullLocator())


def colour_bar(image, axes, label):
    """With three numbers or a few more, which do not cover each other."""
    low, high = image.get_clim()
    ticks = log_ticks(low, high).tick_values(None, None)
    if len(ticks) > 4:
        ticks = ticks[::2] if high > 1000 * low else [low, math.sqrt(low * high), high]
    bar = image.axes.figure.colorbar(image, ax=axes, location="bottom", aspect=30, label=label,
                                     ticks=ticks, format=StrMethodFormatter("{x:.2g}"))
    bar.ax.minorticks_off()
    bar.ax.tick_params(labelsize=9)


def lines_axis(ax, labels):
    """A line for each label, from above."""
    ax.set_yticks(range(len(labels), 0, -1), [textwrap.fill(label, 30) for label in labels])
    ax.set_ylim(0.4, len(labels) + 0.6)
    ax.grid(False, axis="y")
    ax.tick_params(axis="y", length=0)


def height_of(lines, line):
    return min(150 + lines * line, 12000)


def drawn(error):
    return max(error, SMALLEST_ERROR)


def legend_below(ax):
    ax.legend(loc="upper left", bbox_to_anchor=(-0.12, -0.13), ncols=3, fontsize=9.5,
              columnspacing=1.2, handletextpad=0.4)


def legend_above(ax):
    ax.legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=3, fontsize=9.5, columnspacing=1)


def structure_of(row):
    return row.setting["structure"]


# ---- Fronts

def draw_front(ax, rows, cost, error, name_of, style_of):
    """Rows by a cost and an error, each (key, label), and a line along their front. Those of the same
    name are drawn in the style of it."""
    (x, x_label), (y, y_label) = cost, error
    front = sorted(front_of(rows, x, y), key=lambda r: r[x])
    ax.step([r[x] for r in front], [drawn(r[y]) for r in front], where="post", color="#888888",
            label="front")
    for name, same in grouped(rows, name_of).items():
        ax.plot([r[x] for r in same], [drawn(r[y]) for r in same], linestyle="", label=name,
                markersize=7, **style_of(name))
    log_axis(ax.xaxis, x_label)
    log_axis(ax.yaxis, y_label)
    return front


def pareto_figures(rows, styles):
    for work, members in fronts(rows).items():
        for (which, error_label, error), (against, cost_label, cost) in product(FRONT_ERRORS, COSTS):
            def plot(figure, members=members, cost=(cost, cost_label), error=(error, error_label)):
                ax = figure.subplots()
                ax.margins(x=0.2, y=0.1)
                front = draw_front(ax, members, cost, error, split_structure,
                                   lambda name: styles(*name.split(" ", 1)))
                label_apart(ax, [(r[cost[0]], drawn(r[error[0]]), r.method) for r in front])
                legend_below(ax)
            yield Spec("pareto", {"which": which, "against": against, "work": work}, plot,
                       height=440 + 7 * len(set(map(split_structure, members))))


def label_apart(ax, points):
    """Labels of those points that no label is near yet."""
    taken = []
    for x, y, text in points:
        px, py = ax.transData.transform((x, y)) / ax.figure.bbox.size
        if all(abs(px - qx) > 0.25 or abs(py - qy) > 0.04 for qx, qy in taken):
            taken.append((px, py))
            is_left = ax.transAxes.inverted().transform(ax.transData.transform((x, y)))[0] < 0.5
            ax.annotate(text, (x, y), (5 if is_left else -5, -11), textcoords="offset points",
                        ha="left" if is_left else "right", fontsize=9)


def paper_figures(evidence, styles):
    cells = [cell for cell in evidence.measured_cells if cell.row["size_MB"]]
    for rho, found in sorted(grouped(cells, lambda c: c.paper.rho).items()):
        def plot(figure):
            ax = figure.subplots()
            for (structure, split), same in grouped(
                    found, lambda c: (c.paper.structure, c.paper.split)).items():
                style = styles(structure, split)
                ours = [(c.row["size_MB"], c.row["delta_R_max"]) for c in same]
                theirs = [(c.paper.size_MB, c.paper.delta_R_max) for c in same]
                for pair in zip(ours, theirs):
                    ax.plot(*zip(*pair), color="#aaaaaa", linewidth=0.8)
                ax.plot(*zip(*theirs), "x", color=style["color"])
                ax.plot(*zip(*ours), linestyle="", label=f"{structure} {split}", **style)
            ax.plot([], [], "kx", label="the paper's")
            log_axis(ax.xaxis, "size in the paper's accounting [MB]")
            log_axis(ax.yaxis, "largest δ_R")
            legend_below(ax)
        yield Spec("paper", {"rho": plain(rho)}, plot)


# ---- Times

ACCESS = [("at random places", "t_access_ns_random_samples", "#0072B2"),
          ("in the order of a grid", "t_access_ns_grid_samples", "#E69F00"),
          ("at random places, one a call", "t_access_ns_single_samples", "#009E73"),
          ("near the sources", "t_access_ns_near_samples", "#CC79A7"),
          ("along walks, by a cursor", "t_access_ns_walk_samples", "#56B4E9")]


def access_figures(rows):
    """For each group and each order of places one, on the same axis; older results lack some."""
    for group, members in grouped(rows, lambda r: r.group).items():
        orders = [order for order in ACCESS if all(order[1] in row.measures for row in members)]
        all_samples = [x for row in members for _, key, _ in orders for x in row[key]]
        limits = 0.8 * min(all_samples), 1.25 * max(all_samples)
        for title, key, colour in orders:
            def plot(figure, key=key, colour=colour, members=members, limits=limits):
                ax = figure.subplots()
                places = range(len(members), 0, -1)
                samples = [row[key] for row in members]
                lines = {"color": colour}
                ax.boxplot(samples, vert=False, positions=places, widths=0.6, whis=(0, 100),
                           patch_artist=True, manage_ticks=False,
                           medianprops={**lines, "linewidth": 2}, whiskerprops=lines,
                           capprops=lines, boxprops={"facecolor": colour, "alpha": 0.4})
                for y, list_ in zip(places, samples):
                    ax.plot(list_, [y] * len(list_), "k.", markersize=2)
                lines_axis(ax, [row.label for row in members])
                ax.set_xlim(*limits)
                log_axis(ax.xaxis, "access time [ns/query]", *limits)
            yield Spec("access", {"title": title, "group": group}, plot,
                       height=height_of(len(members), 24))


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
                        DASHES.get(split_of(same[0]), "-"),
                        **styles(structure, split_of(same[0])),
                        label=None if structure in named else structure)
                named.add(structure)
            log_axis(ax.xaxis, "sources")
            log_axis(ax.yaxis, "creation time [s]")
            legend_below(ax)
        yield Spec("creation", {"group": group}, plot)

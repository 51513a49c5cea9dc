# SPDX-License-Identifier: Apache-2.0
# Two runs beside each other: rows of the same case, after over before.
import math
from collections import namedtuple

from .figures import Spec, height_of, legend_below, lines_axis, log_axis
from .results import grouped
from .table import shown, table_of

# What is compared: the name, what less and more of it are called, the measure, and how it is drawn.
Measure = namedtuple("Measure", "name less more key mark colour full", defaults=[True])
MEASURES = [
    Measure("access, random", "faster", "slower", "t_access_ns_random", "o", "#0072B2"),
    Measure("access, grid", "faster", "slower", "t_access_ns_grid", "s", "#E69F00"),
    Measure("creation", "faster", "slower", "t_creation_s", "^", "#009E73"),
    Measure("memory", "smaller", "larger", "memory_MB", "D", "#000000"),
    Measure("largest δ_R, fine", "more accurate", "less accurate", "delta_R_fine_max", "o",
            "#D55E00", False),
    Measure("mean δ_R, fine", "more accurate", "less accurate", "delta_R_fine_mean", "s", "#CC79A7",
            False)]
# Settings of a study that are not compared, and those that say how is measured; the others are of
# the sources.
NOT_COMPARED = {"name", "output", "runs"}
MEASURING = {"domain", "margin", "max_memory", "max_seconds", "max_memory_ratio", "seed", "threads",
             "access_points", "access_repeats", "creation_repeats", "probe_grid", "fine_probe_grid",
             "reference_tolerance"}

# After over before, and what the scatter of the samples makes of it: from the lower quartile of the
# later samples over the upper one of the earlier to the reverse.
Ratio = namedtuple("Ratio", "value low high")


def row_pairs(before, after):
    """Rows of the same case and number of sources; each is in one pair at most."""
    left = list(after.measured)
    pairs = []
    if differing_keys(before, after) - MEASURING:
        return pairs
    for row in before.measured:
        other = next((r for r in left if r.key == row.key and r.sources == row.sources), None)
        if other is not None:
            left.remove(other)
            pairs.append((row, other))
    return pairs


def differing_keys(before, after):
    a, b = before.settings, after.settings
    return {key for key in {**a, **b} if shown(a.get(key)) != shown(b.get(key))} - NOT_COMPARED


def differing_settings(before, after):
    return "; ".join(
        f"{key} {shown(before.settings.get(key))}, then {shown(after.settings.get(key))}"
        for key in sorted(differing_keys(before, after)))


def ratio_of(measure, pair):
    """None where one of two numbers is 0, and the other is not, and for times of lengths and of
    metrics."""
    if measure.key.startswith("t_access") and pair[0]["answers"] != pair[1]["answers"]:
        return None
    a, b = ([row.measures.get(f"{measure.key}{quartile}", row[measure.key])
             for quartile in ("_q1", "", "_q3")] for row in pair)
    if a == b and a[0] == a[2]:
        return Ratio(1, 1, 1)
    if a[0] <= 0 or b[0] <= 0 or not math.isfinite(a[2]) or not math.isfinite(b[2]):
        return None
    return Ratio(b[1] / a[1], b[0] / a[2], b[2] / a[0])


def counts_table(pairs):
    rows = []
    for measure in MEASURES:
        ratios = [ratio_of(measure, pair) for pair in pairs]
        known = [r for r in ratios if r]
        better, worse = sum(r.high < 1 for r in known), sum(r.low > 1 for r in known)
        rows.append([measure.name, f"{better} {measure.less}", str(len(known) - better - worse),
                     f"{worse} {measure.more}", str(len(ratios) - len(known))])
    return table_of("counts", rows)


def ratio_text(ratio):
    if ratio is None:
        return "–"
    if ratio.low == ratio.high:
        return f"{ratio.value:.3f}"
    apart = "" if ratio.low <= 1 <= ratio.high else " *"
    return f"{ratio.value:.3f} ({ratio.low:.3f} to {ratio.high:.3f}){apart}"


def by_group(pairs):
    return grouped(pairs, lambda pair: pair[0].group)


def change_tables(pairs):
    return [table_of("change", [[pair[0].label, *(ratio_text(ratio_of(m, pair)) for m in MEASURES)]
                                for pair in members], [m.name for m in MEASURES], group=group)
            for group, members in by_group(pairs).items()]


def change_figures(pairs):
    for group, members in by_group(pairs).items():
        def plot(figure):
            ax = figure.subplots()
            ax.axvline(1, color="#888888")
            for k, measure in enumerate(MEASURES):
                ratios = [(ratio_of(measure, pair), len(members) - i + 0.35 - 0.14 * k)
                          for i, pair in enumerate(members)]
                known = [(r.value, y, r.value - r.low, r.high - r.value) for r, y in ratios if r]
                if known:
                    values, places, below, above = zip(*known)
                    ax.errorbar(values, places, xerr=[below, above], linestyle="", markersize=4,
                                label=measure.name, marker=measure.mark, color=measure.colour,
                                markerfacecolor=measure.colour if measure.full else "none")
            lines_axis(ax, [before.label for before, _ in members])
            log_axis(ax.xaxis, "after / before")
            legend_below(ax)
        yield Spec("change", {"group": group}, plot, height=height_of(len(members), 34))

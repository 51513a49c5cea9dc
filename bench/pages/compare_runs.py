# Two runs beside each other: rows of the same case, after over before.
import math
from collections import namedtuple

from .figures import Spec, grouped, height_of, legend_outside, lines_axis, log_axis
from .results import quartiles
from .table import table_of

# What is compared: the name, what less and more of it are called, the measure, its samples if there
# are any, and how it is drawn.
Measure = namedtuple("Measure", "name less more measure samples mark colour full")
MEASURES = [
    Measure("access, random", "faster", "slower", "t_access_ns_random",
            "t_access_ns_random_samples", "o", "#0072B2", True),
    Measure("access, grid", "faster", "slower", "t_access_ns_grid", "t_access_ns_grid_samples", "s",
            "#E69F00", True),
    Measure("creation", "faster", "slower", "creation_s", "t_creation_s_samples", "^", "#009E73",
            True),
    Measure("memory", "smaller", "larger", "memory_MB", None, "D", "#000000", True),
    Measure("largest δ_R, fine", "more accurate", "less accurate", "delta_R_fine_max", None, "o",
            "#D55E00", False),
    Measure("mean δ_R, fine", "more accurate", "less accurate", "delta_R_fine_mean", None, "s",
            "#CC79A7", False)]
# Settings of a study that do not decide whether two rows are of the same case.
NOT_COMPARED = {"name", "output", "runs"}

# After over before, and what the scatter of the samples makes of it: from the lower quartile of the
# later samples over the upper one of the earlier to the reverse.
Ratio = namedtuple("Ratio", "value low high sampled")


def row_pairs(before, after):
    """Rows of the same case and number of sources; each is in one pair at most."""
    left = list(after.measured)
    pairs = []
    if any(before.settings.get(k) != after.settings.get(k) for k in ("h", "radius", "sources")):
        return pairs
    for row in before.measured:
        other = next((r for r in left if r.key == row.key and r.sources == row.sources), None)
        if other is not None:
            left.remove(other)
            pairs.append((row, other))
    return pairs


def differing_settings(before, after):
    keys = [k for k in {**before.settings, **after.settings} if k not in NOT_COMPARED]
    return "; ".join(
        f"{key} {shown(before.settings.get(key))}, then {shown(after.settings.get(key))}"
        for key in keys if before.settings.get(key) != after.settings.get(key))


def shown(value):
    if value in (None, [], ""):
        return "not set"
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)


def sample_ratio(before, after):
    b, a = quartiles(before), quartiles(after)
    return Ratio(a[1] / b[1], a[0] / b[2], a[2] / b[0], True)


def ratio_of(measure, pair):
    """None where one of two numbers is 0, and the other is not."""
    before, after = pair
    if all(len(row.measures.get(measure.samples) or ()) > 1 for row in pair):
        return sample_ratio(before[measure.samples], after[measure.samples])
    a, b = before[measure.measure], after[measure.measure]
    if a == b:
        return Ratio(1, 1, 1, False)
    if a <= 0 or b <= 0 or not math.isfinite(a) or not math.isfinite(b):
        return None
    return Ratio(b / a, b / a, b / a, False)


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
    if not ratio.sampled:
        return f"{ratio.value:.3f}"
    apart = "" if ratio.low <= 1 <= ratio.high else " *"
    return f"{ratio.value:.3f} ({ratio.low:.3f} to {ratio.high:.3f}){apart}"


def by_group(pairs):
    return grouped(pairs, lambda pair: pair[0].group())


def change_tables(pairs):
    return [table_of("change", [[pair[0].label(), *(ratio_text(ratio_of(m, pair)) for m in MEASURES)]
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
            lines_axis(ax, [before.label() for before, _ in members])
            log_axis(ax.xaxis, "after / before")
            legend_outside(ax)
        yield Spec("change", {"group": group}, plot, height=height_of(len(members), 34))

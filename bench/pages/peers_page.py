# SPDX-License-Identifier: Apache-2.0
# The page of bench/peers: foreign systems and the project's structures on the same works.
import argparse
import math
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from peers_works import DELTAS, TENSORS, WORKS

from . import figures
from .command import OK
from .report_command import Section, counted, page
from .results import InputError, read_results, write_file
from .table import fixed, table_of

COSTS = [("memory [MB]", "memory_MB"), ("creation [s]", "creation_s"),
         ("access at random places [ns/query]", "t_access_ns_random"),
         ("access in the order of a grid [ns/query]", "t_access_ns_grid")]


@dataclass
class Work:
    name: str
    results: object

    @property
    def title(self):
        return WORKS[self.name].__doc__

    @property
    def rows(self):
        return self.results.measured

    @property
    def deltas(self):
        """Those that were asked for: with --quick, of tensors the first alone."""
        settings = [row.setting for row in self.results.rows]
        return [d for d in DELTAS if any(d in (s.get("equal_delta"), s.get("target_delta")) for s in settings)]


def read_works(folder):
    """Those of FOLDER/WORK/results.json, in the order of peers_works."""
    works = [Work(name, read_results(folder / name)) for name in WORKS
             if (folder / name / "results.json").exists()]
    if not works:
        raise InputError(f"{folder}: no WORK/results.json: name a folder that bench/peers wrote")
    return works


def structures_in(works):
    return list(dict.fromkeys(figures.structure_of(row) for w in works for row in w.results.rows))


def is_foreign(structure):
    """Not of this project: neither its trees and grids nor the sources themselves."""
    return not structure.startswith(("K_", "uniform-")) and structure != "direct"


def largest_delta(row):
    """At all probes."""
    return max(row["delta_R_max"], row["delta_R_fine_max"])


def reaches(row, delta):
    """Adaptation and bisection may end a hair above."""
    return largest_delta(row) <= 1.01 * delta


def cheapest(rows, cost):
    """The structure that costs least, and those whose quartiles overlap with its."""
    if not rows:
        return []
    limit = min(rows, key=lambda row: row[cost]).spread(cost)[1]
    return list(dict.fromkeys(figures.structure_of(row) for row in sorted(rows, key=lambda r: r[cost])
                              if row.spread(cost)[0] <= limit))


def least(rows, cost, structure):
    return min((r[cost] for r in rows if figures.structure_of(r) == structure), default=math.inf)


# ---- What to choose

def winners(works, delta, cost):
    """{structure: on how many works none is cheaper}, most first, and the rows of works that any reaches."""
    reached = [rows for rows in ([r for r in w.rows if reaches(r, delta)] for w in works) if rows]
    wins = Counter(s for rows in reached for s in cheapest(rows, cost))
    # Of structures with as many wins the one that loses least elsewhere.
    return dict(sorted(wins.items(), key=lambda win: (-win[1], over_the_least(reached, cost, win[0])))), reached


def over_the_least(reached, cost, structure):
    """The median of its cost over that of the cheapest."""
    return median(least(rows, cost, structure) / min(r[cost] for r in rows) for rows in reached)


def best_of_others(reached, cost, other):
    """Of the foreign systems, or if `other` is one, of the rest: that with the least median of its cost over
    that of `other`, and that median."""
    found = {}
    for s in {figures.structure_of(r) for rows in reached for r in rows
              if is_foreign(figures.structure_of(r)) != is_foreign(other)}:
        ratios = [least(rows, cost, s) / least(rows, cost, other) for rows in reached
                  if least(rows, cost, s) < math.inf and least(rows, cost, other) < math.inf]
        if len(ratios) >= len(reached) / 2:
            found[s] = median(ratios)
    best = min(found, key=found.get, default=None)
    return best, found.get(best)


def two_digits(number):
    return f"{float(f'{number:.2g}'):g}"


def sentence(works, what, delta, cost, wish):
    wins, reached = winners(works, delta, cost)
    if not wins:
        return f"{what}, δ ≤ {delta}: no system reaches it on any of {counted(len(works), 'work')}."
    (best, times), *others = list(wins.items())[:3]
    text = f"{what}, δ ≤ {delta}: {best} is {wish} on {times} of {counted(len(reached), 'work')}"
    text += "".join(f", {other} on {times}" for other, times in others)
    group = "this project's structures" if is_foreign(best) else "the foreign systems"
    nearest, ratio = best_of_others(reached, cost, best)
    if nearest:
        text += f"; of {group} {nearest} comes nearest to {best}, at {two_digits(ratio)} times that (median)"
    else:
        text += f"; of {group} none reaches it on half of these"
    if cost == "creation_s":
        there = [rows for rows in reached if least(rows, cost, best) < math.inf]
        slower = over_the_least(there, "t_access_ns_random", best)
        text += f"; at random places {best} takes {two_digits(slower)} times as long as the fastest"
    return text + "."


def choices(works):
    """Five sentences."""
    isotropic = [w for w in works if w.name not in TENSORS]
    tensors = [w for w in works if w.name in TENSORS]
    memory = "memory_MB", "smallest"
    access = "t_access_ns_random", "fastest at random places"
    wanted = [(isotropic, "Isotropic", *memory), (isotropic, "Isotropic", *access),
              (isotropic, "Isotropic", "creation_s", "created fastest"), (tensors, "Tensors", *memory),
              (tensors, "Tensors", *access)]
    return [sentence(those, what, DELTAS[0], *wish) for those, what, *wish in wanted if those]


# ---- Tables

def choice_table(works):
    lines = []
    for work in works:
        for delta in work.deltas:
            rows = [row for row in work.rows if reaches(row, delta)]
            best = [cheapest(rows, cost) for _, cost in COSTS]
            lines.append([work.title, f"{delta:g}", *(", ".join(names[:3]) or "–" for names in best)])
    return table_of("peers-choice", lines)


def systems_table(works):
    """Every structure: where it was measured and what it reached; a reason where it failed."""
    lines = []
    for structure in structures_in(works):
        rows = [(w, r) for w in works for r in w.results.rows if figures.structure_of(r) == structure]
        measured = {w.name for w, r in rows if r.measures is not None}
        reached = [str(len({w.name for w, r in rows
                            if d in w.deltas and r.measures is not None and reaches(r, d)})) for d in DELTAS]
        failures = {}
        for w, r in rows:
            if r.error:
                failures.setdefault(r.error, {})[w.name] = None
        reasons = "; ".join(f"{', '.join(names)}: {error}" for error, names in failures.items())
        text = next((w.results.descriptions["structures"][structure] for w in works
                     if structure in w.results.descriptions.get("structures", {})), "–")
        lines.append([structure, text, f"{len(measured)} of {len({w.name for w, _ in rows})}", *reached,
                      reasons])
    return table_of("peers-systems", lines)


def rows_table(work):
    def setting(row):
        return row.method.removeprefix(figures.structure_of(row)).lstrip(" ,") or "–"

    def time(row, cost, digits):
        low, high = row.spread(cost)
        if cost == "creation_s" and len(row["t_creation_s_samples"]) == 1:
            return fixed(row[cost], digits)
        return f"{fixed(row[cost], digits)} ({fixed(low, digits)}–{fixed(high, digits)})"

    def remark(row):
        # All systems are given the same settings.
        return "; ".join(text for text in row["remark"].split("; ") if not text.startswith("without effect"))

    lines = []
    for row in work.results.rows:
        start = [figures.structure_of(row), setting(row)]
        if row.measures is None:
            lines.append([*start, *["–"] * 6, f"failed: {row.error}"])
            continue
        lines.append([*start, fixed(row["delta_R_max"], 4), fixed(row["delta_R_fine_max"], 4),
                      fixed(row["memory_MB"], 3), time(row, "creation_s", 4),
                      time(row, "t_access_ns_random", 1), time(row, "t_access_ns_grid", 1), remark(row)])
    return table_of("peers-rows", lines, title=work.title)


# ---- Figures

def front_figure(work, styles):
    rows = [row for row in work.rows if math.isfinite(largest_delta(row))]
    for row in rows:
        row.measures["largest_delta"] = largest_delta(row)
    lines = math.ceil((len(set(map(figures.structure_of, rows))) + 1) / 4)

    def style_of(structure):
        return styles(structure) | ({} if is_foreign(structure) else {"fillstyle": "none"})

    def plot(figure):
        axes = figure.subplot_mosaic([[0, 1], [2, 3], ["legend"] * 2],
                                     height_ratios=[300, 300, 18 * lines])
        for i, (label, cost) in enumerate(COSTS):
            ax = axes[i]
            for delta in DELTAS:
                ax.axhline(delta, color="#888888", linewidth=0.8, linestyle=":")
            ax.margins(x=0.1, y=0.1)
            figures.draw_front(ax, rows, (cost, label), ("largest_delta", "largest δ"),
                               figures.structure_of, style_of)
        axes["legend"].axis("off")
        axes["legend"].legend(*axes[0].get_legend_handles_labels(), loc="center", ncols=4, fontsize=9.5)

    return figures.Spec("peers", {"work": work.title}, plot, width=900,
                        height=700 + 18 * lines)


# ---- The page

def origin(works, command):
    first = works[0].results
    sources = sorted({w.results.rows[0].sources for w in works if w.results.rows})
    number = " to ".join(str(n) for n in dict.fromkeys([*sources[:1], *sources[-1:]])) or "no"
    text = (f"{counted(len(works), 'work')} of {number} sources, "
            f"{counted(len(structures_in(works)), 'system')}. Made by `{command}` with controlspace {first.version}, {first.head['cpu']} "
            f"({first.head['cores']} cores), {first.head['date']}.")
    unfinished = [w.title for w in works if not w.results.complete]
    return text + (f" Not complete: {', '.join(unfinished)}." if unfinished else "")


def write_pages(works, folder, command, note):
    styles = figures.Styles([row for w in works for row in w.results.rows])
    drawn = dict(zip((w.name for w in works if w.rows),
                     figures.draw([front_figure(w, styles) for w in works if w.rows])))
    once = all(len(row["t_creation_s_samples"]) == 1 for w in works for row in w.rows)
    times = "Access times" if once else "Times"
    sentences, intro = choices(works), [origin(works, command), *([note] if note else []),
                                        f"{times} whose quartiles overlap count as equal."]
    tables = [choice_table(works), systems_table(works)]
    lines = ["# Foreign systems", "", *(f"{text}\n" for text in intro), "## What to choose", "",
             *(f"{i}. {text}" for i, text in enumerate(sentences, 1)), ""]
    lines += [f"{table.markdown()}" for table in tables]
    lines += ["## Fronts", ""]
    lines += [f"{figure.caption}\n" for figure in [*drawn.values()][:1]]
    for work in works:
        lines += [f"### {work.title}", ""]
        if work.name in drawn:
            write_file(folder / work.name / "fronts.svg", drawn[work.name].bytes)
            lines += [f"![{work.title}]({work.name}/fronts.svg)", ""]
        lines += ["<details><summary>All rows</summary>", "", rows_table(work).markdown().split("\n\n", 1)[1],
                  "</details>", ""]
    write_file(folder / "README.md", "\n".join(lines).rstrip("\n") + "\n")

    sections = [Section("What to choose", [*(("paragraph", text) for text in intro),
                                           ("sentences", sentences), *(("table", t) for t in tables)])]
    sections += [Section(w.title, [*([("figures", [drawn[w.name]])] if w.name in drawn else []),
                                   ("table", rows_table(w))]) for w in works]
    write_file(folder / "report.html", page("Foreign systems", sections, [w.results for w in works]))


def main(arguments):
    parser = argparse.ArgumentParser(description="Writes README.md and report.html of the results of "
                                     "bench/peers.")
    parser.add_argument("folder", metavar="FOLDER", type=Path, help="of WORK/results.json")
    parser.add_argument("--command", default="bench/peers", help="what made the results, as the page says it")
    parser.add_argument("--note", default="", help="a sentence on the machine")
    options = parser.parse_args(arguments)
    write_pages(read_works(options.folder), options.folder, options.command, options.note)
    print(f"Page: {options.folder}/README.md, report.html")
    return OK

# SPDX-License-Identifier: Apache-2.0
# The command bench/report: a page with figures and tables of results that needs no other file.
import argparse
from collections import namedtuple
from pathlib import Path

import jinja2

from . import compare_runs, fields, figures, paper_page
from .command import OK
from .fronts import COSTS, front_tables
from .glossary import Glossary, one_spelling
from .measure_tables import measure_tables
from .paper import Evidence
from .paper_command import evidence_in
from .results import read_results, write_file
from .table import fixed, shown, table_of

# parts: (kind, item) as report.html.j2 shows them; a part "fold" holds parts that may be opened.
Section = namedtuple("Section", "title parts")
Fold = namedtuple("Fold", "title parts is_open")


def tables(items):
    return [("table", table) for table in items if table.rows]


def titled(title, parts):
    return [("heading", title), *parts] if parts else []


def drawn(specs, prefix):
    found = figures.draw(specs, prefix)
    return [("figures", found)] if found else []


def folds(items):
    """Those that hold something, the first one open."""
    filled = [(title, parts) for title, parts in items if parts]
    return [("fold", Fold(title, parts, i == 0)) for i, (title, parts) in enumerate(filled)]


def origin_table(results):
    head, settings = results.head, results.settings
    failed = len(results.rows) - len(results.measured)
    return table_of("origin", [
        ["program", results.version], *([key, head[key]] for key in ("commit", "compiler", "flags")),
        ["processor", head["cpu"]], ["cores, threads", f"{head['cores']}, {head['threads']}"],
        ["date (UTC)", head["date"]], ["command", head["command_line"]],
        ["sources, seed", f"{shown(settings.get('sources'))}, {settings.get('seed')}"],
        ["rows", f"{len(results.rows)}, {failed} failed"
         f"{'' if results.complete else '; not complete: cases are missing'}"]])


def counted(number, what):
    return f"{number} {what}{'' if number == 1 else 's'}"


def compared(results):
    """What was compared, in a paragraph."""
    rows, settings, head = results.rows, results.settings, results.head
    numbers = sorted({row.sources for row in rows})
    sources = "–" if not numbers else counted(numbers[0], "source") if len(numbers) == 1 else \
        f"{numbers[0]} to {numbers[-1]} sources"
    structures = len(dict.fromkeys(map(figures.structure_of, rows)))
    works = len(dict.fromkeys(row.work for row in rows))
    failed = len(rows) - len(results.measured)
    return (f"{counted(structures, 'structure')} in {counted(len(rows), 'row')}"
            f"{f', of which {failed} failed' if failed else ''}, on {sources} "
            f"({shown(settings.get('sources'))}) under {counted(works, 'requested field')}: memory, "
            f"creation and access times, and the error at {settings.get('probe_grid')}³ and "
            f"{settings.get('fine_probe_grid')}³ probes. Measured with controlspace "
            f"{results.version} on {head['cpu']}, {head['date']}."
            f"{'' if results.complete else ' Not complete: cases are missing.'}")


def outcome_parts(outcome):
    lines = [[wish.replace("_", " "), row.method, fixed(row["memory_MB"]),
              fixed(row["t_access_ns_random"], 1),
              f"{fixed(max(row['within_max'], row['within_fine_max']), 3)}x"]
             for wish, rows in outcome.wishes.items() for row in rows]
    return [("sentences", outcome.sentences)] + (tables([table_of("outcome", lines)]) if lines else [])


def front_page(results):
    parts = [("paragraph", compared(results))]
    if not results.outcomes:
        parts.append(("paragraph", "Which structure to take is not in these results: they are not "
                      "complete, or of an older program. The fronts below show which are candidates."))
    several = len({outcome.work for outcome in results.outcomes}) > 1
    for outcome in results.outcomes:
        title = f"Lengths within {outcome.factor:.4g}x"
        parts += titled(title + (f": {outcome.work}" if several else ""), outcome_parts(outcome))
    return parts + [("fold", Fold("Where it is from", tables([origin_table(results)]), False))]


def front_parts(rows, styles, prefix):
    """For each work its figures and its table; figures of a kind are numbered through."""
    found = figures.draw(figures.pareto_figures(rows, styles), prefix)
    each = len(COSTS)
    parts = []
    for i, (work, table) in enumerate(front_tables(rows)):
        largest, mean = (found[each * k:each * (k + 1)] for k in (2 * i, 2 * i + 1))
        parts.append((work, [("figures", largest), *tables([table]),
                             ("fold", Fold("By mean errors", [("figures", mean)], False))]))
    return folds(parts)


def paper_parts(evidence, styles, prefix):
    if not evidence.cells:
        return []
    return [("paragraph", paper_page.headline(evidence)
             + " Cell by cell, with the reasons: bench/paper writes paper.md."),
            *drawn(figures.paper_figures(evidence, styles), prefix),
            *folds([("Conclusions, ranks and verdicts",
                     tables(paper_page.summary_tables(evidence))),
                    ("Tables 1-4, ours beside the paper's",
                     tables(paper_page.side_by_side(evidence))),
                    ("Experiments", tables(paper_page.experiment_tables(evidence)))])]


def accuracy_parts(sampled, prefix):
    if not sampled:
        return [("paragraph", "Fields are not shown: they were not sampled, or are not kept.")]
    return [("paragraph", "Of the structures of the first setting, each with its first split: "
             f"{sampled[2][0].row.group}."),
            ("beside", [*drawn(fields.delta_figure(sampled), prefix),
                        *tables([fields.delta_table(sampled)])]),
            *drawn(fields.cross_validation(sampled), prefix),
            ("fold", Fold("δ between any two structures, in numbers",
                          tables([fields.pairs_table(sampled)]), False))]


def results_sections(results, styles, prefix, with_fields):
    rows = results.measured
    evidence = Evidence(*evidence_in(results.folder))
    sampled = fields.sampled_fields(results) if with_fields else None
    times = titled("Creation", drawn(figures.creation_figures(rows, styles), prefix)) \
        + titled("Access", drawn(figures.access_figures(rows), prefix))
    sections = [Section("Outcome", front_page(results)),
                Section("Fronts: error against memory and access time",
                        front_parts(rows, styles, prefix))]
    if with_fields:
        sections.append(Section("Accuracy", accuracy_parts(sampled, prefix)))
    sections.append(Section("Times", times))
    if sampled:
        sections.append(Section(f"Slices at {fields.slice_place(sampled)}",
                                drawn(fields.slice_figures(sampled), prefix)))
    sections.append(Section("The paper's tables", paper_parts(evidence, styles, prefix)))
    sections.append(Section("All measures", [
        ("fold", Fold(group, [("table", table)], False))
        for group, table in measure_tables(results.rows).items()]))
    return [section for section in sections if section.parts]


def comparison_section(before, after, prefix):
    pairs = compare_runs.row_pairs(before, after)
    a, b = before.head, after.head
    parts = [("paragraph", f"{len(pairs)} rows of {len(before.rows)} have the same setting as one of "
              f"{len(after.rows)}. Before: {before.version}, {a['cpu']}, {a['date']}. After: "
              f"{after.version}, {b['cpu']}, {b['date']}."
              f"{'' if a['cpu'] == b['cpu'] else ' The machines differ: so do times.'}")]
    differing = compare_runs.differing_settings(before, after)
    if differing:
        parts.append(("paragraph", f"The studies differ: {differing}. What depends on these cannot "
                                   "be compared."))
    if pairs:
        parts += [*tables([compare_runs.counts_table(pairs)]),
                  *drawn(compare_runs.change_figures(pairs), prefix),
                  *tables(compare_runs.change_tables(pairs))]
    return Section(f"{after.folder} after {before.folder}", parts)


def numbered(sections):
    """Sections with the addresses of theirs and of their headings, as the table of contents has
    them: {"address", "title", "parts", "entries"}; a heading is (address, title) then."""
    found = []
    for i, section in enumerate(sections, 1):
        address, parts, entries = f"section-{i}", [], []
        for kind, item in section.parts:
            if kind in ("heading", "fold"):
                entries.append((f"{address}-{len(entries) + 1}",
                                item.title if kind == "fold" else item))
                item = (entries[-1][0], item)
            parts.append((kind, item))
        found.append({"address": address, "title": section.title, "parts": parts,
                      "entries": entries})
    return found


def page(title, sections, all_results=()):
    """The page, well-formed XML too; control characters, which it must not hold, become blanks."""
    def clean(value):
        if not isinstance(value, str):
            return value
        return type(value)("".join(c if c >= " " else " " for c in one_spelling(value)))

    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(Path(__file__).parent),
                                     autoescape=True, finalize=clean, trim_blocks=True,
                                     lstrip_blocks=True, undefined=jinja2.StrictUndefined)
    return environment.get_template("report.html.j2").render(
        title=title, sections=numbered(sections), glossary=Glossary(all_results))


def figures_in(parts):
    for kind, item in parts:
        if kind == "figures":
            yield from item
        elif kind == "fold":
            yield from figures_in(item.parts)
        elif kind == "beside":
            yield from figures_in(item)


def main(arguments):
    parser = argparse.ArgumentParser(
        description="Writes a page with figures and tables of results, report.html, which needs no "
        "other file and no network.")
    parser.add_argument("folders", metavar="RESULTS", type=Path, nargs="+",
                        help="folder of results; those after the first are compared with it")
    parser.add_argument("--output", metavar="FOLDER", type=Path,
                        help="folder of the page; left out: the first one with results")
    parser.add_argument("--without-fields", action="store_true",
                        help="no slices, histograms and cross-validation")
    parser.add_argument("--figures", metavar="FOLDER", type=Path,
                        help="folder for the figures as files too")
    options = parser.parse_args(arguments)
    results = [read_results(folder) for folder in options.folders]
    styles = figures.Styles([row for r in results for row in r.rows])

    def prefix(i):
        return f"{i}-" if len(results) > 1 else ""

    sections = [comparison_section(results[0], after, prefix(i))
                for i, after in enumerate(results[1:], 2)]
    for i, found in enumerate(results, 1):
        of = f"{found.folder}: " if len(results) > 1 else ""
        sections += [Section(of + section.title, section.parts) for section in results_sections(
            found, styles, prefix(i), not options.without_fields)]
    names = ", ".join(str(r.settings.get("name")) for r in results)
    path = (options.output or options.folders[0]) / "report.html"
    text = page(f"Control spaces: {names}", sections, results)
    if options.figures:
        for section in sections:
            for figure in figures_in(section.parts):
                write_file(options.figures / f"{figure.name}.{figure.kind}", figure.bytes)
    write_file(path, text)
    print(f"Report: {path}")
    return OK

# The command bench/report: a page with figures and tables of results that needs no other file.
import argparse
from collections import namedtuple
from pathlib import Path

import jinja2

from . import compare_runs, fields, figures, paper_page
from .command import OK
from .paper import Evidence
from .paper_command import evidence_in
from .results import KNOWN, read_results, write_file
from .table import fixed, table_of

Section = namedtuple("Section", "title parts")  # parts: (kind, item) as report.html.j2 shows them


def tables(items):
    return [("table", table) for table in items]


def titled(title, found):
    return [("heading", title), ("figures", found)] if found else []


def origin_table(results):
    head, settings = results.head, results.settings
    failed = len(results.rows) - len(results.measured)
    return table_of("origin", [
        ["program", results.version], *([key, head[key]] for key in ("commit", "compiler", "flags")),
        ["processor", head["cpu"]], ["cores, threads", f"{head['cores']}, {head['threads']}"],
        ["date (UTC)", head["date"]], ["command", head["command_line"]],
        ["sources, seed", f"{settings.get('sources')}, {settings.get('seed')}"],
        ["rows", f"{len(results.rows)}, {failed} failed"
         f"{'' if results.complete else '; not complete: cases are missing'}"]])


def front_tables(rows):
    for work, members in figures.fronts(rows).items():
        fronts = [(name, figures.front_of(members, cost, "delta_R_fine_max"))
                  for name, (_, _, cost) in zip(("memory", "access"), figures.COSTS)]
        lines = [[row.method, fixed(row["memory_MB"]), fixed(row["t_access_ns_random"], 1),
                  fixed(row["delta_R_fine_max"], 4),
                  ", ".join(name for name, front in fronts if row in front)]
                 for row in sorted(members, key=lambda r: r["delta_R_fine_max"])
                 if any(row in front for _, front in fronts)]
        yield table_of("front", lines, work=work)


def measure_cells(row):
    if row.measures is None:
        return ["–"] * 12 + [f"failed: {row.error}"]
    # Older results do not have these.
    share = row.measures.get("coarser_fine_share")
    within = row.measures.get("within_fine_max")
    numbers = [("memory_MB", 2), ("creation_s", 3), ("t_access_ns_random", 1),
               ("t_access_ns_grid", 1), ("delta_R_max", 4), ("delta_R_mean", 4), ("delta_R_p99", 4),
               ("delta_R_fine_max", 4)]
    return [str(row["cells"] or "–"), *(fixed(row[key], digits) for key, digits in numbers),
            "–" if share is None else f"{100 * share:.2f} %",
            "–" if within is None else f"{fixed(within, 3)}x", fixed(row["gradation_max_left"], 4),
            row["remark"]]


def measure_tables(rows):
    """All measures; those that texts.toml does not know have columns of their own."""
    more = list(dict.fromkeys(key for row in rows if row.measures
                              for key, value in row.measures.items() if key not in KNOWN
                              and isinstance(value, (int, float))))

    def own(row):
        values = (row.measures.get(key) if row.measures else None for key in more)
        return ["–" if value is None else f"{value:.4g}" for value in values]

    return [table_of("measures", [[row.label, *measure_cells(row), *own(row)] for row in members], more,
                     group=group)
            for group, members in figures.grouped(rows, figures.group_of).items()]


def results_section(results, styles, drawn):
    rows = results.measured
    evidence = Evidence(*evidence_in(results.folder))
    parts = tables([origin_table(results)])
    parts += titled("Error against memory and access time",
                    drawn(figures.pareto_figures(rows, styles)))
    parts += tables(front_tables(rows))
    if evidence.cells:
        parts += [("heading", "The paper's tables"), ("paragraph", paper_page.headline(evidence)),
                  ("figures", drawn(figures.paper_figures(evidence, styles)))]
        parts += tables(paper_page.summary_tables(evidence) + paper_page.side_by_side(evidence)
                        + paper_page.detail_tables(evidence))
    parts += titled("Creation time", drawn(figures.creation_figures(rows, styles)))
    parts += titled("Access time", drawn(figures.access_figures(rows)))
    parts += tables(measure_tables(results.rows))
    return Section(f"{results.settings.get('name')} ({results.folder})", parts)


def comparison_section(before, after, drawn):
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
                  ("figures", drawn(compare_runs.change_figures(pairs))),
                  *tables(compare_runs.change_tables(pairs))]
    return Section(f"{after.folder} after {before.folder}", parts)


def fields_section(results, drawn):
    sampled = fields.sampled_fields(results)
    parts = [("paragraph", "Fields are not shown: they were not sampled, or are not kept.")]
    if sampled:
        parts = [("paragraph", "Structures of the first setting, each with its first split."),
                 ("figures", drawn(fields.delta_figure(sampled))
                  + drawn(fields.cross_validation(sampled))),
                 *tables([fields.delta_table(sampled)]),
                 ("figures", drawn(fields.slice_figures(sampled)))]
    return Section(f"Fields of {results.settings.get('name')}", parts)


def page(title, sections):
    """The page, well-formed XML too; control characters, which it must not hold, become blanks."""
    def clean(value):
        return "".join(c if c >= " " else " " for c in value) if isinstance(value, str) else value

    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(Path(__file__).parent),
                                     autoescape=True, finalize=clean,
                                     undefined=jinja2.StrictUndefined)
    return environment.get_template("report.html.j2").render(title=title, sections=sections)


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

    def drawing(i, *made_from):
        prefix = f"{i}-" if len(results) > 1 else ""
        made_by = "; ".join(r.head["command_line"] for r in made_from)
        return lambda specs: figures.draw(specs, prefix, made_by)

    sections = [comparison_section(results[0], after, drawing(i, results[0], after))
                for i, after in enumerate(results[1:], 2)]
    for i, found in enumerate(results, 1):
        sections.append(results_section(found, styles, drawing(i, found)))
        if not options.without_fields:
            sections.append(fields_section(found, drawing(i, found)))
    names = ", ".join(str(r.settings.get("name")) for r in results)
    path = (options.output or options.folders[0]) / "report.html"
    text = page(f"Control spaces: {names}", sections)
    if options.figures:
        for kind, items in (part for section in sections for part in section.parts):
            for figure in items if kind == "figures" else ():
                write_file(options.figures / f"{figure.name}.{figure.kind}", figure.bytes)
    write_file(path, text)
    print(f"Report: {path}")
    return OK

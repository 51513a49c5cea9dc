# The command bench/report: a page with figures and tables of results that needs no other file.
import argparse
from collections import namedtuple
from pathlib import Path

import jinja2

from . import compare_runs, fields, figures, paper_page
from .command import OK
from .paper import Evidence
from .paper_command import evidence_in
from .results import write_file
from .table import Table, fixed

Section = namedtuple("Section", "title parts")  # parts: (kind, item) as report.html.j2 shows them


def tables(items):
    return [("table", table) for table in items]


def titled(title, found):
    return [("heading", title), ("figures", found)] if found else []


def origin_table(results):
    head = results.head
    failed = len(results.rows) - len(results.measured)
    return Table("Where it is from", "", ["<what", "<value"], [
        ["program", results.version], ["commit", head["commit"]], ["compiler", head["compiler"]],
        ["flags", head["flags"]], ["processor", head["cpu"]],
        ["cores, threads", f"{head['cores']}, {head['threads']}"], ["date (UTC)", head["date"]],
        ["command", head["command_line"]],
        ["sources, seed", f"{results.settings.get('sources')}, {results.settings.get('seed')}"],
        ["rows", f"{len(results.rows)}, {failed} failed"
         f"{'' if results.complete else '; not complete: cases are missing'}"]])


def front_tables(rows):
    found = []
    for work, members in figures.fronts(rows).items():
        fronts = [(name, figures.front_of(members, cost, "delta_R_fine_max"))
                  for name, (_, _, cost) in zip(("memory", "access"), figures.COSTS)]
        lines = [[row.front_label(), fixed(row["bytes_total"] / 1e6),
                  fixed(row["t_access_ns_random"], 1), fixed(row["delta_R_fine_max"], 4),
                  ", ".join(name for name, front in fronts if row in front)]
                 for row in sorted(members, key=lambda r: r["delta_R_fine_max"])
                 if any(row in front for _, front in fronts)]
        found.append(Table(f"On a front: {work}",
                           "No other row is as accurate (largest δ_R at the finer probes) and "
                           "smaller (memory), or as fast at random places (access).",
                           ["<structure", "MB", "random ns", "fine max", "<front of"], lines))
    return found


# Columns of the tables of measures: the head, and the text of a measured row.
MEASURES = [
    ("leaves", lambda r: str(r["cells"] or "–")), ("MB", lambda r: fixed(r["bytes_total"] / 1e6)),
    ("creation s", lambda r: fixed(r.creation_s, 3)),
    ("random ns", lambda r: fixed(r["t_access_ns_random"], 1)),
    ("grid ns", lambda r: fixed(r["t_access_ns_grid"], 1)),
    ("δ_R max", lambda r: fixed(r["delta_R_max"], 4)),
    ("δ_R mean", lambda r: fixed(r["delta_R_mean"], 4)),
    ("δ_R p99", lambda r: fixed(r["delta_R_p99"], 4)),
    ("fine max", lambda r: fixed(r["delta_R_fine_max"], 4)),
    ("fine coarser", lambda r: f"{100 * known(r, 'coarser_fine_share'):.2f} %"),
    ("worst", lambda r: fixed(known(r, "coarser_fine_max"), 3)),
    ("G left", lambda r: fixed(r["gradation_max_left"], 4)), ("<remark", lambda r: r["remark"])]


def known(row, key):
    """A measure that older results do not have."""
    value = row.measures.get(key)
    return float("nan") if value is None else value


def measure_tables(rows):
    found = []
    for group, members in figures.grouped(rows, lambda r: r.group()).items():
        lines = []
        for row in members:
            texts = [text(row) for _, text in MEASURES] if row.measures is not None else \
                ["–"] * (len(MEASURES) - 1) + [f"failed: {row.error}"]
            lines.append([row.setting["structure"] + row.variant(), row.split, *texts])
        found.append(Table(
            f"All measures: {group}",
            "Fine: at the finer probes. Coarser: share of them where a required length exceeds the "
            "reference's by over 1 % in some direction; worst: largest ratio of the two.",
            ["<structure", "<split", *(head for head, _ in MEASURES)], lines))
    return found


def results_section(results, styles, prefix):
    made_by = results.head["command_line"]
    rows = results.measured
    evidence = Evidence(*evidence_in(results.folder))
    parts = tables([origin_table(results)])
    parts += titled("Error against memory and access time",
                    figures.pareto_figures(rows, styles, prefix, made_by))
    parts += tables(front_tables(rows))
    if evidence.cells:
        parts += [("heading", "The paper's tables"), ("paragraph", paper_page.headline(evidence)),
                  ("figures", figures.paper_figures(evidence, styles, prefix, made_by))]
        parts += tables(paper_page.summary_tables(evidence) + paper_page.side_by_side(evidence)
                        + paper_page.detail_tables(evidence))
    parts += titled("Creation time", figures.creation_figures(rows, styles, prefix, made_by))
    parts += titled("Access time", figures.access_figures(rows, prefix, made_by))
    parts += tables(measure_tables(results.rows))
    return Section(f"{results.settings.get('name')} ({results.folder})", parts)


def comparison_section(before, after, prefix):
    pairs = compare_runs.row_pairs(before, after)
    a, b = before.head, after.head
    text = (f"{len(pairs)} rows of {len(before.rows)} have the same setting as one of "
            f"{len(after.rows)}. Before: {before.version}, {a['cpu']}, {a['date']}. After: "
            f"{after.version}, {b['cpu']}, {b['date']}."
            f"{'' if a['cpu'] == b['cpu'] else ' The machines differ: so do times.'}")
    parts = [("paragraph", text)]
    differing = compare_runs.differing_settings(before, after)
    if differing:
        parts.append(("paragraph", f"The studies differ: {differing}. What depends on these cannot "
                                   "be compared."))
    if pairs:
        made_by = f"{a['command_line']}; {b['command_line']}"
        parts += [*tables([compare_runs.counts_table(pairs)]),
                  ("figures", compare_runs.change_figures(pairs, prefix, made_by)),
                  *tables(compare_runs.change_tables(pairs))]
    return Section(f"{after.folder} after {before.folder}", parts)


def fields_section(results, prefix):
    sampled = fields.sampled_fields(results)
    made_by = results.head["command_line"]
    parts = [("paragraph", "Structures of the first setting, each with its first split.")]
    if sampled is None:
        parts = [("paragraph", "Fields are not shown: they were not sampled, or are not kept.")]
    else:
        parts += [("figures", [fields.delta_figure(sampled, prefix, made_by),
                               fields.cross_validation(sampled, prefix, made_by)]),
                  *tables([fields.delta_table(sampled)]),
                  ("figures", fields.slice_figures(sampled, prefix, made_by))]
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
    results = [evidence_in(folder)[0] for folder in options.folders]
    styles = figures.Styles([row for r in results for row in r.rows])
    several = len(results) > 1
    sections = [comparison_section(results[0], after, f"{i}-")
                for i, after in enumerate(results[1:], 2)]
    for i, found in enumerate(results, 1):
        prefix = f"{i}-" if several else ""
        sections.append(results_section(found, styles, prefix))
        if not options.without_fields:
            sections.append(fields_section(found, prefix))
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

# SPDX-License-Identifier: Apache-2.0
# The command bench/tables: results as tables in Markdown, and their Pareto fronts.
import argparse
from pathlib import Path

from .command import OK
from .fronts import front_tables, fronts_json
from .measure_tables import measure_tables, verdicts
from .mesh_tables import mesh_tables, read_meshes
from .results import grouped, read_results, write_file
from .table import TEXTS, shown

NOT_COMPLETE = "Not complete: cases are missing.\n\n"


def summary(results):
    """The page summary.md of a study: what was run, all measures, the fronts, and which structure to take."""
    head = results.head
    rows_of = grouped(results.rows, lambda row: row.group)
    tables = []
    for group, table in measure_tables(results.rows).items():
        table.title = f"All measures: {group}"
        table.note = TEXTS["summary"]["measures"] + verdicts(rows_of[group])
        tables.append(table)
    for work, table in front_tables(results.rows):
        table.title = f"On a front: {work}"
        tables.append(table)
    text = (f"# {results.settings['name']}\n\ncontrolspace {results.version}, {head['compiler']}, {head['cpu']} "
            f"({head['cores']} cores, {head['threads']} threads), {head['date']}.\n\n"
            f"Sources: {shown(results.settings.get('sources'))}. Seed {results.settings.get('seed')}.\n\n"
            f"`{head['command_line']}`\n\n{'' if results.complete else NOT_COMPLETE}"
            + "\n".join(table.markdown() for table in tables))
    several = len({outcome.work for outcome in results.outcomes}) > 1
    for outcome in results.outcomes:
        text += f"\n## Which structure to take{f': {outcome.work}' if several else ''}\n\n"
        text += "".join(f"- {sentence}\n" for sentence in outcome.sentences)
    return text


def mesh_summary(data):
    return (f"# {data['name']}\n\n{data['origin']}: `{data['command_line']}`\n\n"
            f"{'' if data['complete'] else NOT_COMPLETE}"
            + "\n".join(table.markdown() for table in mesh_tables(data)))


def write_tables(folder):
    """Returns the files written."""
    if (folder / "meshes.json").exists():
        files = {"summary.md": mesh_summary(read_meshes(folder))}
    else:
        results = read_results(folder)
        files = {"summary.md": summary(results), "pareto.json": fronts_json(results.rows)}
    for name, text in files.items():
        write_file(folder / name, text)
    return [folder / name for name in files]


def main(arguments):
    parser = argparse.ArgumentParser(
        prog="bench/tables",
        description="Writes results as tables in Markdown into their folders: summary.md, with all measures, the "
        "Pareto fronts of error against memory and access time, and which structure to take; the fronts in "
        "pareto.json too. Of results of `controlspace mesh`: all measures, the lengths of edges, and the rank "
        "correlation of L_R and δ_R.",
        epilog="Exit status: 0 all went well; 2 what was given cannot be used.")
    parser.add_argument("folders", metavar="RESULTS", type=Path, nargs="+",
                        help="folder with the results.json of `controlspace compare` or the meshes.json of "
                        "`controlspace mesh`")
    for folder in parser.parse_args(arguments).folders:
        for file in write_tables(folder):
            print(f"Tables: {file}")
    return OK

# SPDX-License-Identifier: Apache-2.0
# The command bench/paper.
import argparse
import json
import time
import tomllib
from pathlib import Path

from . import paper_page
from .command import CASES_FAILED, OK, Program
from .paper import DATA, Evidence
from .results import InputError, read_results, write_file

STUDIES = DATA / "studies"
# Experiments on why cells differ: the folder of their results in that of the cells, and the study.
EXPERIMENTS = [("experiments", "paper-experiments.toml"), ("tie-order-x", "paper-tie-order-x.toml"),
               ("tie-order-zx", "paper-tie-order-zx.toml"), ("round-off", "paper-round-off.toml")]


def experiments_in(folder):
    return [Path(folder) / name for name, _ in EXPERIMENTS
            if (Path(folder) / name / "results.json").exists()]


def evidence_in(folder):
    """Results of a folder and of the experiments that lie in it."""
    return [read_results(place) for place in (folder, *experiments_in(folder))]


def study_at(study, keeps):
    """A study file, as Python reads it, with the densities and l_min of which keeps(key, x)."""
    runs = []
    for run in study["runs"]:
        kept = dict(run)
        for key in ("rho", "tau"):
            values = run.get(key, study.get(key, 1))
            values = values if isinstance(values, list) else [values]
            kept[key] = [x for x in values if keeps(key, x)]
        if kept["rho"] and kept["tau"]:
            runs.append(kept)
    return {**study, "runs": runs}


def toml_text(study):
    """A study file: numbers, strings and lists are the same in TOML and in JSON."""
    lines = [f"{key} = {json.dumps(value)}" for key, value in study.items() if key != "runs"]
    for run in study["runs"]:
        lines += ["", "[[runs]]", *(f"{key} = {json.dumps(value)}" for key, value in run.items())]
    return "\n".join(lines) + "\n"


def run_study(program, name, folder, keeps, options):
    """Runs a study of data/studies at some of its settings; its results go to `folder`."""
    study = study_at(tomllib.loads((STUDIES / name).read_text(encoding="utf-8")), keeps)
    if not study["runs"]:
        return
    write_file(folder / "study.toml", toml_text(study))
    program.compare(folder / "study.toml", "--output", folder, *options)


def run_experiments(program, folder, evidence, options):
    """Runs those whose results do not lie in `folder` yet, at the settings of the cells."""
    def keeps(key, x):
        return any(abs(x - getattr(cell.paper, key)) <= 0.05 * x for cell in evidence.cells)

    if evidence.cells:
        for name, study in EXPERIMENTS:
            if not (folder / name / "results.json").exists():
                run_study(program, study, folder / name, keeps, options)


def parsed(arguments):
    parser = argparse.ArgumentParser(
        description="Sets rows beside the paper's Tables 1-4, cell by cell: prints a summary and "
        "writes paper.md into the first folder of results. Of results of `controlspace mesh`: "
        "Table 5.",
        epilog="Exit status: 0 all went well; 2 what was given cannot be used; 3 some cases failed; "
        "130 stopped by Ctrl-C")
    parser.add_argument("folders", metavar="RESULTS", type=Path, nargs="*",
                        help="folder of results; left out: the paper's tables at rho = 1 and the "
                        "experiments are run")
    parser.add_argument("--experiments", action="store_true",
                        help="run the experiments on why cells differ, at the settings of the "
                        "cells, unless they lie in the folder")
    parser.add_argument("--if-any", action="store_true",
                        help="no page, and no error, where no row was run as the paper's tables")
    parser.add_argument("--full", action="store_true", help="without RESULTS: rho = 0.2 too")
    parser.add_argument("--output", metavar="FOLDER", type=Path,
                        help="without RESULTS: new folder for them")
    parser.add_argument("--program", metavar="FILE", help="controlspace, where it is not found")
    parser.add_argument("--quiet", action="store_true", help="no progress on standard error")
    options = parser.parse_args(arguments)
    if options.folders and (options.full or options.output):
        parser.error("--full and --output are for what is run: leave out the folders")
    return options


def main(arguments):
    options = parsed(arguments)
    quiet = ["--quiet"] if options.quiet else []
    folders = options.folders
    if not folders:
        folder = options.output or Path("results") / time.strftime("paper-%Y%m%d-%H%M%S",
                                                                   time.gmtime())
        run_study(Program(options.program), "paper.toml", folder,
                  lambda key, x: options.full or key != "rho" or x >= 1, quiet)
        folders = [folder]
    first = folders[0]
    if (first / "meshes.json").exists():
        text = paper_page.table_5(first / "meshes.json")
        write_file(first / "paper.md", text)
        print(text, end="")
        return OK
    results = [r for folder in folders for r in evidence_in(folder)]
    if not Evidence(*results).cells:
        if options.if_any:
            return OK
        raise InputError(f"{first}: no row was run as the paper's tables: give results of "
                         "`controlspace compare --as-published`")
    if options.experiments or not options.folders:
        run_experiments(Program(options.program), first, Evidence(*results), quiet)
        results = [r for folder in folders for r in evidence_in(folder)]
    evidence = Evidence(*results)
    write_file(first / "paper.md", paper_page.page(evidence, [r.origin for r in results]))
    print(paper_page.summary(evidence))
    print(f"Every cell and experiment: {first / 'paper.md'}")
    failed = any(row.error for r in results for row in r.rows)
    return CASES_FAILED if failed else OK

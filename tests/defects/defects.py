#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures how sharp the tests are: puts each defect of tests/defects into a copy of the tree, builds, and runs the tests
up to the first failure. A defect that no test finds is a gap of the suite.

    tests/defects/defects.py                         all defects, those measured before left out
    tests/defects/defects.py --only NAME             one of them; may be repeated
    tests/defects/defects.py --before COMMIT         what is not found, by the tests of COMMIT too, in a second copy
    tests/defects/defects.py --fresh                 measures all again

Results are build/defects/results.csv; `--summary FOLDER` writes them there, with a table in Markdown, and measures
nothing. A run stops after --minutes and goes on in the next one. Of a patch the head names what is wrong (What), in
which part (Area), and the test program that is run before all others (First). The copies are kept, so that a defect
costs the files that it changes.
"""

import argparse
import csv
import hashlib
import os
import re
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "build/defects"
# What takes minutes for each defect, and runs the same code as others do.
LEFT_OUT = "^(mpi|faults|package|pages|examples|formats): "
# A defect may make a test endless. Far longer than any takes, on a machine that does other things too.
LONGEST_S = 1500
COLUMNS = ["defect", "area", "what", "found", "by", "seconds", "before", "patch"]


def copy_tree(to):
    """Copies what differs alone: the rest need not be built again."""
    names = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\0")
    for name in filter(None, names):
        source, copy = ROOT / name, to / name
        if not source.is_file():
            copy.unlink(missing_ok=True)
            continue
        if not copy.exists() or copy.read_bytes() != source.read_bytes():
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_bytes(source.read_bytes())
            copy.chmod(source.stat().st_mode)


def checkout(commit, to):
    if not (to / ".git").exists():
        quiet(["git", "clone", "--quiet", "--shared", ROOT, to], ROOT)
    quiet(["git", "checkout", "--quiet", "--force", commit], to)


def quiet(command, folder, fatal=True):
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace")
    if done.returncode != 0 and fatal:
        sys.exit(" ".join(map(str, command)) + "\n" + (done.stdout + done.stderr)[-6000:])
    return done.returncode == 0


def build(tree, *targets):
    if not (tree / "build/ci/build.ninja").exists():
        # File by file: a defect costs the files that it changes, and not those compiled with them.
        quiet(["cmake", "--preset", "ci", "-DCONTROLSPACE_UNITY=OFF"], tree)
    return quiet(["ninja", "-C", "build/ci", *targets], tree)


def tests(tree, *options):
    """The first test that fails, and None if none does."""
    done = subprocess.run(
        ["ctest", "--test-dir", "build/ci", "--parallel", str(os.cpu_count()), "--stop-on-failure",
         "--no-tests=error", "--timeout", str(LONGEST_S), *options],
        cwd=tree, capture_output=True, text=True, errors="replace")
    if done.returncode == 0:
        return None
    failed = re.search(r"^\s*\d+ - (.+) \((Failed|Timeout|[A-Z]+|.*[Ee]xception.*)\)\s*$", done.stdout, re.M)
    return failed[1] if failed else sys.exit(done.stdout[-4000:] + done.stderr[-4000:])


def head_of(patch):
    return dict(line.split(": ", 1) for line in patch.read_text().partition("---")[0].splitlines())


def suite_of(program):
    return "^" + program.removeprefix("tests_") + ": "


def measure(tree, patch, first, others):
    """Which test finds the defect in a tree, and None if none does: of the program `first`, and of all others."""
    quiet(["patch", "-p1", "--forward", "--input", patch], tree)
    try:
        build(tree, first)
        by = tests(tree, "--tests-regex", suite_of(first))
        if by is None and others:
            build(tree)
            by = tests(tree, "--exclude-regex", f"{suite_of(first)}|{LEFT_OUT}")
        return by
    finally:
        quiet(["patch", "-p1", "--reverse", "--input", patch], tree)


def read_results(file):
    if not file.exists():
        return {}
    with open(file, newline="") as text:
        return {row["defect"]: row for row in csv.DictReader(text)}


def write_results(file, results):
    file.parent.mkdir(parents=True, exist_ok=True)
    with open(file, "w", newline="") as text:
        table = csv.DictWriter(text, COLUMNS, lineterminator="\n")
        table.writeheader()
        table.writerows(row for _, row in sorted(results.items(), key=lambda item: (item[1]["area"], item[0])))


def summary(results, folder):
    write_results(folder / "defects.csv", results)
    rows = list(read_results(folder / "defects.csv").values())
    count = {word: sum(row["found"] == word for row in rows) for word in ("yes", "no", "open")}
    patches = len(list((ROOT / "tests/defects").glob("*.patch")))
    lines = ["# Defects that the tests find", "",
             f"Each defect is a patch of `tests/defects`, put into a copy of the tree by itself. Of {patches}, {len(rows)} were "
             f"measured: {count['yes']} are found, {count['no']} are not, and {count['open']} were run over by the program "
             "that their patch names first alone, which does not find them. Made by `tests/defects/defects.py`, then "
             "`--summary bench/results/defects`.", "",
             "\"Found by\" is the first test that failed: of the program that the patch names first, then of the others. "
             "Tests of MPI, faults, packages, pages and examples are left out. Where none found it, the last column says what "
             "the tests of an earlier commit (`--before`) made of it.", "",
             "| area | defect | what is wrong | found by | before |", "|---|---|---|---|---|"]
    for row in rows:
        by = {"yes": row["by"], "no": "**not found**", "open": "open"}[row["found"]]
        lines.append(f"| {row['area']} | {row['defect']} | {row['what']} | {by} | {row['before']} |")
    (folder / "README.md").write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", action="append", help="a patch without .patch; may be repeated")
    parser.add_argument("--before", help="a commit whose tests run over what is not found")
    parser.add_argument("--fresh", action="store_true")
    parser.add_argument("--minutes", type=float, default=55, help="no defect is begun after them (55)")
    parser.add_argument("--summary", type=Path, metavar="FOLDER")
    options = parser.parse_args()

    file = FOLDER / "results.csv"
    results = read_results(file)
    if options.summary:
        summary(results, options.summary)
        return 0
    patches = sorted((ROOT / "tests/defects").glob("*.patch"))
    if options.only:
        patches = [patch for patch in patches if patch.stem in options.only]
    if not patches:
        sys.exit("no defect is called so")
    digest = {patch: hashlib.sha256(patch.read_text().partition("\n---")[2].encode()).hexdigest()[:12] for patch in patches}

    if options.fresh or options.only:
        for patch in patches:
            results.pop(patch.stem, None)

    def is_open(patch, others):
        row = results.get(patch.stem)
        if row is None or row["patch"] != digest[patch]:
            return True
        return others and (row["found"] == "open" or
                           row["found"] == "no" and bool(options.before) and row["before"] == "")

    end = time.monotonic() + 60 * options.minutes
    tree, old = FOLDER / "tree", FOLDER / "before"
    copy_tree(tree)
    sound = set()  # programs whose tests pass without a defect
    # What the programs named first find costs little: they go over all defects before any other program does.
    for others in (False, True):
        left = [patch for patch in patches if is_open(patch, others)]
        for number, patch in enumerate(left):
            if time.monotonic() > end:
                print(f"{len(left) - number} defects left: call again", flush=True)
                return 4
            head = head_of(patch)
            if head["First"] not in sound:
                build(tree, head["First"])
                if failed := tests(tree, "--tests-regex", suite_of(head["First"])):
                    sys.exit(f"without a defect: {failed} fails")
                sound.add(head["First"])
            start = time.monotonic()
            by = measure(tree, patch, head["First"], others)
            row = {"defect": patch.stem, "area": head["Area"], "what": head["What"],
                   "found": "yes" if by else "no" if others else "open", "by": by or "",
                   "seconds": round(time.monotonic() - start), "before": "", "patch": digest[patch]}
            if row["found"] == "no" and options.before:
                checkout(options.before, old)
                by = measure(old, patch, head["First"], True)
                row["before"] = f"found by {by}" if by else "not found"
            results[patch.stem] = row
            write_results(file, results)
            print(f"{patch.stem}: {'found by ' + row['by'] if row['by'] else row['found'] + ' ' + row['before']} "
                  f"({row['seconds']} s)", flush=True)
    missed = [name for name, row in results.items() if row["found"] != "yes"]
    print(f"{len(results) - len(missed)} of {len(results)} defects found" + "".join(f"\nNOT FOUND: {name}" for name in missed))
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())

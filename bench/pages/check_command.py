# SPDX-License-Identifier: Apache-2.0
# The command bench/check: whether two runs of the same cases, on two machines or by two compilers,
# have the same results. Times are not compared.
import argparse
import math

from .command import OK
from .results import PAPER_TIMES, InputError, read_results

DIFFERENT = 1
SHOWN = 3  # of the numbers that differ in a case
TOLERANCE = 1e-10  # relative, of numbers that are no counts
# Settings that say where accuracy is measured: where they differ nothing can be compared.
PLACES = ["domain", "margin", "seed", "access_points", "probe_grid", "fine_probe_grid",
          "reference_tolerance"]


NOT_COMPARED = {*PAPER_TIMES, "access_batch", "size_MB", "memory_MB", "metrics_MB"}


def compared(row):
    return {key: value for key, value in row.measures.items()
            if isinstance(value, (int, float)) and not key.startswith("t_") and key not in NOT_COMPARED}


def row_pairs(here, there):
    of_case = {(row.key, row.sources): row for row in there.measured}
    return [(row, of_case[row.key, row.sources]) for row in here.measured
            if (row.key, row.sources) in of_case]


def differs(a, b):
    """Whether two numbers are not the same; None where they are, but for rounding."""
    if a == b:
        return False
    if isinstance(a, int) and isinstance(b, int):
        return True
    return None if math.isclose(a, b, rel_tol=TOLERANCE) else True


def check(here, there):
    """Lines of a report, and whether something differs beyond rounding."""
    other = [key for key in PLACES if here.settings.get(key) != there.settings.get(key)]
    if other:
        raise InputError(f"the runs differ in {', '.join(other)}: give runs of the same study")
    pairs = row_pairs(here, there)
    if not pairs:
        raise InputError("the runs have no case in common: give runs of the same study")
    equal = rounded = different = 0
    cases = []
    for a, b in pairs:
        numbers_of_b = compared(b)
        texts = []
        for key, value in compared(a).items():
            if key not in numbers_of_b:
                continue
            state = differs(value, numbers_of_b[key])
            if state:
                texts.append(f"{key} {value!r}, there {numbers_of_b[key]!r}")
            equal += state is False
            rounded += state is None
        different += len(texts)
        if texts:
            more = f"; and {len(texts) - SHOWN} more" if len(texts) > SHOWN else ""
            cases.append(f"{a.label}, {a.group}: {'; '.join(texts[:SHOWN])}{more}")
    bits = sum(a.measures.get("checksum") == b.measures.get("checksum") for a, b in pairs)
    lines = [f"here   {here.origin}", f"there  {there.origin}",
             f"{len(pairs)} cases in both, of {len(here.measured)} here and {len(there.measured)} there; "
             f"metrics at random places: the same bits in {bits} of them",
             f"{equal + rounded + different} counts, sizes and errors: {equal} equal, {rounded} within "
             f"{TOLERANCE:g}, {different} different"]
    return lines + cases, different > 0


def main(arguments):
    parser = argparse.ArgumentParser(
        prog="bench/check", description="Compares the results of two runs of the same cases, but for times.",
        epilog="Exit status: 0 the same, but for rounding; 1 different; 2 they cannot be compared.")
    parser.add_argument("results", help="folder of results")
    parser.add_argument("kept", help="folder of results to compare with, such as bench/results/paper-sphere-quick")
    given = parser.parse_args(arguments)
    lines, is_different = check(read_results(given.results), read_results(given.kept))
    print("\n".join(lines))
    return DIFFERENT if is_different else OK

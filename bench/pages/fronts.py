# SPDX-License-Identifier: Apache-2.0
# Pareto fronts of error against memory and access time.
import json
import math
from itertools import product

from .results import grouped
from .table import fixed, table_of

# What they are of: the name, the label of an axis, and the measure.
COSTS = [("memory", "memory [MB]", "memory_MB"),
         ("access time", "access at random places [ns/query]", "t_access_ns_random")]
FRONT_ERRORS = [("Largest", "largest δ_R at the finer probes", "delta_R_fine_max"),
                ("Mean", "mean δ_R at the finer probes", "delta_R_fine_mean")]


def fronts(rows):
    """Measured rows of the same work (sources, law and reference, at whatever τ, target or voxel), where
    there are two or more."""
    rows = [row for row in rows if row.measures and math.isfinite(row["delta_R_fine_max"])]
    return {work: found for work, found in grouped(rows, lambda r: r.work).items()
            if len(found) > 1}


def front_of(rows, cost, error):
    """The rows that no other beats: none of at most this error has a smaller cost, beyond the quartiles
    of times, and none of equal cost a smaller error. Rows that a limit stopped are not compared."""
    points = [(row, row[cost], *row.spread(cost), row[error]) for row in rows
              if not row.measures.get("stopped")]
    return [row for row, at, low, _, e in points
            if not any(y <= e and high < low or y < e and x == at for _, x, _, high, y in points)]


def front_tables(rows):
    """A table for each work: the rows on a front of largest errors, by rising error."""
    for work, members in fronts(rows).items():
        on = [(name, front_of(members, cost, "delta_R_fine_max"))
              for name, (_, _, cost) in zip(("memory", "access"), COSTS)]
        lines = [[row.method, fixed(row["memory_MB"]), fixed(row["t_access_ns_random"], 1),
                  fixed(row["delta_R_fine_max"], 4),
                  ", ".join(name for name, front in on if row in front)]
                 for row in sorted(members, key=lambda r: r["delta_R_fine_max"])
                 if any(row in front for _, front in on)]
        yield work, table_of("front", lines)


def fronts_json(rows):
    """[{work, cost, error, points: [{label, cost, error, front}]}], points in the order of the rows."""
    plots = []
    for work, members in fronts(rows).items():
        for cost, (_, _, error) in product(("bytes_total", "t_access_ns_random"), FRONT_ERRORS):
            front = front_of(members, cost, error)
            plots.append({"work": work, "cost": cost, "error": error, "points": [
                {"label": row.method, "cost": float(row[cost]), "error": float(row[error]),
                 "front": row in front} for row in members]})
    return json.dumps(plots, indent=1, ensure_ascii=False) + "\n"

# SPDX-License-Identifier: Apache-2.0
# Tables of all measures of rows, and which row is fastest.
from .results import grouped, own_measures
from .table import TEXTS, table_of

MEASURES = TEXTS["tables"]["measures"]["measures"]  # key, column, format, perhaps scale and least


def cell_of(value, measure):
    return "–" if value is None else measure["format"].format(value * measure.get("scale", 1))


def measure_tables(rows):
    """For each group of rows a table of all measures; those that texts.toml does not know have columns of
    their own, and those that an earlier program did not have are left out."""
    known = {key for row in rows for key in row.measures or ()}
    measures = [m for m in MEASURES if m["key"] in known or not known]
    more = [{"key": key, "format": "{:.4g}"} for key in own_measures(rows)]

    def line(row):
        values = row.measures or {}
        remark = values["remark"] if values else f"failed: {row.error}"
        return [row.label, *(cell_of(values.get(m["key"]), m) for m in [*measures, *more]), remark]

    heads = [*(m["column"] for m in measures), *(m["key"] for m in more), "<remark"]
    return {group: table_of("measures", [line(row) for row in members], heads)
            for group, members in grouped(rows, lambda r: r.group).items()}


def fastest_of(rows, key):
    """Those whose quartiles overlap with those of the smallest median; none where not all of them were
    timed in turns."""
    if len({row.measures.get("access_batch") for row in rows}) > 1:
        return []
    limit = min(rows, key=lambda row: row[key]).spread(key)[1]
    return [row for row in rows if row.spread(key)[0] <= limit]


def verdicts(rows):
    """" Fastest access at random places: K_L s_L.", of a group of rows; nothing of less than two."""
    text = ""
    for measure in MEASURES:
        timed = [row for row in rows if row.measures and not row.measures.get("stopped")
                 and row.measures.get(measure["key"]) is not None]
        if "least" not in measure or len(timed) < 2:
            continue
        names = [row.label for row in fastest_of(timed, measure["key"])]
        text += f" {measure['least']}: " + (
            "no statement, since the rows were not timed in turns." if not names else
            f"{'indistinguishable between ' * (len(names) > 1)}{'; '.join(names)}.")
    return text

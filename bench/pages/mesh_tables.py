# SPDX-License-Identifier: Apache-2.0
# Tables of meshes.json, the results of `controlspace mesh`.
import json
import re

from .ranks import spearman
from .results import InputError, described, grouped
from .table import TEXTS, Table

# Key, header and format; of a number times `scale`.
COLUMNS = [("tets", "tets", "{}"), ("nodes", "nodes", "{}"), ("mesh_s", "s", "{:.1f}"),
           ("mesh_processor_s", "CPU s", "{:.1f}"), ("peak_bytes", "MB", "{:.0f}", 1e-6),
           ("L_R", "L_R", "{:.4f}"), ("L_R_beside_exact", "-exact", "{:+.4f}"),
           ("L_R_middle", "middle", "{:.4f}"), ("unit_share", "unit", "{:.4f}"),
           ("mean_length", "length", "{:.3f}"), ("quality_min", "q min", "{:.3f}"),
           ("quality_mean", "q mean", "{:.3f}"), ("queries", "queries", "{}"),
           ("query_share", "share", "{:.2f} %", 100), ("delta_R_max", "δ_R max", "{:.3f}"),
           ("delta_R_mean", "δ_R mean", "{:.4f}")]


def read_meshes(folder):
    """The contents of FOLDER/meshes.json; rows have what follows from the rest too. Throws InputError."""
    file = folder / "meshes.json"
    try:
        data = json.loads(file.read_text(encoding="utf-8"))
        data["name"] = data.get("study", {}).get("name", folder.name)
        for row in data["rows"]:
            row["group"] = f"{row['mesher']}, {row['setting']}"
            if row["error"]:
                continue
            row["query_share"] = row["query_s"] / row["mesh_processor_s"]
            if "label" not in row:  # of an earlier program
                row["label"] = old_label(row)
                exact = exact_beside(row, data["rows"])
                if exact:
                    row["L_R_beside_exact"] = row["L_R"] - exact["L_R"]
        return data
    except OSError as error:
        raise InputError(f"{file}: {error.strerror.lower()}") from error
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(f"{file}: {described(error)}") from error


def old_label(row):
    case = row.get("case") or {}
    target = f", δ <= {case['target_delta']:.4g}" if case.get("target_delta") and row["field"] != "exact" else ""
    return f"{row['field']}{'' if target else ' ' + row['split']}".strip() + target


def exact_beside(row, rows):
    """The mesh of the same mesher with the exact field of the same sources: its tau may be another."""
    def field(row):
        return row["mesher"], re.sub(r"\b(tau|epsilon) [^,;]+", "", row["setting"])

    return next((other for other in rows if other["field"] == "exact" and not other["error"]
                 and field(other) == field(row)), None)


def correlation_text(rows):
    """"Rank correlation of L_R with ...", or nothing where there are too few structures."""
    rows = [row for row in rows if not row["error"] and "delta_R_max" in row]
    largest, mean = (spearman([row["L_R"] for row in rows], [row[key] for row in rows])
                     for key in ("delta_R_max", "delta_R_mean"))
    if largest is None or mean is None:
        return ""
    return (f" Rank correlation (Spearman) of L_R with the largest δ_R {largest:.2f}, with the mean one "
            f"{mean:.2f}.")


def cell_of(row, key, text, scale=1):
    value = row.get(key)
    return "–" if value is None else text.format(value * scale)


def tables_of(title, rows, bounds):
    """The measures of the meshes, and the lengths of their edges."""
    yield Table(f"Meshes: {title}", TEXTS["summary"]["meshes"] + correlation_text(rows),
                ["<field", *(column[1] for column in COLUMNS), "<remark"],
                [[row["label"], *(cell_of(row, key, *form) for key, _, *form in COLUMNS),
                  f"failed: {row['error']}" if row["error"] else row.get("shortfall", "")] for row in rows])
    ends = ["0", *(f"{bound:.3g}" for bound in bounds), ""]
    yield Table(f"Edges by metric length [%]: {title}", "",
                ["<field", *(f"{a}–{b}" for a, b in zip(ends, ends[1:]))],
                [[row["label"], *(f"{100 * count / row['edges']:.2f}" for count in row["histogram"])]
                 for row in rows if not row["error"]])


def mesh_tables(data):
    for title, rows in grouped(data["rows"], lambda row: row["group"]).items():
        yield from tables_of(title, rows, data["length_bounds"])

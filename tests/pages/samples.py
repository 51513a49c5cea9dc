# Results as `controlspace compare` writes them, for tests.
import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bench"))

import numpy as np  # noqa: E402
from pages.paper import PAPER_ROWS, Evidence  # noqa: E402
from pages.results import Results, Row  # noqa: E402

HEAD = {"schema_version": 2, "program": "controlspace", "version": "0.1.0", "commit": "0123456789abc",
        "dirty": False, "compiler": "GNU 12", "flags": "-O3", "cpu": "a processor", "cores": 2,
        "threads": 2, "seed": 1, "date": "2026-01-01T00:00:00Z", "command_line": "controlspace …"}
SETTINGS = {"name": "a study", "sources": "sphere", "centre": [0.0, 0.0, 0.0], "radius": 0.8,
            "h": 0.015, "domain": [], "seed": 1, "probe_grid": 4, "fine_probe_grid": 101,
            "output": "out", "runs": []}
DEFAULTS = {"split": "s_L", "rho": 1.0, "tau": 1.0, "epsilon": 0.2, "g_r": 1.25, "s_a": 2.0,
            "s_n": 1.0, "sampling": "regular", "field": "none",
            "frozen": "no", "law": "cone", "schedule": "sources", "neighbourhood": "faces",
            "reference": "exact", "interpolation": "corrected"}
PUBLISHED = {"law": "mean-length", "schedule": "passes", "reference": "published-sphere"}


def times(key, *samples):
    """A time that was sampled: median, quartiles and samples."""
    low, median, high = np.quantile(samples, [0.25, 0.5, 0.75])
    return {key: median, f"{key}_q1": low, f"{key}_q3": high, f"{key}_samples": list(samples)}


def sized(structure, megabytes, control_nodes=103):
    """Counts of a tree without inner nodes of that size in the paper's accounting."""
    size = megabytes * 1e6 - 104 * (not structure.startswith("K_o"))
    size -= 104 * control_nodes * (structure in ("K_V", "K_oV"))
    cells = round(size / 136)
    return {"tree_nodes": cells, "cells": cells, "control_nodes": control_nodes}


def json_row(structure="K_L", split=None, **changes):
    """A row as in results.json: of the paper's sphere, run as published, unless changed."""
    row = {"structure": structure, "split": split, "rho": 1.0, "tau": 1.0, "epsilon": 0.2,
           "g_r": 1.25, "s_a": 2.0, "s_n": 1.0, "sampling": "regular", "field": "none",
           "max_depth": 42 if split else 14, "voxel": None,
           "frozen": "no", **PUBLISHED, "neighbourhood": "faces", "sources": 36186,
           "sources_inserted": 35852, "tree_nodes": 205, "cells": 103, "control_nodes": 103,
           "depth": 9, "bytes_total": 1230000, "bytes_payload": 1000000, "bytes_topology": 200000,
           "bytes_auxiliary": 30000, **times("t_insert_s", 1.5),
           **times("t_gradation_s", 0.25), **times("t_creation_s", 1.75),
           **times("t_access_ns_random", 50.0, 51.0, 52.0),
           **times("t_access_ns_grid", 12.0, 10.0, 11.0),
           **times("t_access_ns_single", 72.0, 70.0, 71.0), "access_batch": 0, "delta_S_max": 0.1,
           "delta_R_max": 1.78, "delta_R_mean": 0.1, "delta_R_p95": 0.3, "delta_R_p99": 0.4,
           "delta_R_fine_max": 2.78, "delta_R_fine_mean": 0.17, "delta_R_fine_p95": 0.3,
           "delta_R_fine_p99": 0.4, "delta_metric_R_max": 5.0, "coarser_max": 1.3,
           "coarser_share": 0.06, "coarser_fine_max": 1.4, "coarser_fine_share": 0.07,
           "within_max": 1.3, "within_fine_max": 1.4,
           "gradation_max_left": 1.2499, "gradation_operations": 12345,
           "checksum": "0123456789abcdef", "remark": "", "error": "", "fields": None, "labels": None}
    # Settings that the rows above do not have stand before the sources.
    own = {key: value for key, value in changes.items() if key not in row}
    row = {"structure": structure, **own, **row, **changes}
    row["labels"] = labels(row)
    return row


def labels(row):
    """As the program makes them, more or less."""
    structure = f"{row['structure']} {row['split'] or ''}".strip()
    work = f"rho {row['rho']:g}, s_a 2, s_n 1, g_r 1.25, {row['reference']} reference"
    tau = f", tau {row['tau']:g}"
    return {"structure": structure, "work": work, "method": structure + tau * (row["tau"] != 1),
            "setting": f"{work}, {row['law']} law, {row['schedule']}, epsilon 0.2{tau}"}


def failed_row(error, **changes):
    row = json_row(**changes)
    last = list(row).index("sources")
    return {key: value if i <= last else None for i, (key, value) in
            enumerate(row.items())} | {"error": error, "labels": row["labels"]}


def paper_json_rows(change=lambda row: None):
    """The paper's rows as if measured here, each changed by `change`."""
    rows = []
    for p in PAPER_ROWS:
        size = round(p.size_MB * 1e6)
        rows.append(json_row(p.structure, p.split or None, rho=p.rho, tau=p.tau, bytes_total=size,
                             bytes_payload=size, **sized(p.structure, p.size_MB),
                             **times("t_creation_s", p.creation_s),
                             **times("t_access_ns_random", p.access_us * 1e3),
                             delta_R_max=p.delta_R_max))
        change(rows[-1])
    return rows


def results_of(json_rows, folder=".", **settings):
    return Results(Path(folder), HEAD, {**SETTINGS, **settings}, [Row(dict(r), DEFAULTS) for r in json_rows], True)


def evidence_of(json_rows, **settings):
    return Evidence(results_of(json_rows, **settings))


def outcome(json_rows, smallest, fastest, most_accurate):
    """An outcome as the program judges it, of these rows."""
    return {"work": json_rows[0]["labels"]["work"], "factor": 1.25, "asked": False,
            "measured": len(json_rows), "within": sorted({*smallest, *fastest, *most_accurate}),
            "smallest": smallest, "fastest": fastest, "most_accurate": most_accurate,
            "sentences": ["Lengths within 1.25x of the reference's at all probes.",
                          "Smallest: one of them (1.23 MB).", "Fastest: another.",
                          "Most accurate: a third."]}


def descriptions(json_rows):
    return {"structures": {row["structure"]: "a structure" for row in json_rows},
            "settings": {key: "a setting" for key in [
                *DEFAULTS, "target_delta", "within", "max_depth", "voxel", "probe_grid",
                "fine_probe_grid"]}}


def write_results(folder, json_rows, complete=True, outcomes=None, described=True, **settings):
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "results.json").write_text(json.dumps(
        {**HEAD, "settings": {**SETTINGS, **settings}, "defaults": DEFAULTS,
         **({"descriptions": descriptions(json_rows)} if described else {}), "rows": json_rows,
         **({} if outcomes is None else {"outcomes": outcomes}), "complete": complete}))
    return folder


def with_fields(folder, json_rows, anisotropy=1.0, cells=20, probes=4,
                domain=(-1, 1, -1, 1, -1, 1)):
    """Gives rows sampled fields: the exact one times 1, 1.1, 1.2 ..."""
    folder = Path(folder)
    (folder / "fields").mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(1)

    def saved(name, array):
        np.save(folder / "fields" / f"{name}.npy", array)
        return f"fields/{name}.npy"

    def metrics(*shape):
        field = np.zeros((*shape, 6))
        field[..., :3] = rng.uniform(0.1, 1, (*shape, 1)) * [1, anisotropy, 1]
        return field

    slice_, places = metrics(cells, cells), metrics(probes, probes, probes)
    exact = {"exact_slice": saved("exact-slice", slice_),
             "exact_probes": saved("exact-probes", places)}
    outlines = np.array([[-1, -1, 0, 1], [0, -1, 1, 1.0]])
    return [{**row, "fields": {
        "domain": list(domain), "z": 0.0, "slice": saved(f"{i:03}-slice", factor * slice_),
        "probes": saved(f"{i:03}-probes", factor * places),
        "outlines": saved(f"{i:03}-outlines", outlines) if i == 0 else None, **exact}}
        for i, (row, factor) in enumerate(zip(json_rows, np.arange(1, 3, 0.1)))]


def run(command, *arguments, **options):
    """Runs bench/COMMAND."""
    return subprocess.run([ROOT / "bench" / command, *map(str, arguments)], capture_output=True,
                          text=True, **options)

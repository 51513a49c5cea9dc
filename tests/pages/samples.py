# SPDX-License-Identifier: Apache-2.0
# Kept results, and rows like theirs with some numbers changed, for tests.
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bench"))

import numpy as np  # noqa: E402
from pages.paper import PAPER_ROWS, Evidence  # noqa: E402
from pages.results import Results, Row  # noqa: E402

KEPT = ROOT / "bench/results"
QUICK = json.loads((KEPT / "paper-sphere-quick/results.json").read_text())
# The paper's K_L s_L, run as published, with the times of metrics alone, as in earlier results; tests add others.
LENGTHS = ("answers", "t_access_ns_near", "t_access_ns_walk", "t_access_ns_metric")
TEMPLATE = next({key: x for key, x in row.items() if not key.startswith(LENGTHS)}
                for row in QUICK["rows"] if row["law"] == "mean-length")


class InFolder(unittest.TestCase):
    """Tests with a folder of their own."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def refused(self, command, message, *arguments):
        """bench/COMMAND ends with status 2 and one clear line."""
        outcome = run(command, *arguments)
        self.assertEqual((outcome.returncode, outcome.stdout), (2, ""), arguments)
        self.assertRegex(outcome.stderr, message)
        self.assertNotIn("Traceback", outcome.stderr)


def times(key, *samples):
    """A time that was sampled: median, quartiles and samples."""
    low, median, high = np.quantile(samples, [0.25, 0.5, 0.75])
    return {key: median, f"{key}_q1": low, f"{key}_q3": high, f"{key}_samples": list(samples)}


def json_row(structure="K_L", split=None, **changes):
    """A row as in results.json: of the paper's sphere, run as published, unless changed."""
    row = {**TEMPLATE, "structure": structure, "split": split, "max_depth": 42 if split else 14,
           "bytes_total": 1230000, "delta_R_max": 1.78, "delta_R_fine_max": 2.78, "remark": "",
           **times("t_creation_s", 1.75), **times("t_access_ns_random", 50.0, 51.0, 52.0)}
    # Settings that the kept row does not have stand before the sources.
    row = {"structure": structure, **{k: x for k, x in changes.items() if k not in row}, **row, **changes}
    label = f"{structure} {split or ''}".strip()
    tau = f", tau {row['tau']:g}" * (row["tau"] != 1)
    work = f"rho {row['rho']:g}, s_a 2, s_n 1, g_r 1.25, {row['reference']} reference"
    return row | {"labels": {"structure": label, "work": work, "method": label + tau,
                             "setting": f"{work}, {row['law']} law, {row['schedule']}{tau}"}}


def failed_row(error, **changes):
    row = json_row(**changes)
    last = list(row).index("sources")
    return {key: value if i <= last else None for i, (key, value) in
            enumerate(row.items())} | {"error": error, "labels": row["labels"]}


def sized(structure, megabytes, control_nodes=103):
    """Counts of a tree without inner nodes of that size in the paper's accounting."""
    size = megabytes * 1e6 - 104 * (not structure.startswith("K_o"))
    size -= 104 * control_nodes * (structure in ("K_V", "K_oV"))
    cells = round(size / 136)
    return {"tree_nodes": cells, "cells": cells, "control_nodes": control_nodes}


def paper_json_rows(change=lambda row: None):
    """The paper's rows as if measured here, each changed by `change`."""
    rows = []
    for p in PAPER_ROWS:
        rows.append(json_row(p.structure, p.split or None, rho=p.rho, tau=p.tau,
                             bytes_total=round(p.size_MB * 1e6), **sized(p.structure, p.size_MB),
                             **times("t_creation_s", p.creation_s),
                             **times("t_access_ns_random", p.access_us * 1e3), delta_R_max=p.delta_R_max))
        change(rows[-1])
    return rows


def results_of(json_rows, folder=".", **settings):
    return Results(Path(folder), QUICK, {**QUICK["settings"], **settings},
                   [Row(dict(r), QUICK["defaults"]) for r in json_rows], True)


def evidence_of(json_rows, **settings):
    return Evidence(results_of(json_rows, **settings))


def outcome(json_rows, smallest, fastest, most_accurate):
    """An outcome as the program judges it, of these rows."""
    return {**QUICK["outcomes"][0], "smallest": smallest, "fastest": fastest, "most_accurate": most_accurate}


def write_results(folder, json_rows, outcomes=(), **settings):
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "results.json").write_text(json.dumps(
        {**QUICK, "settings": {**QUICK["settings"], **settings}, "rows": json_rows,
         "outcomes": list(outcomes)}))
    return folder


def with_fields(folder, json_rows, anisotropy=1.0, cells=20, probes=4, domain=(-1, 1, -1, 1, -1, 1)):
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
    exact = {"exact_slice": saved("exact-slice", slice_), "exact_probes": saved("exact-probes", places)}
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

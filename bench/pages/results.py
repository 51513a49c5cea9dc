# A folder of results as `controlspace compare` writes it: results.json, schema versions 1 and 2.
import json
import math
import os
import statistics
from dataclasses import dataclass
from pathlib import Path


class InputError(Exception):
    """What was given cannot be used; the message names the file."""


# Measures that every measured row has; JSON has no infinity: null where an error is infinite.
NUMBERS = """sources_inserted tree_nodes cells control_nodes depth bytes_total bytes_payload
    bytes_topology bytes_auxiliary t_insert_s t_gradation_s t_access_ns_random t_access_ns_grid
    gradation_max_left gradation_operations""".split()
ERRORS = """delta_S_max delta_R_max delta_R_mean delta_R_p95 delta_R_p99 delta_R_fine_max
    delta_R_fine_mean delta_R_fine_p95 delta_R_fine_p99 delta_metric_R_max""".split()
SAMPLES = ["t_access_ns_random_samples", "t_access_ns_grid_samples"]
# The samples that a time is the median of, and their unit in that of the time.
SAMPLED = {"access_us": ("t_access_ns_random_samples", 1e-3),
           "creation_s": ("t_creation_s_samples", 1)}
RENAMED = {"elements": "tree_nodes", "leaves": "cells"}  # schema 1 to 2
PROVENANCE = "version commit dirty compiler flags cpu cores threads date command_line".split()

# Settings that a case has only where they differ from these, so that rows of older programs, which
# do not know them, compare equal.
DEFAULTS = {"sampling": "regular", "field": "none", "node_values": "graded", "frozen": "no",
            "neighbourhood": "faces", "voxel_factor": 1.0}
# What a case's labels name: key and text. The rest of the settings is in the label of its table.
VARIANTS = [("voxel", ", voxel {:.4g}"), ("voxel_factor", ", c {:.4g}"),
            ("prune_delta", ", pruned at {:.4g}"), ("target_delta", ", δ <= {:.4g}"),
            ("equal_delta", ", for delta {:.4g}"), ("equal_memory", ", for {:.4g} MB"),
            ("neighbourhood", ", {} neighbours"), ("node_values", ", {} at nodes"),
            ("frozen", ", frozen with {}")]
LABELLED = {"structure", "split", "rho", "s_a", "s_n", "tau", "epsilon", "g_r", "law", "schedule",
            "reference", "max_depth", *DEFAULTS, *(key for key, _ in VARIANTS)}


def plain(x):
    """A number as short as it can be written: 1, 0.2, 1e-09."""
    return str(int(x)) if float(x).is_integer() and abs(x) < 1e15 else repr(x)


class Row:
    """One case: its settings, and its measures where it did not fail."""

    def __init__(self, json_row):
        items = list(json_row.items())
        split = list(json_row).index("sources")
        self.setting = {key: value for key, value in items[:split]
                        if value is not None and DEFAULTS.get(key) != value}
        self.key = frozenset(self.setting.items())
        self.split = self.setting.get("split", "")
        self.sources = json_row["sources"]
        self.error = json_row["error"]
        self.measures = None if self.error else checked(dict(items[split + 1:]))

    def __getitem__(self, key):
        return self.measures[key]

    def spread(self, key):
        """Lower and upper quartile of a time; any other measure is one number."""
        samples, unit = SAMPLED.get(key, (None, 1))
        if len(self.measures.get(samples) or ()) < 2:
            return self[key], self[key]
        low, _, high = quartiles(self[samples])
        return low * unit, high * unit

    def variant(self):
        """What the case adds to its structure: ", voxel 0.05"."""
        s = self.setting
        text = "".join(form.format(s[key]) for key, form in VARIANTS if key in s)
        return text + "".join(f", {key} {s[key]}" for key in s if key not in LABELLED)

    def label(self):
        """"K_L s_L, all neighbours"; an adapted tree is cut by no rule."""
        by_rule = self.split and "target_delta" not in self.setting
        return self.setting["structure"] + (f" {self.split}" if by_rule else "") + self.variant()

    def front_label(self):
        tau = self.setting["tau"]
        return self.label() + (f", tau {plain(tau)}" if tau != 1 and "target_delta" not in
                               self.setting else "")

    def work(self):
        """The sources, and what was required of the field."""
        return (f"{self._sources()}g_r {self.setting['g_r']:.6g}; {self.setting['law']} law, "
                f"{self.setting['reference']} reference")

    def group(self, with_density=True):
        """What the rows of one table have in common."""
        s = self.setting
        sources = self._sources() if with_density else ""
        return (f"{sources}tau {plain(s['tau'])}, epsilon {plain(s['epsilon'])}, g_r "
                f"{s['g_r']:.6g}; {s['law']} law, {s['schedule']}, {s['reference']} reference")

    def _sources(self):
        s = self.setting
        text = f"field {s['field']}, " if "field" in s else ""
        if "rho" in s:
            text += f"{s['sampling']} sources, " if "sampling" in s else ""
            text += "".join(f"{key} {plain(s[key])}, " for key in ("rho", "s_a", "s_n"))
        return text


@dataclass
class Results:
    folder: Path
    head: dict      # provenance: version, commit, cpu, ...
    settings: dict  # of the study
    rows: list
    complete: bool

    @property
    def measured(self):
        return [row for row in self.rows if row.measures is not None]

    @property
    def version(self):
        commit = self.head["commit"][:12] + (", modified" if self.head["dirty"] else "")
        return f"{self.head['version']} (commit {commit})"

    @property
    def origin(self):
        return (f"controlspace {self.version}, {self.head['cpu']}, {self.head['date']}"
                f"{'' if self.complete else ', not complete'}: `{self.head['command_line']}`")


def checked(m):
    """The measures of a row, with those that follow from them under the names of the paper's."""
    for key in ERRORS:
        m[key] = math.inf if m[key] is None else m[key]
    for key in NUMBERS + ERRORS:
        if isinstance(m[key], bool) or not isinstance(m[key], (int, float)):
            raise ValueError(f"{key} is no number")
    for key in SAMPLES:
        if not m[key] or not all(isinstance(x, (int, float)) for x in m[key]):
            raise ValueError(f"{key} is no list of numbers")
    return m | {"size_MB": (m["bytes_published_accounting"] or 0) / 1e6,
                "memory_MB": m["bytes_total"] / 1e6, "metrics_MB": m["bytes_payload"] / 1e6,
                "creation_s": m.get("t_creation_s") or m["t_insert_s"] + m["t_gradation_s"],
                "access_us": m["t_access_ns_random"] / 1e3}


def from_schema_1(row):
    row = {RENAMED.get(key, key): value for key, value in row.items()}
    if row.get("depth"):
        row["depth"] -= 1  # the root has level 0
    return row


def read_results(folder):
    """Throws InputError, naming the file, where results.json is missing or damaged."""
    file = Path(folder) / "results.json"
    try:
        data = json.loads(file.read_text(encoding="utf-8"))
        if not isinstance(data, dict) or data.get("program") != "controlspace":
            raise ValueError("not written by controlspace: give a folder of results")
        version = data["schema_version"]
        if version not in (1, 2):
            raise ValueError(f"schema version {version} is unknown: run the study again")
        head = {key: data[key] for key in PROVENANCE}
        rows = []
        for number, row in enumerate(data["rows"], 1):
            try:
                rows.append(Row(from_schema_1(row) if version == 1 else row))
            except (KeyError, TypeError, ValueError, AttributeError) as error:
                raise ValueError(f"row {number}: {described(error)}") from error
        return Results(Path(folder), head, dict(data["settings"]), rows, bool(data["complete"]))
    except OSError as error:
        raise InputError(f"{file}: {error.strerror.lower()}: give a folder of results") from error
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(f"{file}: {described(error)}") from error


def described(error):
    return f"'{error.args[0]}' is missing" if isinstance(error, KeyError) else str(error)


def quartiles(samples):
    """Lower quartile, median and upper quartile, interpolated between the samples."""
    if len(samples) == 1:
        return samples * 3
    return statistics.quantiles(samples, n=4, method="inclusive")


def write_file(path, content):
    """Replaces `path` at once: readers see the old content or the new one, never a part."""
    path = Path(path)
    partial = path.with_name(f"{path.name}.{os.getpid()}.partial")
    try:
        if path.exists() and not path.is_file():
            raise OSError(0, "not a regular file")
        path.parent.mkdir(parents=True, exist_ok=True)
        partial.write_bytes(content.encode() if isinstance(content, str) else content)
        partial.replace(path)
    except OSError as error:
        if partial.parent.is_dir():
            partial.unlink(missing_ok=True)
        raise InputError(f"cannot write {path}: {error.strerror}: choose another folder") from error

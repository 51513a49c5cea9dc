# SPDX-License-Identifier: Apache-2.0
# A folder of results as `controlspace compare` writes it: results.json, schema version 2.
import json
import math
import os
from dataclasses import dataclass, field
from pathlib import Path


class InputError(Exception):
    """What was given cannot be used; the message names the file."""


# Measures that every measured row has; JSON has no infinity: null where an error is infinite.
TIMES = ["t_creation_s", "t_access_ns_random", "t_access_ns_grid"]
# Access times of metrics, and where they are where nothing else was timed: of tensors, and in results
# of earlier programs.
METRIC_TIMES = {"t_access_ns_metric_random": "t_access_ns_random",
                "t_access_ns_metric_single": "t_access_ns_single"}
NUMBERS = """sources_inserted tree_nodes cells control_nodes depth bytes_total bytes_payload
    bytes_topology bytes_auxiliary gradation_max_left gradation_operations""".split() + [
        time + quartile for time in TIMES for quartile in ("", "_q1", "_q3")]
ERRORS = """delta_S_max delta_R_max delta_R_mean delta_R_p95 delta_R_p99 delta_R_fine_max
    delta_R_fine_mean delta_R_fine_p95 delta_R_fine_p99 delta_metric_R_max""".split()
# Of newer programs; null where one is infinite, too.
FACTORS = [*(f"{side}_{key}" for side in ("coarser", "finer", "within") for key in ("max", "fine_max")),
           "G_det", "G_dir"]
KNOWN = {*NUMBERS, *ERRORS, *FACTORS, "access_batch", "bytes_published_accounting", *(
    f"{side}_{key}" for side in ("coarser", "finer") for key in ("share", "fine_share")),
    "t_creation_known_s", *(
    f"{time}{quartile}" for time in ("t_insert_s", "t_gradation_s", "t_access_ns_single",
                                     "t_access_ns_near", "t_access_ns_walk", *METRIC_TIMES)
    for quartile in ("", "_q1", "_q3")), "size_MB", "memory_MB", "metrics_MB", "creation_s", "access_us"}
# Times under the names of the paper's, which are of metrics: the median, and its unit in that of the
# paper.
PAPER_TIMES = {"access_us": ("t_access_ns_metric_random", 1e-3), "creation_s": ("t_creation_s", 1)}
PROVENANCE = "version commit dirty compiler flags cpu cores threads date command_line".split()

def plain(x):
    """A number as short as it can be written: 1, 0.2, 1e-09."""
    return str(int(x)) if float(x).is_integer() and abs(x) < 1e15 else repr(x)


def grouped(rows, key):
    groups = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return groups


@dataclass
class Outcome:
    """Which rows to take within an error, as the program judged: `sentences` say it."""

    work: str
    factor: float
    wishes: dict  # "smallest" -> rows
    sentences: list


class Row:
    """One case: its settings, labels, and its measures where it did not fail."""

    def __init__(self, json_row, defaults):
        items = list(json_row.items())
        split = list(json_row).index("sources")
        self.setting = {key: value for key, value in items[:split] if value is not None}
        self.defaults = defaults
        self.key = self.key_with()
        self.sources = json_row["sources"]
        self.error = json_row["error"]
        # Of the structure; what rows of one table share; what is required; the structure and what
        # is not the default of the rest.
        self.label, self.group, self.work, self.method = (
            json_row["labels"][key] for key in ("structure", "setting", "work", "method"))
        self.measures = None if self.error else checked(dict(items[split + 1:]), self.setting)

    def key_with(self, **changes):
        """What tells the case, changed so, from others; a setting that a program does not know yet
        is the default."""
        return frozenset((key, value) for key, value in {**self.setting, **changes}.items()
                         if value is not None and value != self.defaults.get(key))

    def __getitem__(self, key):
        return self.measures[key]

    def spread(self, key):
        """Lower and upper quartile of a time; any other measure is one number."""
        time, unit = PAPER_TIMES.get(key, (key, 1))
        if f"{time}_q1" not in self.measures:
            return self[key], self[key]
        return self[f"{time}_q1"] * unit, self[f"{time}_q3"] * unit


@dataclass
class Results:
    folder: Path
    head: dict      # provenance: version, commit, cpu, ...
    settings: dict  # of the study
    rows: list
    complete: bool
    outcomes: list = field(default_factory=list)     # none: of an older program, or not complete
    descriptions: dict = field(default_factory=dict)  # "structures", "settings": {name: text}

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


def size_in_table_1(setting, m):
    """Bytes as the paper's Table 1 counts them: 136 for a leaf, 108 (kd-tree) or 216 (octree) for an
    inner node, 104 for a kd-tree as a whole and for each vertex; no metric of a leaf."""
    if not m["tree_nodes"]:
        return 0
    inner, vertices = (216, "K_oV") if setting["structure"].startswith("K_o") else (108, "K_V")
    return (136 * m["cells"] + inner * (m["tree_nodes"] - m["cells"]) + 104 * (inner == 108)
            + 104 * m["control_nodes"] * (setting["structure"] == vertices))


def checked(m, setting):
    """The measures of a row, with those that follow from them under the names of the paper's."""
    for key in [*ERRORS, *(key for key in FACTORS if key in m)]:
        m[key] = math.inf if m[key] is None else m[key]
    for key in NUMBERS + ERRORS:
        if isinstance(m[key], bool) or not isinstance(m[key], (int, float)):
            raise ValueError(f"{key} is no number")
    for key in (f"{time}_samples" for time in TIMES):
        if not m[key] or not all(isinstance(x, (int, float)) for x in m[key]):
            raise ValueError(f"{key} is no list of numbers")
    m = {**m, "answers": m.get("answers") or "metrics"}
    if m["answers"] == "metrics":
        m |= {metric + end: m[time + end] for metric, time in METRIC_TIMES.items()
              for end in ("", "_q1", "_q3", "_samples") if time + end in m}
    return m | {"size_MB": size_in_table_1(setting, m) / 1e6,
                "memory_MB": m["bytes_total"] / 1e6, "metrics_MB": m["bytes_payload"] / 1e6,
                **{key: m[time] * unit for key, (time, unit) in PAPER_TIMES.items()}}


WISHES = ["smallest", "fastest", "most_accurate"]


def outcome_of(data, rows):
    texts = [data["work"], *data["sentences"]]
    if not data["sentences"] or not all(isinstance(text, str) for text in texts):
        raise ValueError("no sentences")
    wishes = {wish: [rows[int(i)] for i in data[wish] if i >= 0] for wish in WISHES}
    if any(row.measures is None for found in wishes.values() for row in found):
        raise ValueError("a row that failed")
    return Outcome(data["work"], float(data["factor"]), wishes, list(data["sentences"]))


def descriptions_of(data):
    found = {kind: dict(data[kind]) for kind in ("structures", "settings")}
    if not all(isinstance(text, str) for texts in found.values() for text in texts.values()):
        raise ValueError("descriptions are no texts")
    return found


def own_measures(rows):
    """Keys of the numbers that a program measured beside those known here."""
    return list(dict.fromkeys(key for row in rows if row.measures
                              for key, value in row.measures.items() if key not in KNOWN
                              and isinstance(value, (int, float))))


def read_results(folder):
    """Throws InputError, naming the file, where results.json is missing or damaged."""
    file = Path(folder) / "results.json"
    try:
        data = json.loads(file.read_text(encoding="utf-8"))
        if not isinstance(data, dict) or data.get("program") != "controlspace":
            raise ValueError("not written by controlspace: give a folder of results")
        version = data["schema_version"]
        if version != 2:
            raise ValueError(f"schema version {version} is not 2: run the study again")
        head = {key: data[key] for key in PROVENANCE}
        defaults = dict(data["defaults"])
        rows = []
        for number, row in enumerate(data["rows"], 1):
            try:
                rows.append(Row(row, defaults))
            except (KeyError, TypeError, ValueError, AttributeError) as error:
                raise ValueError(f"row {number}: {described(error)}") from error
        try:
            outcomes = [outcome_of(outcome, rows) for outcome in data.get("outcomes", ())]
        except (IndexError, KeyError, TypeError, ValueError) as error:
            raise ValueError(f"outcomes: {described(error)}") from error
        # Older results have neither.
        descriptions = descriptions_of(data["descriptions"]) if "descriptions" in data else {}
        return Results(Path(folder), head, dict(data["settings"]), rows, bool(data["complete"]),
                       outcomes, descriptions)
    except OSError as error:
        raise InputError(f"{file}: {error.strerror.lower()}: give a folder of results") from error
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(f"{file}: {described(error)}") from error


def described(error):
    return f"'{error.args[0]}' is missing" if isinstance(error, KeyError) else str(error)


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

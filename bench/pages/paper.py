# SPDX-License-Identifier: Apache-2.0
# The paper's Tables 1-5 beside rows that were run in the same way: which cells are equal, which
# differ, and whether a run shows why or it is inferred; and which conclusions hold.
import math
import tomllib
from collections import namedtuple
from pathlib import Path

import numpy as np

from .ranks import average_ranks
from .results import InputError, grouped, plain

HERE = Path(__file__).resolve().parent
DATA = next(p for p in (HERE.parent / "data", HERE.parents[1] / "data") if (p / "paper").is_dir())

FIELDS = ["structure", "split", "rho", "tau", "size_MB", "creation_s", "access_us", "delta_R_max",
          "L_R"]
PaperRow = namedtuple("PaperRow", FIELDS)
SPLITS = ("s_L", "s_G", "s_M", "")
PAPER_BOX = (-1, 1, -1, 1, -1, 1)
ROUNDING = 1e-8  # relative; the experiments change a tenth of it
# Settings that all of the paper's rows share: those of a study, and those of a case.
SPHERE = {"sources": "sphere", "centre": [0, 0, 0], "radius": 0.8, "h": 0.015}
AS_PUBLISHED = {"law": "mean-length", "schedule": "passes", "reference": "published-sphere",
                "s_a": 2, "s_n": 1, "epsilon": 0.2, "g_r": 1.25}

# One of the paper's tables: its title, the measure, and why its values cannot be compared.
PaperTable = namedtuple("PaperTable", "title measure not_comparable", defaults=[None])
SIZE = PaperTable("Table 1: size in the paper's accounting [MB]", "size_MB")
CREATION = PaperTable("Table 2: creation time [s]", "creation_s", "another machine")
ACCESS = PaperTable("Table 3: access time [µs]", "access_us", "ticks of 0.370 µs")
DELTA_R = PaperTable("Table 4: largest delta_R", "delta_R_max")
TABLES = (SIZE, CREATION, ACCESS, DELTA_R)


def parse_paper_tables(text):
    """Rows of data/paper/sphere_tables.csv; throws InputError that names the line."""
    rows = []
    lines = [(number, line.split(",")) for number, line in enumerate(text.splitlines(), 1)
             if line and not line.startswith("#")]
    for number, values in lines:
        try:
            if number == lines[0][0]:
                if values != FIELDS:
                    raise ValueError(f"the header should be {','.join(FIELDS)}")
                continue
            if len(values) != len(FIELDS):
                raise ValueError("give nine fields")
            if values[1] not in SPLITS:
                raise ValueError(f"unknown split '{values[1]}'")
            rows.append(PaperRow(*values[:2], *map(float, values[2:])))
        except ValueError as error:
            raise InputError(f"the paper's tables, line {number}: {error}") from error
    return rows


PAPER_ROWS = parse_paper_tables((DATA / "paper" / "sphere_tables.csv").read_text(encoding="utf-8"))
PAPER_BY_SETTING = {(p.structure, p.split, p.rho, p.tau): p for p in PAPER_ROWS}


# Runs of bench/links: K_oL with right links between leaves, and with those of the published program.
LinksRun = namedtuple("LinksRun", "rho tau links sources elements leaves wrong_links delta_R_max delta_R_mean")
OCTREE_LINKS = {}
for _line in (DATA / "paper" / "octree_links.csv").read_text(encoding="utf-8").splitlines():
    if _line[0] not in "#r":
        _run = LinksRun(*(x if x.isalpha() else float(x) for x in _line.split(",")))
        OCTREE_LINKS[_run.rho, _run.tau, _run.links] = _run


def max_depth(setting):
    """Of leaves that are cut for sources; that of the paper where a case has none."""
    return setting.get("max_depth") or paper_depth(setting)


def paper_depth(setting):
    return 42 if "split" in setting else 14


def paper_row(setting):
    """The paper's row for a case; None where the paper has no such structure or setting."""
    if any(setting.get(k) != v for k, v in AS_PUBLISHED.items() if k not in
           ("law", "schedule", "reference")) or max_depth(setting) != paper_depth(setting):
        return None
    return PAPER_BY_SETTING.get((setting["structure"], setting.get("split", ""),
                                 setting["rho"], setting["tau"]))


def is_paper_sphere(settings):
    return all(settings.get(key) == value for key, value in SPHERE.items())


def is_as_published(row):
    """Whether a case was run as the paper's, with nothing else that is not the default. Of its
    isotropic sources all intersections are alike."""
    ours = {**AS_PUBLISHED, **{key: None for key in ("structure", "split", "rho", "tau",
                                                     "max_depth", "intersection")}}
    return all(row.setting.get(k) == v for k, v in AS_PUBLISHED.items()) and all(
        key in ours for key, _ in row.key)


def rounded(x):
    """In units of the last digit that the paper prints."""
    return math.floor(abs(x) * 100 + 0.5) if math.isfinite(x) else math.inf


def within(x, low, high):
    return rounded(low) <= rounded(x) <= rounded(high)


class Cell(namedtuple("Cell", "row paper")):
    """A row of ours that the paper has too."""

    def ours(self, table):
        return self.row[table.measure]

    def theirs(self, table):
        return getattr(self.paper, table.measure)

    def published_nodes(self):
        """Control nodes in the paper's size, if its tree has the nodes of ours: its Table 1
        counts 104 bytes for each."""
        return self.row["control_nodes"] + (self.paper.size_MB - self.row["size_MB"]) * 1e6 / 104


class Evidence:
    """Rows of one or more studies of the paper's sphere, for and against its tables."""

    def __init__(self, *all_results):
        self.entries = []  # (row, box); of rows with the same case and box the first one counts
        known = set()
        for results in all_results:
            settings = results.settings
            box = tuple(settings.get("domain") or PAPER_BOX)
            if not is_paper_sphere(settings) or any(
                    abs(a - b) > ROUNDING for a, b in zip(box, PAPER_BOX)):
                continue
            for row in results.rows:
                if (box, row.key) not in known:
                    known.add((box, row.key))
                    self.entries.append((row, box))
        self.by_key = {row.key: row for row, box in self.entries
                       if box == PAPER_BOX and row.measures is not None}
        cells = [Cell(row, paper_row(row.setting)) for row, box in self.entries
                 if box == PAPER_BOX and is_as_published(row) and paper_row(row.setting)]
        self.cells = sorted(cells, key=lambda cell: PAPER_ROWS.index(cell.paper))

    @property
    def measured_cells(self):
        return [cell for cell in self.cells if cell.row.measures is not None]

    def find(self, row, **changes):
        """The measured row of a case that differs in `changes`, or None."""
        return self.by_key.get(row.key_with(**changes))

    def near_ties(self, row, **changes):
        """The same but for what decides between edges that are almost equally long: l_min, the box
        or the sources' normal lengths differ by 1e-8 of their size at most, and s_G's sections may
        be exact. Of sources that are isotropic but for that all intersections are alike."""
        key, tau, s_n = row.key_with(**changes), row.setting["tau"], row.setting["s_n"]
        found = []
        for other, box in self.entries:
            if other.measures is None or (box == PAPER_BOX and other.key == key):
                continue
            split = other.setting.get("split")
            same = other.key_with(tau=tau, s_n=s_n, intersection=row.setting.get("intersection"),
                                  split="s_G" if split == "s_Gx" else split) == key
            if same and all(abs(other.setting[k] - x) <= ROUNDING * x
                            for k, x in (("tau", tau), ("s_n", s_n))):
                found.append(other)
        return found

    def near_densities(self, row):
        """The same with sources up to 5 % closer together or farther apart."""
        rho = row.setting["rho"]
        return [other for other in self.by_key.values() if other.key_with(rho=rho) == row.key
                and 0 < abs(other.setting["rho"] - rho) <= 0.05 * rho]

    def other_depths(self, row):
        """The same with other depth limits, the deepest last."""
        depth = row.setting.get("max_depth")
        found = [other for other in self.by_key.values()
                 if other.key != row.key and other.key_with(max_depth=depth) == row.key]
        return sorted(found, key=lambda other: max_depth(other.setting))


# ---- Verdicts on cells

EQUAL, SHOWN, INFERRED, NOT_COMPARABLE, UNEXPLAINED, FAILED = VERDICTS = (
    "equal", "shown", "inferred", "not comparable", "differs, unexplained", "failed")
Judged = namedtuple("Judged", "cell verdict reason")


def value_range(measure, rows):
    values = [row[measure] for row in rows]
    return min(values), max(values)


# Each rule: its verdict on the difference of a cell (shown: runs of ours give the printed digits, or
# their range holds them; inferred: the numbers point to a fault of the program behind the paper, which
# no run of ours repeats; None: neither) and the numbers that decide it; None where it does not apply.
# They are tried in this order, for what is shown first.

def shown_or_inferred(shown, inferred):
    return SHOWN if shown else INFERRED if inferred else None


def balance(evidence, table, cell):
    row, paper = cell
    plain_row = evidence.find(row, structure="K_oL")
    plain_paper = paper_row({**row.setting, "structure": "K_oL"})
    if paper.structure != "K_oLB" or not plain_row or not plain_paper:
        return None
    growth = row["size_MB"] / plain_row["size_MB"]
    paper_growth = paper.size_MB / plain_paper.size_MB
    delta, plain_delta = row["delta_R_max"], plain_row["delta_R_max"]
    accurate = table is not DELTA_R or delta <= plain_delta
    return (shown_or_inferred(False, growth < 2 and paper_growth > 3 and accurate),
            f"balance: balanced 2:1, ours has {growth:.2f} times K_oL's size and delta_R "
            f"{delta:.2f} against its {plain_delta:.2f}; the paper's has {paper_growth:.1f} times")


def ties(evidence, table, cell):
    if cell.paper.split in ("", "s_L"):
        return None
    variants = evidence.near_ties(cell.row)
    if not variants:
        return None, "ties: not tried here"
    low, high = value_range(table.measure, [cell.row, *variants])
    return (shown_or_inferred(within(cell.theirs(table), low, high),
                              abs(cell.ours(table) - cell.theirs(table)) <= high - low),
            f"ties: {len(variants)} runs that choose otherwise among edges of almost equal length "
            f"give {low:.2f} to {high:.2f}")


def shared_vertices(evidence, table, cell):
    if cell.paper.structure not in ("K_V", "K_oV"):
        return None
    nodes, places = cell.published_nodes(), cell.row["control_nodes"]
    better = table is not DELTA_R or cell.ours(table) < cell.theirs(table)
    return (shown_or_inferred(False, nodes > 1.05 * places and better),
            f"shared vertices: the paper's size holds {nodes:.0f} control nodes, ours one for each "
            f"of {places} places")


def links(evidence, table, cell):
    if cell.paper.structure != "K_oL" or table is not DELTA_R:
        return None
    right, published = (OCTREE_LINKS[cell.paper.rho, cell.paper.tau, kind] for kind in ("right", "published"))
    repeated = rounded(right.delta_R_max) == rounded(cell.ours(table)) and \
        rounded(published.delta_R_max) == rounded(cell.theirs(table))
    return (shown_or_inferred(repeated, False),
            f"links: with those of the published program, {100 * published.wrong_links:.1f} % of them to leaves "
            f"that do not touch, {published.delta_R_max:.2f}, with right ones {right.delta_R_max:.2f}")


def interpolation(evidence, table, cell):
    published = evidence.find(cell.row, interpolation="published")
    if cell.paper.structure != "K_Li" or not published:
        return None
    variants = evidence.near_ties(cell.row, interpolation="published")
    low, high = value_range(table.measure, [published, *variants])
    value = published[table.measure]
    return (shown_or_inferred(within(cell.theirs(table), low, high),
                              abs(value - cell.theirs(table)) <= high - low),
            f"interpolation: with the published one, its two slips included, {value:.2f}" +
            (f" ({low:.2f} to {high:.2f} over {len(variants)} runs that choose otherwise among "
             f"edges of almost equal length)" if variants else ""))


def scatter(evidence, table, cell):
    variants = evidence.near_densities(cell.row) if table is DELTA_R else []
    if not variants:
        return None
    low, high = value_range(table.measure, [cell.row, *variants])
    return (shown_or_inferred(within(cell.theirs(table), low, high), False),
            f"scatter: the largest of 27000 errors is {low:.2f} to {high:.2f} with sources 1 % "
            f"closer or farther apart")


RULES = (balance, ties, shared_vertices, links, interpolation, scatter)


def judge(evidence, table):
    """A verdict on each cell of a table, in the order of `evidence.cells`."""
    return [Judged(cell, *verdict(evidence, table, cell)) for cell in evidence.cells]


def verdict(evidence, table, cell):
    if cell.row.measures is None:
        return FAILED, cell.row.error
    if table.not_comparable:
        return NOT_COMPARABLE, table.not_comparable
    if rounded(cell.ours(table)) == rounded(cell.theirs(table)):
        return EQUAL, ""
    tried = [found for found in (rule(evidence, table, cell) for rule in RULES) if found]
    for wanted in (SHOWN, INFERRED):
        for found, text in tried:
            if found == wanted:
                return wanted, text
    return (UNEXPLAINED,
            "; ".join(f"not {text}" for _, text in tried) or "no experiment bears on it")


# ---- Conclusions that the paper's tables suggest

# At one setting, claims speak of structures by label, ours or the paper's: measure -> (value, lower
# and upper quartile), and "deep": largest delta_R with the deepest limit that was tried.
UNITS = {"memory_MB": " MB", "creation_s": " s", "access_us": " µs", "delta_R_max": ""}


def pair_text(entries, a, b, measure):
    return ", ".join(f"{label} {entries[label][measure][0]:.3g}{UNITS[measure]}" for label in (a, b))


def below(a, b, factor=1):
    """Whether a < factor b; None, indistinguishable, where the quartiles overlap."""
    return True if a[2] < factor * b[1] else False if a[1] >= factor * b[2] else None


# Tests at one setting: (whether it holds, or None; the numbers), or None where an entry is missing.

def all_hold(entries, conditions):
    if any(label not in entries for c in conditions for label in (c[0], c[4])):
        return None
    held = []
    for left, measure, order, factor, right in conditions:
        a, b = entries[left][measure], entries[right][measure]
        held.append(below(a, b, factor) if order == "<" else below(b, a, 1 / factor))
    return (False if False in held else None if None in held else True,
            "; ".join(pair_text(entries, c[0], c[4], c[1]) for c in conditions))


def all_rounder(entries):
    labels = [label for label in entries if not label.endswith("s_M")]
    if len(labels) < 9:  # among a few, a good rank says little
        return None
    ranks = [average_ranks([entries[label][measure][0] for label in labels]) for measure in UNITS]
    means = sorted((mean, i) for i, mean in enumerate(np.mean(ranks, axis=0)))
    best = [(labels[i], mean) for mean, i in means[:3]]
    return (any(label.startswith("K_L ") for label, _ in best),
            "mean ranks: " + ", ".join(f"{label} {mean:.2f}" for label, mean in best))


def fastest_octree(entries):
    others = [label for label in entries if label != "K_oL"]
    if "K_oL" not in entries or not others:
        return None
    other = min(others, key=lambda label: entries[label]["access_us"][0])
    return all_hold(entries, [("K_oL", "access_us", "<", 1, other)])


def poor_deep_slabs(entries):
    middle, slabs = entries.get("K_L s_L"), entries.get("K_L s_M")
    if not middle or not slabs or "deep" not in slabs:
        return None
    deep, limit = slabs["deep"], middle["delta_R_max"][0]
    return (deep > 2 * limit, f"K_L s_M {slabs['delta_R_max'][0]:.3g} at the paper's depth, "
            f"{deep:.3g} at the deepest; K_L s_L {limit:.3g}")


TEXTS = tomllib.loads((HERE / "paper.toml").read_text(encoding="utf-8"))
CLAIMS = {claim["sentence"]: claim for claim in TEXTS["claims"]}


def tested(claim, entries):
    if "conditions" in claim:
        return all_hold(entries, claim["conditions"])
    return globals()[claim["test"]](entries)


STANDS, DOES_NOT_STAND, UNDECIDED, NOT_MEASURED = CLAIM_VERDICTS = (
    "Conclusions that stand", "Conclusions that do not stand",
    "Conclusions that times do not decide", "Conclusions that were not measured")
JudgedClaim = namedtuple("JudgedClaim", "claim verdict holds undecided settings paper_holds "
                                        "paper_settings numbers")


def setting_name(paper):
    return f"ρ {plain(paper.rho)} τ {plain(paper.tau)}"


def cells_by_setting(evidence):
    return grouped(evidence.measured_cells, lambda cell: setting_name(cell.paper))


def entry_of(evidence, row):
    entry = {measure: (row[measure], *row.spread(measure)) for measure in UNITS}
    deep = evidence.other_depths(row)
    return entry | ({"deep": deep[-1]["delta_R_max"]} if deep else {})


def paper_entry(paper):
    values = paper._asdict() | {"memory_MB": paper.size_MB}
    return {measure: (values[measure],) * 3 for measure in UNITS}


def judge_claims(evidence):
    """All claims, each at every setting that has rows run as published: it stands if it fails at
    none. Numbers are those of the first setting where it fails, else of the first."""
    settings = []
    for name, cells in cells_by_setting(evidence).items():
        labels = [f"{cell.paper.structure} {cell.paper.split}".strip() for cell in cells]
        settings.append((name, dict(zip(labels, (entry_of(evidence, c.row) for c in cells))),
                         dict(zip(labels, (paper_entry(c.paper) for c in cells)))))
    judged = []
    for claim in CLAIMS.values():
        outcomes = [(name, tested(claim, ours), tested(claim, paper))
                    for name, ours, paper in settings]
        outcomes = [outcome for outcome in outcomes if outcome[1]]
        ours = [our[0] for _, our, _ in outcomes]
        papers = [paper[0] for _, _, paper in outcomes if paper]
        state = NOT_MEASURED if not ours else DOES_NOT_STAND if False in ours else \
            STANDS if True in ours else UNDECIDED
        shown = next((o for o in outcomes if o[1][0] is False), (outcomes or [None])[0])
        judged.append(JudgedClaim(claim, state, ours.count(True), ours.count(None), len(ours),
                                  papers.count(True), len(papers),
                                  f"{shown[0]}: {shown[1][1]}" if shown else ""))
    return judged

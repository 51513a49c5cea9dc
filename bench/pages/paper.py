# The paper's Tables 1-5 beside rows that were run in the same way: which cells are equal, which
# differ for a reason that an experiment shows, and which conclusions hold.
import csv
import math
from collections import namedtuple
from pathlib import Path

from .results import InputError, plain

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

# One of the paper's tables: its title, our value, the key of the paper's value, and why values
# cannot be compared (another machine, another clock).
PaperTable = namedtuple("PaperTable", "title ours paper not_comparable")
SIZE = PaperTable("Table 1: size in the paper's accounting [MB]",
                  lambda row: (row["bytes_published_accounting"] or 0) / 1e6, "size_MB", None)
CREATION = PaperTable("Table 2: creation time [s]", lambda row: row.creation_s, "creation_s",
                      "another machine")
ACCESS = PaperTable("Table 3: access time [µs]", lambda row: row["t_access_ns_random"] / 1e3,
                    "access_us", "ticks of 0.370 µs")
DELTA_R = PaperTable("Table 4: largest delta_R", lambda row: row["delta_R_max"], "delta_R_max",
                     None)
TABLES = (SIZE, CREATION, ACCESS, DELTA_R)


def parse_paper_tables(text):
    """Rows of data/paper/sphere_tables.csv; throws InputError that names the line."""
    rows = []
    header = None
    for number, line in enumerate(text.splitlines(), 1):
        if not line or line.startswith("#"):
            continue
        values = next(csv.reader([line]))
        try:
            if header is None:
                header = values
                if header != FIELDS:
                    raise ValueError(f"the header should be {','.join(FIELDS)}")
                continue
            if len(values) != len(FIELDS):
                raise ValueError("give nine fields")
            if values[1] not in SPLITS:
                raise ValueError(f"unknown split '{values[1]}'")
            rows.append(PaperRow(*values[:2], *(float(v) for v in values[2:])))
        except ValueError as error:
            raise InputError(f"the paper's tables, line {number}: {error}") from error
    return rows


PAPER_ROWS = parse_paper_tables((DATA / "paper" / "sphere_tables.csv").read_text(encoding="utf-8"))
PAPER_BY_SETTING = {(p.structure, p.split, p.rho, p.tau): p for p in PAPER_ROWS}


def paper_row(setting):
    """The paper's row for a case; None where the paper has no such structure or setting."""
    depth = 42 if "split" in setting else 14
    if any(setting.get(k) != v for k, v in AS_PUBLISHED.items() if k not in
           ("law", "schedule", "reference")) or setting.get("max_depth") != depth:
        return None
    return PAPER_BY_SETTING.get((setting["structure"], setting.get("split", ""),
                                 setting["rho"], setting["tau"]))


def rounded(x):
    """In units of the last digit that the paper prints."""
    return math.floor(abs(x) * 100 + 0.5) if math.isfinite(x) else math.inf


def within(x, low, high):
    return rounded(low) <= rounded(x) <= rounded(high)


def key_of(setting, **changes):
    """The key of a case that differs in `changes`; None removes a setting."""
    merged = {**setting, **changes}
    return frozenset((k, v) for k, v in merged.items() if v is not None)


Cell = namedtuple("Cell", "row paper")


class Evidence:
    """Rows of one or more studies of the paper's sphere, for and against its tables."""

    def __init__(self, *all_results):
        self.entries = []  # (row, box); of rows with the same case and box the first one counts
        known = set()
        for results in all_results:
            settings = results.settings
            box = tuple(settings.get("domain") or PAPER_BOX)
            sphere = all(settings.get(k) == v for k, v in SPHERE.items())
            if not sphere or any(abs(a - b) > ROUNDING for a, b in zip(box, PAPER_BOX)):
                continue
            for row in results.rows:
                if (box, row.key) not in known:
                    known.add((box, row.key))
                    self.entries.append((row, box))
        self.by_key = {row.key: row for row, box in self.entries
                       if box == PAPER_BOX and row.measures is not None}
        order = {id(p): i for i, p in enumerate(PAPER_ROWS)}
        published = {**AS_PUBLISHED, "structure": None, "split": None, "rho": None, "tau": None,
                     "max_depth": None}
        cells = []
        for row, box in self.entries:
            s = row.setting
            # No setting beyond those of the paper: nothing frozen, no other neighbourhood.
            as_published = set(s) <= set(published) and all(
                s.get(k) == v for k, v in AS_PUBLISHED.items())
            if box == PAPER_BOX and as_published and paper_row(s):
                cells.append(Cell(row, paper_row(s)))
        self.cells = sorted(cells, key=lambda cell: order[id(cell.paper)])

    @property
    def measured_cells(self):
        return [cell for cell in self.cells if cell.row.measures is not None]

    def find(self, setting, **changes):
        """The measured row of a case that differs in `changes`, or None."""
        return self.by_key.get(key_of(setting, **changes))

    def near_ties(self, setting, **changes):
        """The same but for what decides between edges that are almost equally long: l_min or the
        box differ by 1e-8 of their size at most, and s_G's sections may be exact."""
        wanted = {**setting, **changes}
        key = key_of(wanted)
        found = []
        for row, box in self.entries:
            s = row.setting
            if row.measures is None or (box == PAPER_BOX and row.key == key):
                continue
            split = "s_G" if s.get("split") == "s_Gx" else s.get("split")
            close = abs(s["tau"] - wanted["tau"]) <= ROUNDING * wanted["tau"]
            if close and key_of(s, tau=wanted["tau"], split=split) == key:
                found.append(row)
        return found

    def near_densities(self, setting):
        """The same with sources up to 5 % closer together or farther apart."""
        rho = setting["rho"]
        return [row for row in self.by_key.values()
                if row.setting.get("rho", rho) != rho and abs(row.setting["rho"] - rho) <= 0.05 * rho
                and key_of(row.setting, rho=rho) == key_of(setting)]

    def other_depths(self, setting):
        """The same with other depth limits, the deepest last."""
        depth = setting["max_depth"]
        found = [row for row in self.by_key.values() if row.setting.get("max_depth") != depth
                 and key_of(row.setting, max_depth=depth) == key_of(setting)]
        return sorted(found, key=lambda row: row.setting["max_depth"])


# ---- Verdicts on cells

EQUAL, EXPLAINED, NOT_COMPARABLE, UNEXPLAINED, FAILED = VERDICTS = (
    "equal", "explained", "not comparable", "differs, unexplained", "failed")
Judged = namedtuple("Judged", "cell verdict reason")


def published_nodes(cell):
    """Control nodes in the paper's size, if its tree has the elements of ours: its Table 1 counts
    104 bytes for each."""
    more = cell.paper.size_MB * 1e6 - (cell.row["bytes_published_accounting"] or 0)
    return cell.row["control_nodes"] + more / 104


def value_range(table, rows):
    values = [table.ours(row) for row in rows]
    return min(values), max(values)


# Each rule: whether it explains the difference of a cell, and the numbers that decide it; None where
# it does not apply. They are tried in this order.

def balance(evidence, table, row, paper):
    plain_row = evidence.find(row.setting, structure="K_oL")
    plain_paper = paper_row({**row.setting, "structure": "K_oL"})
    if row.setting["structure"] != "K_oLB" or not plain_row or not plain_paper:
        return None
    growth = SIZE.ours(row) / SIZE.ours(plain_row)
    paper_growth = paper.size_MB / plain_paper.size_MB
    delta, plain_delta = row["delta_R_max"], plain_row["delta_R_max"]
    accurate = table is not DELTA_R or delta <= plain_delta
    return (growth < 2 and paper_growth > 3 and accurate,
            f"balance: balanced 2:1, ours has {growth:.2f} times K_oL's size and delta_R "
            f"{delta:.2f} against its {plain_delta:.2f}; the paper's has {paper_growth:.1f} times")


def ties(evidence, table, row, paper):
    if row.split in ("", "s_L"):
        return None
    variants = evidence.near_ties(row.setting)
    if not variants:
        return False, "ties: not tried here"
    low, high = value_range(table, [row, *variants])
    theirs = getattr(paper, table.paper)
    return (abs(table.ours(row) - theirs) <= high - low or within(theirs, low, high),
            f"ties: {len(variants)} runs that choose otherwise among edges of almost equal length "
            f"give {low:.2f} to {high:.2f}")


def shared_vertices(evidence, table, row, paper):
    if row.setting["structure"] not in ("K_V", "K_oV"):
        return None
    nodes, places = published_nodes(Cell(row, paper)), row["control_nodes"]
    better = table is not DELTA_R or row["delta_R_max"] < paper.delta_R_max
    return (nodes > 1.05 * places and better,
            f"shared vertices: the paper's size holds {nodes:.0f} control nodes, ours one for each "
            f"of {places} places")


def links(evidence, table, row, paper):
    if row.setting["structure"] != "K_oL" or table is not DELTA_R:
        return None
    queue = evidence.find(row.setting, schedule="queue")
    if not queue:
        return False, "links: not tried here"
    ours, with_queue = row["delta_R_max"], queue["delta_R_max"]
    return (abs(ours - paper.delta_R_max) <= abs(with_queue - ours),
            f"links: which leaves are compared decides; with one leaf a face and passes {ours:.2f}, "
            f"with all leaves and the queue {with_queue:.2f}")


def published_interpolation(evidence, table, row, paper):
    if row.setting["structure"] != "K_Li":
        return None
    published = evidence.find(row.setting, interpolation="published")
    if not published:
        return None
    variants = evidence.near_ties(row.setting, interpolation="published")
    low, high = value_range(table, [published, *variants])
    theirs = getattr(paper, table.paper)
    return (within(theirs, low, high) or abs(table.ours(published) - theirs) <= high - low,
            f"interpolation: with the published one, its two slips included, "
            f"{table.ours(published):.2f}" +
            (f" ({low:.2f} to {high:.2f} over {len(variants)} runs that choose otherwise among "
             f"edges of almost equal length)" if variants else ""))


def scatter(evidence, table, row, paper):
    variants = evidence.near_densities(row.setting) if table is DELTA_R else []
    if not variants:
        return None
    low, high = value_range(table, [row, *variants])
    return (within(paper.delta_R_max, low, high),
            f"scatter: the largest of 27000 errors is {low:.2f} to {high:.2f} with sources 1 % "
            f"closer or farther apart")


RULES = (balance, ties, shared_vertices, links, published_interpolation, scatter)


def judge(evidence, table):
    """A verdict on each cell of a table, in the order of `evidence.cells`."""
    return [Judged(cell, *verdict(evidence, table, cell)) for cell in evidence.cells]


def verdict(evidence, table, cell):
    row, paper = cell
    if row.measures is None:
        return FAILED, row.error
    if table.not_comparable:
        return NOT_COMPARABLE, table.not_comparable
    if rounded(table.ours(row)) == rounded(getattr(paper, table.paper)):
        return EQUAL, ""
    tried = []
    for rule in RULES:
        explanation = rule(evidence, table, row, paper)
        if explanation and explanation[0]:
            return EXPLAINED, explanation[1]
        if explanation:
            tried.append(f"not {explanation[1]}")
    return UNEXPLAINED, "; ".join(tried) or "no experiment bears on it"


# ---- Conclusions that the paper's tables suggest

# What a claim may speak of: one structure at one setting, ours or the paper's. `deep`: largest
# delta_R with the deepest limit that was tried.
Entry = namedtuple("Entry", "label memory creation access delta_r deep", defaults=[None])
UNITS = {"memory": " MB", "creation": " s", "access": " µs", "delta_r": ""}


def pair_text(a, b, measure):
    unit = UNITS[measure]
    return (f"{a.label} {getattr(a, measure):.3g}{unit}, "
            f"{b.label} {getattr(b, measure):.3g}{unit}")


def all_hold(*conditions):
    """A test of conditions (structure, measure, "<" or ">", factor, other structure)."""
    def test(entries):
        by_label = {e.label: e for e in entries}
        holds, texts = True, []
        for left, measure, order, factor, right in conditions:
            if left not in by_label or right not in by_label:
                return None
            a, b = by_label[left], by_label[right]
            x, y = getattr(a, measure), factor * getattr(b, measure)
            holds = holds and (x < y if order == "<" else x > y)
            texts.append(pair_text(a, b, measure))
        return holds, "; ".join(texts)
    return test


def all_rounder(entries):
    entries = [e for e in entries if not e.label.endswith("s_M")]
    if len(entries) < 9:  # among a few, a good rank says little
        return None
    ranks = [average_ranks([getattr(e, measure) for e in entries]) for measure in UNITS]
    means = sorted((sum(r) / len(r), i) for i, r in enumerate(zip(*ranks)))
    best = [(entries[i].label, mean) for mean, i in means[:3]]
    return (any(label.startswith("K_L ") for label, _ in best),
            "mean ranks: " + ", ".join(f"{label} {mean:.2f}" for label, mean in best))


def fastest_octree(entries):
    octree = next((e for e in entries if e.label == "K_oL"), None)
    others = [e for e in entries if e is not octree]
    if not octree or not others:
        return None
    other = min(others, key=lambda e: e.access)
    return octree.access < other.access, pair_text(octree, other, "access")


def poor_deep_slabs(entries):
    by_label = {e.label: e for e in entries}
    middle, slabs = by_label.get("K_L s_L"), by_label.get("K_L s_M")
    if not middle or not slabs or slabs.deep is None:
        return None
    return (slabs.deep > 2 * middle.delta_r,
            f"K_L s_M {slabs.delta_r:.3g} at the paper's depth, {slabs.deep:.3g} at the deepest; "
            f"K_L s_L {middle.delta_r:.3g}")


# The sentence, what is compared, where to see more, and a test at one setting: (holds, numbers), or
# None where an entry that it needs is missing.
Claim = namedtuple("Claim", "sentence compared more test")
CLAIMS = [Claim(*claim) for claim in (
    ("K_L is a good all-rounder.",
     "mean rank in memory, creation, access and delta_R among the best three of nine, s_M left out",
     "Tables 1-4", all_rounder),
    ("Interpolation buys accuracy for time.",
     "K_Li against K_L, with s_L and with s_G: smaller delta_R, longer access", "Tables 3 and 4",
     all_hold(("K_Li s_L", "delta_r", "<", 1, "K_L s_L"), ("K_Li s_L", "access", ">", 1, "K_L s_L"),
              ("K_Li s_G", "delta_r", "<", 1, "K_L s_G"),
              ("K_Li s_G", "access", ">", 1, "K_L s_G"))),
    ("Values at vertices buy accuracy for memory and creation time.",
     "K_V against K_L, with s_L: smaller delta_R, more MB, more s", "Tables 1, 2 and 4",
     all_hold(("K_V s_L", "delta_r", "<", 1, "K_L s_L"), ("K_V s_L", "memory", ">", 1, "K_L s_L"),
              ("K_V s_L", "creation", ">", 1, "K_L s_L"))),
    ("The plain octree is the fastest to read.", "access time of K_oL against all others",
     "Table 3", fastest_octree),
    ("The split s_M is poor.", "delta_R of K_L: more than twice that of s_L", "Table 4",
     all_hold(("K_L s_M", "delta_r", ">", 2, "K_L s_L"))),
    ("The split s_M is poor at any depth.", "the same, at the deepest limit tried",
     "experiment: the depth limit of s_M", poor_deep_slabs),
    ("The octree with values at vertices is bad.", "delta_R of K_oV above that of K_V s_L",
     "experiment: shared vertices", all_hold(("K_oV", "delta_r", ">", 1, "K_V s_L"))),
    ("Balancing ruins memory.", "K_oLB: more than twice the MB of K_oL", "experiment: balance",
     all_hold(("K_oLB", "memory", ">", 2, "K_oL"))),
    ("Balancing ruins accuracy.", "delta_R of K_oLB above that of K_oL", "experiment: balance",
     all_hold(("K_oLB", "delta_r", ">", 1, "K_oL"))))]

STANDS, DOES_NOT_STAND, NOT_MEASURED = CLAIM_VERDICTS = (
    "Conclusions that stand", "Conclusions that do not stand", "Conclusions that were not measured")
JudgedClaim = namedtuple("JudgedClaim", "claim verdict holds settings paper_holds paper_settings "
                                        "numbers")


def setting_name(paper):
    return f"ρ {plain(paper.rho)} τ {plain(paper.tau)}"


def cells_by_setting(evidence):
    groups = {}
    for cell in evidence.measured_cells:
        groups.setdefault(setting_name(cell.paper), []).append(cell)
    return groups


def our_entry(evidence, row):
    deep = evidence.other_depths(row.setting)
    return Entry(f"{row.setting['structure']} {row.split}".strip(), row["bytes_total"] / 1e6,
                 row.creation_s, ACCESS.ours(row), row["delta_R_max"],
                 deep[-1]["delta_R_max"] if deep else None)


def paper_entry(p):
    return Entry(f"{p.structure} {p.split}".strip(), p.size_MB, p.creation_s, p.access_us,
                 p.delta_R_max)


def judge_claims(evidence):
    """All claims, each at every setting that has rows run as published: it stands if it holds at
    every one. Numbers are those of the first setting where it fails, else of the first."""
    settings = [(name, [our_entry(evidence, cell.row) for cell in cells],
                 [paper_entry(cell.paper) for cell in cells])
                for name, cells in cells_by_setting(evidence).items()]
    judged = []
    for claim in CLAIMS:
        outcomes = [(name, claim.test(ours), claim.test(paper)) for name, ours, paper in settings]
        outcomes = [outcome for outcome in outcomes if outcome[1]]
        papers = [paper[0] for _, _, paper in outcomes if paper]
        failed = [outcome for outcome in outcomes if not outcome[1][0]]
        shown = (failed or outcomes or [None])[0]
        state = NOT_MEASURED if not outcomes else DOES_NOT_STAND if failed else STANDS
        judged.append(JudgedClaim(claim, state, len(outcomes) - len(failed), len(outcomes),
                                  sum(papers), len(papers),
                                  f"{shown[0]}: {shown[1][1]}" if shown else ""))
    return judged


# ---- Ranks

def average_ranks(values):
    """From 1 for the smallest; equal values share the mean of their ranks."""
    ordered = sorted(values)
    count = {v: ordered.count(v) for v in set(values)}
    return [ordered.index(v) + (count[v] + 1) / 2 for v in values]


def spearman(a, b):
    """Spearman's rho; None where there is nothing to order."""
    if len(a) < 3 or len(set(a)) == 1 or len(set(b)) == 1:
        return None
    x, y = average_ranks(a), average_ranks(b)
    mean = (len(a) + 1) / 2
    xy = sum((p - mean) * (q - mean) for p, q in zip(x, y))
    xx = sum((p - mean) ** 2 for p in x)
    yy = sum((q - mean) ** 2 for q in y)
    return xy / math.sqrt(xx * yy)

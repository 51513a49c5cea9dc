# SPDX-License-Identifier: Apache-2.0
# Tables of the comparison with the paper, and the page paper.md.
import json

from . import paper as p
from .ranks import spearman
from .results import InputError, described, plain
from .table import Table, fixed

CASE = ["<structure", "<split", "ρ", "τ"]


def case_of(cell):
    return [cell.paper.structure, cell.paper.split, plain(cell.paper.rho), plain(cell.paper.tau)]


# ---- Experiments

def value_text(value, digits, who):
    """The text of a value of paper.toml: "row.size_MB / other.size_MB", of what `who` names."""
    if " / " in value:
        a, b = (operand.split(".") for operand in value.split(" / "))
        return fixed(who[a[0]][a[1]] / who[b[0]][b[1]], digits)
    name, key = value.split(".")
    if name == "range":
        low, high = p.value_range(key, who["all"])
        return f"{low:.2f} to {high:.2f}"
    return fixed(who[name][key], digits) if who[name] else "–"


def experiment_lines(experiment, evidence, cell):
    changes = experiment.get("other", {})
    other = evidence.find(cell.row, **changes)
    rows = getattr(evidence, experiment["rows"])(cell.row) if "rows" in experiment else ()
    needed = [other] * ("other" in experiment) + [rows] * ("rows" in experiment)
    if cell.paper.structure not in experiment.get("only", [cell.paper.structure]) or \
            not all(needed):
        return []
    paper_other = p.paper_row({**cell.row.setting, **changes})
    who = {"other": other, "rows": {"count": len(rows)}, "all": [cell.row, *rows],
           "paper": cell.paper._asdict() | {"nodes": cell.published_nodes()},
           "paper_other": paper_other and paper_other._asdict()}
    return [[*case_of(cell), *(value_text(column[1], *column[2:] or [2], {
        **who, "row": row.setting | row.measures, "paper": who["paper"] if row is cell.row else None
    }) for column in experiment["columns"])]
        for row in (who["all"] if "each" in experiment else [cell.row])]


def experiment_tables(evidence):
    tables = [clock_ticks(), octree_links()]
    for experiment in p.TEXTS["experiments"]:
        lines = [line for cell in evidence.measured_cells
                 for line in experiment_lines(experiment, evidence, cell)]
        note = experiment["note"] + ("" if lines else " Not in these results: see `--experiments`.")
        tables.append(Table(f"Experiment: {experiment['name']}", note,
                            CASE + [column[0] for column in experiment["columns"]], lines))
    return tables


def clock_ticks():
    tick, half_digit = 1e4 / 27000, 0.0051  # µs; of a printed value, and its own rounding
    times = [row.access_us for row in p.PAPER_ROWS]
    off = [abs(t - round(t / tick) * tick) for t in times]
    return Table(
        "Experiment: the clock of Table 3",
        "Checked on the paper's own table: a clock of 10 ms over 27000 queries gives 0.370 µs.",
        ["entries", "whole ticks", "farthest from one [µs]", "different values",
         "shortest [ticks]"],
        [[str(len(times)), str(sum(x <= half_digit for x in off)), fixed(max(off), 4),
          str(len({round(t / tick) for t in times})), fixed(min(times) / tick, 0)]])


def octree_links():
    lines = []
    for (rho, tau, kind), run in p.OCTREE_LINKS.items():
        if kind == "published":
            paper = p.PAPER_BY_SETTING["K_oL", "", rho, tau]
            right = p.OCTREE_LINKS[rho, tau, "right"]
            lines.append([plain(rho), plain(tau), f"{100 * run.wrong_links:.1f}", fixed(run.delta_R_max),
                          fixed(paper.delta_R_max), fixed(right.delta_R_max)])
    return Table(
        "Experiment: the links of K_oL",
        "A small program of its own (`bench/links`) with the published program's links between leaves: when an element "
        "splits, its children take the children of a neighbour that has split by their number, even of a coarser one, "
        "and these link back to them. Wrong: links between leaves that do not touch.",
        ["ρ", "τ", "wrong [%]", "delta_R", "paper", "with right links"], lines)


# ---- The summary

def claims_tables(evidence):
    judged = p.judge_claims(evidence)
    tables = []
    for verdict in p.CLAIM_VERDICTS:
        rows = [[j.claim["sentence"], share(j.holds, j.settings)
                 + (f", {j.undecided} indistinguishable" if j.undecided else ""),
                 share(j.paper_holds, j.paper_settings), j.numbers, j.claim["compared"],
                 j.claim["more"]] for j in judged if j.verdict == verdict]
        if rows:
            tables.append(Table(
                verdict,
                "Holds: number of settings of the sphere at which our numbers bear it out, and the "
                "paper's own. It stands if ours fail at none; times whose quartiles overlap are "
                "indistinguishable and decide nothing.",
                ["<conclusion", "holds", "in the paper", "<numbers, ours", "<compared",
                 "<more in"], rows))
    return tables


def share(part, whole):
    return f"{part} of {whole}" if whole else "–"


def rank_table(evidence):
    groups = p.cells_by_setting(evidence)
    table = Table("Ranks: Spearman's rho, ours against the paper's",
                  "Within each column of a table. 1: the same order; -1: the reverse; ties share "
                  "the mean of their ranks. Without faults: without K_oLB, K_V and K_oV.",
                  ["<table", "<rows", "mean", *groups])
    measures = [(t.title, t.measure, t.measure) for t in p.TABLES]
    measures.append(("Table 1 against the memory really allocated", "memory_MB", "size_MB"))
    for title, ours, theirs in measures:
        for rows, left_out in (("all", ()), ("without faults", ("K_oLB", "K_V", "K_oV"))):
            rhos = []
            for cells in groups.values():
                cells = [cell for cell in cells if cell.paper.structure not in left_out]
                rhos.append(spearman([cell.row[ours] for cell in cells],
                                       [getattr(cell.paper, theirs) for cell in cells]))
            known = [rho for rho in rhos if rho is not None]
            mean = sum(known) / len(known) if known else None
            table.rows.append([title, rows, *("–" if rho is None else fixed(rho)
                                              for rho in (mean, *rhos))])
    return table


def counts_table(evidence):
    table = Table("Verdicts on the paper's cells",
                  "Equal: to the printed digit. Shown: runs of ours give the printed digits, or their "
                  "range holds them. Inferred: our numbers point to the reason (a fault of the program "
                  "behind the paper, a choice between almost equal edges), but no run repeats it.",
                  ["<table", *p.VERDICTS, "not measured"])
    for t in p.TABLES:
        verdicts = [judged.verdict for judged in p.judge(evidence, t)]
        table.rows.append([t.title, *(str(verdicts.count(v)) for v in p.VERDICTS),
                           str(len(p.PAPER_ROWS) - len(verdicts))])
    return table


def cell_line(table, judged):
    cell = judged.cell
    digits = 3 if table.not_comparable else 2
    ours = fixed(cell.ours(table), digits) if cell.row.measures is not None else "–"
    return [*case_of(cell), ours, fixed(cell.theirs(table)), judged.verdict, judged.reason]


CELL_COLUMNS = CASE + ["ours", "paper", "<verdict", "<why"]


def open_table(evidence):
    """The cells that nobody may overlook."""
    rows = [[t.title.split(":")[0], *cell_line(t, judged)] for t in p.TABLES
            for judged in p.judge(evidence, t) if judged.verdict in (p.UNEXPLAINED, p.FAILED)]
    return Table("Cells that differ, of which nothing is shown or inferred",
                 "With what was tried, and what it gave." if rows else "None.",
                 ["<table", *CELL_COLUMNS], rows)


def headline(evidence):
    claims = [judged.verdict for judged in p.judge_claims(evidence)]
    cells = [judged.verdict for t in (p.SIZE, p.DELTA_R) for judged in p.judge(evidence, t)]
    return (f"Of the conclusions that the paper's tables suggest {claims.count(p.STANDS)} stand and "
            f"{claims.count(p.DOES_NOT_STAND)} do not. Of the {len(cells)} cells of Tables 1 and 4 "
            f"{cells.count(p.EQUAL)} are equal to the printed digit, {cells.count(p.SHOWN)} "
            f"differ for a reason that runs show, {cells.count(p.INFERRED)} for one that is inferred, "
            f"{cells.count(p.UNEXPLAINED)} for none that is known.")


def summary_tables(evidence):
    return [*claims_tables(evidence), rank_table(evidence), counts_table(evidence),
            open_table(evidence)]


def detail_tables(evidence):
    return experiment_tables(evidence) + [
        Table(t.title, "", CELL_COLUMNS, [cell_line(t, judged) for judged in p.judge(evidence, t)])
        for t in p.TABLES]


def side_by_side(evidence):
    """Tables 1-4 with ours beside the paper's: structures down, settings across."""
    columns = list(dict.fromkeys(p.setting_name(cell.paper) for cell in evidence.cells))
    groups = p.cells_by_setting(evidence)
    tables = []
    for t in p.TABLES:
        def text(cell):
            if cell.row.measures is None:
                return f"failed / {plain(cell.theirs(t))}"
            if not t.not_comparable:
                return f"{cell.ours(t):.2f} / {plain(cell.theirs(t))}"
            peers = groups[p.setting_name(cell.paper)]
            ranks = [1 + sum(value(peer, t) < value(cell, t) for peer in peers)
                     for value in (p.Cell.ours, p.Cell.theirs)]
            return f"{cell.ours(t):.3g} ({ranks[0]}) / {plain(cell.theirs(t))} ({ranks[1]})"
        lines = {}
        for cell in evidence.cells:
            line = lines.setdefault(tuple(case_of(cell)[:2]), {})
            line[p.setting_name(cell.paper)] = text(cell)
        tables.append(Table(
            f"{t.title}, ours {'(rank) ' if t.not_comparable else ''}/ paper",
            f"In brackets: ranks in the column; values cannot be compared ({t.not_comparable})."
            if t.not_comparable else "", ["<structure", "<split", *columns],
            [[*case, *(line.get(name, "–") for name in columns)] for case, line in lines.items()]))
    return tables


def table_5(file):
    """Table 5 from results of `controlspace mesh`; throws InputError."""
    try:
        data = json.loads(file.read_text(encoding="utf-8"))
        lines, columns = {}, []
        for row in data["rows"] if p.is_paper_sphere(data["study"]) else ():
            case = {key: value for key, value in row.get("case", {}).items() if value is not None}
            paper = p.paper_row(case) if case and row["field"] != "exact" else None
            if paper is None:
                continue
            name = p.setting_name(paper)
            columns += [name] if name not in columns else []
            run = f"{row['mesher']}, {case['law']}, {case['schedule']}"
            ours = "failed" if row["error"] else fixed(row["L_R"], 4)
            lines.setdefault((paper.structure, paper.split, run), {})[name] = \
                f"{ours} / {paper.L_R:.2f}"
        if not lines:
            raise ValueError("no row was meshed as the paper's Table 5")
        return f"# The paper, Table 5\n\n{data['origin']}: `{data['command_line']}`\n\n" + Table(
            "Table 5: L_R, ours / paper",
            "The paper's meshes are of its own mesher, with up to 350,000 tetrahedra.",
            ["<structure", "<split", "<run", *columns],
            [[*case, *(line.get(name, "–") for name in columns)] for case, line in lines.items()]
        ).markdown()
    except OSError as error:
        raise InputError(f"{file}: {error.strerror.lower()}") from error
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(f"{file}: {described(error)}") from error


def summary(evidence):
    return "\n".join([headline(evidence) + "\n",
                      *(table.markdown() for table in summary_tables(evidence))])


def page(evidence, origins):
    return ("# The paper, cell by cell\n\nJurczyk & Głut, \"Tree-based control space structures for "
            "discrete metric sources in 3D meshing\", Tables 1-4, beside rows that were run in the "
            "same way.\n\n" + "".join(f"- {origin}\n" for origin in origins) + "\n"
            + "\n".join([summary(evidence), *(t.markdown() for t in detail_tables(evidence))]))

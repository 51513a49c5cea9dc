# Tables of the comparison with the paper, and the page paper.md.
import json

from . import paper as p
from .results import InputError, described, plain
from .table import Table, fixed

# How `controlspace mesh` names the paper's settings.
MESH_SETTING = "rho {}, s_a 2, s_n 1, tau {}, epsilon 0.2, g_r 1.25; "
CASE = ["<structure", "<split", "ρ", "τ"]


def case_of(cell):
    return [cell.paper.structure, cell.paper.split, plain(cell.paper.rho), plain(cell.paper.tau)]


# ---- Experiments: title, note, columns, and the columns' values of a cell (one list, or a list of
# lists where a cell has several lines); nothing where the experiment has no row for the cell.

def balance(evidence, cell):
    row, paper = cell
    if paper.structure != "K_oLB":
        return None
    plain_row = evidence.find(row.setting, structure="K_oL")
    plain_paper = p.paper_row({**row.setting, "structure": "K_oL"})
    if not plain_row or not plain_paper:
        return None
    size = p.SIZE.ours(row)
    return map(fixed, (size, size / p.SIZE.ours(plain_row), paper.size_MB,
                       paper.size_MB / plain_paper.size_MB, row["delta_R_max"],
                       plain_row["delta_R_max"], paper.delta_R_max, plain_paper.delta_R_max))


def shared_vertices(_, cell):
    if cell.paper.structure not in ("K_V", "K_oV"):
        return None
    nodes, places = p.published_nodes(cell), cell.row["control_nodes"]
    return [str(places), fixed(nodes, 0), fixed(nodes / places), fixed(cell.row["delta_R_max"]),
            fixed(cell.paper.delta_R_max)]


def depth_limit(evidence, cell):
    rows = evidence.other_depths(cell.row.setting)
    return [[str(row.setting["max_depth"]), str(row["depth"]), str(row["cells"]),
             fixed(row["delta_R_max"]), fixed(row["delta_R_mean"], 4),
             fixed(cell.paper.delta_R_max) if row is cell.row else "–"]
            for row in [cell.row, *rows]] if rows else None


def near_ties(evidence, cell):
    variants = evidence.near_ties(cell.row.setting)
    return [str(len(variants)), *ours_range_paper(p.SIZE, cell, variants),
            *ours_range_paper(p.DELTA_R, cell, variants)] if variants else None


def ours_range_paper(table, cell, variants):
    low, high = p.value_range(table, [cell.row, *variants])
    return [fixed(table.ours(cell.row)), f"{low:.2f} to {high:.2f}",
            fixed(getattr(cell.paper, table.paper))]


def accounting(_, cell):
    allocated = cell.row["bytes_total"] / 1e6
    return map(fixed, (cell.paper.size_MB, p.SIZE.ours(cell.row), allocated,
                       cell.row["bytes_payload"] / 1e6, cell.paper.size_MB / allocated))


def two_references(evidence, cell):
    exact = evidence.find(cell.row.setting, reference="exact")
    return [fixed(cell.row["delta_R_max"]), fixed(exact["delta_R_max"]),
            fixed(cell.paper.delta_R_max), fixed(cell.row["delta_R_mean"], 4),
            fixed(exact["delta_R_mean"], 4)] if exact else None


def schedules(evidence, cell):
    queue = evidence.find(cell.row.setting, schedule="queue")
    return [fixed(cell.row["delta_R_max"]), fixed(queue["delta_R_max"]),
            fixed(cell.paper.delta_R_max), fixed(cell.row["gradation_max_left"], 4),
            fixed(queue["gradation_max_left"], 4)] if queue else None


def interpolations(evidence, cell):
    published = evidence.find(cell.row.setting, interpolation="published")
    return [text for table in (p.SIZE, p.DELTA_R)
            for text in (fixed(table.ours(cell.row)), fixed(table.ours(published)),
                         fixed(getattr(cell.paper, table.paper)))] if published else None


def scatter(evidence, cell):
    variants = evidence.near_densities(cell.row.setting)
    return [str(len(variants)), *ours_range_paper(p.DELTA_R, cell, variants)] if variants else None


EXPERIMENTS = [
    ("balance",
     "K_oLB with every leaf at most one level finer than its neighbours across faces, beside K_oL "
     "at the same setting.",
     ["MB", "times K_oL", "paper MB", "times K_oL", "delta_R", "K_oL delta_R", "paper delta_R",
      "paper K_oL delta_R"], balance),
    ("shared vertices",
     "Our trees have one control node at each place. The paper's number follows from its size, "
     "which counts 104 bytes for each, on the elements of our tree. Of several nodes at one place "
     "each gets what its own leaves get.",
     ["places", "paper's nodes", "nodes a place", "delta_R", "paper delta_R"], shared_vertices),
    ("the depth limit of s_M",
     "s_M peels slabs, so its depth grows linearly with the box. Depth: of the tree; the root has "
     "level 0.",
     ["limit", "depth", "leaves", "delta_R", "mean", "paper delta_R"], depth_limit),
    ("edges that are almost equally long",
     "s_G and s_M cut boxes whose edges are equally long but for rounding or the digits of the "
     "golden section, and s_M slabs that are as long as l_min but for rounding. Range over runs "
     "with another order among them: a box longer by a billionth along some axes, l_min by as "
     "much, s_G's sections to all digits instead of five.",
     ["runs", "MB", "range", "paper", "delta_R", "range", "paper"], near_ties),
    ("the accounting of Table 1",
     "The paper's size counts 136 bytes a leaf, 108 (kd-tree) or 216 (octree) an inner node and "
     "104 a vertex, and no metric of a leaf. Beside it what our structure allocates, the metrics "
     "in it among that.",
     ["paper MB", "in its accounting", "allocated", "metrics", "paper / allocated"], accounting),
    ("the clock of Table 3", None, None, None),
    ("the two references",
     "The same graded structure against the analytic field h + s ||p| - r| with s = 2 (g-1)/(g+1), "
     "and against the exact field of all sources' cones.",
     ["analytic", "exact", "paper", "analytic, mean", "exact, mean"], two_references),
    ("links and schedules",
     "At most ten passes over the nearest leaf across each face, as for the tables, and the queue "
     "of the paper's text over all leaves across each face, until nothing changes. G left: the "
     "largest gradation ratio between linked nodes at the end.",
     ["delta_R passes", "queue", "paper", "G left passes", "queue"], schedules),
    ("the interpolation of K_Li",
     "Ours, and the published one with its two slips: the trilinear part of the basis evaluated at "
     "t in [0, 1] where 2t - 1 is meant, and one corner that is the mean of a wrong face.",
     ["MB", "published", "paper", "delta_R", "published", "paper"], interpolations),
    ("what a maximum over 27000 places is worth",
     "Largest delta_R with the sources a little closer together or farther apart: differences "
     "within the range say nothing of a structure.",
     ["runs", "delta_R", "range", "paper"], scatter)]


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


def experiment_tables(evidence):
    tables = []
    for name, note, columns, values_of in EXPERIMENTS:
        if values_of is None:
            tables.append(clock_ticks())
            continue
        table = Table(f"Experiment: {name}", note, CASE + columns)
        for cell in evidence.measured_cells:
            values = list(values_of(evidence, cell) or [])
            lines = values if values and isinstance(values[0], list) else [values]
            table.rows += [case_of(cell) + line for line in lines if line]
        if not table.rows:
            table.note += " Not in these results: see `--experiments`."
        tables.append(table)
    return tables


# ---- The summary

def claims_tables(evidence):
    judged = p.judge_claims(evidence)
    tables = []
    for verdict in p.CLAIM_VERDICTS:
        rows = [[j.claim.sentence, share(j.holds, j.settings), share(j.paper_holds, j.paper_settings),
                 j.numbers, j.claim.compared, j.claim.more] for j in judged if j.verdict == verdict]
        if rows:
            tables.append(Table(
                verdict,
                "Holds: number of settings of the sphere at which our numbers bear it out, and the "
                "paper's own. It stands if ours do at every setting.",
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
    measures = [(t.title, t.ours, t.paper) for t in p.TABLES]
    measures.append(("Table 1 against the memory really allocated",
                     lambda row: row["bytes_total"] / 1e6, "size_MB"))
    for title, ours, theirs in measures:
        for rows, left_out in (("all", ()), ("without faults", ("K_oLB", "K_V", "K_oV"))):
            rhos = []
            for cells in groups.values():
                cells = [cell for cell in cells if cell.paper.structure not in left_out]
                rhos.append(p.spearman([ours(cell.row) for cell in cells],
                                       [getattr(cell.paper, theirs) for cell in cells]))
            known = [rho for rho in rhos if rho is not None]
            mean = sum(known) / len(known) if known else None
            table.rows.append([title, rows, *("–" if rho is None else fixed(rho)
                                              for rho in (mean, *rhos))])
    return table


def counts_table(evidence):
    table = Table("Verdicts on the paper's cells",
                  "Equal: to the printed digit. Explained: differs, and an experiment shows why.",
                  ["<table", *p.VERDICTS, "not measured"])
    for t in p.TABLES:
        verdicts = [judged.verdict for judged in p.judge(evidence, t)]
        table.rows.append([t.title, *(str(verdicts.count(v)) for v in p.VERDICTS),
                           str(len(p.PAPER_ROWS) - len(verdicts))])
    return table


def cell_line(table, judged):
    row, paper = judged.cell
    digits = 3 if table.not_comparable else 2
    ours = fixed(table.ours(row), digits) if row.measures is not None else "–"
    return [*case_of(judged.cell), ours, fixed(getattr(paper, table.paper)), judged.verdict,
            judged.reason]


CELL_COLUMNS = CASE + ["ours", "paper", "<verdict", "<why"]


def open_table(evidence):
    """The cells that nobody may overlook."""
    rows = [[t.title.split(":")[0], *cell_line(t, judged)] for t in p.TABLES
            for judged in p.judge(evidence, t) if judged.verdict in (p.UNEXPLAINED, p.FAILED)]
    return Table("Cells that differ and are not explained",
                 "With what was tried, and what it gave." if rows else "None.",
                 ["<table", *CELL_COLUMNS], rows)


def headline(evidence):
    claims = [judged.verdict for judged in p.judge_claims(evidence)]
    cells = [judged.verdict for t in (p.SIZE, p.DELTA_R) for judged in p.judge(evidence, t)]
    return (f"Of the conclusions that the paper's tables suggest {claims.count(p.STANDS)} stand and "
            f"{claims.count(p.DOES_NOT_STAND)} do not. Of the {len(cells)} cells of Tables 1 and 4 "
            f"{cells.count(p.EQUAL)} are equal to the printed digit, {cells.count(p.EXPLAINED)} "
            f"differ for a reason that an experiment shows, {cells.count(p.UNEXPLAINED)} differ and "
            f"are not explained.")


def summary_tables(evidence):
    return [*claims_tables(evidence), rank_table(evidence), counts_table(evidence),
            open_table(evidence)]


def detail_tables(evidence):
    return experiment_tables(evidence) + [
        Table(t.title, "", CELL_COLUMNS, [cell_line(t, judged) for judged in p.judge(evidence, t)])
        for t in p.TABLES]


def side_by_side(evidence):
    """Tables 1-4 with ours beside the paper's: structures down, settings across."""
    columns = [p.setting_name(cell.paper) for cell in evidence.cells]
    columns = sorted(set(columns), key=columns.index)
    tables = []
    for t in p.TABLES:
        def ranks(value_of, t=t):
            return {name: sorted(value_of(cell) for cell in cells)
                    for name, cells in p.cells_by_setting(evidence).items()}
        ours, theirs = lambda c, t=t: t.ours(c.row), lambda c, t=t: getattr(c.paper, t.paper)
        our_ranks, their_ranks = ranks(ours), ranks(theirs)
        lines = {}
        for cell in evidence.cells:
            name = p.setting_name(cell.paper)
            line = lines.setdefault(tuple(case_of(cell)[:2]), {})
            if cell.row.measures is None:
                line[name] = f"failed / {plain(theirs(cell))}"
            elif t.not_comparable:
                line[name] = (f"{ours(cell):.3g} ({our_ranks[name].index(ours(cell)) + 1}) / "
                              f"{plain(theirs(cell))} ({their_ranks[name].index(theirs(cell)) + 1})")
            else:
                line[name] = f"{ours(cell):.2f} / {plain(theirs(cell))}"
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
        for row in data["rows"]:
            paper = next((r for r in p.PAPER_ROWS if row["split"] == r.split and row["field"] ==
                          r.structure and row["setting"].startswith(MESH_SETTING.format(
                              plain(r.rho), plain(r.tau)))), None)
            if paper is None:
                continue
            run = row["setting"].split("; ")[1].replace(" law", "").split(", published")[0]
            columns += [name for name in [p.setting_name(paper)] if name not in columns]
            line = lines.setdefault((row["field"], row["split"], f"{row['mesher']}, {run}"), {})
            ours = "failed" if row["error"] else fixed(row["L_R"], 4)
            line[p.setting_name(paper)] = f"{ours} / {paper.L_R:.2f}"
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

# SPDX-License-Identifier: Apache-2.0
# The paper cell by cell: the page of kept results to the letter; what each rule, claim and rank says of
# numbers that the kept results do not have; and what is refused.
import csv
import json
import shutil
import subprocess
import unittest

from samples import (KEPT, ROOT, InFolder, evidence_of, failed_row, json_row,
                     paper_json_rows, results_of, run, sized, times, write_results)

from pages import paper, paper_page
from pages.paper import DELTA_R, EQUAL, INFERRED, SHOWN, SIZE, UNEXPLAINED, Evidence
from pages.paper_command import EXPERIMENTS


def measured(structure, split, megabytes, delta_r, nodes=103, **changes):
    return json_row(structure, split, delta_R_max=delta_r, **sized(structure, megabytes, nodes), **changes)


class Kept(InFolder):
    def test_kept_results_give_the_kept_page(self):
        shutil.copytree(KEPT / "paper-sphere", self.folder / "out")
        page = self.folder / "out/paper.md"
        page.unlink()
        # All experiments lie there: none is run, so the program is not needed.
        done = run("paper", self.folder / "out", "--experiments", "--program", "/none")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(page.read_text(), (KEPT / "paper-sphere/paper.md").read_text())
        self.assertIn(done.stdout.split("\n")[0], page.read_text())

    def test_kept_results_give_the_kept_conclusions(self):
        shutil.copytree(KEPT / "paper-conclusions", self.folder / "out")
        page = self.folder / "out/README.md"
        page.unlink()
        done = run("conclusions", "--output", self.folder / "out")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(page.read_text(), (KEPT / "paper-conclusions/README.md").read_text())

    def test_the_program_of_links_prints_the_kept_runs(self):
        kept = (ROOT / "data/paper/octree_links.csv").read_text()
        program = self.folder / "links"
        subprocess.run(["c++", "-std=c++20", "-O2", "-ffp-contract=off", ROOT / "bench/links.cpp", "-o", program],
                       check=True)
        self.assertEqual(subprocess.run([program], capture_output=True, text=True).stdout, kept)
        # Right links give the library's K_oL, published ones what was rerun.
        rows = json.loads((KEPT / "paper-sphere/results.json").read_text())["rows"]
        ours = {(r["rho"], r["tau"]): r for r in rows if r["structure"] == "K_oL" and r["law"] == "mean-length"}
        for (rho, tau, kind), links in paper.OCTREE_LINKS.items():
            row = ours[rho, tau]
            self.assertEqual((links.sources, links.elements, links.leaves),
                             (row["sources"], row["tree_nodes"], row["cells"]))
            if kind == "right":
                self.assertAlmostEqual(links.delta_R_max, row["delta_R_max"], delta=6e-5)
                self.assertAlmostEqual(links.delta_R_mean, row["delta_R_mean"], delta=6e-5)
        lines = (ROOT / "data/paper/reproduction.csv").read_text().splitlines()
        for row in csv.DictReader(line for line in lines if line and line[0] != "#"):
            if row["structure"] == "K_oL":
                links = paper.OCTREE_LINKS[float(row["rho"]), float(row["tau"]), "published"]
                self.assertEqual([f"{links.delta_R_max:.4f}", f"{links.delta_R_mean:.4f}"],
                                 [row["delta_R_max"], row["delta_R_mean"]])

    def test_the_rerun_agrees_where_it_was_programmed_alike(self):
        # delta_R_max of the rerun, rounded, is the printed value; sizes follow from the counts.
        lines = (ROOT / "data/paper/reproduction.csv").read_text().splitlines()
        checked = 0
        for row in csv.DictReader(line for line in lines if line and line[0] != "#"):
            if row["rerun"] != "published":
                continue
            key = (row["structure"], row["split"], float(row["rho"]), float(row["tau"]))
            printed = paper.PAPER_BY_SETTING[key]
            self.assertLessEqual(abs(float(row["delta_R_max"]) - printed.delta_R_max), 0.0051)
            leaves, kd = float(row["nodes"]), bool(row["split"])
            inner = float(row["elements"]) - leaves
            size = 136 * leaves + (108 if kd else 216) * inner + (104 if kd else 0)
            self.assertAlmostEqual(size / 1e6 / printed.size_MB, 1, delta=0.003)
            checked += 1
        self.assertEqual(checked, 10)


class Cells(unittest.TestCase):
    def test_a_case_finds_its_row(self):
        # Jurczyk & Głut, Tables 1-5, row K_V s_G, last column.
        setting = results_of([json_row("K_V", "s_G", rho=0.2, tau=0.2)]).rows[0].setting
        self.assertEqual(paper.paper_row(setting)[4:], (1041.96, 856.65, 3.33, 1.59, 0.66))

    def test_only_what_was_run_as_published_is_a_cell(self):
        self.assertEqual(len(evidence_of([json_row("K_oL", intersection="in-turn")]).cells), 1)
        for change in ({"law": "cone"}, {"schedule": "queue"}, {"reference": "exact"}, {"tau": 0.3},
                       {"precision": "float"}, {"interpolation": "published"}, {"max_depth": 100}):
            self.assertFalse(evidence_of([json_row("K_oL", **change)]).cells, change)
        for setting in ({"domain": [-2, 2, -2, 2, -2, 2]}, {"radius": 0.7}, {"sources": "planes"}):
            self.assertFalse(evidence_of([json_row("K_oL")], **setting).cells, setting)

    def test_verdicts_on_numbers_beside_the_printed_ones(self):
        def verdict(table, *rows):
            return paper.judge(evidence_of(rows), table)[-1].verdict

        # Jurczyk & Głut, Tables 1 and 4: K_L s_L 17.07, 1.78; s_M 5.27, 6.48; s_G 1.62; K_Li s_G 1.11; K_oL
        # 16.36, 1.83; K_oLB 528.22, 6.88; K_oV 42.89, 1.79. Cells are in this order: the last one is judged.
        k_l, octree = measured("K_L", "s_L", 17.07, 1.80), measured("K_oL", None, 16.36, 1.65)
        s_m, s_g = measured("K_L", "s_M", 5.15, 6.48), measured("K_L", "s_G", 8.16, 1.66)
        k_li = measured("K_Li", "s_G", 8.18, 1.3)
        for table, rows, expected in (
                # To the printed digit.
                *((SIZE, [measured("K_L", "s_L", x, 1.8)], v) for x, v in (
                    (17.0749, EQUAL), (17.0651, EQUAL), (17.0755, UNEXPLAINED), (17.0645, UNEXPLAINED))),
                (SIZE, [failed_row("out of memory", structure="K_oL")], paper.FAILED),
                # Balance: while it is cheap and harmless.
                (SIZE, [octree, measured("K_oLB", None, 19.43, 0.52)], INFERRED),
                (SIZE, [octree, measured("K_oLB", None, 40, 0.52)], UNEXPLAINED),
                (DELTA_R, [octree, measured("K_oLB", None, 19.43, 1.7)], UNEXPLAINED),
                (SIZE, [measured("K_oLB", None, 19.43, 0.52)], UNEXPLAINED),
                # Ties: as far as cases equal but for rounding differ.
                (SIZE, [s_m], UNEXPLAINED),
                *((SIZE, [s_m, measured("K_L", "s_M", x, 6.48, tau=1 - by)], v) for x, by, v in (
                    (5.30, 1e-9, SHOWN), (5.01, 1e-9, INFERRED), (5.25, 1e-9, UNEXPLAINED),
                    (9, 1e-4, UNEXPLAINED))),
                *((DELTA_R, [s_g, measured("K_L", "s_G", 8.19, 1.6, s_n=1 + by)], v)
                  for by, v in ((2.3e-16, SHOWN), (1e-3, UNEXPLAINED))),
                (DELTA_R, [s_g, measured("K_L", "s_Gx", 8.4, 1.6)], SHOWN),
                # Shared vertices: a tree with more nodes than places, and a worse error.
                *((t, [measured("K_oV", None, x, delta, 147359)], v) for t, x, delta, v in (
                    (SIZE, 31.65, 0.18, INFERRED), (DELTA_R, 31.65, 0.18, INFERRED),
                    (DELTA_R, 31.65, 1.9, UNEXPLAINED), (DELTA_R, 42.8, 0.18, UNEXPLAINED))),
                # Links: where the run with right ones is as ours.
                *((t, [measured("K_oL", None, size, x)], v) for t, size, x, v in (
                    (DELTA_R, 16.36, 1.65, SHOWN), (DELTA_R, 16.36, 1.6, UNEXPLAINED),
                    (SIZE, 16.5, 1.65, UNEXPLAINED))),
                # Scatter: what near densities reach, and no size.
                *((DELTA_R, [k_l, measured("K_L", "s_L", 17, x, rho=0.99)], v)
                  for x, v in ((1.784, SHOWN), (1.79, UNEXPLAINED))),
                (DELTA_R, [k_l, measured("K_L", "s_L", 17, 1.62, rho=0.8)], UNEXPLAINED),
                (SIZE, [measured("K_L", "s_L", 17.2, 1.8), measured("K_L", "s_L", 17, 1.6, rho=0.99)],
                 UNEXPLAINED),
                # The published interpolation: what it reaches.
                *((DELTA_R, [k_li, measured("K_Li", "s_G", 8.18, x, interpolation="published")], v)
                  for x, v in ((1.1112, SHOWN), (1.2, UNEXPLAINED)))):
            with self.subTest(table=table.title, rows=[(r["structure"], r["cells"], r["delta_R_max"])
                                                       for r in rows]):
                self.assertEqual(verdict(table, *rows), expected)

    def test_a_box_longer_by_a_billionth_is_another_order_of_ties(self):
        for by, split, expected in ((1e-9, "s_G", SHOWN), (0.1, "s_G", UNEXPLAINED),
                                    (1e-9, "s_L", UNEXPLAINED)):  # s_L has no ties
            other = results_of([measured("K_L", split, 8.19, 1.6 if split == "s_G" else 1.9)],
                               domain=[-1 - by, 1 + by, -1, 1, -1, 1])
            evidence = Evidence(results_of([measured("K_L", split, 8.16, 1.66)]), other)
            self.assertEqual([j.verdict for j in paper.judge(evidence, DELTA_R)], [expected], (by, split))

    def test_the_summary_hides_no_cell_that_differs_or_failed(self):
        def change(row):
            if (row["structure"], row["split"], row["rho"], row["tau"]) == ("K_L", "s_L", 1, 1):
                row["delta_R_max"] = 1.9
        rows = [failed_row("no memory", structure="K_oLB", rho=r["rho"], tau=r["tau"])
                if r["structure"] == "K_oLB" and r["tau"] == 0.5 else r for r in paper_json_rows(change)]
        text = paper_page.summary(evidence_of(rows))
        self.assertRegex(text, r"1\.90 \| +1\.78 \| differs, unexplained \| no experiment")
        self.assertIn("no memory", text)


class Claims(unittest.TestCase):
    def judged(self, rows, sentence):
        return next(j for j in paper.judge_claims(evidence_of(rows)) if j.claim["sentence"] == sentence)

    def test_the_papers_own_numbers_bear_out_what_they_suggest(self):
        for sentence in ("Balancing ruins memory.", "Balancing ruins accuracy.", "The split s_M is poor.",
                         "The octree with values at vertices is bad.",
                         "Interpolation buys accuracy for time."):
            self.assertEqual(self.judged(paper_json_rows(), sentence)[1:7], (paper.STANDS, 6, 0, 6, 6, 6))

    def test_twice_as_much_is_the_threshold(self):
        for sentence, key, below, above, *names in (
                ("Balancing ruins memory.", "bytes_total", 19, 21, "K_oL", None, "K_oLB", None),
                ("The split s_M is poor.", "delta_R_max", 19, 21, "K_L", "s_L", "K_L", "s_M")):
            for value, expected in ((below, paper.DOES_NOT_STAND), (above, paper.STANDS)):
                rows = [json_row(*names[:2], **{key: 10}), json_row(*names[2:], **{key: value})]
                self.assertEqual(self.judged(rows, sentence).verdict, expected, (sentence, value))

    def test_times_decide_only_where_their_quartiles_lie_apart(self):
        def judged(*samples):
            rows = [json_row(structure, tau=tau, **times("t_access_ns_random", *s))
                    for tau, pair in zip((1, 0.5), samples)
                    for structure, s in zip(("K_oL", "K_oV"), pair)]
            return self.judged(rows, "The plain octree is the fastest to read.")[1:5]
        fast, slow, wide = [1, 2, 3], [7, 8, 9], [1, 2.2, 9]
        self.assertEqual(judged((fast, slow), (fast, wide)), (paper.STANDS, 1, 1, 2))
        self.assertEqual(judged((fast, slow), (slow, fast)), (paper.DOES_NOT_STAND, 1, 0, 2))
        self.assertEqual(judged((wide, wide), (fast, wide)), (paper.UNDECIDED, 0, 2, 2))

    def test_a_claim_stands_only_if_it_holds_at_every_setting(self):
        def cheap(row):
            if row["structure"] == "K_oLB" and row["tau"] == 0.2:
                row["bytes_total"] = 1_000_000
        mixed = self.judged(paper_json_rows(cheap), "Balancing ruins memory.")
        self.assertEqual(mixed[1:5], (paper.DOES_NOT_STAND, 4, 0, 6))
        self.assertTrue(mixed.numbers.startswith("ρ 1 τ 0.2: K_oLB 1 MB"), mixed.numbers)

    def test_s_m_at_other_depths_counts_with_the_deepest(self):
        sentence = "The split s_M is poor at any depth."
        rows = paper_json_rows()
        self.assertEqual(self.judged(rows, sentence).verdict, paper.NOT_MEASURED)
        rows += [{**row, "max_depth": depth, "delta_R_max": delta} for row in rows
                 if (row["structure"], row["split"]) == ("K_L", "s_M")
                 for depth, delta in ((200, 2.0), (100, 7.0))]
        self.assertEqual(self.judged(rows, sentence)[1:5], (paper.DOES_NOT_STAND, 0, 0, 6))

    def test_ours_beside_the_papers(self):
        def cell(rows, number, structure, split, column):
            table = paper_page.side_by_side(evidence_of(rows))[number]
            line = next(r for r in table.rows if r[:2] == [structure, split])
            return line[table.columns.index(column)]
        # Jurczyk & Głut, Tables 1, 2, 4; in brackets the rank in the column.
        rows = paper_json_rows()
        self.assertEqual(cell(rows, 0, "K_L", "s_G", "ρ 0.2 τ 0.2"), "341.10 / 341.1")
        self.assertEqual(cell(rows, 3, "K_oV", "", "ρ 1 τ 0.2"), "1.04 / 1.04")
        rows = [json_row("K_L", split, **times("t_creation_s", s)) for split, s in (("s_L", 5), ("s_G", 7))]
        self.assertEqual(cell(rows, 1, "K_L", "s_G", "ρ 1 τ 1"), "7 (2) / 2.39 (1)")
        self.assertEqual(cell([failed_row("x", structure="K_oL")], 3, "K_oL", "", "ρ 1 τ 1"), "failed / 1.83")


class Command(InFolder):
    def test_failed_cases_have_their_page_and_status_3(self):
        out = write_results(self.folder / "out", [failed_row("raise tau", structure="K_oL")])
        outcome = run("paper", out)
        self.assertEqual(outcome.returncode, 3)
        self.assertIn("raise tau", outcome.stdout)
        self.assertIn("| failed", (out / "paper.md").read_text())

    def test_what_cannot_be_used_is_refused_and_nothing_is_written(self):
        other = write_results(self.folder / "other", [json_row("K_oL", law="cone")])
        self.refused("paper", "no row was run as the paper's tables", other)
        self.assertEqual(run("paper", other, "--if-any").returncode, 0)
        self.refused("paper", "none/results.json: no such file", self.folder / "none")
        self.refused("paper", "leave out the folders", other, "--full")
        cells = write_results(self.folder / "cells", [json_row("K_oL")])
        self.refused("paper", "/none: no such file", cells, "--experiments", "--program", "/none")
        (cells / "results.json").write_text('{"program": "controlspace"')
        self.refused("paper", "cells/results.json", cells)
        (cells / "meshes.json").write_text("[]")
        self.refused("paper", "meshes.json", cells)
        self.assertFalse(list(self.folder.rglob("paper.md")))

    def test_experiments_are_runs_of_the_program(self):
        out = write_results(self.folder / "out", [json_row("K_oL")])
        fake = self.folder / "controlspace"
        fake.write_text(f"#!/bin/sh\necho \"$*\" >>{self.folder}/calls\nexit ${{STATUS:-0}}\n")
        fake.chmod(0o755)
        self.assertEqual(run("paper", out, "--experiments", "--program", fake,
                             env={"STATUS": "3"}).returncode, 0)
        self.assertEqual((self.folder / "calls").read_text().splitlines(), [
            f"compare {out}/{name}/study.toml --output {out}/{name}" for name, _ in EXPERIMENTS])
        self.assertEqual(run("paper", out, "--experiments", "--program", fake,
                             env={"STATUS": "130"}).returncode, 130)

    def test_table_5_of_meshes(self):
        data = json.loads((KEPT / "meshes/hxt/meshes.json").read_text())
        octree = next(row for row in data["rows"] if row["field"] == "K_oL")
        octree["error"] = "MMG failed"
        adapted = {**octree, "L_R": 0.9123, "case": {**octree["case"], "tau": 0.3}}
        (self.folder / "meshes.json").write_text(json.dumps({**data, "rows": [*data["rows"], adapted]}))
        outcome = run("paper", self.folder)
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        # Jurczyk & Głut, Table 5, first column: 0.67 and 0.68.
        row = next(row for row in data["rows"] if (row["field"], row["split"]) == ("K_L", "s_L"))
        self.assertIn(f"{row['L_R']:.4f} / 0.67", outcome.stdout)
        self.assertIn("failed / 0.68", outcome.stdout)
        self.assertNotIn("0.9123", outcome.stdout)
        self.assertEqual((self.folder / "paper.md").read_text(), outcome.stdout)


if __name__ == "__main__":
    unittest.main()

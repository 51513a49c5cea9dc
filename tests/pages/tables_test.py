# SPDX-License-Identifier: Apache-2.0
# bench/tables: kept tables are those that it makes; fronts, fastest rows, ranks and tables of meshes by hand.
import json
import shutil

from samples import KEPT, InFolder, failed_row, json_row, results_of, run, times, unittest, write_results

from pages.fronts import front_of, front_tables, fronts, fronts_json
from pages.measure_tables import verdicts
from pages.ranks import average_ranks, spearman


def row_at(structure, size, ns, largest, mean, **changes):
    return json_row(structure, bytes_total=size, delta_R_fine_max=largest, delta_R_fine_mean=mean,
                    **times("t_access_ns_random", ns), **changes)


class Fronts(unittest.TestCase):
    def marks(self, json_rows):
        return [[point["front"] for point in plot["points"]]
                for plot in json.loads(fronts_json(results_of(json_rows).rows))]

    def test_a_front_holds_what_nothing_else_is_at_most_as_large_as_in_both(self):
        rows = [row_at("a", 10, 9, 0.5, 0.1), row_at("b", 20, 1, 0.5, 0.2), row_at("c", 30, 5, 0.1, 0.3),
                row_at("d", 40, 7, 0.1, 0.3), row_at("a", 10, 9, 0.5, 0.1)]
        plots = json.loads(fronts_json(results_of(rows).rows))
        self.assertEqual([(plot["cost"], plot["error"]) for plot in plots],
                         [(cost, error) for cost in ("bytes_total", "t_access_ns_random")
                          for error in ("delta_R_fine_max", "delta_R_fine_mean")])
        self.assertEqual(self.marks(rows)[:3], [[True, False, True, False, True], [True, False, False, False, True],
                                                [False, True, True, False, False]])
        self.assertEqual(plots[3]["points"][1], {"label": "b", "cost": 1, "error": 0.2, "front": True})
        (_, table), = front_tables(results_of(rows).rows)
        self.assertEqual([(line[0], line[-1]) for line in table.rows],
                         [("c", "memory, access"), ("a", "memory"), ("b", "access"), ("a", "memory")])

    def test_a_row_that_a_limit_stopped_is_on_no_front_and_keeps_no_other_from_one(self):
        rows = [row_at("a", 10, 1, 0.1, 0.1), row_at("b", 20, 2, 0.2, 0.2)]
        self.assertEqual(self.marks(rows), [[True, False]] * 4)
        rows[0]["stopped"] = "stopped at 60 s, 9 leaves, δ 0.1 reached"
        self.assertEqual(self.marks(rows), [[False, True]] * 4)

    def test_rows_are_weighed_against_those_of_the_same_work(self):
        rows = [row_at("K_oL", 10, 9, 0.5, 0.1, **changes) for changes in (
            {}, {"tau": 0.5}, {"rho": 0.2}, {"reference": "exact"})]
        rows += [row_at("K_oL", 10, 9, None, 0.1), failed_row("raise tau", structure="K_oL")]
        found = fronts(results_of(rows).rows)
        self.assertEqual([[row.method for row in members] for members in found.values()], [["K_oL", "K_oL, tau 0.5"]])

    def test_only_what_is_faster_beyond_the_quartiles_drives_a_row_from_the_front_of_access(self):
        for samples, on_front in (([8], ["b"]), ([7, 8, 11], ["a", "b"])):
            rows = [row_at("a", 10, 9, 0.5, 0.1),
                    row_at("b", 20, 8, 0.1, 0.1) | times("t_access_ns_random", *samples)]
            front = front_of(results_of(rows).rows, "t_access_ns_random", "delta_R_fine_max")
            self.assertEqual([row.label for row in front], on_front)


class Verdicts(unittest.TestCase):
    def test_the_fastest_is_named_only_where_quartiles_do_not_overlap_in_one_batch(self):
        def timed(structure, *samples, batch=0):
            return json_row(structure, access_batch=batch, **times("t_access_ns_random", *samples))

        place = "Fastest access at random places: "
        slow, fast, middle = timed("slow", 50, 51, 52), timed("fast", 40, 41, 42), timed("middle", 40.5, 41.4, 60)
        for rows, words in (([slow, fast], "fast."),
                            ([slow, middle, fast], "indistinguishable between middle; fast."),
                            ([slow, timed("later", 1, 1, 1, batch=1)],
                             "no statement, since the rows were not timed in turns.")):
            self.assertIn(place + words, verdicts(results_of(rows).rows))
        for rows in ([fast], [fast, {**slow, "stopped": "stopped at 60 s"}], [fast, failed_row("x")]):
            self.assertNotIn("Fastest", verdicts(results_of(rows).rows))


class Ranks(unittest.TestCase):
    def test_ranks_begin_at_1_and_equal_values_share_theirs(self):
        for values, ranks in (([30, 10, 20], [3, 1, 2]), ([5, 6, 7, 8, 7], [1, 2, 3.5, 5, 3.5]),
                              ([2, 2, 2, 1], [3, 3, 3, 1]), ([], [])):
            self.assertEqual(average_ranks(values), ranks)

    def test_spearman_by_hand(self):
        # Without ties rho = 1 - 6 sum d^2 / (n (n^2 - 1)); here d = 0, -1, 1, -1, 1.
        self.assertAlmostEqual(spearman([1, 2, 3, 4, 5], [10, 30, 20, 50, 40]), 1 - 6 * 4 / (5 * 24))
        # Ranks 1 2 3 4 5 and 1 2 3.5 5 3.5: covariance 8, variances 10 and 9.5.
        self.assertAlmostEqual(spearman([1, 2, 3, 4, 5], [5, 6, 7, 8, 7]), 8 / 95 ** 0.5)
        # Ranks 1.5 1.5 3 4 and 1 2.5 2.5 4.
        self.assertAlmostEqual(spearman([1, 1, 2, 3], [1, 2, 2, 3]), 3.75 / 4.5)
        for a, b in (([], []), ([1, 2], [1, 2]), ([1, 2, 3], [4, 4, 4])):
            self.assertIsNone(spearman(a, b))

    def test_only_the_order_counts_and_either_list_may_come_first(self):
        a = [0.1, 0.5, 0.3, 0.9]
        self.assertAlmostEqual(spearman(a, [x ** 3 for x in a]), 1)
        self.assertAlmostEqual(spearman(a, [-x for x in a]), -1)
        self.assertAlmostEqual(spearman([1, 3, 2, 7], [4, 2, 9, 1]), spearman([4, 2, 9, 1], [1, 3, 2, 7]))


def mesh_row(label, l_r, delta=None, **changes):
    row = {"field": label, "split": "", "label": label, "setting": "tau 1", "mesher": "delaunay", "error": "",
           "histogram": [0, 0, 40, 0, 360], "tets": 350000, "nodes": 60000, "edges": 400, "creation_s": 0.1,
           "mesh_s": 20.0, "mesh_processor_s": 10.0, "peak_bytes": 162e6, "L_R": l_r, "L_R_beside_exact": l_r - 0.8025,
           "L_R_middle": l_r, "unit_share": 0.9, "mean_length": 1.01, "quality_min": 0.3, "quality_mean": 0.8,
           "queries": 9, "query_s": 0.5}
    if delta is not None:
        row |= {"delta_R_max": delta, "delta_R_mean": delta / 10}
    return row | changes


class Meshes(InFolder):
    def page_of(self, rows, **changes):
        (self.folder / "meshes.json").write_text(json.dumps(
            {"origin": "controlspace 0.1.0", "command_line": "controlspace mesh", "study": {"name": "named"},
             "length_bounds": [0.5, 0.8, 1.25, 2], "complete": True, "rows": rows} | changes))
        outcome = run("tables", self.folder)
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        return (self.folder / "summary.md").read_text()

    def rows(self):
        return [mesh_row("exact", 0.8025), mesh_row("K_oL", 0.7512, 1.9), mesh_row("K_oLB", 0.7634, 0.6),
                mesh_row("K_oV", 0.7957, 0.2)]

    def test_tables_show_the_exact_fields_mesh_and_how_l_r_goes_with_delta_r(self):
        page = self.page_of(self.rows())
        for text in ("# named\n", "## Meshes: delaunay, tau 1\n", "| 0.7512 | -0.0513 |", "| -0.0068 |",
                     "with the largest δ_R -1.00, with the mean one -1.00.", "| 5.00 % |", " 10.00 |", " 90.00 |",
                     "| 0.5–0.8 |", "| 0–0.5 |", "|    2– |"):
            self.assertIn(text, page)
        self.assertNotIn("Not complete", page)
        self.assertIn("Not complete: cases are missing.", self.page_of(self.rows(), complete=False))

    def test_meshers_have_tables_of_their_own_and_few_structures_no_correlation(self):
        rows = self.rows()
        rows[2]["mesher"] = "hxt"
        page = self.page_of(rows)
        for text in ("## Meshes: delaunay, tau 1", "## Meshes: hxt, tau 1"):
            self.assertIn(text, page)
        self.assertNotIn("Rank correlation", page)

    def test_of_an_earlier_program_the_exact_fields_mesh_is_found(self):
        rows = self.rows()
        rows[3]["setting"] = "tau 0.5"
        for row in rows:
            del row["label"], row["L_R_beside_exact"]
        self.assertIn("-0.0068", self.page_of(rows))
        rows[3]["mesher"] = "hxt"
        self.assertNotIn("-0.0068", self.page_of(rows))

    def test_a_mesh_that_failed_is_a_row_with_its_reason(self):
        failed = {"field": "K_oL", "split": "", "label": "K_oL", "setting": "tau 1", "mesher": "delaunay",
                  "error": "MMG | failed"}
        page = self.page_of([*self.rows(), failed])
        self.assertIn("failed: MMG \\| failed", page)

    def test_damaged_meshes_are_named(self):
        self.page_of(self.rows())
        for content in ("", "[]", "{\"rows\": [{}]}"):
            (self.folder / "meshes.json").write_text(content)
            self.refused("tables", "meshes.json: ", self.folder)


class Command(InFolder):
    def test_kept_tables_are_those_that_it_makes(self):
        checked = 0
        for name in ("results.json", "meshes.json"):
            for file in sorted(KEPT.rglob(name)):
                if not (file.parent / "summary.md").exists():
                    continue
                folder = self.folder / file.parent.relative_to(KEPT)
                folder.mkdir(parents=True, exist_ok=True)
                shutil.copy(file, folder)
                outcome = run("tables", folder)
                self.assertEqual(outcome.returncode, 0, outcome.stderr)
                for made in ("summary.md", "pareto.json"):
                    if (folder / made).exists():
                        self.assertTrue((folder / made).read_bytes() == (file.parent / made).read_bytes(),
                                        file.parent / made)
                        checked += 1
        self.assertGreater(checked, 40)

    def test_rows_that_failed_and_runs_that_were_interrupted(self):
        folder = write_results(self.folder / "out", [failed_row("no | memory", structure="direct")])
        results = json.loads((folder / "results.json").read_text())
        (folder / "results.json").write_text(json.dumps(results | {"complete": False}))
        self.assertEqual(run("tables", folder).returncode, 0)
        page = (folder / "summary.md").read_text()
        self.assertIn("Not complete: cases are missing.\n", page)
        self.assertIn("| failed: no \\| memory |", page)
        self.assertEqual(json.loads((folder / "pareto.json").read_text()), [])

    def test_what_cannot_be_read_is_refused(self):
        self.refused("tables", "none/results.json: no such file", self.folder / "none")


if __name__ == "__main__":
    unittest.main()

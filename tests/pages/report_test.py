# SPDX-License-Identifier: Apache-2.0
# report.html: the numbers of its figures and tables are those of rows; it is well-formed, needs no
# other file, and is written whole or not at all.
import base64
import os
import re
import unittest
from xml.etree import ElementTree

import numpy as np
from samples import (QUICK, InFolder, failed_row, json_row, outcome, paper_json_rows, results_of, run,
                     times, with_fields, write_results)

from pages import compare_runs, fields, figures
from pages import report_command as report
from pages.measure_tables import MEASURES, measure_tables
from pages.results import InputError, read_results
from pages.table import Table

HOSTILE = "</td><script>alert(1)</script> & \"quoted\" ]]> \x01"
CONE = {"law": "cone", "schedule": "queue", "reference": "exact"}


def three_rows():
    """Three structures, of which the second is beaten by the first."""
    return [json_row("K_oL", **CONE),
            json_row("K_oV", bytes_total=2_460_000, **times("t_access_ns_random", 100.25, 300, 200.5),
                     **CONE),
            json_row("direct", bytes_total=3_690_000, delta_R_fine_max=0, **CONE)]


def parsed(page):
    """The page as XML; raises where it is not well-formed."""
    return ElementTree.fromstring(page.replace("<!DOCTYPE html>\n", ""))


def lines_of(tree):
    return [["".join(cell.itertext()) for cell in line] for line in tree.iter("tr")]


class Results(InFolder):
    def test_what_is_missing_or_damaged_is_named(self):
        folder = write_results(self.folder, [json_row("K_oL")])
        whole = (folder / "results.json").read_text()
        for text, message in (
                ("", "results.json: "), (whole[:-9], "results.json: "), ("[]", "not written by"),
                (whole.replace('"schema_version": 2', '"schema_version": 1'), "version 1 is not 2: run the"),
                (whole.replace('"depth": 21', '"depth": "deep"'), "row 1: depth is no number"),
                (re.sub('"cells": [0-9]*, ', "", whole), "row 1: 'cells' is missing"),
                (whole.replace("[50.0, 51.0, 52.0]", "[]"), "row 1: t_access_ns_random_samples"),
                (re.sub('"cpu": "[^"]*", ', "", whole), "'cpu' is missing")):
            (folder / "results.json").write_text(text)
            with self.assertRaisesRegex(InputError, message):
                read_results(folder)

    def test_every_damaged_copy_is_read_or_refused(self):
        folder = write_results(self.folder, [json_row("K_oL")])
        whole = (folder / "results.json").read_bytes()
        for place in range(0, len(whole), 97):
            for damaged in (whole[:place], whole[:place] + b"\xff" + whole[place + 1:],
                            whole[:place] + b"7" + whole[place + 1:]):
                (folder / "results.json").write_bytes(damaged)
                try:
                    read_results(folder)
                except InputError as error:
                    self.assertIn("results.json", str(error))

    def test_damaged_outcomes_are_refused(self):
        rows = [json_row("K_oL"), failed_row("no memory", structure="K_V")]
        good = outcome(rows, [0], [], [0])
        for change in ({"smallest": [7]}, {"fastest": [1]}, {"sentences": []}, {"sentences": [1]},
                       {"factor": None}, {"work": 5}):
            write_results(self.folder, rows, outcomes=[{**good, **change}])
            with self.assertRaisesRegex(InputError, "outcomes: "):
                read_results(self.folder)

    def test_a_setting_that_a_program_does_not_know_yet_is_the_default(self):
        old, new, other = results_of([json_row("K_Li", interpolation=x)
                                      for x in (None, "corrected", "published")]).rows
        self.assertEqual(old.key, new.key)
        self.assertNotEqual(old.key, other.key)


class Figures(InFolder):
    def test_70_structures_look_different(self):
        styles = figures.Styles(results_of([json_row(f"K_{i}") for i in range(70)]).rows)
        splits = [None, "s_G", "s_Gx", "s_M"]
        looks = {tuple(styles(f"K_{i}", split).values()) for i in range(70) for split in splits}
        self.assertEqual(len(looks), 70 * len(splits))

    def test_every_axis_has_three_numbers_or_more(self):
        for low, high in ((0.15, 0.16), (1e-4, 10), (0.03, 0.22), (1, 4.1), (5e-7, 900), (1, 1.01)):
            ticks = figures.log_ticks(low, high).tick_values(None, None)
            self.assertGreaterEqual(sum(low <= x <= high * (1 + 1e-9) for x in ticks), 3, (low, high))


class Fields(InFolder):
    def sampled(self, **options):
        rows = with_fields(self.folder, [json_row("K_oL"), json_row("K_V", "s_L")], **options)
        return fields.sampled_fields(read_results(write_results(self.folder, rows)))

    def test_nonconformity_of_check_values(self):
        c, s = 3 ** 0.5 / 2, 0.5  # axes turned by 30 degrees about z and then about x
        turn = np.array([[1, 0, 0], [0, c, -s], [0, s, c]]) @ [[c, -s, 0], [s, c, 0], [0, 0, 1]]

        def metrics(lengths):
            m = turn @ np.diag(lengths) @ turn.T
            return np.array([*lengths, 0, 0, 0]), m[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
        for a, b, delta in (([0.1] * 3, [1] * 3, 14.0296115), ([0.2] * 3, [0.3] * 3, 0.288675135),
                            ([0.1, 0.4, 0.2], [0.5, 0.1, 0.3], 3.91538986)):
            for m, n in zip(metrics(a), metrics(b)):
                self.assertAlmostEqual(float(fields.nonconformity(m, n)), delta, places=6)
        self.assertEqual(float(fields.nonconformity(metrics([np.nan, 1, 1])[0], metrics([1] * 3)[0])), np.inf)
        self.assertEqual(fields.percentiles(np.arange(1, 151.0)), [143, 149, 150])  # nearest rank

    def test_tables_and_figures_of_sampled_fields(self):
        sampled = self.sampled()
        # 1.1 times the exact field: δ = √3 (1.1 + 1/1.1 - 2) everywhere.
        delta = 3 ** 0.5 * (1.1 + 1 / 1.1 - 2)
        table = fields.delta_table(sampled)
        self.assertEqual((table.rows[0][3], table.rows[1][3]), ("0.0000 (1.7800)", f"{delta:.4f} (1.7800)"))
        pairs = {row[0]: row[1:] for row in fields.pairs_table(sampled).rows}
        self.assertEqual(pairs["K_V s_L, K_oL"], [fields.short(delta)] * 2)
        # Without anisotropy, and with it: one more panel.
        turned = self.sampled(anisotropy=2)
        self.assertEqual([next(fields.slice_figures(s)).width for s in (sampled, turned)], [440, 660])

    def test_slices_are_across_z_or_a_flat_axis(self):
        for axis, domain in (("z", (-1, 1, -1, 1, -1, 1)), ("y", (-1, 1, 0, 0, 2, 5)),
                             ("x", (0, 0, -1, 1, 2, 5))):
            sampled = self.sampled(domain=domain)
            self.assertEqual(fields.slice_place(sampled).split()[0], axis)
            self.assertEqual(len(figures.draw(fields.slice_figures(sampled))), 3)

    def test_damaged_fields_are_named(self):
        self.sampled()
        results = read_results(self.folder)
        slice_ = self.folder / "fields" / "001-slice.npy"
        whole = slice_.read_bytes()
        for content in (b"", whole[:50], whole[:-8], b"no array at all"):
            slice_.write_bytes(content)
            with self.assertRaisesRegex(InputError, "001-slice.npy"):
                fields.sampled_fields(results)
        for shape, message in (((3, 3, 6), "different shapes"), ((3, 3), "001-slice.npy")):
            np.save(slice_, np.zeros(shape))
            with self.assertRaisesRegex(InputError, message):
                fields.sampled_fields(results)


class TwoRuns(unittest.TestCase):
    def test_rows_are_paired_by_case_and_number_of_sources_each_once(self):
        before = [json_row("K_oL"), json_row("K_oV"), json_row("K_oL", tau=0.5)]
        after = [before[2], before[0], before[0], {**before[1], "sources": 5}]
        a, b = results_of(before), results_of(after)
        self.assertEqual(compare_runs.row_pairs(a, b),
                         [(a.rows[0], b.rows[1]), (a.rows[2], b.rows[0])])
        self.assertFalse(compare_runs.row_pairs(a, results_of(before, h=0.02)))
        twice = results_of([before[0], before[0]])
        self.assertEqual(len(compare_runs.row_pairs(twice, results_of(before[:1]))), 1)
        failed = results_of([failed_row("x", structure="K_oL"), before[0]])
        self.assertEqual(compare_runs.row_pairs(a, failed), [(a.rows[0], failed.rows[1])])

    def test_a_ratios_band_comes_from_opposite_quartiles(self):
        slow, fast, near = (
            results_of([json_row("K_oL", **times("t_access_ns_random", *samples))]).rows[0]
            for samples in ([100, 110, 120, 130, 140], [50, 55, 60, 65, 70], [105, 115, 125]))
        ratio = compare_runs.ratio_of(compare_runs.MEASURES[0], (slow, fast))
        for value, expected in zip(ratio, (0.5, 55 / 130, 65 / 110)):
            self.assertAlmostEqual(value, expected)
        same = compare_runs.ratio_of(compare_runs.MEASURES[0], (slow, near))
        self.assertTrue(same.low <= 1 <= same.high)

    def test_times_of_lengths_and_of_metrics_are_not_compared(self):
        of_metrics = json_row("K_oL")
        of_lengths = {**of_metrics, "answers": "lengths", **times("t_access_ns_metric_random", 80.0, 81.0)}
        access, *_, memory = compare_runs.MEASURES[:4]
        for pair, is_compared in (((of_metrics, of_lengths), False), ((of_lengths, of_metrics), False),
                                  ((of_metrics, of_metrics), True), ((of_lengths, of_lengths), True)):
            rows = results_of(pair).rows
            self.assertEqual(compare_runs.ratio_of(access, rows) is not None, is_compared)
            self.assertIsNotNone(compare_runs.ratio_of(memory, rows))

    def test_the_papers_access_time_is_that_of_metrics(self):
        of_metrics, of_lengths = results_of([
            json_row("K_oL"),
            {**json_row("K_oL"), "answers": "lengths", **times("t_access_ns_metric_random", 80.0, 81.0, 82.0)}]).rows
        self.assertAlmostEqual(of_metrics["access_us"], 0.051)
        self.assertAlmostEqual(of_lengths["access_us"], 0.081)
        self.assertAlmostEqual(of_lengths.spread("access_us")[1], 0.0815)
        self.assertEqual(of_lengths["t_access_ns_random"], 51)

    def test_what_changed_is_counted_and_stands_in_the_tables(self):
        before = [json_row("K_oL"), json_row("K_oV"), json_row("K_oL", tau=0.5)]
        after = [json_row("K_oL", **times("t_access_ns_random", 26, 25, 25.5), bytes_total=2_460_000,
                          delta_R_fine_mean=0.18), before[2],
                 json_row("K_oV", delta_R_fine_max=0, **times("t_access_ns_random", 49, 50.5, 52))]
        pairs = compare_runs.row_pairs(results_of(before), results_of(after))
        counts = {row[0]: row[1:] for row in compare_runs.counts_table(pairs).rows}
        # Faster by the median is not faster where the quartiles overlap.
        self.assertEqual(counts["access, random"], ["1 faster", "2", "0 slower", "0"])
        self.assertEqual(counts["creation"], ["0 faster", "3", "0 slower", "0"])
        self.assertEqual(counts["memory"][2:], ["1 larger", "0"])
        self.assertEqual(counts["largest δ_R, fine"], ["0 more accurate", "2", "0 less accurate", "1"])
        self.assertRegex(compare_runs.change_tables(pairs)[0].rows[0][1], r"^0\.500 .* \*$")

    def test_studies_that_measure_otherwise_are_told_apart(self):
        differing = compare_runs.differing_settings
        self.assertEqual(differing(results_of([]), results_of([], name="another", output="else")), "")
        self.assertEqual(differing(results_of([]), results_of([], fine_probe_grid=20)),
                         "fine_probe_grid 101, then 20")


class Page(InFolder):
    def page_of(self, rows, **options):
        write_results(self.folder, rows, **options)
        done = run("report", self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return (self.folder / "report.html").read_text()

    def test_kept_results_give_a_page_that_needs_nothing_else(self):
        page = self.page_of(QUICK["rows"], outcomes=QUICK["outcomes"])
        self.assertNotIn("http", page)
        tree = parsed(page)
        for image in tree.iter("img"):
            self.assertTrue(image.get("src").startswith("data:image/"))
        ids = {e.get("id") for e in tree.iter()} - {None}
        links = {a.get("href").removeprefix("#") for a in tree.iter("a")}
        self.assertLessEqual(links, ids)
        self.assertLessEqual({heading.get("id") for heading in tree.iter("h2")}, links)
        self.assertLessEqual({"pareto-01", "pareto-08", "paper-01", "access-01", "access-06"}, ids)
        # Outcomes in the program's words stand first, and the paper's headline is that of bench/paper.
        first = next(tree.iter("section"))
        self.assertEqual([e.text for e in first.iter("li")],
                         [text for found in QUICK["outcomes"] for text in found["sentences"]])
        text = " ".join(tree.itertext())
        self.assertTrue(run("paper", self.folder).stdout.split("\n")[0] in text)
        self.assertTrue("Fields are not shown" in text)
        # Each row stands in the tables with its numbers.
        lines = lines_of(tree)
        for row in QUICK["rows"]:
            self.assertTrue(any(line[0] == row["labels"]["structure"] and line[2:3] + line[7:8] == [
                f"{row['bytes_total'] / 1e6:.2f}", f"{row['delta_R_max']:.4f}"] for line in lines), row["labels"])

    def test_fields_are_shown_and_figures_are_files_too(self):
        rows = with_fields(self.folder, three_rows())
        page = self.page_of(rows, outcomes=[outcome(rows, [1], [0, 1], [2])])
        ids = {figure.get("id") for figure in parsed(page).iter("figure")}
        self.assertLessEqual({"slice-01", "slice-04", "delta-01", "cross-validation-02"}, ids)
        lines = lines_of(next(parsed(page).iter("section")))
        for line in (["smallest", "K_oV", "2.46", "200.5"], ["fastest", "K_oL", "1.23", "51.0"],
                     ["most accurate", "direct", "3.69", "51.0"]):
            self.assertIn(line, [found[:4] for found in lines])
        new = self.folder / "new"
        self.assertEqual(run("report", self.folder, "--output", new, "--figures", new).returncode, 0)
        self.assertEqual((new / "report.html").read_text(), page)
        self.assertEqual({p.stem for p in new.iterdir()}, ids | {"report"})

    def test_failed_rows_and_measures_of_the_programs_own(self):
        own = json_row("K_V", "s_L") | {"node_share": 0.25}
        table, = measure_tables(results_of(
            [json_row("K_oL"), own, failed_row("no memory", structure="direct")]).rows).values()
        self.assertEqual([(line[-1], line[table.columns.index("node_share")]) for line in table.rows],
                         [("", "–"), ("", "0.25"), ("failed: no memory", "–")])
        self.assertTrue("no memory" in self.page_of([failed_row("no memory", structure="direct")]))
        self.page_of([])

    def test_nothing_is_shown_as_python_writes_it_and_no_table_is_empty(self):
        for rows, sources in ((QUICK["rows"], ["a.csv", "ball:0,0,0,r=1,h=0.1"]), ([], []),
                              ([failed_row("no memory", structure="direct")], ["a.csv"])):
            tree = parsed(self.page_of(rows, sources=sources))
            text = " ".join(tree.find("body").itertext())
            self.assertIn(f"({', '.join(sources) or 'not set'})", text)
            self.assertNotIn("['", text)
            self.assertEqual(re.findall(r"\bdelta_R\b", text), [])
            for table in tree.iter("tbody"):
                self.assertGreater(len(table), 0)
            for fold in tree.iter("details"):
                self.assertGreater(len(fold), 1)

    def test_texts_of_results_stand_in_the_page_as_texts(self):
        figure = figures.Figure(HOSTILE, HOSTILE, HOSTILE, 10, 10, "svg", b"foobar")
        table = Table(HOSTILE, HOSTILE, [f"<{HOSTILE}", "n"], [[HOSTILE, "1"]])
        page = report.page(HOSTILE, [report.Section(HOSTILE, [
            ("heading", HOSTILE), ("paragraph", HOSTILE), ("figures", [figure]),
            ("table", table), ("sentences", [HOSTILE]), ("beside", [("paragraph", HOSTILE)]),
            ("fold", report.Fold(HOSTILE, [("paragraph", HOSTILE)], True))])])
        parsed(page)
        self.assertNotIn("<script>alert", page)
        self.assertNotIn("\x01", page)
        self.assertIn("&lt;script&gt;alert(1)", page)

    def test_every_name_on_the_page_has_its_entry_in_the_glossary(self):
        own = json_row("K_V", "s_L", voxel=0.5, remark="without effect: target_delta (within)")
        own["node_share"] = 0.25
        rows = with_fields(self.folder, [*three_rows(), own], anisotropy=2) + paper_json_rows()
        rows.append(json_row("K_oLi"))  # descriptions of settings name it
        tree = parsed(self.page_of(rows, outcomes=[outcome(rows, [1], [0, 1], [2])]))
        explained = {name for term in tree.iter("dt") for name in term.text.split(", ")}
        used = {row["structure"] for row in rows} | {"node_share"}
        # Measures of the tables: their heads, but for words of plain English.
        for kind in ("measures", "front", "outcome", "delta"):
            used |= {c for c in figures.TEXTS["tables"][kind]["columns"] if not c.startswith("<")}
        used |= {measure["column"] for measure in MEASURES}
        # Symbols anywhere, in figures too: words joined by "_", and Greek letters.
        svgs = (base64.b64decode(image.get("src").split(",")[1]).decode() for image in
                tree.iter("img") if image.get("src").startswith("data:image/svg"))
        for text in [" ".join(tree.find("body").itertext()),
                     *(" ".join(re.findall(r"<text[^>]*>([^<]*)", svg)) for svg in svgs)]:
            used |= set(re.findall(r"(?<![\w/.-])[A-Za-zδρτε]+_[A-Za-z]\w*|[δρτε](?!\w)", text))
        self.assertGreater(len(used), 40)
        self.assertEqual(used - explained - {"sort_by", "maximum", *QUICK["settings"]}, set())

    def test_two_runs(self):
        for name in ("before", "after"):
            write_results(self.folder / name, three_rows()[:2])
        outcome = run("report", self.folder / "before", self.folder / "after", "--output", self.folder)
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        tree = parsed((self.folder / "report.html").read_text())
        self.assertIn(["memory", "0 smaller", "2", "0 larger", "0"], lines_of(tree))
        self.assertLessEqual({"2-change-01", "1-access-01", "2-access-01"},
                             {figure.get("id") for figure in tree.iter("figure")})

    def test_what_cannot_be_written_is_refused_and_leaves_nothing_behind(self):
        out = write_results(self.folder / "out", [json_row("K_oL")])
        before = sorted(self.folder.rglob("*"))
        self.refused("report", "none/results.json: no such file", self.folder / "none")
        self.refused("report", "choose another folder", out, "--output", out / "results.json" / "x")
        os.symlink("/dev/full", out / "report.html")
        self.refused("report", "report.html", out)
        os.unlink(out / "report.html")
        (out / "results.json").write_text("{}")
        self.refused("report", "out/results.json: not written by controlspace", out)
        self.assertEqual(sorted(self.folder.rglob("*")), before)


if __name__ == "__main__":
    unittest.main()

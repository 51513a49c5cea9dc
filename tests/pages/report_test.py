# report.html: the numbers of its figures and tables are those of rows; it is well-formed, needs no
# other file, and is written whole or not at all.
import base64
import os
import re
import shutil
import tempfile
import unittest
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from matplotlib import colormaps
from samples import (ROOT, failed_row, json_row, outcome, paper_json_rows, results_of, run, times,
                     with_fields, write_results)

from pages import compare_runs, fields, figures
from pages import report_command as report
from pages.results import InputError, grouped, read_results
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


class WithFolder(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)


class Results(WithFolder):
    def test_what_is_missing_or_damaged_is_named(self):
        folder = write_results(self.folder, [json_row("K_oL")])
        whole = (folder / "results.json").read_text()
        self.assertEqual(len(read_results(folder).rows), 1)
        for text, message in (
                ("", "results.json: "), (whole[:-9], "results.json: "), ("[]", "not written by"),
                (whole.replace('"schema_version": 2', '"schema_version": 9'), "version 9"),
                (whole.replace('"depth": 9', '"depth": "deep"'), "row 1: depth is no number"),
                (whole.replace('"cells": 103, ', ""), "row 1: 'cells' is missing"),
                (whole.replace("[50.0, 51.0, 52.0]", "[]"), "row 1: t_access_ns_random_samples"),
                (whole.replace('"cpu": "a processor", ', ""), "'cpu' is missing")):
            (folder / "results.json").write_text(text)
            with self.assertRaisesRegex(InputError, message):
                read_results(folder)
        with self.assertRaisesRegex(InputError, "none/results.json: no such file"):
            read_results(folder / "none")

    def test_every_damaged_copy_is_read_or_refused(self):
        folder = write_results(self.folder, [json_row("K_oL")])
        whole = (folder / "results.json").read_bytes()
        for place in range(0, len(whole), 37):
            for damaged in (whole[:place], whole[:place] + b"\xff" + whole[place + 1:],
                            whole[:place] + b"7" + whole[place + 1:]):
                (folder / "results.json").write_bytes(damaged)
                try:
                    read_results(folder)
                except InputError as error:
                    self.assertIn("results.json", str(error))

    def test_schema_1_is_not_read(self):
        write_results(self.folder, [json_row("K_oL")])
        text = (self.folder / "results.json").read_text()
        (self.folder / "results.json").write_text(text.replace('version": 2', 'version": 1'))
        with self.assertRaisesRegex(InputError, "version 1 is not 2: run the study again"):
            read_results(self.folder)

    def test_kept_results_are_read(self):
        for kept in ("fields", "adaptation"):
            self.assertTrue(read_results(ROOT / "bench/results" / kept).measured)

    def test_a_setting_that_a_program_does_not_know_yet_is_the_default(self):
        old, new, other = results_of([json_row("K_Li"), json_row("K_Li", interpolation="corrected"),
                                      json_row("K_Li", interpolation="published")]).rows
        self.assertEqual(old.key, new.key)
        self.assertNotEqual(old.key, other.key)


class Figures(unittest.TestCase):
    def test_a_front_holds_the_rows_that_no_other_beats(self):
        rows = results_of(three_rows()).rows
        front = figures.front_of(rows, "memory_MB", "delta_R_fine_max")
        self.assertEqual([r.setting["structure"] for r in front], ["K_oL", "direct"])
        found = figures.draw(figures.pareto_figures(rows, figures.Styles(rows)), "p-")
        self.assertEqual([f.name for f in found], [f"p-pareto-0{i}" for i in (1, 2, 3, 4)])
        self.assertIn("K_oV", found[0].bytes.decode())
        (work, table), = report.front_tables(rows)
        self.assertEqual(work, rows[0].work)
        self.assertEqual([(r[0], r[4]) for r in table.rows],
                         [("direct", "memory, access"), ("K_oL", "memory")])

    def test_a_time_within_the_quartiles_of_another_is_on_its_front(self):
        fast, other, slow = results_of([json_row(**times("t_access_ns_random", *samples)) for samples in
                                        ([48, 50, 54], [50, 52, 54], [60, 62, 64])]).rows
        front = figures.front_of([fast, other, slow], "t_access_ns_random", "delta_R_fine_max")
        self.assertEqual(front, [fast, other])

    def test_access_times_of_a_group_are_a_figure_for_each_order(self):
        found = list(figures.access_figures(results_of(three_rows()).rows))
        self.assertEqual(len(found), 3)
        older = [row for row in results_of(three_rows()).rows]
        for row in older:
            del row.measures["t_access_ns_single_samples"]
        self.assertEqual(len(list(figures.access_figures(older))), 2)
        self.assertEqual(grouped([1, 2, 3], lambda x: x % 2), {1: [1, 3], 0: [2]})

    def test_creation_times_are_drawn_where_the_number_of_sources_varies(self):
        rows = results_of(three_rows()).rows
        styles = figures.Styles(rows)
        self.assertFalse(list(figures.creation_figures(rows, styles)))
        rows += results_of([json_row("K_oL", rho=0.5, sources=100000, **CONE)]).rows
        self.assertEqual(len(list(figures.creation_figures(rows, styles))), 1)

    def test_no_rows_give_no_figures(self):
        styles = figures.Styles([])
        self.assertFalse(list(figures.pareto_figures([], styles)))
        self.assertFalse(list(figures.access_figures([])))
        self.assertFalse(list(figures.creation_figures([], styles)))

    def test_70_structures_look_different(self):
        rows = results_of([json_row(f"K_{i}") for i in range(70)]).rows
        styles = figures.Styles(rows)
        splits = [None, "s_G", "s_Gx", "s_M"]
        looks = {tuple(styles(f"K_{i}", split).values()) for i in range(70) for split in splits}
        self.assertEqual(len(looks), 70 * len(splits))

    def test_every_axis_has_three_numbers_or_more(self):
        for low, high in ((0.15, 0.16), (1e-4, 10), (0.03, 0.22), (1, 4.1), (5e-7, 900), (1, 1.01)):
            ticks = figures.log_ticks(low, high).tick_values(None, None)
            self.assertGreaterEqual(sum(low <= x <= high * (1 + 1e-9) for x in ticks), 3, (low, high))

    def test_the_larger_an_error_the_brighter(self):
        colours = colormaps[fields.DELTA_COLOURS](np.linspace(0, 1, 9))[:, :3]
        brightness = colours @ [0.2126, 0.7152, 0.0722]
        self.assertTrue((np.diff(brightness) > 0).all(), brightness)


class Fields(WithFolder):
    def sampled(self, **options):
        rows = with_fields(self.folder, [json_row("K_oL"), json_row("K_V", "s_L")], **options)
        write_results(self.folder, rows)
        return fields.sampled_fields(read_results(self.folder))

    def test_nonconformity_of_check_values(self):
        def metric(xx, yy, zz, *off):
            return np.array([xx, yy, zz, *(off or (0, 0, 0))])
        for a, b, delta in ((metric(*[0.1] * 3), metric(1, 1, 1), 14.0296115),
                            (metric(*[0.2] * 3), metric(*[0.3] * 3), 0.288675135),
                            (metric(0.1, 0.4, 0.2), metric(0.5, 0.1, 0.3), 3.91538986)):
            self.assertAlmostEqual(float(fields.nonconformity(a, b)), delta, places=6)
            # The same by the general formula.
            turned = [self.turned(m) for m in (a, b)]
            self.assertAlmostEqual(float(fields.nonconformity(*turned)), delta, places=6)
        self.assertEqual(float(fields.nonconformity(metric(np.nan, 1, 1), metric(1, 1, 1))), np.inf)

    @staticmethod
    def turned(metric):
        """In axes turned by 30 degrees about z and then about x."""
        c, s = 3 ** 0.5 / 2, 0.5
        turn = np.array([[1, 0, 0], [0, c, -s], [0, s, c]]) @ [[c, -s, 0], [s, c, 0], [0, 0, 1]]
        m = turn @ metric[fields.COMPONENTS] @ turn.T
        return m[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]

    def test_percentiles_are_by_nearest_rank(self):
        self.assertEqual(fields.percentiles(np.arange(1, 201.0)), [190, 198, 200])
        self.assertEqual(fields.percentiles(np.array([3.0])), [3, 3, 3])

    def test_tables_and_figures_of_sampled_fields(self):
        sampled = self.sampled()
        # 1.1 times the exact field: δ = √3 (1.1 + 1/1.1 - 2) everywhere.
        delta = 3 ** 0.5 * (1.1 + 1 / 1.1 - 2)
        table = fields.delta_table(sampled)
        self.assertEqual(table.rows[0], ["K_oL", "0.0000 (0.3000)", "0.0000 (0.4000)",
                                         "0.0000 (1.7800)"])
        self.assertEqual(table.rows[1][3], f"{delta:.4f} (1.7800)")
        self.assertEqual(len(figures.draw(fields.cross_validation(sampled))), 2)
        pairs = {row[0]: row[1:] for row in fields.pairs_table(sampled).rows}
        self.assertEqual(pairs["K_V s_L, K_oL"], [fields.short(delta)] * 2)
        shares, = figures.draw(fields.delta_figure(sampled))
        self.assertIn("95th percentile", shares.bytes.decode())
        slices = figures.draw(fields.slice_figures(sampled))
        self.assertEqual([(f.kind, f.title) for f in slices], [
            ("png", "exact field"), ("png", "K_oL"), ("png", "K_V s_L (too many cells)")])
        self.assertTrue(slices[0].bytes.startswith(b"\x89PNG"))
        self.assertEqual(len({f.caption for f in slices}), 1)

    def test_anisotropy_is_shown_where_there_is_any(self):
        for anisotropy in (1, 2):
            spec = list(fields.slice_figures(self.sampled(anisotropy=anisotropy)))[1]
            figure = figures.plt.figure()
            spec.plot(figure)
            labels = " ".join(ax.get_xlabel() for ax in figure.axes)
            figures.plt.close(figure)
            self.assertEqual("anisotropy" in labels, anisotropy > 1)
            self.assertIn("error δ", labels)

    def test_slices_are_across_z_or_a_flat_axis(self):
        for axis, domain in (("z", (-1, 1, -1, 1, -1, 1)), ("z", (-1, 1, -1, 1, 0, 0)),
                             ("y", (-1, 1, 0, 0, 2, 5)), ("x", (0, 0, -1, 1, 2, 5))):
            sampled = self.sampled(domain=domain)
            spec = next(fields.slice_figures(sampled))
            self.assertEqual(fields.slice_place(sampled).split()[0], axis)
            figure = figures.plt.figure()
            spec.plot(figure)
            figures.plt.close(figure)

    def test_damaged_fields_are_named(self):
        self.sampled()
        results = read_results(self.folder)
        slice_ = self.folder / "fields" / "001-slice.npy"
        whole = slice_.read_bytes()
        for content in (b"", whole[:50], whole[:-8], b"no array at all"):
            slice_.write_bytes(content)
            with self.assertRaisesRegex(InputError, "001-slice.npy"):
                fields.sampled_fields(results)
        np.save(slice_, np.zeros((3, 3, 6)))
        with self.assertRaisesRegex(InputError, "different shapes"):
            fields.sampled_fields(results)
        np.save(slice_, np.zeros((3, 3)))
        with self.assertRaisesRegex(InputError, "001-slice.npy"):
            fields.sampled_fields(results)


class TwoRuns(unittest.TestCase):
    def test_rows_are_paired_by_case_and_number_of_sources_each_once(self):
        before = [json_row("K_oL"), json_row("K_oV"), json_row("K_oL", tau=0.5)]
        after = [before[2], before[0], before[0], {**before[1], "sources": 5}]
        a, b = results_of(before), results_of(after)
        self.assertEqual(compare_runs.row_pairs(a, b),
                         [(a.rows[0], b.rows[1]), (a.rows[2], b.rows[0])])
        self.assertFalse(compare_runs.row_pairs(a, results_of([])))
        self.assertFalse(compare_runs.row_pairs(a, results_of(before, h=0.02)))
        failed = results_of([failed_row("x", structure="K_oL"), before[0]])
        self.assertEqual(compare_runs.row_pairs(a, failed), [(a.rows[0], failed.rows[1])])

    def test_a_run_compared_with_itself_has_not_changed(self):
        rows = results_of(three_rows())
        pairs = compare_runs.row_pairs(rows, rows)
        for row in compare_runs.counts_table(pairs).rows:
            self.assertEqual((row[1][0], row[2], row[3][0], row[4]), ("0", "3", "0", "0"))

    def test_a_ratios_band_comes_from_opposite_quartiles(self):
        slow, fast, near = (
            results_of([json_row("K_oL", **times("t_access_ns_random", *samples))]).rows[0]
            for samples in ([100, 110, 120, 130, 140], [50, 55, 60, 65, 70], [105, 115, 125]))
        ratio = compare_runs.ratio_of(compare_runs.MEASURES[0], (slow, fast))
        self.assertAlmostEqual(ratio.value, 0.5)
        self.assertAlmostEqual(ratio.low, 55 / 130)
        self.assertAlmostEqual(ratio.high, 65 / 110)
        back = compare_runs.ratio_of(compare_runs.MEASURES[0], (fast, slow))
        self.assertAlmostEqual(back.low, 1 / ratio.high)
        same = compare_runs.ratio_of(compare_runs.MEASURES[0], (slow, near))
        self.assertTrue(same.low <= 1 <= same.high)

    def test_studies_that_measure_otherwise_are_told_apart(self):
        before = results_of([])
        self.assertEqual(compare_runs.differing_settings(before, results_of(
            [], name="another", output="elsewhere")), "")
        after = results_of([], fine_probe_grid=20, domain=[0, 1, 0, 1, 0, 1])
        self.assertEqual(compare_runs.differing_settings(before, after),
                         "domain not set, then 0, 1, 0, 1, 0, 1; fine_probe_grid 101, then 20")

    def test_what_changed_is_counted_and_stands_in_the_tables(self):
        after = [json_row("K_oL", **times("t_access_ns_random", 26, 25, 25.5), bytes_total=2_460_000,
                          delta_R_fine_mean=0.18), json_row("K_oV", delta_R_fine_max=0),
                 json_row("K_oL", tau=0.5)]
        before = [json_row("K_oL"), json_row("K_oV"), json_row("K_oL", tau=0.5)]
        pairs = compare_runs.row_pairs(results_of(before), results_of(after))
        counts = compare_runs.counts_table(pairs).rows
        self.assertEqual(counts[0], ["access, random", "1 faster", "2", "0 slower", "0"])
        self.assertEqual(counts[3][3], "1 larger")
        self.assertEqual(counts[4][4], "1")
        self.assertEqual(counts[5][3], "1 less accurate")
        tables = compare_runs.change_tables(pairs)
        self.assertEqual(len(tables), 2)
        self.assertRegex(tables[0].rows[0][1], r"^0\.500 .* \*$")
        self.assertEqual(tables[0].rows[0][4], "2.000")
        self.assertEqual(tables[0].rows[1][5], "–")
        self.assertEqual(len(list(compare_runs.change_figures(pairs))), 2)


class Page(unittest.TestCase):
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
        self.assertIn("base64,Zm9vYmFy\"", page)
        self.assertNotIn("http", page)

    def test_a_table_has_every_cell_and_heads_to_sort_by(self):
        page = report.page("t", [report.Section("s", [
            ("table", Table("t", "", ["<a", "b"], [["x", "1"], ["y", "2"]]))])])
        self.assertIn('<td class="left">x</td><td>1</td>', page)
        self.assertIn('onclick="sort_by(this)"', page)

    def test_measures_of_every_row(self):
        tables = list(report.measure_tables(results_of(
            [json_row("K_oL"), json_row("K_oL", **CONE),
             failed_row("no memory", structure="direct")]).rows).values())
        self.assertEqual(len(tables), 2)
        self.assertEqual(tables[0].rows[0], [
            "K_oL", "103", "1.23", "1.750", "51.0", "11.0", "71.0", "1.7800", "0.1000", "0.4000",
            "2.7800", "7.00 %", "1.400x", "1.2499", ""])
        self.assertEqual(tables[0].rows[1][-1], "failed: no memory")
        # A measure of somebody's own.
        row = json_row("K_oL")
        row["node_share"] = 0.25
        table, = report.measure_tables(results_of([row, json_row("K_V", "s_L")]).rows).values()
        self.assertEqual((table.columns[-2], table.rows[0][-2], table.rows[1][-2]),
                         ("node_share", "0.25", "–"))


class FrontPage(WithFolder):
    def page_of(self, rows, **options):
        write_results(self.folder, rows, **options)
        self.assertEqual(run("report", self.folder).returncode, 0)
        return (self.folder / "report.html").read_text()

    def test_outcomes_stand_first_in_the_programs_words(self):
        rows = three_rows()
        page = self.page_of(rows, outcomes=[outcome(rows, [1], [0, 1], [2])])
        tree = parsed(page)
        first = next(tree.iter("section"))
        self.assertEqual([e.text for e in first.iter("li")], outcome(rows, [], [], [])["sentences"])
        lines = [["".join(cell.itertext()) for cell in line.iter("td")]
                 for line in next(first.iter("tbody")).iter("tr")]
        self.assertEqual(lines, [["smallest", "K_oV", "2.46", "200.5", "1.400x"],
                                 ["fastest", "K_oL", "1.23", "51.0", "1.400x"],
                                 ["fastest", "K_oV", "2.46", "200.5", "1.400x"],
                                 ["most accurate", "direct", "3.69", "51.0", "1.400x"]])

    def test_results_without_outcomes_say_so(self):
        self.assertIn("Which structure to take is not in these results",
                      self.page_of(three_rows(), described=False))

    def test_damaged_outcomes_and_descriptions_are_refused(self):
        rows = [json_row("K_oL"), failed_row("no memory", structure="K_V")]
        good = outcome(rows, [0], [], [0])
        for change in ({"smallest": [7]}, {"fastest": [1]}, {"sentences": []}, {"sentences": [1]},
                       {"factor": None}, {"work": 5}):
            write_results(self.folder, rows, outcomes=[{**good, **change}])
            with self.assertRaisesRegex(InputError, "outcomes: "):
                read_results(self.folder)
        write_results(self.folder, rows, outcomes=[good])
        self.assertEqual(len(read_results(self.folder).outcomes), 1)

    def test_the_table_of_contents_leads_to_every_section(self):
        rows = with_fields(self.folder, three_rows())
        tree = parsed(self.page_of(rows, outcomes=[outcome(rows, [1], [0], [2])]))
        ids = {e.get("id") for e in tree.iter()} - {None}
        links = [a.get("href") for a in tree.iter("a")]
        self.assertLessEqual({link.removeprefix("#") for link in links}, ids)
        contents = next(tree.iter("nav"))
        linked = {a.get("href").removeprefix("#") for a in contents.iter("a")}
        for heading in tree.iter("h2"):
            self.assertIn(heading.get("id"), linked)
        titles = " ".join(h.text for h in tree.iter("h2"))
        for title in ("Outcome", "Fronts", "Accuracy", "Times", "Slices", "All measures", "Glossary"):
            self.assertIn(title, titles)

    def test_a_caption_stands_once_for_its_figures(self):
        page = self.page_of(with_fields(self.folder, three_rows()))
        text = " ".join(parsed(page).itertext())
        for kind in ("slice", "access", "cross-validation", "delta"):
            caption = figures.TEXTS["figures"][kind]["caption"].split("{")[0][:60]
            self.assertEqual(text.count(caption), 1, kind)

    def test_every_name_on_the_page_has_its_entry_in_the_glossary(self):
        own = json_row("K_V", "s_L", voxel=0.5, remark="without effect: target_delta (within)")
        own["node_share"] = 0.25
        rows = with_fields(self.folder, [*three_rows(), own], anisotropy=2) + paper_json_rows()
        page = self.page_of(rows, outcomes=[outcome(rows, [1], [0, 1], [2])])
        tree = parsed(page)
        explained = {name for term in tree.iter("dt") for name in term.text.split(", ")}
        heads = {"".join(head.itertext()) for head in tree.iter("th")}
        used = {row["structure"] for row in rows}
        # Measures of the tables: their heads, but for words of plain English.
        for kind in ("measures", "front", "outcome", "delta"):
            used |= {c for c in figures.TEXTS["tables"][kind]["columns"] if not c.startswith("<")}
        self.assertIn("node_share", heads)
        # Symbols anywhere, in figures too: words joined by "_", and Greek letters.
        svgs = (base64.b64decode(image.get("src").split(",")[1]).decode() for image in
                tree.iter("img") if image.get("src").startswith("data:image/svg"))
        for text in [" ".join(tree.find("body").itertext()),
                     *(" ".join(re.findall(r"<text[^>]*>([^<]*)", svg)) for svg in svgs)]:
            used |= set(re.findall(r"(?<![\w/.-])[A-Za-zδρτε]+_[A-Za-z]\w*|[δρτε](?!\w)", text))
        self.assertGreater(len(used), 40)
        script = {"sort_by"}
        self.assertEqual(used - explained - script - {"maximum"}, set())


class Command(WithFolder):
    def test_one_page_that_needs_nothing_else(self):
        out = self.folder / "out"
        rows = with_fields(out, [json_row("K_L", "s_M"), json_row("K_oL")])
        write_results(out, rows)
        outcome = run("report", out)
        self.assertEqual((outcome.returncode, outcome.stdout), (0, f"Report: {out}/report.html\n"),
                         outcome.stderr)
        self.assertEqual(outcome.stderr, "")
        page = (out / "report.html").read_text()
        tree = parsed(page)
        self.assertNotIn("http", page)
        images = [image.get("src") for image in tree.iter("img")]
        self.assertTrue(all(image.startswith("data:image/") for image in images))
        ids = {figure.get("id") for figure in tree.iter("figure")}
        self.assertLessEqual({"pareto-01", "pareto-04", "paper-01", "access-01", "slice-01",
                              "slice-03", "delta-01", "cross-validation-02"}, ids)
        for text in ("controlspace …", "Of the conclusions that the paper", "All measures"):
            self.assertIn(text, page)
        # Again, elsewhere: the same page, and its figures as files.
        outcome = run("report", out, "--output", self.folder / "new", "--figures",
                      self.folder / "new")
        self.assertEqual((self.folder / "new" / "report.html").read_text(), page)
        self.assertEqual({p.stem for p in (self.folder / "new").iterdir()}, ids | {"report"})

    def test_without_sampled_fields_it_says_so(self):
        out = write_results(self.folder / "out", [json_row("K_oL")])
        self.assertEqual(run("report", out).returncode, 0)
        self.assertIn("Fields are not shown", (out / "report.html").read_text())
        self.assertEqual(run("report", out, "--without-fields").returncode, 0)
        self.assertNotIn("Fields are", (out / "report.html").read_text())
        # Fields that are not kept beside results.json.
        rows = with_fields(out, [json_row("K_oL")])
        write_results(out, rows)
        shutil.rmtree(out / "fields")
        self.assertEqual(run("report", out).returncode, 0)
        self.assertIn("Fields are not shown", (out / "report.html").read_text())

    def test_two_runs(self):
        for name in ("before", "after"):
            write_results(self.folder / name, three_rows()[:2])
        outcome = run("report", self.folder / "before", self.folder / "after", "--output",
                      self.folder / "both")
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        page = (self.folder / "both" / "report.html").read_text()
        ids = {figure.get("id") for figure in parsed(page).iter("figure")}
        self.assertIn("2 rows of 2 have the same setting as one of 2", page)
        lines = [["".join(cell.itertext()) for cell in line] for line in parsed(page).iter("tr")]
        self.assertIn(["memory", "0 smaller", "2", "0 larger", "0"], lines)
        self.assertLessEqual({"2-change-01", "1-access-01", "2-access-01"}, ids)

    def test_what_cannot_be_written_is_refused_and_leaves_nothing_behind(self):
        out = write_results(self.folder / "out", [json_row("K_oL")])
        before = sorted(self.folder.rglob("*"))

        def refused(message, *arguments):
            outcome = run("report", *arguments)
            self.assertEqual(outcome.returncode, 2, arguments)
            self.assertRegex(outcome.stderr, message)
            self.assertNotIn("Traceback", outcome.stderr)
        refused("none/results.json: no such file", self.folder / "none")
        refused("RESULTS")
        refused("choose another folder", out, "--output", out / "results.json" / "x")
        os.symlink("/dev/full", out / "report.html")
        refused("report.html", out)
        os.unlink(out / "report.html")
        (out / "results.json").write_text("{}")
        refused("out/results.json: not written by controlspace", out)
        self.assertEqual(sorted(self.folder.rglob("*")), before)


if __name__ == "__main__":
    unittest.main()

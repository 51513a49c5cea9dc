# The page of foreign systems: every system of the results is on it, with its numbers or why it failed; its
# sentences follow from the numbers; its works are studies that the program can read.
import tempfile
import tomllib
import unittest
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from samples import failed_row, json_row, run, times, write_results

import peers_works
from pages import peers_page
from pages.results import InputError

REASON = "isotropic sources only: <tensors> & \"others\" are refused"


def row(structure, delta=0.09, megabytes=1.0, random=(50.0, 51.0, 52.0), creation=1.0, **changes):
    return json_row(structure, delta_R_max=delta, delta_R_fine_max=1.02 * delta,
                    bytes_total=round(1e6 * megabytes), **times("t_access_ns_random", *random),
                    **times("t_creation_s", creation), **changes)


class WithFolder(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def works(self, **rows):
        """Works by their rows."""
        for name, found in rows.items():
            name = name.replace("_", "-")
            write_results(self.folder / name, found, name=name)
        return peers_page.read_works(self.folder)


class Page(WithFolder):
    def test_every_system_and_every_reason_is_on_both_pages(self):
        self.works(sphere=[row("K_oL"), row("tets-linear", equal_delta=0.1), row("direct", 0)],
                   sphere_layers=[row("K_oL"), failed_row(REASON, structure="netgen-localh")])
        done = run("peers_page", self.folder, "--command", "bench/peers --quick", "--note", "A busy machine.")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        readme = (self.folder / "README.md").read_text()
        html = (self.folder / "report.html").read_text()
        ElementTree.fromstring(html.replace("<!DOCTYPE html>\n", ""))
        for text in ("K_oL", "tets-linear", "direct", "netgen-localh", "bench/peers --quick", "A busy machine.",
                     "Sphere of the paper, isotropic", "Sphere, lengths [4, 0.25]: 4:1"):
            self.assertIn(text, readme)
            self.assertIn(text, html)
        self.assertIn(f"sphere-layers: {REASON}", readme)
        self.assertIn(f"failed: {REASON}", readme)
        self.assertNotIn("<tensors>", html)
        for name in ("sphere", "sphere-layers"):
            self.assertIn(f"({name}/fronts.svg)", readme)
            ElementTree.parse(self.folder / name / "fronts.svg")

    def test_a_work_where_all_systems_failed_is_shown(self):
        self.works(sphere=[failed_row(REASON, structure="K_oL")])
        self.assertEqual(run("peers_page", self.folder).returncode, 0)
        readme = (self.folder / "README.md").read_text()
        self.assertIn(REASON, readme)
        self.assertIn("no system reaches it on any of 1 work", readme)

    def test_a_folder_without_results_is_named(self):
        with self.assertRaisesRegex(InputError, "no WORK/results.json"):
            peers_page.read_works(self.folder)
        self.assertEqual(run("peers_page", self.folder).returncode, 2)

    def test_a_row_shows_its_numbers(self):
        work, = self.works(sphere=[row("uniform-nearest", 0.0712, 12.345, (10.0, 20.0, 30.0), 0.25)])
        line, = peers_page.rows_table(work).rows
        self.assertEqual(line[2:5], ["0.0712", "0.0726", "12.345"])
        self.assertEqual(line[5:7], ["0.2500", "20.0 (15.0–25.0)"])

    def test_results_without_rows_are_a_page(self):
        self.works(sphere=[], planes=[row("K_oL")])
        self.assertEqual(run("peers_page", self.folder).returncode, 0)
        self.assertIn("2 works of 36186 sources, 1 system.", (self.folder / "README.md").read_text())
        self.works(sphere=[], planes=[])
        self.assertEqual(run("peers_page", self.folder).returncode, 0)
        self.assertIn("2 works of no sources, 0 systems.", (self.folder / "README.md").read_text())

    def test_one_creation_has_no_quartiles(self):
        def intro(*creation):
            once, = self.works(sphere=[row("K_oL") | times("t_creation_s", *creation)])
            self.assertEqual(run("peers_page", self.folder).returncode, 0)
            text = (self.folder / "README.md").read_text()
            return peers_page.rows_table(once).rows[0][5], "Access times whose quartiles" in text

        self.assertEqual(intro(0.25), ("0.2500", True))
        self.assertEqual(intro(1.0, 2.0, 3.0), ("2.0000 (1.5000–2.5000)", False))


class Choice(WithFolder):
    def test_grids_of_this_project_are_not_foreign(self):
        own = ["K_oL", "uniform-nearest", "uniform-trilinear", "direct"]
        self.assertEqual([s for s in own if peers_page.is_foreign(s)], [])
        foreign = ["openvdb-uniform-nearest", "nanovdb-nearest", "tets-linear", "kd-nearest-all"]
        self.assertEqual([s for s in foreign if peers_page.is_foreign(s)], foreign)

    def test_sentences_follow_from_the_numbers(self):
        small = [row("K_V", megabytes=1, random=(9.0,)), row("tets-linear", megabytes=3, random=(18.0,)),
                 row("uniform-nearest", megabytes=5, random=(3.0,), creation=4.0),
                 row("kd-nearest-all", 0.01, 9, (30.0,), creation=0.25), row("kd-nearest", 0.5, 0.1)]
        works = self.works(sphere=small, planes=small, scattered=[row("kd-nearest", megabytes=0.5),
                                                                  row("K_V", megabytes=1)])
        memory, access, creation = peers_page.choices(works)
        self.assertIn("K_V is smallest on 2 of 3 works, kd-nearest on 1;", memory)
        self.assertIn("tets-linear comes nearest to K_V, at 3 times that", memory)
        self.assertIn("uniform-nearest is fastest at random places on 2 of 3 works", access)
        self.assertIn("kd-nearest-all is created fastest on 2 of 3 works", creation)
        self.assertIn("of this project's structures K_V comes nearest to kd-nearest-all, at 4 times that", creation)
        self.assertIn("at random places kd-nearest-all takes 10 times as long as the fastest", creation)

    def test_tensors_are_judged_apart(self):
        works = self.works(sphere=[row("K_V")], thin_layers=[row("tets-log")])
        self.assertEqual([text.split()[0] for text in peers_page.choices(works)],
                         ["Isotropic,"] * 3 + ["Tensors,"] * 2)
        self.assertIn("tets-log is smallest on 1 of 1 work", peers_page.choices(works)[3])

    def test_times_whose_quartiles_overlap_are_equal(self):
        work, = self.works(sphere=[row("K_V", random=(10.0, 12.0, 14.0)), row("K_oV", random=(12.0, 13.5, 15.0)),
                                   row("K_L", random=(14.0, 15.0, 16.0))])
        self.assertEqual(peers_page.cheapest(work.rows, "t_access_ns_random"), ["K_V", "K_oV"])
        self.assertEqual(peers_page.cheapest([], "memory_MB"), [])

    def test_delta_that_is_missed_does_not_count(self):
        rows = [row("K_V", 0.0985, 2, target_delta=0.1), row("K_V", 0.03, 3, target_delta=0.02),
                row("kd-nearest", 0.12, 1)]
        table = peers_page.choice_table(self.works(sphere=rows))
        self.assertEqual([line[2] for line in table.rows], ["K_V", "–"])

    def test_delta_that_was_not_asked_for_is_not_shown(self):
        works = self.works(sphere=[row("K_V", 0.01, target_delta=0.1)])
        self.assertEqual([line[1] for line in peers_page.choice_table(works).rows], ["0.1"])
        self.assertEqual(peers_page.systems_table(works).rows[0][3:5], ["1", "0"])


class Works(unittest.TestCase):
    def test_all_are_studies(self):
        names = [name for name in peers_works.WORKS if name not in ("bracket", "junction", "blade")]
        self.assertGreaterEqual(len(peers_works.WORKS), 10)
        with tempfile.TemporaryDirectory() as folder:
            for name in names:
                place = Path(folder) / name
                place.mkdir()
                study = tomllib.loads(peers_works.study_of(name, place, True, ["peers"]))
                self.assertEqual(study["name"], name)
                self.assertEqual(study["runs"][-1]["structures"], ["peers"])
                if study["sources"] != "sources.csv":
                    continue
                table = np.loadtxt(place / "sources.csv", delimiter=",", skiprows=1)
                low, high = np.reshape(study["domain"], (3, 2)).T
                self.assertTrue(np.all((low <= table[:, :3]) & (table[:, :3] <= high)), name)
                if name not in peers_works.TENSORS:
                    self.assertGreater(table[:, 3].min(), 0)
                    continue
                xx, yy, zz, xy, xz, yz = table[:, 3:].T
                m = np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=1).reshape(-1, 3, 3)
                lengths = np.linalg.eigvalsh(m)
                self.assertGreater(lengths.min(), 0.0009, name)
                self.assertGreater((lengths[:, 2] / lengths[:, 0]).max(), 15, name)

    def test_the_full_coast_line_has_a_million_sources(self):
        with tempfile.TemporaryDirectory() as folder:
            peers_works.coast(Path(folder), quick=False)
            with (Path(folder) / "sources.csv").open() as lines:
                self.assertEqual(sum(1 for _ in lines) - 1, 2**20)


if __name__ == "__main__":
    unittest.main()

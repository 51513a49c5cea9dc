# SPDX-License-Identifier: Apache-2.0
# The page of foreign systems: that of kept results to the letter; every system is on it, with its numbers
# or why it failed; its sentences follow from the numbers; its works are studies that the program can read.
import re
import shutil
import tempfile
import tomllib
import unittest
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from samples import KEPT, InFolder, failed_row, json_row, run, times, write_results

import peers_works
from pages import peers_page

REASON = "isotropic sources only: <tensors> & \"others\" | are refused"


def row(structure, delta=0.09, megabytes=1.0, random=(50.0, 51.0, 52.0), creation=(1.0,), **changes):
    return json_row(structure, delta_R_max=delta, delta_R_fine_max=1.02 * delta,
                    bytes_total=round(1e6 * megabytes), **times("t_access_ns_random", *random),
                    **times("t_creation_s", *creation), **changes)


class Page(InFolder):
    def works(self, **rows):
        """Works by their rows."""
        for name, found in rows.items():
            write_results(self.folder / name.replace("_", "-"), found, name=name)
        return peers_page.read_works(self.folder)

    def readme(self):
        done = run("peers_page", self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        ElementTree.fromstring((self.folder / "report.html").read_text().replace("<!DOCTYPE html>\n", ""))
        return (self.folder / "README.md").read_text()

    def test_kept_results_give_the_kept_page(self):
        kept = (KEPT / "peers/README.md").read_text()
        command, note = re.search(r"Made by `(.*)` with .*\n\n(.*)\n", kept).groups()
        for file in (KEPT / "peers").glob("*/results.json"):
            (self.folder / file.parent.name).mkdir()
            shutil.copy(file, self.folder / file.parent.name)
        done = run("peers_page", self.folder, "--command", command, "--note", note)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertTrue((self.folder / "README.md").read_text() == kept)

    def test_a_system_that_failed_says_why_on_both_pages(self):
        self.works(sphere=[row("K_oL")], sphere_layers=[failed_row(REASON, structure="netgen-localh")])
        readme = self.readme()
        self.assertIn("sphere-layers: " + REASON.replace("|", "\\|"), readme)
        self.assertIn("no system reaches it on any of 1 work", readme)
        self.assertNotIn("<tensors>", (self.folder / "report.html").read_text())
        self.works(sphere=[], sphere_layers=[])
        self.assertIn("2 works of no sources, 0 systems.", self.readme())

    def test_a_folder_without_results_is_named(self):
        self.refused("peers_page", "no WORK/results.json", self.folder)

    def test_one_creation_has_no_quartiles(self):
        for creation, cell in (((0.25,), "0.2500"), ((1.0, 2.0, 3.0), "2.0000 (1.5000–2.5000)")):
            work, = self.works(sphere=[row("K_oL", random=(10.0, 20.0, 30.0), creation=creation)])
            self.assertEqual(peers_page.rows_table(work).rows[0][5:7], [cell, "20.0 (15.0–25.0)"])

    def test_sentences_follow_from_the_numbers(self):
        small = [row("K_V", megabytes=1, random=(9.0,)), row("tets-linear", megabytes=3, random=(18.0,)),
                 row("uniform-nearest", megabytes=5, random=(3.0,), creation=(4.0,)),
                 row("kd-nearest-all", 0.01, 9, (30.0,), creation=(0.25,)), row("kd-nearest", 0.5, 0.1)]
        works = self.works(sphere=small, planes=small, thin_layers=[row("tets-log")], scattered=[
            row("kd-nearest", megabytes=0.5), row("K_V", megabytes=1)])
        memory, access, creation, tensors, _ = peers_page.choices(works)
        self.assertIn("K_V is smallest on 2 of 3 works, kd-nearest on 1;", memory)
        self.assertIn("tets-linear comes nearest to K_V, at 3 times that", memory)
        self.assertIn("uniform-nearest is fastest at random places on 2 of 3 works", access)
        self.assertIn("kd-nearest-all is created fastest on 2 of 3 works", creation)
        self.assertIn("of this project's structures K_V comes nearest to kd-nearest-all, at 4 times that", creation)
        self.assertIn("at random places kd-nearest-all takes 10 times as long as the fastest", creation)
        self.assertIn("tets-log is smallest on 1 of 1 work", tensors)

    def test_times_whose_quartiles_overlap_are_equal(self):
        work, = self.works(sphere=[row("K_V", random=(10.0, 12.0, 14.0)), row("K_oV", random=(12.0, 13.5, 15.0)),
                                   row("K_L", random=(14.0, 15.0, 16.0))])
        self.assertEqual(peers_page.cheapest(work.rows, "t_access_ns_random"), ["K_V", "K_oV"])

    def test_delta_that_is_missed_or_was_not_asked_for_does_not_count(self):
        rows = [row("K_V", 0.0985, 2, target_delta=0.1), row("kd-nearest", 0.12, 1)]
        table = peers_page.choice_table(self.works(sphere=rows))
        self.assertEqual([line[1:3] for line in table.rows], [["0.1", "K_V"]])
        table = peers_page.choice_table(self.works(sphere=[*rows, row("K_V", 0.03, 3, target_delta=0.02)]))
        self.assertEqual([line[2] for line in table.rows], ["K_V", "–"])


class Works(unittest.TestCase):
    def test_all_are_studies(self):
        names = [name for name in peers_works.WORKS if name not in ("bracket", "junction", "blade")]
        self.assertGreaterEqual(len(names), 7)
        with tempfile.TemporaryDirectory() as folder:
            for name in names:
                place = Path(folder) / name
                place.mkdir()
                study = tomllib.loads(peers_works.study_of(name, place, True, ["peers"]))
                self.assertEqual(study["name"], name)
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
                self.assertGreater(np.linalg.eigvalsh(m).min(), 0, name)


if __name__ == "__main__":
    unittest.main()

# bench/check: two runs of the same cases have the same results, but for times and rounding.
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from samples import ROOT, json_row, times, write_results

from pages.check_command import check
from pages.results import InputError, read_results


class Check(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def results(self, name, rows, **settings):
        return read_results(write_results(self.folder / name, rows, **settings))

    def compared(self, rows, other):
        return check(self.results("here", rows), self.results("there", other))

    def test_times_do_not_count(self):
        lines, different = self.compared(
            [json_row("K_oL"), json_row("K_V", "s_L")],
            [json_row("K_V", "s_L", **times("t_access_ns_random", 500.0)), json_row("K_oL"),
             json_row("K_oV")])
        self.assertFalse(different)
        self.assertIn("2 cases in both, of 2 here and 3 there", lines[2])
        self.assertIn("the same bits in 2", lines[2])
        self.assertIn(" 0 within", lines[3])

    def test_rounding_is_counted(self):
        lines, different = self.compared(
            [json_row("K_oL")],
            [json_row("K_oL", delta_R_max=1.78 * (1 + 1e-13), checksum="f" * 16)])
        self.assertFalse(different)
        self.assertIn("the same bits in 0", lines[2])
        self.assertIn(" 1 within", lines[3])

    def test_what_differs_is_named(self):
        for changes, text in (({"cells": 104}, "cells 103, there 104"),
                              ({"delta_S_max": 0.1001}, "delta_S_max 0.1, there 0.1001"),
                              ({"delta_R_max": None}, "delta_R_max 1.78, there inf")):
            with self.subTest(text), tempfile.TemporaryDirectory() as self.here:
                self.folder = Path(self.here)
                lines, different = self.compared([json_row("K_oL")], [json_row("K_oL", **changes)])
                self.assertTrue(different)
                self.assertIn(text, lines[-1])
                self.assertIn("K_oL", lines[-1])

    def test_runs_of_other_cases_are_refused(self):
        here = self.results("here", [json_row("K_oL")])
        with self.assertRaisesRegex(InputError, "no case in common"):
            check(here, self.results("other", [json_row("K_oL", rho=0.2)]))
        with self.assertRaisesRegex(InputError, "differ in probe_grid"):
            check(here, self.results("probes", [json_row("K_oL")], probe_grid=5))

    def test_the_command(self):
        self.results("here", [json_row("K_oL")])
        self.results("there", [json_row("K_oL", depth=10)])
        run = lambda a, b: subprocess.run(  # noqa: E731
            [sys.executable, ROOT / "bench/check", self.folder / a, self.folder / b],
            capture_output=True, text=True)
        self.assertEqual(run("here", "here").returncode, 0)
        different = run("here", "there")
        self.assertEqual(different.returncode, 1)
        self.assertIn("depth 9, there 10", different.stdout)
        missing = run("here", "nowhere")
        self.assertEqual(missing.returncode, 2)
        self.assertIn("nowhere", missing.stderr)


if __name__ == "__main__":
    unittest.main()

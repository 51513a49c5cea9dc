# SPDX-License-Identifier: Apache-2.0
# bench/check: two runs of the same cases have the same results, but for times and rounding.
import json

from samples import KEPT, QUICK, InFolder, json_row, run, times, unittest, write_results


class Check(InFolder):
    def compared(self, row, **settings):
        """The kept run, and the same with one row in place of its first."""
        there = write_results(self.folder, [row, *QUICK["rows"][1:]], **settings)
        outcome = run("check", KEPT / "paper-sphere-quick", there)
        return outcome.returncode, outcome.stdout.splitlines() or [outcome.stderr]

    def test_a_run_against_itself(self):
        status, lines = self.compared(QUICK["rows"][0])
        self.assertEqual(status, 0)
        self.assertIn("35 cases in both, of 35 here and 35 there", lines[2])
        self.assertIn("the same bits in 35", lines[2])
        self.assertIn(" 0 within 1e-10, 0 different", lines[3])

    def test_times_do_not_count_and_rounding_is_counted(self):
        first = QUICK["rows"][0]
        status, lines = self.compared({**first, **times("t_access_ns_random", 500.0), "checksum": "f" * 16,
                                       "delta_R_max": first["delta_R_max"] * (1 + 1e-13)})
        self.assertEqual(status, 0)
        self.assertIn("the same bits in 34", lines[2])
        self.assertIn(" 1 within 1e-10, 0 different", lines[3])

    def test_every_number_that_differs_is_found(self):
        first = QUICK["rows"][0]
        keys = [key for key in first if key.startswith(("bytes_", "delta_", "coarser_", "within_"))]
        for key in [*keys, "cells", "depth", "sources_inserted", "gradation_max_left"]:
            if first[key] is None or key == "bytes_published_accounting":
                continue
            other = first[key] + 1 if isinstance(first[key], int) else first[key] * (1 + 1e-9)
            status, lines = self.compared({**first, key: other})
            self.assertEqual((status, len(lines)), (1, 5), key)
            self.assertIn(f"{key} {first[key]}, there {other}", lines[-1])
            self.assertIn("K_L s_L", lines[-1])
        status, lines = self.compared({**first, "delta_R_max": None})
        self.assertIn(", there inf", lines[-1])

    def test_what_cannot_be_compared_is_refused(self):
        kept = KEPT / "paper-sphere-quick"
        self.refused("check", "nowhere", kept, self.folder / "nowhere")
        self.refused("check", "no case in common", kept, write_results(self.folder, [json_row(rho=0.2)]))
        self.refused("check", "differ in probe_grid", kept, write_results(
            self.folder, QUICK["rows"], probe_grid=5))
        (self.folder / "results.json").write_text(json.dumps(QUICK)[:-9])
        self.refused("check", "results.json", kept, self.folder)


if __name__ == "__main__":
    unittest.main()

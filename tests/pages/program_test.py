# SPDX-License-Identifier: Apache-2.0
# End to end: a run of the program (the first argument), then the pages of its results.
import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from samples import run

PROGRAM = sys.argv.pop()
QUICK = ("--access-points 100 --access-repeats 3 --fine-probe-grid 5 --quiet "
         "--as-published --splits s_M --structures").split()


class Pages(unittest.TestCase):
    def test_all_pages(self):
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "out"
            shown = subprocess.run([PROGRAM, "compare", *QUICK, "K_L,K_oL", "--output", out], check=True,
                                   capture_output=True, text=True)
            outcome = run("paper", out)
            self.assertEqual(outcome.returncode, 0, outcome.stderr)
            # Table 4, K_L s_M and K_oL: the former to the printed digit, the latter not.
            self.assertIn("Of the 4 cells of Tables 1 and 4 2 are equal", outcome.stdout)
            page = (out / "paper.md").read_text()
            self.assertIn("| K_L       | s_M   |   1 |   1 | 6.48 |  6.48 | equal", page)
            outcome = run("report", out)
            self.assertEqual(outcome.returncode, 0, outcome.stderr)
            page = (out / "report.html").read_text()
            self.assertIn("compare --access-points 100", page)
            # What the terminal shows stands in the summary too.
            outcome = run("tables", out)
            self.assertEqual(outcome.returncode, 0, outcome.stderr)
            self.assertEqual(len(json.loads((out / "pareto.json").read_text())), 4)
            summary = (out / "summary.md").read_text()
            table = [line for line in shown.stdout.splitlines() if line.startswith("K_")]
            self.assertEqual(len(table), 2)
            for line in table:
                self.assertIn(f"| {' | '.join(re.split(' {2,}', line))} |", " ".join(summary.split()))
            for sentence in shown.stdout.split("Which structure to take\n")[1].splitlines()[:2]:
                self.assertIn(f"- {sentence}\n", summary)
            has_fields = any(row.get("fields") for row in
                             json.loads((out / "results.json").read_text())["rows"])
            self.assertEqual("cross-validation" in page, has_fields)


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: Apache-2.0
# The report in a browser, where one is installed: nothing is wider than the page, narrow or wide,
# light or dark.
import html
import json
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

from samples import json_row, outcome, paper_json_rows, run, with_fields, write_results

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
# Opens all that is folded; what is wider than the page, and what is cut or to be scrolled sideways.
MEASURE = """<script>
for (const fold of document.querySelectorAll("details")) fold.open = true;
const wider = Array.from(document.querySelectorAll("body *")).filter(
  e => e.getBoundingClientRect().right > innerWidth + 1);
const scrolled = Array.from(document.querySelectorAll("body *")).filter(
  e => getComputedStyle(e).overflowX !== "visible" && e.scrollWidth > e.clientWidth + 1);
const named = e => e.tagName + "." + e.className + ": " + e.textContent.trim().slice(0, 60);
const found = {width: innerWidth, page: document.documentElement.scrollWidth,
               height: document.documentElement.scrollHeight,
               wider: wider.map(named), scrolled: scrolled.map(named),
               background: getComputedStyle(document.body).backgroundColor};
document.body.innerHTML = "<pre id='found'></pre>";
document.getElementById("found").textContent = JSON.stringify(found);
</script>"""


def measured(page, width, dark):
    """What MEASURE finds."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "page.html"
        file.write_text(page.replace("</body>", MEASURE + "</body>"))
        scheme = ["--blink-settings=preferredColorScheme=0"] if dark else []
        dom = subprocess.run(
            [BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", f"--window-size={width},900",
             f"--user-data-dir={folder}/profile", *scheme, "--dump-dom", file.as_uri()],
            capture_output=True, text=True, timeout=300).stdout
    return json.loads(html.unescape(re.search(r'<pre id="found">(.*?)</pre>', dom)[1]))


@unittest.skipUnless(BROWSER, "no browser is installed (chromium): the page is not looked at in one")
class InABrowser(unittest.TestCase):
    def test_nothing_is_wider_than_the_page(self):
        with tempfile.TemporaryDirectory() as folder:
            long = "openvdb-uniform-trilinear"
            rows = [json_row("K_V", "s_L"), json_row("K_oL"),
                    json_row(long, voxel=0.01234, remark="a remark of many words " * 9,
                             command="x", own_measure_with_a_long_name=1.5)]
            rows[2]["labels"]["structure"] += ", as-made, pruned at 0.1, for delta 0.02"
            rows = with_fields(folder, rows) + paper_json_rows()
            write_results(folder, rows, outcomes=[outcome(rows, [1], [0, 2], [2])], name="a-study-of-a-name-without-blanks-" * 4)
            self.assertEqual(run("report", folder).returncode, 0)
            page = (Path(folder) / "report.html").read_text()
        backgrounds = set()
        for width in (1400, 500):
            for dark in (False, True):
                with self.subTest(width=width, dark=dark):
                    found = measured(page, width, dark)
                    self.assertEqual(found["width"], width)
                    self.assertEqual(found["page"], width)
                    self.assertEqual((found["wider"], found["scrolled"]), ([], []))
                    backgrounds.add(found["background"])
        self.assertEqual(backgrounds, {"rgb(255, 255, 255)", "rgb(18, 18, 18)"})

    def test_what_is_wider_is_found(self):
        page = '<!DOCTYPE html><html><body><div style="overflow-x: auto"><p style="width: 600px">' \
            '</p></div>{}</body></html>'
        found = measured(page.format(""), 500, False)
        self.assertEqual((found["page"], len(found["scrolled"])), (500, 1))
        found = measured(page.format('<p style="width: 700px">x</p>'), 500, False)
        self.assertGreater(found["page"], 700)


if __name__ == "__main__":
    unittest.main()

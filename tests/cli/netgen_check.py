# SPDX-License-Identifier: Apache-2.0
"""Netgen answers by mesh sizes that `export` wrote as the structure does.

netgen_check.py PROGRAM. Ends with 77 where Netgen's Python package, 6.2.2404 or later, is missing.

Netgen keeps one length a cell of an octree of its own, whose cells are about as large as the length. It
ignores a request that is less than a sixth below what it has, and lets lengths grow by its grading from
there: answers are up to 1.2 times too large; where a cell reaches into finer places, too small.
"""

import math
import pathlib
import random
import subprocess
import sys
import tempfile

try:
    import netgen.meshing as meshing
    import netgen.occ as occ

    meshing.LocalH.GetH
except (ImportError, AttributeError):
    print("skipped: no Netgen that tells its lengths (PyPI: netgen-mesher)")
    sys.exit(77)

SOURCES = "x,y,z,h\n0,0,0,0.1\n1,0,0,0.2\n0,1,0,0.2\n1,1,1,0.4\n0.7,0.6,0.5,0.03\n"
PLACES = 1000


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    folder = pathlib.Path(tempfile.mkdtemp())
    random.seed(1)
    places = [[random.uniform(0.01, 0.99) for _ in range(3)] for _ in range(PLACES)]
    (folder / "s.csv").write_text(SOURCES)
    (folder / "p.csv").write_text("x,y,z\n" + "".join("%r,%r,%r\n" % tuple(p) for p in places))

    def run(*arguments):
        subprocess.run([program, *arguments], cwd=folder, check=True, stderr=subprocess.DEVNULL)

    run("build", "s.csv", "-o", "f.ctrl")
    run("query", "f.ctrl", "p.csv", "-o", "answers.csv")
    run("export", "f.ctrl", "-o", "f.msz")
    rows = (folder / "answers.csv").read_text().splitlines()[1:]
    expected = [float(row.split(",")[3]) for row in rows]

    geometry = occ.OCCGeometry(occ.Box((0, 0, 0), (1, 1, 1)))
    mesh = geometry.GenerateMesh(maxh=1, grading=0.3, meshsizefilename=str(folder / "f.msz"),
                                 perfstepsend=meshing.MeshingStep.ANALYSE)
    lengths = mesh.GetLocalH(1)
    ratios = sorted(lengths.GetH(meshing.Pnt(*p)) / h for p, h in zip(places, expected))
    mean = math.exp(sum(map(math.log, ratios)) / PLACES)
    print(f"Netgen's lengths over the structure's: {ratios[0]:.3f} to {ratios[-1]:.3f}, "
          f"98 % from {ratios[PLACES // 100]:.3f} to {ratios[-PLACES // 100]:.3f}, mean {mean:.3f}")
    good = LIMITS[0] <= ratios[PLACES // 100] and ratios[-PLACES // 100] <= LIMITS[1]
    sys.exit(0 if good else 1)


LIMITS = 1 / 1.3, 1.3  # of 98 %
main()

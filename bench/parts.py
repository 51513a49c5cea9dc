# SPDX-License-Identifier: Apache-2.0
"""Three parts as CAD files: parts.py FOLDER writes bracket.step, junction.step and blade.step.

Lengths are in millimetres. The bracket has a fillet, two holes and a rib of 1.5; the junction of two
pipes has walls of 2; the blade, a twisted wing section, has a thin trailing edge.
"""
import math
import pathlib
import sys

import gmsh

occ = gmsh.model.occ


def bracket():
    plate = (3, occ.addBox(0, 0, 0, 60, 40, 6))
    wall = (3, occ.addBox(0, 0, 0, 6, 40, 45))
    body, _ = occ.fuse([plate], [wall])
    occ.synchronize()
    inner = [tag for dim, tag in gmsh.model.getEntities(1) if is_at(tag, x=6, z=6)]
    body = occ.fillet([body[0][1]], inner, [8])
    corners = [occ.addPoint(x, 19.25, z) for x, z in ((3, 3), (50, 3), (3, 38))]
    lines = [occ.addLine(corners[i], corners[(i + 1) % 3]) for i in range(3)]
    rib = occ.extrude([(2, occ.addPlaneSurface([occ.addCurveLoop(lines)]))], 0, 1.5, 0)
    body, _ = occ.fuse(body, [e for e in rib if e[0] == 3])
    holes = [(3, occ.addCylinder(45, y, -1, 0, 0, 10, 4)) for y in (10, 30)]
    occ.cut(body, holes)


def is_at(curve, x, z):
    box = gmsh.model.getBoundingBox(1, curve)
    return all(abs(box[i] - value) < 1e-3 for i, value in ((0, x), (3, x), (2, z), (5, z)))


def junction():
    outer, _ = occ.fuse([(3, occ.addCylinder(-40, 0, 0, 80, 0, 0, 12))],
                        [(3, occ.addCylinder(0, 0, 0, 15, 0, 40, 8))])
    inner, _ = occ.fuse([(3, occ.addCylinder(-50, 0, 0, 100, 0, 0, 10))],
                        [(3, occ.addCylinder(0, 0, 0, 18.75, 0, 50, 6))])
    occ.cut(outer, inner)


def blade():
    """Sections of NACA 0012 with a blunt trailing edge, shorter and turned towards the tip."""
    loops = []
    for height, chord, turn in ((0, 40, 0), (30, 34, 10), (60, 26, 22)):
        points = []
        for k in range(-20, 21):
            t = (k / 20) ** 2
            half = 0.6 * (0.2969 * math.sqrt(t) - 0.126 * t - 0.3516 * t**2 + 0.2843 * t**3
                          - 0.1015 * t**4)
            x, y = chord * (t - 0.3), math.copysign(chord * half, k) if k else 0
            c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
            points.append(occ.addPoint(c * x - s * y, s * x + c * y, height))
        loops.append(occ.addWire([occ.addSpline(points), occ.addLine(points[-1], points[0])]))
    occ.addThruSections(loops, makeSolid=True)


def main():
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    for make in (bracket, junction, blade):
        gmsh.clear()
        make()
        occ.synchronize()
        volumes = gmsh.model.getEntities(3)
        assert len(volumes) == 1, f"{make.__name__}: {len(volumes)} solids"
        surplus = [e for dim in (2, 1, 0) for e in gmsh.model.getEntities(dim)
                   if not len(gmsh.model.getAdjacencies(*e)[0])]
        occ.remove(surplus, recursive=True)
        occ.synchronize()
        gmsh.write(str(folder / f"{make.__name__}.step"))
        print(f"{make.__name__}: volume {occ.getMass(*volumes[0]):.0f} mm^3")
    gmsh.finalize()


main()

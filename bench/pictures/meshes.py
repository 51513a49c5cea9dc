# SPDX-License-Identifier: Apache-2.0
"""The paper's Figures 4a, 4b and 5 beside meshes of ours (see bench/pictures/meshes).

Of each figure three meshes: of the exact field, of the paper's structure made by the paper's procedure, and of
the same structure adapted to δ <= 0.1. Their numbers go to figures.json, from which summary.md is made.
"""

import argparse
import json
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyvista
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
PICTURES = ROOT / "data/pictures"
THIN = ["--s-a", "4", "--s-n", "0.25"]
PAPER = ["--law", "mean-length", "--schedule", "passes"]
ADAPTED = ["--target-delta", "0.1"]


@dataclass
class Figure:
    sources: str
    structure: str
    options: list
    paper: str  # what the paper says of its mesh: tetrahedra, L_R
    reference: str = "exact"  # that of the paper's procedure


FIGURES = {
    "4a": Figure("sphere, lengths 0.015 across and 0.06 along", "K_V", THIN, "291 570, 0.70"),
    "4b": Figure("sphere, length 0.03", "K_oV", [], "350 293, 0.79", "published-sphere"),
    "5, slope 0": Figure("planes, slope 0, lengths as in 4a", "K_V",
                         [*THIN, "--sources", "planes", "--slope", "0"], "–"),
    "5, slope 0.2": Figure("planes, slope 0.2, lengths as in 4a", "K_V",
                           [*THIN, "--sources", "planes", "--slope", "0.2"], "–"),
}


def file_of(name):
    return f"mesh-figure-{name.replace(', ', '-').replace(' ', '-')}.png"


def meshed(program, mmg, options, folder):
    """Rows of meshes.json, each with its .vtu, and where they come from."""
    options = [*options, "--reference-tolerance", "0.02"]
    files = ["--files", "vtu", "--output", folder]
    subprocess.run([program, "mesh", *options, "--mmg", mmg, *files], check=True, cwd=ROOT)
    data = json.loads((folder / "meshes.json").read_text())
    keep = "field split setting mesher tets nodes L_R delta_R_max delta_R_mean".split()
    origin = {"origin": data["origin"], "command": " ".join(["controlspace mesh", *options])}
    meshes = sorted(folder.glob("*.vtu"))
    return [{key: row.get(key) for key in keep} | origin | {"file": file}
            for row, file in zip(data["rows"], meshes, strict=True)]


def stored_l_r(mesh):
    """L_R by the field that the mesh was made by, with the mean of the lengths at both ends of an edge."""
    tets = mesh.cells_dict[pyvista.CellType.TETRA]
    pairs = np.concatenate([tets[:, [i, j]] for i in range(4) for j in range(i)])
    edges = np.unique(np.sort(pairs, axis=1), axis=0)
    inverse = np.linalg.inv(mesh["length_tensor"][:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3))
    v = (mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]]).astype(float)
    lengths = sum(np.linalg.norm(np.einsum("eij,ej->ei", inverse[edges[:, end]], v), axis=1) for end in (0, 1)) / 2
    return float(np.mean((lengths >= 0.8) & (lengths < 1.25)))


def draw(panels, picture):
    """A cross-section of each mesh, coloured by the mean metric length of the edges, where 1 is what its field
    requests: the tetrahedra that the plane z = 0 cuts, and those behind it."""
    plotter = pyvista.Plotter(off_screen=True, shape=(1, len(panels)), window_size=(620 * len(panels), 690),
                              border=False)
    bar = {"title_font_size": 14, "label_font_size": 12, "color": "black", "fmt": "%.2f",
           "position_x": 0.25, "position_y": 0.01, "width": 0.5, "height": 0.09}
    for i, (title, mesh) in enumerate(panels):
        # Whole tetrahedra, not their sections: those would look smaller than they are.
        behind = mesh.clip(normal="z", origin=(0, 0, 0), crinkle=True)
        plotter.subplot(0, i)
        plotter.add_mesh(behind, scalars="edge_length", cmap="coolwarm", clim=(0.5, 1.5), lighting=False,
                         scalar_bar_args=bar | {"title": "mean metric length of edges" + i * " "},
                         show_edges=True, line_width=0.3, edge_color="#404040")
        plotter.add_text(f"{title.replace('δ ≤', 'delta <=')}: {mesh.n_cells} tetrahedra", position=(10, 660),
                         font_size=10, color="black")
        plotter.view_xy()
        plotter.enable_parallel_projection()
        plotter.camera.parallel_scale = 1.24
        # Room below for the scale of colours.
        plotter.camera.focal_point, plotter.camera.position = (0, -0.1, 0), (0, -0.1, 10)
        plotter.enable_anti_aliasing("ssaa")
    plotter.set_background("white", all_renderers=True)
    plotter.screenshot(picture)
    # Few colours, so that the file stays small.
    Image.open(picture).convert("RGB").quantize(64).save(picture, optimize=True)


def made(name, program, mmg, folder):
    """The rows of a figure; draws its picture, of 4a that of README too."""
    figure = FIGURES[name]
    options = ["--structures", figure.structure, "--kd-depth", "30", *figure.options]
    rows = meshed(program, mmg, [*options, *PAPER, "--reference", figure.reference], folder / "paper")
    if figure.reference == "exact":
        rows += meshed(program, mmg, [*options, *ADAPTED, "--exact", "no"], folder / "adapted")
    else:  # another reference, and its mesh
        rows += meshed(program, mmg, [*options, *ADAPTED], folder / "adapted")
    meshes = [pyvista.read(row.pop("file")) for row in rows]
    panels = []
    for row, mesh in zip(rows, meshes):
        by_paper = row["command"].count("mean-length")
        is_exact = row["field"] == "exact"
        row["kind"] = ("reference of Table 4" if by_paper and figure.reference != "exact" else "exact field") \
            if is_exact else "paper's procedure" if by_paper else "adapted to δ ≤ 0.1"
        row["L_R_stored"] = stored_l_r(mesh)
        panels.append((row["kind"] if is_exact else f"{figure.structure}, {row['kind']}", mesh))
    exact = [panel for panel in panels if panel[0] == "exact field"]
    stored = [panel for panel in panels if panel[0].startswith("K_")]
    draw([*exact, *stored], PICTURES / file_of(name))
    if name == "4a":
        draw([*exact, stored[-1]], PICTURES / "mesh-exact-and-stored.png")
    return rows


def summary(results):
    lines = ["# The paper's Figures 4a, 4b and 5", "",
             "Made by `bench/pictures/meshes`. Each mesh is of the box [-1, 1]³, sized by sources with g_r 1.25 at "
             "ρ = 1, τ = 1: by the exact field of the sources; by the structure, inserted and graded as in the paper "
             "(mean-length law, ten passes, at most level 30); and by the structure adapted to δ ≤ 0.1. Thin layers by "
             "MMG, isotropic lengths by Gmsh's Delaunay.", "",
             "Of the paper: depth 30, K_V with s_L and lengths [4, 0.25] in 4a, K_oV and isotropic lengths in 4b, "
             "slopes 0 and 0.2 in 5, tetrahedra and L_R. Its mesher is its own, and ρ and τ of its figures are not "
             "known here, nor are the structure and lengths of 5. No tree here reaches level 30: the limit does "
             "not matter.", "",
             "L_R: by the exact field; of the paper's procedure in 4b, and the mesh before it, by the reference of "
             "Table 4. L_R stored: by the field that the mesh was made by. Which of them the paper's L_R is, is not "
             "known here.", "",
             "| figure | sources | paper: tetrahedra, L_R | mesh of | tetrahedra | L_R | L_R stored | "
             "largest sampled δ |",
             "|---|---|---|---|---:|---:|---:|---:|"]
    for name, rows in results.items():
        figure = FIGURES[name]
        for row in rows:
            field = row["kind"] if row["field"] == "exact" else f"{figure.structure}, {row['kind']}"
            delta = "–" if row["field"] == "exact" else f"{row['delta_R_max']:.3g}"
            paper = figure.paper if row["kind"] == "paper's procedure" else ""
            lines.append(f"| {name} | {figure.sources} | {paper} | {field} | {row['tets']} | {row['L_R']:.4f} | "
                         f"{row['L_R_stored']:.4f} | {delta} |")
    lines.append("")
    for name in results:
        lines += [f"![Figure {name}](../../../data/pictures/{file_of(name)})", "",
                  f"*Figure {name}: {FIGURES[name].sources}; colours: mean metric length of edges (1: as requested by "
                  "the field of the mesh).*", ""]
    lines += ["Commands:", ""]
    for rows in results.values():
        for command in dict.fromkeys((row["origin"], row["command"]) for row in rows):
            lines.append(f"- {command[0].partition('), ')[0]}): `{command[1]}`")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--program", default="build/release/bin/controlspace")
    parser.add_argument("--mmg", required=True, help="MMG's program mmg3d_O3")
    parser.add_argument("--only", choices=FIGURES, help="one figure; the others stay as they are")
    parser.add_argument("--output", type=Path, default=ROOT / "bench/results/figures")
    options = parser.parse_args()
    file = options.output / "figures.json"
    kept = json.loads(file.read_text()) if file.exists() else {}
    results = {}
    for name in FIGURES:
        if options.only in (None, name):
            with tempfile.TemporaryDirectory() as folder:
                results[name] = made(name, options.program, options.mmg, Path(folder))
        elif name in kept:
            results[name] = kept[name]
    options.output.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(results, indent=1, ensure_ascii=False) + "\n")
    (options.output / "summary.md").write_text(summary(results))


main()

"""Draws a cross-section of a mesh: python meshes.py MESH.vtu PICTURE.png TITLE

Left the tetrahedra that the plane z = 0 cuts or that lie behind it, as they are; right the same,
coloured by the mean metric length of their edges, where 1 is what the structure asked for.
"""

import sys

import pyvista
from PIL import Image

mesh_file, picture, title = sys.argv[1:]

mesh = pyvista.read(mesh_file)
# Whole tetrahedra, not their sections: those would look smaller than they are.
behind = mesh.clip(normal="z", origin=(0, 0, 0), crinkle=True)

plotter = pyvista.Plotter(off_screen=True, shape=(1, 2), window_size=(1240, 690), border=False)
edges = {"show_edges": True, "line_width": 0.3, "edge_color": "#404040"}


def look():
    plotter.view_xy()
    plotter.enable_parallel_projection()
    plotter.camera.zoom(1.36)
    # Room below for the scale of colours.
    camera = plotter.camera
    shift = -0.05 * (mesh.bounds[3] - mesh.bounds[2])
    camera.focal_point = (camera.focal_point[0], camera.focal_point[1] + shift, 0)
    camera.position = (camera.position[0], camera.position[1] + shift, camera.position[2])
    plotter.enable_anti_aliasing("ssaa")


plotter.subplot(0, 0)
plotter.add_mesh(behind, color="#d8e2ee", ambient=0.35, **edges)
plotter.add_text(f"{title}: {mesh.n_cells} tetrahedra", font_size=8, color="black")
look()
plotter.subplot(0, 1)
plotter.add_mesh(
    behind,
    scalars="edge_length",
    cmap="coolwarm",
    clim=(0.5, 1.5),
    lighting=False,  # which would change the colours
    scalar_bar_args={
        "title": "mean metric length of edges",
        "title_font_size": 14,
        "label_font_size": 12,
        "color": "black",
        "fmt": "%.2f",
        "position_x": 0.25,
        "position_y": 0.01,
        "width": 0.5,
        "height": 0.07,
    },
    **edges,
)
look()
plotter.set_background("white", all_renderers=True)
plotter.screenshot(picture)

# Few colours, so that the file stays small.
Image.open(picture).convert("RGB").quantize(64).save(picture, optimize=True)

# SPDX-License-Identifier: Apache-2.0
"""Draws the surfaces of the meshes of bench/day-one: parts.py FOLDER PICTURE.png"""
import pathlib
import sys

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

# Elevation, azimuth and zoom.
VIEWS = {"bracket": (28, -50, 1.0), "junction": (25, -60, 1.15), "blade": (25, -60, 1.0)}


def read(file):
    """Vertices and triangles of a Medit mesh."""
    words = file.read_text(encoding="ascii").split()

    def rows(name, columns):
        first = words.index(name) + 2
        numbers = np.array(words[first:first + columns * int(words[first - 1])], dtype=float)
        return numbers.reshape(-1, columns)[:, :-1]

    return rows("Vertices", 4), rows("Triangles", 4).astype(int) - 1


def main():
    folder, picture = map(pathlib.Path, sys.argv[1:])
    figure = plt.figure(figsize=(12, 4.4))
    light = np.array([0.3, -0.6, 0.75])
    for i, (name, (elevation, azimuth, zoom)) in enumerate(VIEWS.items()):
        points, triangles = read(next((folder / name).glob("*K_oV.mesh")))
        corners = points[triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        shade = 0.55 + 0.4 * np.abs(normals @ light)[:, None]
        ax = figure.add_axes([i / 3, 0, 1 / 3, 1], projection="3d")
        ax.add_collection3d(Poly3DCollection(
            corners, facecolors=np.clip(shade * [0.72, 0.80, 0.92], 0, 1), edgecolors="#28324a",
            linewidths=0.08))
        low, high = points.min(0), points.max(0)
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
        ax.set_box_aspect(high - low, zoom=zoom)
        ax.view_init(elevation, azimuth)
        ax.set_axis_off()
    figure.savefig(picture, dpi=110)


main()

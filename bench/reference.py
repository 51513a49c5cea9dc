# SPDX-License-Identifier: Apache-2.0
"""Draws how an exact query of tensors grows with the number of sources: reference.py JSON SVG."""
import json
import re
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

NAME = re.compile(r"query/anisotropy:(\d+)/sources:(\d+)/(\w+)/tolerance:([\d.]+)")


def main():
    source, target = sys.argv[1:]
    series = {}
    with open(source, encoding="utf-8") as file:
        for row in json.load(file)["benchmarks"]:
            if match := NAME.fullmatch(row["name"]):
                anisotropy, sources, order, tolerance = match.groups()
                points = series.setdefault((anisotropy, order, float(tolerance)), [])
                points.append((int(sources), 1e6 * row["per_query"]))
    figure, axes = plt.subplots(1, 2, figsize=(8, 3.6), sharey=True, layout="constrained")
    for ax, shown in zip(axes, ("4", "100")):
        for (anisotropy, order, tolerance), points in sorted(series.items()):
            if anisotropy == shown:
                ax.plot(*zip(*sorted(points)), "o-" if order == "walk" else "s--", markersize=4,
                        color="C0" if tolerance > 0.005 else "C1",
                        label=f"{order}, tolerance {tolerance:g}")
        ax.set(xscale="log", yscale="log", xlabel="sources", title=f"sources of {shown} : 1")
        ax.grid(color="#dddddd")
    axes[0].set_ylabel("exact query [µs]")
    axes[0].legend(frameon=False, fontsize=8)
    figure.savefig(target)


main()

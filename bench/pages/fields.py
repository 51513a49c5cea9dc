# SPDX-License-Identifier: Apache-2.0
# Sampled fields of structures: slices, and δ at the probes, from fields/*.npy beside results.json.
import math
from dataclasses import dataclass

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import LogNorm

from .figures import (SMALLEST_ERROR, Spec, colour_bar, drawn, height_of, legend_above, lines_axis,
                      log_axis)
from .results import InputError
from .table import table_of

# The larger an error, the brighter; lengths in colours of their own.
DELTA_COLOURS, LENGTH_COLOURS = "inferno", "viridis"
NUMBERED = 8  # as many structures have their numbers in the cells of a matrix
VISIBLE_ANISOTROPY = 1.01  # below it, lengths in all directions are the same to the eye
COMPONENTS = [[0, 3, 4], [3, 1, 5], [4, 5, 2]]  # xx yy zz xy xz yz as a matrix


@dataclass
class Sample:
    label: str
    row: object           # None: the exact field
    slice: np.ndarray     # (n, n, 6), rows of x at rising y
    probes: np.ndarray    # (m, 6)
    outlines: np.ndarray  # (k, 4): x_low, y_low, x_high, y_high; or None


def loaded(folder, name, *shape):
    """An array of finite or other numbers; `shape` has None where any length does."""
    file = folder / name
    try:
        array = np.load(file, allow_pickle=False)
    except (OSError, ValueError, EOFError) as error:
        raise InputError(f"{file}: cannot be read: run the study again") from error
    fits = len(shape) == array.ndim and all(n in (None, m) for n, m in zip(shape, array.shape))
    if not fits or array.dtype.kind != "f":
        raise InputError(f"{file}: not the array that results.json says: run the study again")
    return array


def sampled_fields(results):
    """(description, exact field, structures) where rows have fields and these are kept, else None."""
    rows = [row for row in results.measured if row.measures.get("fields")]
    if not rows or not (results.folder / "fields").is_dir():
        return None
    try:
        about = rows[0]["fields"]

        def sample(label, row, slice_, probes, outlines=None):
            return Sample(label, row, loaded(results.folder, slice_, None, None, 6),
                          loaded(results.folder, probes, None, None, None, 6).reshape(-1, 6),
                          None if outlines is None else loaded(results.folder, outlines, None, 4))

        exact = sample("exact", None, about["exact_slice"], about["exact_probes"])
        structures = [sample(row.label, row, row["fields"]["slice"], row["fields"]["probes"],
                             row["fields"]["outlines"]) for row in rows]
        if any(s.slice.shape != exact.slice.shape or s.probes.shape != exact.probes.shape
               for s in structures):
            raise InputError(f"{results.folder / 'fields'}: arrays of different shapes")
        return about, exact, structures
    except (KeyError, TypeError) as error:
        raise InputError(f"{results.folder / 'results.json'}: fields: {error}") from error


def mean_length(metrics):
    return metrics[..., :3].mean(axis=-1)


def anisotropy(metrics):
    lengths = np.linalg.eigvalsh(np.nan_to_num(metrics[..., COMPONENTS]))
    with np.errstate(divide="ignore", invalid="ignore"):
        return lengths[..., 2] / lengths[..., 0]


def nonconformity(a, b):
    """δ: the Frobenius norm of A^-1 B + B^-1 A - 2I; infinite where there is no metric."""
    with np.errstate(all="ignore"):
        if not a[..., 3:].any() and not b[..., 3:].any():
            ratio = a[..., :3] / b[..., :3]
            delta = np.linalg.norm((ratio - 1) ** 2 / ratio, axis=-1)
        else:
            p, q = a[..., COMPONENTS], b[..., COMPONENTS]
            excess = np.linalg.solve(p, q) + np.linalg.solve(q, p) - 2 * np.eye(3)
            delta = np.linalg.norm(excess, axis=(-2, -1))
    return np.where(np.isnan(delta), np.inf, delta)


def percentiles(values, which=(95, 99, 100)):
    """The least values that at least so many per cent do not exceed (nearest rank)."""
    ordered = np.sort(values, axis=None)
    return [float(ordered[math.ceil(len(ordered) * p / 100) - 1]) for p in which]


def delta_figure(sampled):
    _, exact, structures = sampled
    low, high, classes = SMALLEST_ERROR, 20, 60
    edges = np.geomspace(low, high, classes + 1)
    marks = [("95th percentile", "|", "black", 14), ("99th percentile", "o", "#D55E00", 6),
             ("maximum", "x", "#D55E00", 6)]

    def plot(figure):
        ax = figure.subplots()
        n = len(structures)
        found = []
        for i, sample in enumerate(structures):
            delta = nonconformity(sample.probes, exact.probes)
            shares, _ = np.histogram(np.clip(delta, low, high), edges)
            ax.stairs(n - i + 0.8 * shares / shares.max(), edges, baseline=n - i, fill=True,
                      color="#56B4E9")
            found.append(percentiles(delta))
        for values, (label, mark, colour, size) in zip(zip(*found), marks):
            ax.plot([min(drawn(v), 2 * high) for v in values], np.arange(n, 0, -1) + 0.25, mark,
                    label=label, color=colour, markersize=size, markerfacecolor="none")
        lines_axis(ax, [sample.label for sample in structures])
        ax.set_ylim(0.8, n + 1)
        log_axis(ax.xaxis, "δ to the exact field", low, high)
        legend_above(ax)
    yield Spec("delta", {}, plot, height=height_of(len(structures), 40))


def delta_table(sampled):
    _, exact, structures = sampled
    rows = []
    for sample in structures:
        values = percentiles(nonconformity(sample.probes, exact.probes))
        stored = [sample.row[f"delta_R_{key}"] for key in ("p95", "p99", "max")]
        rows.append([sample.label, *(f"{v:.4f} ({s:.4f})" for v, s in zip(values, stored))])
    return table_of("delta", rows)


PAIR_PERCENTILES = [("95th percentile", 95), ("maximum", 100)]


def pair_deltas(sampled):
    """Labels, and a matrix of δ between any two for each of PAIR_PERCENTILES."""
    _, exact, structures = sampled
    samples = [exact, *structures]
    n = len(samples)
    pairs = np.zeros((len(PAIR_PERCENTILES), n, n))
    for i in range(n):
        for j in range(i):
            values = percentiles(nonconformity(samples[i].probes, samples[j].probes),
                                 [p for _, p in PAIR_PERCENTILES])
            pairs[:, i, j] = pairs[:, j, i] = values
    return [sample.label for sample in samples], pairs


def short(value):
    return f"{value:.0e}" if 0 < value < 0.01 else f"{value:.2g}"


def cross_validation(sampled):
    labels, pairs = pair_deltas(sampled)
    n = len(labels)
    for (title, _), values in zip(PAIR_PERCENTILES, pairs):
        def plot(figure, values=values):
            ax = figure.subplots()
            image = ax.imshow(np.maximum(values, SMALLEST_ERROR), cmap=DELTA_COLOURS,
                              norm=LogNorm(SMALLEST_ERROR, 10), aspect="auto")
            for (i, j), value in np.ndenumerate(values if n <= NUMBERED else []):
                ax.text(j, i, short(value), ha="center", va="center", fontsize=9,
                        color="black" if value > 0.5 else "white")
            ax.set_xticks(range(n), labels, rotation=60, ha="right", rotation_mode="anchor")
            ax.set_yticks(range(n), labels)
            ax.grid(False)
            colour_bar(image, ax, "δ between two structures")
        yield Spec("cross-validation", {"which": title}, plot, height=360 + 20 * n, raster=True)


def pairs_table(sampled):
    labels, pairs = pair_deltas(sampled)
    rows = [[f"{a}, {b}", *(short(values[i, j]) for values in pairs)]
            for i, a in enumerate(labels) for j, b in enumerate(labels) if j < i]
    return table_of("pairs", rows)


def sides_and_axis(about):
    """The sides of the domain, and the axis across the slice: that of a plane, or z."""
    sides = [about["domain"][i:i + 2] for i in (0, 2, 4)]
    return sides, next((a for a in range(3) if sides[a][0] == sides[a][1]), 2)


def slice_place(sampled):
    about = sampled[0]
    return f"{'xyz'[sides_and_axis(about)[1]]} = {about['z']:.4g}"


def slice_figures(sampled):
    """The exact field, then each structure and its error."""
    about, exact, structures = sampled
    sides, across = sides_and_axis(about)
    (x0, x1), (y0, y1) = (side for a, side in enumerate(sides) if a != across)
    x_name, y_name = ("xyz"[a] for a in range(3) if a != across)
    measures = [("h_mean [length]", mean_length)]
    if np.nanmax(anisotropy(exact.slice)) > VISIBLE_ANISOTROPY:
        measures.append(("anisotropy", anisotropy))
    norms = []
    for _, measure in measures:
        values = measure(exact.slice)
        known = values[np.isfinite(values) & (values > 0)]
        norms.append(LogNorm(known.min(), max(known.max(), 1.01 * known.min())))

    def panel(ax, values, label, norm, colours, outlines=None):
        image = ax.imshow(values, extent=(x0, x1, y0, y1), origin="lower", cmap=colours, norm=norm,
                          interpolation="nearest")
        if outlines is not None:
            corners = outlines[:, [[0, 3], [0, 1], [2, 1]]]  # left and lower sides
            ax.add_collection(LineCollection(corners, colors="white", linewidths=0.3, alpha=0.5))
        ax.set(xlabel=f"{x_name} [length]", ylabel=f"{y_name} [length]", xlim=(x0, x1), ylim=(y0, y1))
        ax.grid(False)
        colour_bar(image, ax, label)

    for sample in [exact, *structures]:
        def plot(figure, sample=sample):
            panels = [(measure(sample.slice), name, norm, LENGTH_COLOURS, sample.outlines)
                      for (name, measure), norm in zip(measures, norms)]
            if sample.row:
                delta = np.maximum(nonconformity(sample.slice, exact.slice), SMALLEST_ERROR)
                panels.append((delta, "error δ", LogNorm(SMALLEST_ERROR, 10), DELTA_COLOURS))
            axes = figure.subplots(1, max(2, len(panels)), squeeze=False)[0]
            for ax, content in zip(axes, panels):
                panel(ax, *content)
                ax.set_xticks([x0, x1])
                ax.set_yticks([y0, y1])
            for ax in axes[len(panels):]:
                ax.set_axis_off()
        cells = "" if sample.outlines is not None or not sample.row else " (too many cells)"
        yield Spec("slice", {"label": (sample.label if sample.row else "exact field") + cells},
                   plot, width=440 + 220 * (len(measures) - 1), height=300, raster=True)

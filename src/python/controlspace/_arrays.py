# SPDX-License-Identifier: Apache-2.0
"""Arguments as the C library reads them; ValueError for what cannot be used."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def numbers(name: str, values: ArrayLike) -> Array:
    """`values` as doubles in C order; copied only if they are not."""
    try:
        array = np.asarray(values)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} is no array of numbers: {error}") from None
    if np.ma.is_masked(values):
        raise ValueError(f"{name} has masked entries: leave these out, or fill them in")
    if array.dtype.kind not in "fiub":
        raise ValueError(f"{name} has the dtype {array.dtype}: give real numbers")
    return np.require(array, np.float64, ["C", "A"])


def number(name: str, value: Any) -> float:
    array = numbers(name, value)
    if array.ndim != 0:
        raise ValueError(f"{name} has the shape {array.shape}: give one number")
    return float(array)


def length(name: str, value: Any) -> float:
    h = number(name, value)
    if not 0 < h < np.inf:
        raise ValueError(f"{name} is {h}: give a positive length")
    return h


def places(name: str, x: ArrayLike) -> Array:
    array = numbers(name, x)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} has the shape {array.shape}: give (n, 3)")
    return array


def require_all(good: NDArray[np.bool_] | np.bool_, name: str, what: str, values: Array) -> None:
    """Raises ValueError for the first row that is not good."""
    if good.all():
        return
    i = int(np.argmin(good))
    raise ValueError(f"{name}[{i}] is {values[i].tolist()}: {what}")


def source_places(points: ArrayLike) -> Array:
    array = places("points", points)
    if len(array) == 0:
        raise ValueError("points is empty: give at least one source")
    require_all(np.isfinite(array).all(axis=1), "points", "give finite coordinates", array)
    return array


def metrics(
    h: ArrayLike, n: int, h_min: float | None = None, h_max: float | None = None
) -> tuple[Array, float]:
    """Lengths (n,) or metrics (n, 6), their lengths limited to [h_min, h_max]; and the smallest."""
    array = numbers("h", h)
    if array.shape not in ((n,), (n, 6), (n, 3, 3)):
        raise ValueError(f"h has the shape {array.shape}: give ({n},), ({n}, 6) or ({n}, 3, 3)")
    least = 0.0 if h_min is None else length("h_min", h_min)
    most = np.inf if h_max is None else length("h_max", h_max)
    if least > most:
        raise ValueError(f"h_min is {least} and h_max {most}: give h_min <= h_max")
    is_limited = h_min is not None or h_max is not None
    if array.ndim == 1:
        good = (array > 0) & (array < np.inf)
        require_all(good, "h", "give a positive length", array)
        array = np.clip(array, least, most) if is_limited else array
        return array, float(array.min())
    rows = array.reshape(n, -1)
    require_all(np.isfinite(rows).all(axis=1), "h", "give finite numbers", array)
    if array.ndim == 3:
        uneven = np.abs(array - array.transpose(0, 2, 1)).max(axis=(1, 2))
        symmetric = uneven <= 1e-10 * np.abs(rows).max(axis=1)
        require_all(symmetric, "h", "give a symmetric tensor", array)
        array = six(array)
    lengths, directions = np.linalg.eigh(matrices(array))
    require_all(lengths[:, 0] > 0, "h", "the tensor is not positive definite", array)
    if is_limited:
        lengths = np.clip(lengths, least, most)
        array = six(lengths[:, None, :] * directions @ directions.transpose(0, 2, 1))
    return array, float(lengths.min())


def growths(growth: ArrayLike, n: int) -> tuple[float, Array | None]:
    """The ratio of the field, and those of the sources if they have their own."""
    array = numbers("growth", growth)
    if array.shape not in ((), (n,)):
        raise ValueError(f"growth has the shape {array.shape}: give one number, or ({n},)")
    good = (array >= 1) & (array <= 1e6)
    if array.ndim == 0:
        if not good:
            raise ValueError(f"growth is {array}: give 1 or more, up to 1e6")
        return float(array), None
    require_all(good, "growth", "give 1 or more, up to 1e6", array)
    return float(array.max()), array


def matrices(m: Array) -> Array:
    """(n, 6) as (n, 3, 3)."""
    return np.take(m, (0, 3, 4, 3, 1, 5, 4, 5, 2), axis=1).reshape(-1, 3, 3)


def six(m: Array) -> Array:
    """(n, 3, 3), symmetric, as (n, 6)."""
    return np.take(m.reshape(-1, 9), (0, 4, 8, 3, 6, 7), axis=1)


def box_around(points: Array, box: ArrayLike | None) -> Array:
    """The lowest and the highest corner, (2, 3)."""
    if box is None:
        low, high = points.min(axis=0), points.max(axis=0)
        extent = (high - low).max() or 1.0
        outwards = np.where(high > low, 0.05, 0.55) * extent
        return np.array([low - outwards, high + outwards])
    given = numbers("box", box)
    if given.shape not in ((2, 3), (6,)):
        raise ValueError(f"box has the shape {given.shape}: give its two corners, (2, 3)")
    given = given.reshape(2, 3)
    inside = ((points >= given[0]) & (points <= given[1])).all(axis=1)
    require_all(inside, "points", f"it lies outside the box {given.tolist()}", points)
    return given


def path(name: str, file: str | os.PathLike[str]) -> bytes:
    try:
        encoded = os.fsencode(file)
    except TypeError as error:
        raise ValueError(f"{name} is no path: {error}") from None
    if not encoded or b"\0" in encoded:
        raise ValueError(f"{name} is {encoded!r}: give a path")
    return encoded

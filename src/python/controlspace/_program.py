# SPDX-License-Identifier: Apache-2.0
"""The program `controlspace`, which comes with the package, as a process of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, Sequence

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays

# Either from the package, or from a build folder.
_FILE = os.environ.get("CONTROLSPACE_PROGRAM") or Path(__file__).parent / "bin" / "controlspace"
_BAD_INPUT, _SOME_MISSED = 2, 3


def _words(key: str, value: Any) -> list[str]:
    option = "--" + key.replace("_", "-")
    if value is True:
        return [option]
    if isinstance(value, tuple):
        return [option, *map(str, value)]
    if isinstance(value, list):
        value = ",".join(map(str, value))
    return [option, str(value)]


def run(*words: str, **options: Any) -> None:
    """Runs the program; its error becomes a ValueError or RuntimeError."""
    command = [os.fspath(_FILE), *words, "--quiet"]
    for key, value in options.items():
        command += _words(key, value)
    if any("\0" in word for word in command):
        raise ValueError("an option holds the character NUL: leave it out")
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if done.returncode in (0, _SOME_MISSED):
        return
    lines = done.stderr.strip().splitlines() or [f"status {done.returncode}"]
    reason = lines[-1].removeprefix("controlspace: error: ")
    raise (ValueError if done.returncode == _BAD_INPUT else RuntimeError)(reason)


def compare(
    points: ArrayLike,
    h: ArrayLike,
    structures: Sequence[str] | None = None,
    box: ArrayLike | None = None,
    growth: ArrayLike = 1.25,
    delta: float | None = None,
    **settings: Any,
) -> list[dict[str, Any]]:
    """Builds structures of the same sources and measures them: one dict for each.

    points, h, growth: as in `build`. box: None: as `controlspace compare` chooses it. delta: None:
    structures are inserted and graded. structures: names (None: all). Rows are those of
    results.json: among others "structure", "bytes_total" [bytes], "t_creation_s" [s],
    "t_access_ns_random" [ns] and "delta_R_max"; None where there is no value.
    settings: options of `controlspace compare`, with _ for -: a list becomes words with commas, a
    tuple several words, True an option alone: `tau=[0.5, 1]`, `probe_grid=10`.

    ValueError for what cannot be used; RuntimeError if the program fails. Takes seconds and more.
    """
    points = _arrays.source_places(points)
    m, _ = _arrays.metrics(h, len(points))
    ratio, growths = _arrays.growths(growth, len(points))
    settings |= {"g_r": ratio}
    if structures is not None:
        settings["structures"] = list(structures)
    if box is not None:
        settings["domain"] = tuple(_arrays.box_around(points, box).T.ravel().tolist())
    if delta is not None:
        settings["target_delta"] = _arrays.length("delta", delta)
    header = "x,y,z,h" if m.ndim == 1 else "x,y,z,m_xx,m_yy,m_zz,m_xy,m_xz,m_yz"
    with tempfile.TemporaryDirectory() as folder:
        sources, results = Path(folder, "sources.csv"), Path(folder, "results")
        rows = np.column_stack([points, m] if growths is None else [points, m, growths])
        header += "" if growths is None else ",g"
        np.savetxt(sources, rows, "%.17g", ",", header=header, comments="")
        run("compare", sources=sources, output=results, **settings)
        measured: list[dict[str, Any]] = json.loads((results / "results.json").read_text())["rows"]
        return measured


def main() -> None:
    """The command `controlspace`."""
    os.execv(_FILE, [os.fspath(_FILE), *sys.argv[1:]])

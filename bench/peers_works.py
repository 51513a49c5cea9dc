# SPDX-License-Identifier: Apache-2.0
"""The works on which bench/peers compares systems: peers_works.py FOLDER [--quick] [--only WORK]... writes
FOLDER/WORK/study.toml, and the sources that the program does not sample itself.

A work is a function that returns settings of a study; the first line of its documentation is its title. Its
argument `quick` asks for fewer sources.
"""
import argparse
import json
import pathlib
import subprocess
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
UNIT_CUBE = [0, 1, 0, 1, 0, 1]
LAYERS = {"s_a": 4, "s_n": 0.25}

# All are measured like this; resolutions are chosen at the probes of both grids, and access is timed at the
# coarser one.
STUDY = {"splits": "s_L"}
TREES = ["K_L", "K_V", "K_oL", "K_oV", "K_LA", "K_oLA"]
GRIDS = ["uniform-nearest", "uniform-trilinear", "openvdb-vec3s-trilinear"]
OF_SIZES = ["openvdb-uniform-nearest", "openvdb-uniform-trilinear", "direct"]
DELTAS = [0.1, 0.02]


def sphere(folder, quick):
    """Sphere of the paper, isotropic"""
    return {"sources": "sphere", "h": 0.04 if quick else 0.015}


def planes(folder, quick):
    """Planes of the paper, isotropic"""
    return {"sources": "planes", "h": 0.04 if quick else 0.015}


def sphere_layers(folder, quick):
    """Sphere, lengths [4, 0.25]: 4:1"""
    return {"sources": "sphere", "h": 0.08 if quick else 0.06, "rho": 3, **LAYERS}


def planes_layers(folder, quick):
    """Planes, lengths [4, 0.25]: 4:1"""
    return {"sources": "planes", "h": 0.08 if quick else 0.06, "rho": 3, **LAYERS}


def thin_layers(folder, quick):
    """Sphere, layers of 100:1"""
    return {"sources": "sphere", "h": 0.12 if quick else 0.1, "s_a": 10, "s_n": 0.01,
            "rho": 8 if quick else 6}


def scattered(folder, quick):
    """Sphere, sources scattered at random"""
    return {"sources": "sphere", "h": 0.04 if quick else 0.015, "sampling": "random"}


def clustered(folder, quick):
    """Sphere, sources in clusters"""
    return {"sources": "sphere", "h": 0.04 if quick else 0.015, "sampling": "clustered"}


def ugawg_linear(folder, quick):
    """UGAWG's linear metric at scattered points"""
    x = scattered_points(quick)
    ones = np.ones(len(x))
    return tensors(folder, x, 0.1 * ones, 0.1 * ones, across(x[:, 2]), 0 * ones)


def ugawg_polar(folder, quick):
    """UGAWG's first polar metric at scattered points"""
    x = scattered_points(quick)
    r = np.hypot(x[:, 0], x[:, 1])
    h, c, s = across(r), x[:, 0] / r, x[:, 1] / r
    return tensors(folder, x, h * c**2 + 0.1 * s**2, h * s**2 + 0.1 * c**2, np.full(len(x), 0.1), (h - 0.1) * c * s)


def across(coordinate):
    """UGAWG's length across its layer, from 0.001 to 0.1."""
    return 0.001 + 0.198 * np.abs(coordinate - 0.5)


def predicted(folder, quick):
    """Metrics predicted from a solution's Hessian, at scattered points"""
    x = scattered_points(quick)
    # u = tanh(20 (x + y² / 2 - 0.8)) + sin(3 z) / 3 with an error of 0.01.
    f = np.tanh(20 * (x[:, 0] + x[:, 1] ** 2 / 2 - 0.8))
    first, second = 20 * (1 - f**2), -800 * f * (1 - f**2)
    hessian = np.zeros((len(x), 3, 3))
    gradient = np.stack([np.ones(len(x)), x[:, 1], np.zeros(len(x))], axis=1)
    hessian += second[:, None, None] * gradient[:, :, None] * gradient[:, None, :]
    hessian[:, 1, 1] += first
    hessian[:, 2, 2] = -3 * np.sin(3 * x[:, 2])
    values, vectors = np.linalg.eigh(hessian)
    lengths = np.clip(np.sqrt(0.01 / np.maximum(np.abs(values), 1e-9)), 0.005, 0.2)
    m = np.einsum("nik,nk,njk->nij", vectors, lengths, vectors)
    return tensors(folder, x, m[:, 0, 0], m[:, 1, 1], m[:, 2, 2], m[:, 0, 1], m[:, 0, 2], m[:, 1, 2])


def bracket(folder, quick):
    """Bracket: curvature and thickness"""
    return part(folder, quick)


def junction(folder, quick):
    """Junction of pipes: curvature and thickness"""
    return part(folder, quick)


def blade(folder, quick):
    """Blade: curvature and thickness"""
    return part(folder, quick)


def coast(folder, quick):
    """Fractal coast line in a plane"""
    x = coast_line(2**13 if quick else 2**20)
    h = 0.004 + 0.012 * np.cos(3 * x[:, 0]) ** 2
    np.savetxt(folder / "sources.csv", np.c_[x, 0 * h, h], "%.9g", ",", header="x,y,z,h", comments="")
    return {"sources": "sources.csv", "domain": [0, 2, 0, 1, 0, 0], "creation_repeats": 1}


ISOTROPIC, TENSORS = (
    {function.__name__.replace("_", "-"): function for function in functions} for functions in (
        (sphere, planes, scattered, clustered, bracket, junction, blade, coast),
        (sphere_layers, planes_layers, thin_layers, ugawg_linear, ugawg_polar, predicted)))
WORKS = {**ISOTROPIC, **TENSORS}


def coast_line(count):
    """`count` points or more, at most twice as many, of a closed line in [0, 2] x [0, 1]: midpoints of edges,
    displaced across them at random, again and again; of dimension 1.2."""
    random = np.random.default_rng(1)
    x = np.array([[0.3, 0.3], [1.1, 0.2], [1.7, 0.5], [0.8, 0.8]])
    while len(x) < count:
        edge = np.roll(x, -1, axis=0) - x
        shift = random.normal(0, 0.16, len(x))[:, None] * edge[:, ::-1] * [-1, 1]
        x = np.stack([x, x + edge / 2 + shift], axis=1).reshape(-1, 2)
    return np.clip(x, [0, 0], [2, 1])


def scattered_points(quick):
    return np.random.default_rng(1).uniform(0, 1, (60 if quick else 150, 3))


def tensors(folder, x, *components):
    """Settings of sources of tensors: xx, yy, zz, xy and, where they are not 0, xz and yz."""
    m = np.zeros((len(x), 6))
    m[:, :len(components)] = np.stack(components, axis=1)
    np.savetxt(folder / "sources.csv", np.c_[x, m], "%.9g", ",",
               header="x,y,z,m_xx,m_yy,m_zz,m_xy,m_xz,m_yz", comments="")
    return {"sources": "sources.csv", "domain": UNIT_CUBE}


def part(folder, quick):
    if not (folder.parent / f"{folder.name}.step").exists():
        subprocess.run([sys.executable, HERE / "parts.py", folder.parent], check=True,
                       stdout=subprocess.DEVNULL)
    return {"sources": f"../{folder.name}.step", "isotropic": True,
            "surface_angle": 45 if quick else 15,
            # Their lengths differ most: background meshes take a minute for these bytes.
            "max_memory": 0.03 if quick else 0.1, "creation_repeats": 1}


def study_of(name, folder, quick, structures):
    """The text of a study file."""
    make = WORKS[name]
    is_tensor = name in TENSORS
    # The exact field of tensors takes 20 times as long, at each probe and each node, and so do answers of trees
    # that hold sources: fewer places are timed. `direct` computes it for each answer, and is left out there; so
    # are grids whose nodes are those of others.
    probes, fine = ((15, 20) if quick else (20, 31)) if is_tensor else (30, 61)
    memory = (0.01 if quick else 0.02) if is_tensor else (0.05 if quick else 0.2)
    study = {"name": name, **STUDY, "creation_repeats": 1 if quick or is_tensor else 3,
             "access_points": 5000 if is_tensor else 20000,
             "access_repeats": 5 if quick else 9, "probe_grid": probes, "fine_probe_grid": fine,
             "max_memory": memory, **make(folder, quick)}
    deltas = DELTAS[:1] if quick and is_tensor else DELTAS
    others = GRIDS + ([] if is_tensor else OF_SIZES)
    # Trees that are only read, as most of the foreign systems are.
    # Adaptation samples fields of tensors, and the probes find a little more: it aims lower.
    targets = [round(0.9 * delta, 4) for delta in deltas] if is_tensor else deltas
    runs = [{"structures": TREES, "target_delta": targets, "precision": "double"}, {"structures": others, "equal_delta": deltas},
            {"structures": structures, "target_delta": targets, "equal_delta": deltas}]
    runs = [run for run in runs if run["structures"]]

    def lines(table):
        return "".join(f"{key} = {json.dumps(value)}\n" for key, value in table.items())

    return f"# {make.__doc__}\n{lines(study)}" + "".join(f"\n[[runs]]\n{lines(run)}" for run in runs)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--only", action="append", choices=list(WORKS))
    parser.add_argument("--structures", default="peers", help="beside those of the project")
    options = parser.parse_args()
    for name in options.only or WORKS:
        folder = options.folder / name
        folder.mkdir(parents=True, exist_ok=True)
        text = study_of(name, folder, options.quick, [s for s in options.structures.split(",") if s])
        (folder / "study.toml").write_text(text, encoding="utf-8")
        print(name)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Golden numbers of the metric algebra, by textbook formulas in 60-digit arithmetic.

    python3 metric_golden.py > metric_golden.csv      (needs NumPy and mpmath)

The tensors are drawn in double precision and then taken as exact; everything after that uses
mpmath's symmetric eigensolver, and none of the project's formulas:
  intersection        r = 1/sqrt of  A^1/2 max(1, A^-1/2 B A^-1/2) A^1/2,  A = a^-2, B = b^-2
  nonconformity       Frobenius norm of  a^-1 b + b^-1 a - 2 I
  riemannian          the same of A and B
  eigenvalues of a, ascending
  metric_length       |a^-1 v|
Where a pair is mild (anisotropy up to 10) the intersection and the eigenvalues were also computed
with numpy.linalg.eigh, and the script fails unless both agree to 1e-12.
"""
import sys

import mpmath as mp
import numpy as np

mp.mp.dps = 60
rng = np.random.default_rng(20240117)


def rotation():
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    return q * np.sign(np.diag(r))


def tensor(lengths, frame):
    m = frame @ np.diag(lengths) @ frame.T
    return (m + m.T) / 2


def spectral(m, f):
    values, vectors = mp.eigsy(m)
    return vectors * mp.diag([f(x) for x in values]) * vectors.T


def intersection(a, b):
    root = spectral(a, lambda h: 1 / h)
    inverse_root = a
    reduced = inverse_root * spectral(b, lambda h: 1 / h**2) * inverse_root
    cut = spectral((reduced + reduced.T) / 2, lambda x: max(mp.mpf(1), x))
    result = root * cut * root
    return spectral((result + result.T) / 2, lambda x: 1 / mp.sqrt(x))


def nonconformity(a, b):
    return mp.norm(a**-1 * b + b**-1 * a - 2 * mp.eye(3), 2)


def np_spectral(m, f):
    values, vectors = np.linalg.eigh(m)
    return vectors @ np.diag(f(values)) @ vectors.T


def np_intersection(a, b):
    root = np_spectral(a, lambda h: 1 / h)
    reduced = a @ np_spectral(b, lambda h: h**-2.0) @ a
    result = root @ np_spectral(reduced, lambda x: np.maximum(1, x)) @ root
    return np_spectral(result, lambda x: x**-0.5)


def six(m):
    return [m[0, 0], m[1, 1], m[2, 2], m[0, 1], m[0, 2], m[1, 2]]


def lengths(decades):
    return 10 ** rng.uniform(-decades / 2, decades / 2, 3)


def pairs():
    for decades, size, n in ((1, 0.5, 80), (3, 1, 80), (6, 2, 80), (6, 6, 20)):
        for _ in range(n):
            yield (f"anisotropy-1e{decades}", tensor(lengths(decades), rotation()),
                   10 ** rng.uniform(-size, size) * tensor(lengths(decades), rotation()))
    for kind, thin in (("plates-1e6", (1e-6, 1, 1)), ("needles-1e6", (1e-6, 1e-6, 1))):
        for _ in range(30):
            size = 10 ** rng.uniform(-3, 3)
            yield (kind, tensor(np.array(thin) * rng.uniform(1, 2, 3), rotation()),
                   tensor(size * np.array(thin) * rng.uniform(1, 2, 3), rotation()))
    for _ in range(20):
        yield "isotropic", 10 ** rng.uniform(-1, 1) * np.eye(3), tensor(lengths(3), rotation())
    for _ in range(20):
        yield "axis-aligned", np.diag(lengths(3)), tensor(lengths(3), rotation())
    for _ in range(20):
        frame = rotation()
        yield "same-frame", tensor(lengths(3), frame), tensor(lengths(3), frame)
    for k in range(20):
        frame, near = rotation(), 1 + 10.0 ** (-k - 1)
        yield ("near-equal-lengths", tensor([1, near, near * near], frame),
               tensor([0.5, 2, 2 * near], rotation()))
    for k in range(20):
        m = tensor(lengths(2), rotation())
        noise = rng.normal(size=(3, 3)) * 10.0 ** (-k - 1) * np.abs(m).min()
        yield "near-equal-metrics", m, m + (noise + noise.T) / 2


def main():
    print("# Made by metric_golden.py; tensors as xx yy zz xy xz yz")
    names = [f"{t}_{c}" for t in "abr" for c in ("xx", "yy", "zz", "xy", "xz", "yz")]
    names += ["nonconformity", "riemannian", "h1", "h2", "h3", "vx", "vy", "vz", "metric_length"]
    print(",".join(["kind"] + names))
    for kind, a, b in pairs():
        v = rng.normal(size=3)
        ea, eb, ev = mp.matrix(a.tolist()), mp.matrix(b.tolist()), mp.matrix(v.tolist())
        r = intersection(ea, eb)
        values = sorted(mp.eigsy(ea, eigvals_only=True))
        if kind == "anisotropy-1e1":
            by_numpy = np_intersection(a, b)
            assert np.allclose(by_numpy, np.array(r.tolist(), float), rtol=0,
                               atol=1e-12 * np.abs(by_numpy).max())
            assert np.allclose(np.linalg.eigh(a)[0], np.array(values, float), rtol=1e-12)
        row = six(a) + six(b) + six(r)
        row += [nonconformity(ea, eb), nonconformity(ea**-2, eb**-2)]
        row += values + list(v) + [mp.norm(ea**-1 * ev, 2)]
        print(",".join([kind] + [repr(float(x)) for x in row]))


if __name__ == "__main__":
    sys.exit(main())

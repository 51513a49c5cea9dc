# SPDX-License-Identifier: Apache-2.0
"""Fields: how they are built, and what they answer."""

from __future__ import annotations

import ctypes
import os
import tempfile
import warnings
from pathlib import Path
from typing import Any, NoReturn, overload

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _program
from ._arrays import Array
from ._library import Options, Sources, call, call_until_interrupted, library, size_at

# Where xx yy zz xy xz yz go.
_ORDERS = {
    "mmg": (0, 3, 4, 1, 5, 2),
    "medit": (0, 3, 1, 4, 5, 2),
    "gmsh": (0, 3, 4, 3, 1, 5, 4, 5, 2),
}
_HXT = 10
# A field must outlive its callback, of which Gmsh does not tell when a model drops it. The key is
# the names of all other models: where they are the same again, the callback of the earlier field
# was replaced, or its model removed. Models of one name cannot be told apart: their key is an
# object of its own, so that their fields are kept.
_in_gmsh: dict[object, Field] = {}


class Field:
    """A metric at every point of a box; made by `build` and `load`. Reading is thread-safe.

    Places are arrays (n, 3) of coordinates; n may be 0. Those outside the box get the metric of
    the box's nearest point. Other shapes and dtypes, and NaN, raise ValueError.
    """

    __slots__ = ("_handle", "_delta", "__weakref__")
    _handle: int | None
    _delta: float | None

    def __init__(self) -> None:
        raise TypeError("a Field is made by controlspace.build or controlspace.load")

    def __del__(self) -> None:
        handle = getattr(self, "_handle", None)
        if handle is not None:
            library.cspace_free(handle)

    def __reduce__(self) -> NoReturn:
        raise TypeError("a Field is neither copied nor pickled: save it to a file")

    @property
    def box(self) -> Array:
        """The box, (2, 3): its lowest and its highest corner."""
        box = np.empty((2, 3))
        call("domain", self._handle, box.ctypes.data)
        return box

    @property
    def delta(self) -> float | None:
        """Non-conformity that `build` reached; None if the field was not adapted, or loaded."""
        return self._delta

    def metric(self, x: ArrayLike) -> Array:
        """Metrics M at the places `x` (n, 3): (n, 6), xx yy zz xy xz yz, in lengths."""
        x = _arrays.places("x", x)
        m = np.empty((len(x), 6))
        call("sample", self._handle, len(x), x.ctypes.data, m.ctypes.data)
        return m

    @overload
    def size(self, x: ArrayLike) -> Array: ...
    @overload
    def size(self, x: float, y: float, z: float) -> float: ...

    def size(self, x: Any, y: Any = None, z: Any = None) -> Any:
        """The smallest length that the metric requests in any direction.

        `size(x)`, with places (n, 3), returns (n,); `size(x, y, z)`, one place, a float.
        """
        if z is not None:
            try:
                h = size_at(self._handle, x, y, z)
            except ctypes.ArgumentError as error:
                raise ValueError(f"a place is three numbers: {error}") from None
            if h == h:
                return h
            raise ValueError(f"the place ({x}, {y}, {z}) is NaN")
        if y is not None:
            raise ValueError("a place is three numbers: give x, y and z, or an array (n, 3)")
        x = _arrays.places("x", x)
        h = np.empty(len(x))
        call("sample_lengths", self._handle, len(x), x.ctypes.data, h.ctypes.data)
        return h

    def riemannian(self, x: ArrayLike, order: str = "mmg") -> Array:
        """Riemannian metrics M^-2 at the places `x` (n, 3), in 1 / length^2.

        order: "mmg", (n, 6): m11 m12 m13 m22 m23 m33, as in MMG's functions and mmgpy;
        "medit", (n, 6): m11 m12 m22 m13 m23 m33, as in .sol files;
        "gmsh", (n, 9): the rows of the matrix, as in the tensors of Gmsh's views.
        """
        if order not in _ORDERS:
            raise ValueError(f"order is {order!r}: give one of {', '.join(_ORDERS)}")
        m = self.metric(x)
        call("to_riemannian", len(m), m.ctypes.data, m.ctypes.data)
        return np.take(m, _ORDERS[order], axis=1)

    def edge_length(self, a: ArrayLike, b: ArrayLike) -> Array:
        """Metric lengths (n,) of the edges from the places `a` (n, 3) to `b` (n, 3).

        Simpson's rule for the integral of |M^-1 dx|; an edge as long as requested has length 1.
        """
        a, b = _arrays.places("a", a), _arrays.places("b", b)
        if a.shape != b.shape:
            raise ValueError(f"a has the shape {a.shape}, b {b.shape}: give one end for each")
        lengths = np.empty(len(a))
        addresses = a.ctypes.data, b.ctypes.data, lengths.ctypes.data
        call("edge_lengths", self._handle, len(a), *addresses)
        return lengths

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes a .ctrl file, or a .vdb for one of openvdb-tiles or openvdb-bricks, whose lengths
        are then floats; whole or not at all. ValueError where that fails."""
        call("save", self._handle, _arrays.path("file", file))

    def export(self, file: str | os.PathLike[str], **options: Any) -> None:
        """Writes `file` as `controlspace export`; its ending names the format: .vtu, .vti, .htg,
        .npy, .pos, .csv, .structured, .msz, .msh, or .sol and .solb with mesh="its.mesh".

        Options are those of the program, `slice=("z", 0.1)` for `--slice z 0.1`, written as in
        `compare`. ValueError for an option or ending that cannot be used.
        """
        output = os.path.abspath(os.fsdecode(_arrays.path("file", file)))
        with tempfile.TemporaryDirectory() as folder:
            saved = Path(folder, "field.ctrl")
            self.save(saved)
            _program.run("export", str(saved), output=output, **options)

    def gmsh(self, factor: float | None = None) -> None:
        """Makes Gmsh's current model ask this field for sizes, without Python in between.

        Needs the `gmsh` module, initialized. The field replaces sizes at points and from
        boundaries; smaller ones, of curvature or background fields, still count. `factor` scales
        all sizes, as Gmsh makes edges longer than requested; left out: 0.70 for HXT, 0.77 for other
        algorithms (set Mesh.Algorithm3D before). The field is kept as long as a model may ask it.
        RuntimeError where Gmsh fails.
        """
        import gmsh

        try:
            others = gmsh.model.list()
        except Exception:  # the only class that the module raises
            others = []
        if not others:
            raise RuntimeError("Gmsh is not initialized: call gmsh.initialize() first")
        current = gmsh.model.getCurrent()
        others.remove(current)
        if factor is None:
            is_hxt = gmsh.option.getNumber("Mesh.Algorithm3D") == _HXT
            factor = 0.70 if is_hxt else 0.77
        scale = _arrays.length("factor", factor)
        passes_lc = (gmsh.GMSH_API_VERSION_MAJOR, gmsh.GMSH_API_VERSION_MINOR) >= (4, 9)
        callback = library.cspace_gmsh_size if passes_lc else library.cspace_gmsh_size_4_8
        failed = ctypes.c_int()
        gmsh.lib.gmshModelMeshSetSizeCallback(
            ctypes.cast(callback, ctypes.c_void_p),
            ctypes.c_void_p(self._handle),
            ctypes.byref(failed),
        )
        if failed.value:
            raise RuntimeError(f"Gmsh took no size callback: {gmsh.logger.getLastError()}")
        _in_gmsh[object() if current in others else tuple(sorted(others))] = self
        gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 0)
        gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
        gmsh.option.setNumber("Mesh.MeshSizeFactor", scale)


def _field(handle: ctypes.c_void_p, delta: float | None) -> Field:
    field = object.__new__(Field)
    field._handle, field._delta = handle.value, delta
    return field


def build(
    points: ArrayLike,
    h: ArrayLike,
    structure: str | None = None,
    box: ArrayLike | None = None,
    growth: ArrayLike = 1.25,
    delta: float | None = None,
    h_min: float | None = None,
    h_max: float | None = None,
    **options: float | str,
) -> Field:
    """Builds a field from sources: what is requested at points.

    points: (n, 3), n >= 1.
    h: lengths (n,); or metrics M, (n, 6) as xx yy zz xy xz yz, or (n, 3, 3).
    structure: one of `structures()`. None: the octree K_oV; of lengths it is adapted to delta = 0.1,
    of metrics, where that takes long, only if delta is given.
    box: lowest and highest corner, (2, 3); with z0 == z1 (or x, or y) a plane that holds all points.
    None: the box of the points and 5 % of its longest edge.
    growth: gradation ratio g_r >= 1, growth of lengths per metric length of distance: one number,
    or one for each source, (n,).
    delta: largest non-conformity to the exact field, above 0, that a tree is refined to; guaranteed
    for lengths (not in K_Li and K_oLi), sampled for metrics; a UserWarning says that it was missed.
    None with a structure: sources are inserted and graded, which is faster and less accurate.
    h_min, h_max: limits of lengths, in all directions; without h_max lengths far from all sources
    grow up to half of the box's diagonal.
    options: further ones of cspace_create (controlspace.h): tau=0.5, split="s_G", max_memory=1 [GiB].

    ValueError for what cannot be used; it names the source by its index. Ctrl-C ends it with
    KeyboardInterrupt.
    """
    points = _arrays.source_places(points)
    h, finest = _arrays.metrics(h, len(points), h_min, h_max)
    corners = _arrays.box_around(points, box)
    ratio, growths = _arrays.growths(growth, len(points))
    if structure is None:
        structure = "K_oV"
        if delta is None and h.ndim == 1:
            delta = 0.1
    if "g_r" in options:
        raise ValueError("g_r: give it as growth")
    given = {"finest_length": finest, **options}
    if h_max is not None:
        given["h_max"] = _arrays.length("h_max", h_max)
    target = 0.0 if delta is None else _arrays.length("delta", delta)
    stop = ctypes.c_int(0)
    sources = Sources(
        struct_size=ctypes.sizeof(Sources),
        n=len(points),
        positions=points.ctypes.data,
        metrics=None if h.ndim == 1 else h.ctypes.data,
        lengths=h.ctypes.data if h.ndim == 1 else None,
        growths=None if growths is None else growths.ctypes.data,
    )
    making = Options(
        struct_size=ctypes.sizeof(Options),
        growth=ratio,
        delta=target,
        further=" ".join(f"{key}={value}" for key, value in given.items()).encode(),
        stop=ctypes.pointer(stop),
    )
    reached, handle = ctypes.c_double(), ctypes.c_void_p()
    try:
        call_until_interrupted(
            stop,
            "build",
            _word("structure", structure),
            corners.ctypes.data,
            sources,
            making,
            ctypes.byref(reached),
            ctypes.byref(handle),
        )
    except BaseException:
        library.cspace_free(handle)  # interrupted after it was made
        raise
    if reached.value > target:  # not of NaN, where nothing was adapted
        warnings.warn(f"delta {reached.value:.3g} reached, {target:.3g} requested", stacklevel=2)
    return _field(handle, None if delta is None else reached.value)


def _word(name: str, value: Any) -> bytes:
    if not isinstance(value, str) or "\0" in value:
        raise ValueError(f"{name} is {value!r}: give one of {', '.join(structures())}")
    return value.encode()


def load(file: str | os.PathLike[str]) -> Field:
    """The field in a .ctrl or .vdb, of `Field.save` or `controlspace build`; ValueError otherwise."""
    handle = ctypes.c_void_p()
    call("load", _arrays.path("file", file), ctypes.byref(handle))
    return _field(handle, None)


def structures() -> list[str]:
    """Names of the data structures, for `build` and `compare`."""
    names: list[str] = []
    while name := library.cspace_structure(len(names)):
        names.append(name.decode())
    return names

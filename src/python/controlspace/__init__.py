# SPDX-License-Identifier: Apache-2.0
"""Size and metric fields for mesh generation: built from point sources, queried as NumPy arrays.

A metric is six numbers, xx yy zz xy xz yz, of the symmetric positive definite tensor M whose
eigenvalues are LENGTHS: the requested edge lengths along its eigenvectors, in the unit of the
coordinates. The Riemannian metric of MMG and most other meshers is M^-2: see `Field.riemannian`.

Input that cannot be used raises a ValueError that names the index of the first wrong row; a failure
of the system raises RuntimeError, MemoryError or OSError. Batches of 100000 places or more use all
cores, without Python's global lock.
"""

from ._field import Field, build, load, structures
from ._library import version as _version
from ._program import compare

__all__ = ["Field", "build", "compare", "load", "structures"]
__version__ = _version()

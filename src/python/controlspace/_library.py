# SPDX-License-Identifier: Apache-2.0
"""The C library, whose functions controlspace.h describes."""

from __future__ import annotations

import ctypes
import os
import threading
from ctypes import POINTER, c_char_p, c_double, c_int, c_size_t, c_void_p
from pathlib import Path

# Either from the package, or from a build folder.
_FILE = os.environ.get("CONTROLSPACE_LIBRARY") or Path(__file__).parent / "libcontrolspace.so"
_OK, _BAD_INPUT = 0, 2


# Arrays go as addresses: see _arrays.py.
class Sources(ctypes.Structure):
    """cspace_sources."""

    _fields_ = (
        ("struct_size", c_size_t),
        ("n", c_size_t),
        ("positions", c_void_p),
        ("metrics", c_void_p),
        ("lengths", c_void_p),
        ("growths", c_void_p),
    )


class Options(ctypes.Structure):
    """cspace_options."""

    _fields_ = (
        ("struct_size", c_size_t),
        ("growth", c_double),
        ("delta", c_double),
        ("max_memory", c_double),
        ("further", c_char_p),
        ("stop", POINTER(c_int)),
    )


_FUNCTIONS = {
    "version": (c_char_p,),
    "last_error": (c_char_p,),
    "structure": (c_char_p, c_size_t),
    "build": (
        *(c_int, c_char_p, c_void_p, POINTER(Sources)),
        *(POINTER(Options), POINTER(c_double), POINTER(c_void_p)),
    ),
    "free": (None, c_void_p),
    "sample": (c_int, c_void_p, c_size_t, c_void_p, c_void_p),
    "sample_lengths": (c_int, c_void_p, c_size_t, c_void_p, c_void_p),
    "edge_lengths": (c_int, c_void_p, c_size_t, c_void_p, c_void_p, c_void_p),
    "to_riemannian": (c_int, c_size_t, c_void_p, c_void_p),
    "domain": (c_int, c_void_p, c_void_p),
    "save": (c_int, c_void_p, c_char_p),
    "load": (c_int, c_char_p, POINTER(c_void_p)),
}

library = ctypes.CDLL(os.fspath(_FILE))
for _name, (_result, *_arguments) in _FUNCTIONS.items():
    _function = getattr(library, "cspace_" + _name)
    _function.restype, _function.argtypes = _result, _arguments

# One place takes less time than giving the global lock away and back.
size_at = ctypes.PyDLL(os.fspath(_FILE)).cspace_size
size_at.restype, size_at.argtypes = c_double, (c_void_p, c_double, c_double, c_double)


def call(name: str, *arguments: object) -> None:
    """Calls the function cspace_NAME; its failure becomes an exception."""
    status = getattr(library, "cspace_" + name)(*arguments)
    if status == _OK:
        return
    reason = library.cspace_last_error().decode(errors="replace")
    if status == _BAD_INPUT:
        raise ValueError(reason)
    raise MemoryError(reason) if reason == "out of memory" else RuntimeError(reason)


def call_until_interrupted(stop: c_int, name: str, *arguments: object) -> None:
    """As `call`, in a thread of its own: Python handles Ctrl-C only in the main thread, and only
    between its own steps. `stop` is set to 1 then, for the function to end."""
    errors: list[BaseException] = []
    is_done = threading.Event()

    def work() -> None:
        try:
            call(name, *arguments)
        except BaseException as error:
            errors.append(error)
        finally:
            is_done.set()

    threading.Thread(target=work).start()
    interruption: BaseException | None = None
    # To its end in any case: the function reads and writes what the caller owns.
    while not is_done.is_set():
        try:
            is_done.wait()
        except BaseException as error:  # of a handler of signals
            interruption = interruption or error
            stop.value = 1
    if interruption:
        raise interruption
    if errors:
        raise errors[0]


def version() -> str:
    return str(library.cspace_version().decode())

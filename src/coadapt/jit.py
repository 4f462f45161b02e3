"""The compiler: the one place that names numba.

Kernels are plain Python functions over arrays. Set ``NUMBA_DISABLE_JIT=1`` to run them uncompiled.
Sums keep the order they are written in (no ``fastmath``), so results agree on every machine.
"""

from __future__ import annotations

from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


ROOT = Path(__file__).parent

FOLDERS = ("momdp/sarsop",)
"""Where kernels are."""


def _digest_of_kernels() -> str:
    digest = sha256()
    for folder in FOLDERS:
        for source in sorted((ROOT / folder).glob("*.py")):
            digest.update(source.read_bytes())
    return digest.hexdigest()


KERNELS = _digest_of_kernels()
"""Stands for the source of all kernels together."""


def kernel(function: Function) -> Function:
    """Compile ``function`` on first use and keep the result on disk."""
    return _compiled(function, from_python=True)


def inner(function: Function) -> Function:
    """Compile ``function`` for kernels alone to call: what Python would need is left out."""
    return _compiled(function, from_python=False)


def _compiled(function: Function, *, from_python: bool) -> Function:
    compiler: Any = numba.njit
    compiled: Any = compiler(cache=True, no_cpython_wrapper=not from_python)(function)
    # numba asks only whether the kernel's own file changed, but the compiled code holds the kernels
    # it calls as well. So the stamp that it compares is made one of all kernels.
    cache = getattr(getattr(compiled, "_cache", None), "_cache_file", None)
    if cache is not None:
        cache._source_stamp = KERNELS
    return cast("Function", compiled)


def is_compiled(function: Callable[..., Any]) -> bool:
    """Whether compiled code for ``function`` lies on disk, or none is needed."""
    cache = getattr(getattr(function, "_cache", None), "_cache_file", None)
    if cache is None:
        return not hasattr(function, "overloads")
    return bool(cache._load_index())

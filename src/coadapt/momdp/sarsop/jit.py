"""The compiler: the one place that names numba.

Kernels are plain Python functions over arrays. Set ``NUMBA_DISABLE_JIT=1`` to run them uncompiled.
Sums keep the order they are written in (no ``fastmath``), so results agree on every machine.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba  # pyright: ignore[reportMissingTypeStubs]

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Function:
    """Compile ``function`` on first use and keep the result on disk."""
    return cast(Function, numba.njit(cache=True)(function))  # pyright: ignore[reportUnknownMemberType]


def is_compiling() -> bool:
    """Whether kernels are compiled at all."""
    return not bool(numba.config.DISABLE_JIT)  # pyright: ignore

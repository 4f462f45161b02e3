"""The compiler: the one place that names numba.

Kernels are plain Python functions over arrays. Set ``NUMBA_DISABLE_JIT=1`` to run them uncompiled.
Sums keep the order they are written in (no ``fastmath``), so results agree on every machine.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


ROOT = Path(__file__).parent

FOLDERS: dict[str, tuple[str, ...]] = {
    "momdp/sarsop": (),
    "robots/kernels": (),
    "simulation/kernels": ("robots/kernels",),
    "analysis/kernels": (),
}
"""Where kernels are, and in which other folders the kernels are that they call."""


@cache
def stamp(folder: str) -> str:
    """Stands for the source of the kernels in ``folder``, of those they may call, and of this."""
    digest = sha256(Path(__file__).read_bytes())  # how they are compiled
    for part in (folder, *FOLDERS[folder]):
        for source in sorted((ROOT / part).glob("*.py")):
            digest.update(source.read_bytes())
    return digest.hexdigest()


def kernel(function: Function) -> Function:
    """Compile ``function`` on first use and keep the result on disk."""
    return _compiled(function, from_python=True)


def bare(function: Function) -> Function:
    """Compile ``function`` for kernels alone to call: what Python would need is left out.

    It must make no arrays, nor call a function that does. Nobody counts references to arrays in it,
    which takes most of the time of a small function. It is not kept on disk: the kernels that call
    it are, with its code in them.
    """
    return _compiled(function, from_python=False)


def _compiled(function: Function, *, from_python: bool) -> Function:
    compiler: Any = numba.njit
    compiled: Any = compiler(
        cache=from_python, no_cpython_wrapper=not from_python, _nrt=from_python
    )(function)
    # numba asks only whether the kernel's own file changed, but the compiled code holds the kernels
    # it calls as well. So the stamp that it compares is made one of them all.
    cache_file = getattr(getattr(compiled, "_cache", None), "_cache_file", None)
    if cache_file is not None:
        folder = Path(function.__code__.co_filename).parent.relative_to(ROOT)
        cache_file._source_stamp = stamp(folder.as_posix())
    return cast("Function", compiled)


def is_compiled(function: Callable[..., Any]) -> bool:
    """Whether compiled code for ``function`` lies on disk, or none is needed."""
    cache_file = getattr(getattr(function, "_cache", None), "_cache_file", None)
    if cache_file is None:
        return not hasattr(function, "overloads")
    return bool(cache_file._load_index())

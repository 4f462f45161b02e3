"""Policies in a compact file of our own: a zip archive of NumPy arrays, about a tenth of the XML.

Members: ``format`` (the version, a whole number), ``start`` ``[X + 1]``, ``vectors`` ``[N, Y]`` and
``actions`` ``[N]`` of `AlphaVectorPolicy`. ``numpy.load`` reads it too. Nothing is unpickled, and
the sizes in an array's header are compared with the bytes there are before memory is allocated.
"""

from __future__ import annotations

import math
import zipfile
import zlib
from typing import BinaryIO

import numpy as np
from numpy.lib import format as npy

from coadapt.arrays import FloatArray, IntArray
from coadapt.errors import FileError
from coadapt.momdp.files.limits import MAX_POLICY, MAX_VALUES
from coadapt.momdp.policy import AlphaVectorPolicy

VERSION = 1
"""Of the format. A reader refuses others."""

HEADER = 4096
"""Bytes that the header of an array may take."""


def write_compact(policy: AlphaVectorPolicy, file: BinaryIO) -> None:
    """Write ``policy`` to an open file."""
    np.savez_compressed(
        file,
        format=np.array([VERSION], dtype=np.int64),
        start=policy.start.astype("<i8"),
        vectors=policy.vectors.astype("<f8"),
        actions=policy.actions.astype("<i8"),
    )


def read_compact(path: object, file: BinaryIO) -> AlphaVectorPolicy:
    """The policy in an open file.

    Args:
        path: the file, for error messages.
        file: the open file.

    Raises:
        FileError: if the file is damaged, of another version or too large.
    """
    try:
        with zipfile.ZipFile(file) as archive:
            version = _array(path, archive, "format", "<i8", 1)
            if version.tolist() != [VERSION]:
                raise FileError(
                    path, None, f"found format {version.tolist()}, expected version {VERSION}"
                )
            start = _array(path, archive, "start", "<i8", 1).astype(np.int64)
            actions = _array(path, archive, "actions", "<i8", 1).astype(np.int64)
            vectors = _array(path, archive, "vectors", "<f8", 2).astype(np.float64)
    except (
        zipfile.BadZipFile,
        zlib.error,
        EOFError,
        KeyError,
        NotImplementedError,
        OSError,
        RuntimeError,
    ) as error:
        raise FileError(
            path, None, "found a damaged archive or another format, expected a compact policy"
        ) from error
    _check(path, start, vectors, actions)
    return AlphaVectorPolicy(start=start, vectors=vectors, actions=actions)


def _array(
    path: object, archive: zipfile.ZipFile, name: str, kind: str, axes: int
) -> np.typing.NDArray[np.generic]:
    """The array ``name``, which must have the type ``kind`` and ``axes`` axes."""
    info = archive.getinfo(f"{name}.npy")
    if info.file_size > 8 * MAX_POLICY + HEADER:
        raise FileError(
            path, None, f"found {info.file_size:,} bytes of {name}, expected fewer numbers"
        )
    with archive.open(info) as member:
        try:
            version = npy.read_magic(member)
            read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
            shape, by_column, found = read(member, max_header_size=HEADER)
        except ValueError as error:
            raise FileError(path, None, f"found no array {name}, expected one") from error
        if found != np.dtype(kind) or len(shape) != axes or by_column:
            raise FileError(
                path,
                None,
                f"found {name} of type {found} and shape {shape}, expected {kind} and {axes} axes",
            )
        size = math.prod(shape) * found.itemsize
        if min(shape) < 0 or size > info.file_size:
            raise FileError(path, None, f"found {name} cut short, expected shape {shape}")
        data = member.read()
    if len(data) != size:
        raise FileError(path, None, f"found {len(data)} bytes of {name}, expected {size}")
    return np.frombuffer(data, dtype=found).reshape(shape)


def _check(path: object, start: IntArray, vectors: FloatArray, actions: IntArray) -> None:
    count, length = vectors.shape
    fits = (
        len(start) > 1
        and length > 0
        and len(actions) == count
        and start[0] == 0
        and start[-1] == count
        and bool((np.diff(start) > 0).all())
    )
    if not fits:
        raise FileError(
            path, None, "found arrays that do not fit together, expected those of a policy"
        )
    if not np.isfinite(vectors).all() or (actions < 0).any() or (actions > MAX_VALUES).any():
        raise FileError(
            path, None, "found a number out of range, expected finite values and actions from 0"
        )

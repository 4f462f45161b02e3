"""Policies in a compact file of our own: a zip archive of NumPy arrays, about a tenth of the XML.

Members: ``format`` (the version, a whole number), ``start`` ``[X + 1]``, ``vectors`` ``[N, Y]`` and
``actions`` ``[N]`` of `AlphaVectorPolicy`. ``numpy.load`` reads it too. Nothing is unpickled, and
an array is given memory as its header says, up to a limit.
"""

from __future__ import annotations

import math
import zipfile
import zlib
from lzma import LZMAError
from tokenize import TokenError
from typing import BinaryIO

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from coadapt.arrays import FloatArray, IntArray
from coadapt.errors import FileError, excerpt
from coadapt.momdp.files.limits import MAX_POLICY, MAX_VALUES
from coadapt.momdp.policy import AlphaVectorPolicy

VERSION = 1
"""Of the format. A reader refuses others."""

HEADER = 4096
"""Bytes that the header of an array may take."""

PIECE = 1 << 20
"""Bytes that are unpacked at a time."""

DAMAGE = (
    zipfile.BadZipFile,
    zlib.error,
    LZMAError,
    EOFError,
    KeyError,
    NotImplementedError,
    OSError,
    RuntimeError,
    ValueError,
)
"""What reading a damaged archive raises."""


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
            start = _array(path, archive, "start", "<i8", 1, MAX_VALUES + 1)
            actions = _array(path, archive, "actions", "<i8", 1)
            vectors = _array(path, archive, "vectors", "<f8", 2)
    except FileError:
        raise
    except DAMAGE as error:
        raise FileError(
            path, None, "found a damaged archive or another format, expected a compact policy"
        ) from error
    policy = AlphaVectorPolicy(
        start=start.astype(np.int64, copy=False),
        vectors=vectors.astype(np.float64, copy=False),
        actions=actions.astype(np.int64, copy=False),
    )
    _check(path, policy.start, policy.vectors, policy.actions)
    return policy


def _array(
    path: object,
    archive: zipfile.ZipFile,
    name: str,
    kind: str,
    axes: int,
    most: int = MAX_POLICY,
) -> NDArray[np.generic]:
    """The array ``name``: of the type ``kind``, with ``axes`` axes and at most ``most`` numbers."""
    with archive.open(f"{name}.npy") as member:
        try:
            version = npy.read_magic(member)
            read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
            shape, by_column, found = read(member, max_header_size=HEADER)
        except (ValueError, SyntaxError, TokenError) as error:
            raise FileError(path, None, f"found no array {name}, expected one") from error
        whole = all(type(n) is int and n >= 0 for n in shape)
        if found != np.dtype(kind) or len(shape) != axes or by_column or not whole:
            raise FileError(
                path,
                None,
                f"found {name} of type {found} and shape {excerpt(str(shape))}, "
                f"expected {kind} and {axes} axes",
            )
        size = math.prod(shape)
        if size > most:
            raise FileError(
                path,
                None,
                f"found {name} of shape {excerpt(str(shape))}, expected at most {most:,} numbers",
            )
        room = bytearray(size * found.itemsize)
        at = 0
        while data := member.read(min(PIECE, len(room) - at + 1)):
            if at + len(data) > len(room):
                raise FileError(path, None, f"found too many bytes of {name}, expected {len(room)}")
            room[at : at + len(data)] = data
            at += len(data)
    if at != len(room):
        raise FileError(path, None, f"found {name} cut short, expected {len(room)} bytes")
    return np.frombuffer(room, dtype=found).reshape(shape)


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

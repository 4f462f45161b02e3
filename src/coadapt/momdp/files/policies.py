"""The door to policy files."""

from __future__ import annotations

import os
from pathlib import Path

from coadapt.errors import FileError
from coadapt.momdp.files.atomic import replacing
from coadapt.momdp.files.compact import read_compact, write_compact
from coadapt.momdp.files.policyx import read_policyx, write_policyx
from coadapt.momdp.files.problems import check_openable
from coadapt.momdp.policy import AlphaVectorPolicy

XML = (".policy", ".policyx")
"""Suffixes of the XML format."""

COMPACT = ".coadapt"
"""Suffix of the compact format."""


def read_policy(path: str | os.PathLike[str]) -> AlphaVectorPolicy:
    """The policy in a file, in the format that its suffix names, in any case.

    Args:
        path: a file that ends in ``.policy`` or ``.policyx`` (XML) or ``.coadapt`` (compact).

    Raises:
        coadapt.errors.InputError: if the file cannot be read, is not in its format, or is too
            large.
    """
    place, suffix = Path(path), policy_suffix(path)
    check_openable(place)
    try:
        with place.open("rb") as file:
            return (read_compact if suffix == COMPACT else read_policyx)(place, file)
    except OSError as error:
        raise FileError(place, None, f"cannot be read: {error.strerror}") from error


def write_policy(policy: AlphaVectorPolicy, path: str | os.PathLike[str]) -> None:
    """Write ``policy`` to a file, which appears complete or not at all. It reads back the same.

    Args:
        policy: the policy.
        path: where; the suffix names the format, see `read_policy`.

    Raises:
        coadapt.errors.InputError: if the suffix is another, or the file cannot be written.
    """
    place, suffix = Path(path), policy_suffix(path)
    with replacing(place) as file:
        (write_compact if suffix == COMPACT else write_policyx)(policy, file)


def policy_suffix(path: str | os.PathLike[str]) -> str:
    """The suffix of a policy file in lower case: one of `XML` or `COMPACT`.

    Raises:
        coadapt.errors.InputError: if the name has another one.
    """
    place = Path(path)
    suffix = place.suffix.lower()
    if suffix not in (*XML, COMPACT):
        raise FileError(
            place,
            None,
            f"found a name that ends in {suffix!r}, expected .policy, .policyx or .coadapt",
        )
    return suffix

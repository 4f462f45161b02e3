"""Policies as XML, in the form that APPL's solver writes and its simulator reads.

``<Policy>`` contains one ``<AlphaVector vectorLength numObsValue numVectors>``, and that a
``<Vector action obsValue>`` with ``vectorLength`` numbers for every alpha vector, or a
``<SparseVector>`` with an ``<Entry>index value</Entry>`` for those that are not 0. All indices
count from 0.
"""

from __future__ import annotations

from typing import BinaryIO, final

import numpy as np

from coadapt.arrays import FloatArray
from coadapt.errors import FileError, excerpt
from coadapt.momdp.files.limits import MAX_POLICY, MAX_VALUES
from coadapt.momdp.files.sparse_rows import starts
from coadapt.momdp.files.values import INTEGER, joined, numbers, read_numbers
from coadapt.momdp.files.xml_events import Kind, parse_xml
from coadapt.momdp.policy import AlphaVectorPolicy

GRAMMAR = {
    "Policy": Kind(frozenset(("AlphaVector",))),
    "AlphaVector": Kind(
        frozenset(("Vector", "SparseVector")),
        required=("vectorLength", "numObsValue", "numVectors"),
    ),
    "Vector": Kind(text=True, required=("action", "obsValue")),
    "SparseVector": Kind(frozenset(("Entry",)), required=("action", "obsValue")),
    "Entry": Kind(text=True),
}
"""What each element may contain."""


def write_policyx(policy: AlphaVectorPolicy, file: BinaryIO) -> None:
    """Write ``policy`` to an open file, with the shortest digits that read back exactly."""
    # The reference reads words up to white space: no number may touch the tag that follows.
    count, length = policy.vectors.shape
    values = len(policy.start) - 1
    head = (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<Policy version="0.1" type="value" model="problem">\n'
        f'<AlphaVector vectorLength="{length}" numObsValue="{values}" numVectors="{count}">\n'
    )
    file.write(head.encode())
    for x in range(values):
        for i in range(int(policy.start[x]), int(policy.start[x + 1])):
            file.write(
                f'<Vector action="{policy.actions[i]}" obsValue="{x}">'
                f"{joined(policy.vectors[i])} </Vector>\n".encode()
            )
    file.write(b"</AlphaVector>\n</Policy>\n")


def read_policyx(path: object, file: BinaryIO) -> AlphaVectorPolicy:
    """The policy in an open file. The vectors of an observed state keep their order.

    Args:
        path: the file, for error messages.
        file: the open file.

    Raises:
        FileError: naming the line, what was found and what was expected.
    """
    collector = _Collector(path)
    parse_xml(path, file, "Policy", GRAMMAR, collector)
    return collector.policy()


@final
class _Collector:
    """Collects vectors."""

    def __init__(self, path: object) -> None:
        self._path = path
        self._line: int | None = None
        self._length = self._values = self._count = 0
        self._vectors: list[FloatArray] = []
        self._actions: list[int] = []
        self._states: list[int] = []

    def begin(self, line: int, path: tuple[str, ...], attributes: dict[str, str]) -> None:
        """Note the sizes, or the action and state of a vector."""
        name = path[-1]
        if name == "AlphaVector":
            if self._line is not None:
                raise FileError(self._path, line, "found <AlphaVector> again, expected it once")
            self._line = line
            self._length = self._index(line, attributes, "vectorLength", MAX_VALUES, 1)
            self._values = self._index(line, attributes, "numObsValue", MAX_VALUES, 1)
            self._count = self._index(line, attributes, "numVectors", MAX_POLICY)
        elif name in ("Vector", "SparseVector"):
            self._states.append(self._index(line, attributes, "obsValue", self._values - 1))
            self._actions.append(self._index(line, attributes, "action", MAX_VALUES))
            if len(self._states) * self._length > MAX_POLICY:
                raise FileError(
                    self._path,
                    line,
                    f"found more than {MAX_POLICY:,} numbers in all vectors, expected fewer",
                )
            if name == "SparseVector":
                self._vectors.append(np.zeros(self._length))

    def end(self, line: int, path: tuple[str, ...], text: str) -> None:
        """Read the numbers of a vector."""
        if path[-1] == "Vector":
            self._vectors.append(read_numbers(self._path, line, text, self._length, numbers))
        elif path[-1] == "Entry":
            words = text.split(None, 2)
            if len(words) != 2 or not _is_index(words[0], self._length - 1):
                raise FileError(
                    self._path,
                    line,
                    f"found {excerpt(text.strip())}, expected an index below {self._length} and "
                    "a number",
                )
            self._vectors[-1][int(words[0])] = numbers(self._path, line, words[1:])[0]

    def policy(self) -> AlphaVectorPolicy:
        """The policy, its vectors by observed state."""
        if self._line is None:
            raise FileError(self._path, 1, "found no <AlphaVector>, expected one")
        if len(self._vectors) != self._count:
            raise FileError(
                self._path,
                self._line,
                f"found {len(self._vectors)} vectors, expected numVectors='{self._count}'",
            )
        states = np.array(self._states, dtype=np.int64)
        counts = np.bincount(states, minlength=self._values)
        if (counts == 0).any():
            missing = int(np.argmin(counts))
            raise FileError(
                self._path,
                self._line,
                f"found no vector for observed value {missing}, expected at least one",
            )
        order = np.argsort(states, kind="stable")
        return AlphaVectorPolicy(
            start=starts(counts),
            vectors=np.stack([self._vectors[int(i)] for i in order]),
            actions=np.array(self._actions, dtype=np.int64)[order],
        )

    def _index(
        self, line: int, attributes: dict[str, str], name: str, last: int, first: int = 0
    ) -> int:
        text = attributes[name].strip()
        if not _is_index(text, last) or int(text) < first:
            raise FileError(
                self._path,
                line,
                f"found {name}={excerpt(text)}, expected a whole number from {first} to {last}",
            )
        return int(text)


def _is_index(text: str, last: int) -> bool:
    return INTEGER.fullmatch(text) is not None and len(text) <= 18 and 0 <= int(text) <= last

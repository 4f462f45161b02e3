"""Decision diagrams of `.pomdpx` files: every path to a terminal becomes an entry.

A node branches on a variable. A path that does not branch on a variable holds for all of its
values. Missing edges are 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

import numpy as np

from coadapt.errors import FileError, excerpt
from coadapt.momdp.files.layered import WILD, LayeredTable
from coadapt.momdp.files.limits import MAX_ENTRIES
from coadapt.momdp.files.pomdpx_variables import Axis
from coadapt.momdp.files.pomdpx_xml import RawNode, RawTable
from coadapt.momdp.files.values import PROBABILITY_TOLERANCE, one_number

MAX_PATHS = MAX_ENTRIES // 50
"""Paths of one diagram, its templates written out."""


def read_diagram(
    path: object,
    raw: RawTable,
    names: Sequence[str],
    axes: Sequence[Axis],
    table: LayeredTable,
    *,
    probability: bool,
) -> None:
    """Set ``table`` as the diagram of ``raw`` says.

    Raises:
        FileError: if the diagram is not one over ``axes``.
    """
    templates: dict[str, RawNode] = {}
    main: RawNode | None = None
    for root in raw.roots:
        if len(root.children) != 1:
            raise FileError(
                path, root.line, f"found {len(root.children)} elements, expected one node"
            )
        if root.kind == "DAG":
            if main is not None:
                raise FileError(path, root.line, "found <DAG> again, expected it once")
            main = root.children[0]
        elif (
            templates.setdefault(root.attributes["id"].strip(), root.children[0])
            is not (root.children[0])
        ):
            raise FileError(path, root.line, "found a template id again, expected a new one")
    if main is None:
        raise FileError(path, raw.line, "found no <DAG>, expected one in a DD parameter")
    _Walk(path, names, axes, table, templates, probability).run(main)


@final
class _Walk:
    """Visits the paths of a diagram, without recursion."""

    def __init__(
        self,
        path: object,
        names: Sequence[str],
        axes: Sequence[Axis],
        table: LayeredTable,
        templates: dict[str, RawNode],
        probability: bool,
    ) -> None:
        self._path = path
        self._axis = {name: i for i, name in enumerate(names)}
        self._axes = axes
        self._table = table
        self._templates = templates
        self._probability = probability
        self._paths = 0
        self._todo: list[tuple[RawNode, tuple[int, ...], int]] = []

    def run(self, root: RawNode) -> None:
        """Visit everything below ``root``."""
        self._todo.append((root, (WILD,) * len(self._axes), 0))
        while self._todo:
            node, chosen, templates = self._todo.pop()
            self._paths += 1
            if self._paths > MAX_PATHS:
                raise FileError(
                    self._path,
                    node.line,
                    f"found more than {MAX_PATHS:,} paths in a diagram, expected fewer",
                )
            if node.kind == "Node":
                self._branch(node, chosen, templates)
            elif node.kind == "SubDAG":
                self._shorthand(node, chosen, templates)
            else:
                self._terminal(node, chosen)

    def _branch(self, node: RawNode, chosen: tuple[int, ...], templates: int) -> None:
        axis = self._find(node, node.attributes["var"])
        if chosen[axis] != WILD:
            raise FileError(
                self._path,
                node.line,
                f"found {excerpt(node.attributes['var'])} a second time on a path, expected once",
            )
        seen: set[int] = set()
        for edge in node.children:
            value = self._value(edge, axis, edge.attributes["val"])
            if value in seen or len(edge.children) != 1:
                raise FileError(
                    self._path, edge.line, "found an unusable edge, expected one for each value"
                )
            seen.add(value)
            after = (*chosen[:axis], value, *chosen[axis + 1 :])
            self._todo.append((edge.children[0], after, templates))

    def _shorthand(self, node: RawNode, chosen: tuple[int, ...], templates: int) -> None:
        kind = node.attributes["type"].strip()
        if kind == "template":
            name = node.attributes.get("idref", "").strip()
            if name not in self._templates or templates > len(self._templates):
                raise FileError(
                    self._path,
                    node.line,
                    f"found template {excerpt(name)}, expected the id of one that does not lead "
                    "back to itself",
                )
            self._todo.append((self._templates[name], chosen, templates + 1))
            return
        axis = self._find(node, node.attributes.get("var", ""))
        if not self._probability or axis != len(self._axes) - 1 or chosen[axis] != WILD:
            raise FileError(
                self._path,
                node.line,
                f"found {excerpt(kind)} for {excerpt(node.attributes.get('var', ''))}, expected "
                "it for the variable that the table is about",
            )
        size = self._axes[axis].variable.size
        if kind == "uniform":
            self._set(node, chosen, 1.0 / size)
        elif kind == "deterministic":
            value = self._value(node, axis, node.attributes.get("val", ""))
            self._set(node, (*chosen[:axis], value), 1.0)
        elif kind == "persistent":
            before = self._previous(node)
            values = range(size) if chosen[before] == WILD else (chosen[before],)
            for value in values:
                kept = (*chosen[:before], value, *chosen[before + 1 : axis], value)
                self._set(node, kept, 1.0)
        else:
            raise FileError(
                self._path,
                node.line,
                f"found type {excerpt(kind)}, expected deterministic, persistent, uniform or "
                "template",
            )

    def _previous(self, node: RawNode) -> int:
        """The parent that is the value before the step."""
        own = self._axes[-1]
        for i, axis in enumerate(self._axes[:-1]):
            if axis.variable is own.variable and not axis.current:
                return i
        raise FileError(
            self._path,
            node.line,
            "found persistent, expected the variable's value before the step among the parents",
        )

    def _terminal(self, node: RawNode, chosen: tuple[int, ...]) -> None:
        value = one_number(self._path, node.line, node.text, "a number")
        if self._probability and not 0 <= value <= 1 + PROBABILITY_TOLERANCE:
            raise FileError(
                self._path,
                node.line,
                f"found {excerpt(node.text)}, expected a probability from 0 to 1",
            )
        self._set(node, chosen, value)

    def _set(self, node: RawNode, chosen: tuple[int, ...], value: float) -> None:
        self._table.set(node.line, chosen, np.array([value]))

    def _find(self, node: RawNode, name: str) -> int:
        axis = self._axis.get(name.strip())
        if axis is None:
            raise FileError(
                self._path,
                node.line,
                f"found variable {excerpt(name)}, expected the table's own or a parent of it",
            )
        return axis

    def _value(self, node: RawNode, axis: int, name: str) -> int:
        value = self._axes[axis].variable.index.get(name.strip())
        if value is None:
            raise FileError(
                self._path,
                node.line,
                f"found value {excerpt(name)}, expected one such as "
                f"{excerpt(self._axes[axis].variable.names[0])}",
            )
        return value

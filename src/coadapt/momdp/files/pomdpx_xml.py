"""The parts of a `.pomdpx` file as they stand in it, before their words are looked up.

The sections may come in any order, so the tables are kept as text until all variables are known.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import BinaryIO, final

from coadapt.errors import FileError, excerpt
from coadapt.momdp.files.limits import MAX_NODES, MAX_VARIABLES
from coadapt.momdp.files.values import one_number
from coadapt.momdp.files.xml_events import ANYTHING, Kind, parse_xml

GRAMMAR = {
    "pomdpx": Kind(
        frozenset(
            (
                "Description",
                "Discount",
                "Variable",
                "InitialStateBelief",
                "StateTransitionFunction",
                "ObsFunction",
                "RewardFunction",
            )
        )
    ),
    "Description": Kind(ANYTHING),
    "Discount": Kind(text=True),
    "Variable": Kind(frozenset(("StateVar", "ObsVar", "ActionVar", "RewardVar"))),
    "StateVar": Kind(frozenset(("ValueEnum", "NumValues")), required=("vnamePrev", "vnameCurr")),
    "ObsVar": Kind(frozenset(("ValueEnum", "NumValues")), required=("vname",)),
    "ActionVar": Kind(frozenset(("ValueEnum", "NumValues")), required=("vname",)),
    "RewardVar": Kind(required=("vname",)),
    "ValueEnum": Kind(text=True),
    "NumValues": Kind(text=True),
    "InitialStateBelief": Kind(frozenset(("CondProb",))),
    "StateTransitionFunction": Kind(frozenset(("CondProb",))),
    "ObsFunction": Kind(frozenset(("CondProb",))),
    "RewardFunction": Kind(frozenset(("Func",))),
    "CondProb": Kind(frozenset(("Var", "Parent", "Parameter"))),
    "Func": Kind(frozenset(("Var", "Parent", "Parameter"))),
    "Var": Kind(text=True),
    "Parent": Kind(text=True),
    "Parameter": Kind(frozenset(("Entry", "DAG", "SubDAGTemplate"))),
    "Entry": Kind(frozenset(("Instance", "ProbTable", "ValueTable"))),
    "Instance": Kind(text=True),
    "ProbTable": Kind(text=True),
    "ValueTable": Kind(text=True),
    "DAG": Kind(frozenset(("Node", "SubDAG"))),
    "SubDAGTemplate": Kind(frozenset(("Node", "SubDAG")), required=("id",)),
    "Node": Kind(frozenset(("Edge",)), required=("var",)),
    "Edge": Kind(frozenset(("Node", "SubDAG", "Terminal")), required=("val",)),
    "SubDAG": Kind(required=("type",)),
    "Terminal": Kind(text=True),
}
"""What each element may contain."""

SECTIONS = ("InitialStateBelief", "StateTransitionFunction", "ObsFunction", "RewardFunction")


@dataclass
class RawVariable:
    """A variable as declared.

    Attributes:
        line: where.
        kind: the name of its element.
        attributes: of that element.
        values: text of ``ValueEnum``, or None.
        count: text of ``NumValues``, or None.
    """

    line: int
    kind: str
    attributes: dict[str, str]
    values: str | None = None
    count: str | None = None


@dataclass(slots=True)
class RawNode:
    """An element of a decision diagram.

    Attributes:
        line: where.
        kind: the name of the element.
        attributes: of the element.
        text: the number of a terminal.
        children: the elements in it.
    """

    line: int
    kind: str
    attributes: dict[str, str]
    text: str = ""
    children: list[RawNode] = field(default_factory=list["RawNode"])


@dataclass
class RawTable:
    """A table as written.

    Attributes:
        line: where it begins.
        section: the name of the section.
        variable: what it is about.
        parents: what it depends on, or None if it does not say.
        diagram: whether its parameter is a decision diagram.
        entries: line, instance and numbers of each entry.
        roots: the diagram and its templates.
    """

    line: int
    section: str
    variable: str = ""
    parents: list[str] | None = None
    diagram: bool = False
    entries: list[tuple[int, str, str]] = field(default_factory=list[tuple[int, str, str]])
    roots: list[RawNode] = field(default_factory=list[RawNode])


@dataclass
class RawDocument:
    """A file as written.

    Attributes:
        discount: in [0, 1), or None if there is none.
        variables: in the file's order.
        tables: in the file's order.
        sections: the line of every section.
    """

    discount: float | None = None
    variables: list[RawVariable] = field(default_factory=list[RawVariable])
    tables: list[RawTable] = field(default_factory=list[RawTable])
    sections: dict[str, int] = field(default_factory=dict[str, int])


def read_document(path: object, file: BinaryIO) -> RawDocument:
    """The parts of a `.pomdpx` file.

    Args:
        path: the file, for error messages.
        file: the open file.

    Raises:
        FileError: if it is not XML, or not that of a `.pomdpx` file.
    """
    collector = _Collector(path)
    parse_xml(path, file, "pomdpx", GRAMMAR, collector)
    return collector.document


@final
class _Collector:
    """Fills a document."""

    def __init__(self, path: object) -> None:
        self.document = RawDocument()
        self._path = path
        self._instance: str | None = None
        self._numbers: str | None = None
        self._nodes: list[RawNode] = []
        self._count = 0

    def begin(self, line: int, path: tuple[str, ...], attributes: dict[str, str]) -> None:
        """Make room for what the element will contain."""
        name = path[-1]
        if name in ("StateVar", "ObsVar", "ActionVar", "RewardVar"):
            if len(self.document.variables) == MAX_VARIABLES:
                raise FileError(
                    self._path, line, f"found more than {MAX_VARIABLES} variables, expected fewer"
                )
            self.document.variables.append(RawVariable(line, name, attributes))
        elif name in ("CondProb", "Func"):
            self.document.tables.append(RawTable(line, path[-2]))
        elif name == "Parameter":
            self._begin_parameter(line, attributes)
        elif name == "Entry":
            self._instance = self._numbers = None
        elif name in ("DAG", "SubDAGTemplate", "Node", "Edge", "SubDAG", "Terminal"):
            if not self.document.tables[-1].diagram:
                raise FileError(
                    self._path, line, f"found <{name}>, expected <Entry> unless type='DD'"
                )
            self._count += 1
            if self._count > MAX_NODES:
                raise FileError(
                    self._path,
                    line,
                    f"found more than {MAX_NODES:,} elements of decision diagrams, expected fewer",
                )
            self._nodes.append(RawNode(line, name, attributes))
        elif name in SECTIONS or name == "Variable":
            self._once(self.document.sections, name, line)

    def end(self, line: int, path: tuple[str, ...], text: str) -> None:
        """Keep what the element contains."""
        name = path[-1]
        document = self.document
        if name == "Instance":
            self._instance = self._only(line, name, self._instance, text)
        elif name in ("ProbTable", "ValueTable"):
            wanted = "ValueTable" if path[1] == "RewardFunction" else "ProbTable"
            if name != wanted:
                raise FileError(
                    self._path, line, f"found <{name}> in <{path[1]}>, expected <{wanted}>"
                )
            self._numbers = self._only(line, name, self._numbers, text)
        elif name == "Entry":
            if self._instance is None or self._numbers is None:
                missing = "Instance" if self._instance is None else "table of numbers"
                raise FileError(
                    self._path, line, f"found an <Entry> without {missing}, expected one"
                )
            document.tables[-1].entries.append((line, self._instance, self._numbers))
        elif name == "Discount":
            self._discount(line, text)
        elif name == "ValueEnum":
            variable = document.variables[-1]
            variable.values = self._only(line, name, variable.values, text)
        elif name == "NumValues":
            variable = document.variables[-1]
            variable.count = self._only(line, name, variable.count, text)
        elif name == "Var":
            self._variable(line, text)
        elif name == "Parent":
            table = document.tables[-1]
            if table.parents is not None:
                raise FileError(self._path, line, "found <Parent> again, expected it once")
            table.parents = [word for word in text.split(None, 2 * MAX_VARIABLES) if word != "null"]
        elif self._nodes and name in (self._nodes[-1].kind,):
            self._end_node(text)

    def _discount(self, line: int, text: str) -> None:
        if self.document.discount is not None:
            raise FileError(self._path, line, "found <Discount> again, expected it once")
        wanted = "a discount of at least 0 and below 1"
        discount = one_number(self._path, line, text.strip(), wanted)
        if not 0 <= discount < 1:
            raise FileError(
                self._path,
                line,
                f"found discount {excerpt(text.strip())}, expected at least 0 and below 1: without "
                "discounting the value of going on for ever need not be finite",
            )
        self.document.discount = discount

    def _variable(self, line: int, text: str) -> None:
        table = self.document.tables[-1]
        words = text.split(None, 1)
        if len(words) != 1 or table.variable:
            raise FileError(
                self._path, line, f"found {excerpt(text.strip())}, expected one variable"
            )
        table.variable = words[0]

    def _begin_parameter(self, line: int, attributes: dict[str, str]) -> None:
        table = self.document.tables[-1]
        kind = attributes.get("type", "TBL")
        if kind not in ("TBL", "DD"):
            raise FileError(self._path, line, f"found type {excerpt(kind)}, expected TBL or DD")
        if table.entries or table.roots:
            raise FileError(self._path, line, "found <Parameter> again, expected it once")
        table.diagram = kind == "DD"

    def _end_node(self, text: str) -> None:
        node = self._nodes.pop()
        node.text = text.strip()
        if self._nodes:
            self._nodes[-1].children.append(node)
        else:
            self.document.tables[-1].roots.append(node)

    def _only(self, line: int, name: str, before: str | None, text: str) -> str:
        if before is not None:
            raise FileError(self._path, line, f"found <{name}> again, expected it once")
        return text

    def _once(self, seen: dict[str, int], name: str, line: int) -> None:
        if name in seen:
            raise FileError(
                self._path, line, f"found <{name}> again, expected it once (line {seen[name]})"
            )
        seen[name] = line

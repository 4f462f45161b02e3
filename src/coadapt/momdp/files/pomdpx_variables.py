"""The variables of a `.pomdpx` file and their products.

The fully observed state variables together are x, the others y, the observation variables o, the
action variables a. In every product the first variable is the most significant.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from coadapt.arrays import IntArray
from coadapt.errors import FileError, excerpt
from coadapt.momdp.files.layered import steps
from coadapt.momdp.files.limits import (
    MAX_CHARACTERS,
    MAX_OBSERVATIONS,
    MAX_PAIRS,
    MAX_REWARDS,
    MAX_VALUES,
    check_size,
)
from coadapt.momdp.files.pomdpx_xml import RawDocument, RawVariable
from coadapt.momdp.files.values import whole_number

OBSERVED, HIDDEN, ACTION, OBSERVATION = "x", "y", "a", "o"
"""The groups of variables."""

KINDS = {
    OBSERVED: "observed states",
    HIDDEN: "hidden states",
    ACTION: "actions",
    OBSERVATION: "observations",
}
"""What the combinations of the values of each group are."""

NAME_JOINT = ","
"""Between the parts of a name in a product."""

NO_VARIABLE = "0"
"""Of a group without variables there is one value, named by its letter and this."""


@dataclass(frozen=True)
class Variable:
    """One variable.

    Attributes:
        group: which product it belongs to.
        place: its place in the product.
        names: its values.
        index: the index of each name.
    """

    group: str
    place: int
    names: tuple[str, ...]
    index: dict[str, int]

    @property
    def size(self) -> int:
        """Number of values."""
        return len(self.names)


@dataclass(frozen=True)
class Axis:
    """A variable in a role: a table's parent, or what it is about.

    Attributes:
        variable: the variable.
        current: whether its value after the step is meant; for an initial belief, before it.
    """

    variable: Variable
    current: bool

    @property
    def key(self) -> tuple[str, int, bool]:
        """What distinguishes this axis from others."""
        return self.variable.group, self.variable.place, self.current


@dataclass(frozen=True)
class Product:
    """All combinations of the variables of a group.

    Attributes:
        variables: the first is the most significant.
        names: of the combinations.
    """

    variables: tuple[Variable, ...]
    names: tuple[str, ...]

    @property
    def size(self) -> int:
        """Number of combinations."""
        return len(self.names)

    @property
    def steps(self) -> tuple[int, ...]:
        """How far apart neighbouring values of each variable are."""
        return steps([v.size for v in self.variables])

    def component(self, place: int, index: IntArray) -> IntArray:
        """The value of variable ``place`` in the combinations ``index``."""
        return index // self.steps[place] % self.variables[place].size


@dataclass(frozen=True)
class Variables:
    """All variables of a file.

    Attributes:
        observed, hidden, actions, observations: the groups.
        axes: the axis that every name stands for.
        rewards: the names of the reward variables.
        states: for every state variable its name before and after a step.
    """

    observed: Product
    hidden: Product
    actions: Product
    observations: Product
    axes: dict[str, Axis]
    rewards: tuple[str, ...]
    states: tuple[tuple[str, str], ...]

    def product(self, group: str) -> Product:
        """The product of a group."""
        return {
            OBSERVED: self.observed,
            HIDDEN: self.hidden,
            ACTION: self.actions,
            OBSERVATION: self.observations,
        }[group]


def read_variables(path: object, document: RawDocument) -> Variables:
    """The variables that ``document`` declares.

    Raises:
        FileError: if a name is used twice, a variable has no values, or a product is too large.
    """
    groups: dict[str, list[Variable]] = {OBSERVED: [], HIDDEN: [], ACTION: [], OBSERVATION: []}
    axes: dict[str, Axis] = {}
    rewards: list[str] = []
    states: list[tuple[str, str]] = []
    taken: dict[str, int] = {}
    line = document.sections.get("Variable")
    declared = _declared(path, document)
    for place, raw in enumerate(document.variables):
        for attribute in ("vname", "vnamePrev", "vnameCurr"):
            name = raw.attributes.get(attribute, "").strip()
            if name and (name in taken or len(name.split()) > 1 or name in ("*", "-", "null")):
                raise FileError(path, raw.line, f"found {excerpt(name)}, expected a new name")
            taken[name] = raw.line
        if raw.kind == "RewardVar":
            rewards.append(raw.attributes["vname"].strip())
            continue
        group, values = declared[place]
        letter = {OBSERVED: "s", HIDDEN: "s"}.get(group, group)
        names = tuple(f"{letter}{i}" for i in values) if isinstance(values, range) else values
        index = {name: i for i, name in enumerate(names)}
        variable = Variable(group, len(groups[group]), names, index)
        groups[group].append(variable)
        if raw.kind == "StateVar":
            before = raw.attributes["vnamePrev"].strip()
            after = raw.attributes["vnameCurr"].strip()
            axes[before], axes[after] = Axis(variable, False), Axis(variable, True)
            states.append((before, after))
        else:
            axes[raw.attributes["vname"].strip()] = Axis(variable, True)
    for what, found in (
        ("StateVar", states),
        ("ActionVar", groups[ACTION]),
        ("RewardVar", rewards),
    ):
        if not found:
            raise FileError(path, line, f"found no <{what}>, expected at least one")
    return Variables(
        *(_product(path, line, group, groups[group]) for group in KINDS),
        axes=axes,
        rewards=tuple(rewards),
        states=tuple(states),
    )


def _declared(path: object, document: RawDocument) -> list[tuple[str, range | tuple[str, ...]]]:
    """Group and values of each variable; ``range`` stands for values without names.

    Raises:
        FileError: if there are too many combinations: checked before anything of their number is
            made.
    """
    sizes = dict.fromkeys(KINDS, 1)
    declared: list[tuple[str, range | tuple[str, ...]]] = []
    for raw in document.variables:
        if raw.kind == "RewardVar":
            declared.append((raw.kind, range(0)))
            continue
        group, values = _group(path, raw), _values(path, raw)
        check_size(path, raw.line, KINDS[group], (sizes[group], len(values)), MAX_VALUES)
        sizes[group] *= len(values)
        declared.append((group, values))
    line = document.sections.get("Variable")
    x, y, a, o = (sizes[group] for group in (OBSERVED, HIDDEN, ACTION, OBSERVATION))
    check_size(path, line, "observed states x actions x hidden states", (x, a, y), MAX_REWARDS)
    check_size(path, line, "actions x observed states", (a, x), MAX_PAIRS)
    check_size(path, line, "hidden states x observations", (y, o), MAX_OBSERVATIONS)
    return declared


def _group(path: object, raw: RawVariable) -> str:
    if raw.kind != "StateVar":
        return ACTION if raw.kind == "ActionVar" else OBSERVATION
    text = raw.attributes.get("fullyObs", "false").strip()
    if text not in ("true", "false", "1", "0"):
        raise FileError(path, raw.line, f"found fullyObs={excerpt(text)}, expected true or false")
    return OBSERVED if text in ("true", "1") else HIDDEN


def _values(path: object, raw: RawVariable) -> range | tuple[str, ...]:
    if (raw.values is None) == (raw.count is None):
        found = "neither" if raw.values is None else "both"
        raise FileError(
            path, raw.line, f"found {found} of <ValueEnum> and <NumValues>, expected one"
        )
    if raw.count is not None:
        count = whole_number(path, raw.line, raw.count.strip(), "the number of values")
        if count > MAX_VALUES:
            raise FileError(
                path, raw.line, f"found {count} values, expected at most {MAX_VALUES:,}"
            )
        return range(count)
    names = tuple((raw.values or "").split(None, MAX_VALUES))
    if not 1 <= len(names) <= MAX_VALUES:
        found = f"more than {MAX_VALUES:,}" if names else "0"
        raise FileError(path, raw.line, f"found {found} values, expected 1 to {MAX_VALUES:,}")
    if len(set(names)) < len(names) or {"*", "-"} & set(names):
        seen: set[str] = {"*", "-"}
        for name in names:
            if name in seen:
                raise FileError(path, raw.line, f"found {excerpt(name)}, expected a new name")
            seen.add(name)
    return names


def _product(path: object, line: int | None, group: str, variables: Sequence[Variable]) -> Product:
    if not variables:
        return Product((), (f"{group}{NO_VARIABLE}",))
    if len(variables) == 1:
        return Product(tuple(variables), variables[0].names)
    count = math.prod(v.size for v in variables)
    letters = sum(count // v.size * sum(map(len, v.names)) + count for v in variables)
    what = f"characters in the names of the {KINDS[group]}"
    check_size(path, line, what, (letters,), MAX_CHARACTERS)
    names = [NAME_JOINT.join(parts) for parts in product(*(v.names for v in variables))]
    if len(set(names)) < count:
        names = [f"{name}{NAME_JOINT}{i}" for i, name in enumerate(names)]
    return Product(tuple(variables), tuple(names))


def combine(product: Product, parts: Sequence[IntArray]) -> IntArray:
    """The combination in which every variable has the value in ``parts``."""
    total = np.zeros_like(parts[0])
    for part, step in zip(parts, product.steps, strict=True):
        total = total + part * step
    return total

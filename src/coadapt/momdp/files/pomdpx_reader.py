"""Reads `.pomdpx` files.

The product of the fully observed variables is x, that of the others y. Where a group has no
variable it has one value.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import BinaryIO

import numpy as np

from coadapt.errors import FileError, excerpt
from coadapt.momdp.files.pomdpx_entries import Factor, read_factor
from coadapt.momdp.files.pomdpx_join import Distribution, Frame, in_order
from coadapt.momdp.files.pomdpx_observation import build_observation
from coadapt.momdp.files.pomdpx_reward import build_reward
from coadapt.momdp.files.pomdpx_transition import TOTAL_TOLERANCE, build_edges, check_rows
from coadapt.momdp.files.pomdpx_variables import (
    ACTION,
    HIDDEN,
    OBSERVATION,
    OBSERVED,
    Axis,
    Variables,
    combine,
    read_variables,
)
from coadapt.momdp.files.pomdpx_xml import RawDocument, RawTable, read_document
from coadapt.momdp.files.rows import normalised
from coadapt.momdp.model import MOMDP, Root


def read_pomdpx(path: object, file: BinaryIO) -> MOMDP:
    """The problem in a `.pomdpx` file.

    Args:
        path: the file, for error messages.
        file: the open file.

    Raises:
        FileError: naming the line, what was found and what was expected.
    """
    document = read_document(path, file)
    last = document.tables[-1].line if document.tables else None
    if document.discount is None:
        raise FileError(path, last, "found no <Discount>, expected one")
    variables = read_variables(path, document)
    before = [before for before, _ in variables.states]
    after = [after for _, after in variables.states]
    seen = [name for name, axis in variables.axes.items() if axis.variable.group == OBSERVATION]
    start = _factors(path, document, variables, "InitialStateBelief", before)
    moves = _factors(path, document, variables, "StateTransitionFunction", after)
    sights = _factors(path, document, variables, "ObsFunction", seen)
    gains = _factors(path, document, variables, "RewardFunction", list(variables.rewards))
    line = document.sections["StateTransitionFunction"]
    edges = build_edges(path, line, variables, moves)
    check_rows(path, line, variables, edges, moves)
    observation, observation_index = build_observation(path, variables, edges, sights)
    roots = _roots(path, document.sections["InitialStateBelief"], variables, start)
    reward = build_reward(path, variables, edges, gains)
    return MOMDP(
        edge_start=edges.start,
        edge_next=edges.next,
        edge_map=edges.map,
        transition=edges.transition,
        observation=observation,
        observation_index=observation_index,
        reward=reward,
        discount=document.discount,
        roots=roots,
        observed_names=variables.observed.names,
        hidden_names=variables.hidden.names,
        action_names=variables.actions.names,
        observation_names=variables.observations.names,
    )


def _factors(
    path: object,
    document: RawDocument,
    variables: Variables,
    section: str,
    wanted: Sequence[str],
) -> list[Factor]:
    """The tables of a section: one for each of the names ``wanted``."""
    tables: dict[str, RawTable] = {}
    line = document.sections.get(section)
    if line is None and wanted:
        raise FileError(
            path, document.sections.get("Variable"), f"found no <{section}>, expected one"
        )
    for raw in document.tables:
        if raw.section != section:
            continue
        if raw.variable not in wanted:
            raise FileError(
                path,
                raw.line,
                f"found a table of {excerpt(raw.variable)}, expected one of "
                f"{', '.join(wanted[:5]) or 'no variable'}",
            )
        if raw.variable in tables:
            raise FileError(
                path, raw.line, f"found a second table of {excerpt(raw.variable)}, expected one"
            )
        tables[raw.variable] = raw
    for name in wanted:
        if name not in tables:
            raise FileError(path, line, f"found no table of {name} in <{section}>, expected one")
    initial, about = section == "InitialStateBelief", section != "RewardFunction"
    factors = [
        read_factor(path, tables[name], variables, about=about, initial=initial) for name in wanted
    ]
    for factor in factors:
        for name, axis in zip(factor.names, factor.axes, strict=True):
            if name != factor.name and not _may_depend(section, axis):
                raise FileError(
                    path,
                    factor.line,
                    f"found parent {name} of {factor.name}, expected {PARENTS[section]}",
                )
    return factors


PARENTS = {
    "InitialStateBelief": "state variables before the step",
    "StateTransitionFunction": "state and action variables",
    "ObsFunction": "action variables and state variables after the step",
    "RewardFunction": "state and action variables",
}
"""What the tables of each section may depend on."""


def _may_depend(section: str, axis: Axis) -> bool:
    is_state = axis.variable.group in (OBSERVED, HIDDEN)
    if section == "InitialStateBelief":
        return is_state and not axis.current
    if section == "ObsFunction":
        return axis.variable.group == ACTION or (is_state and axis.current)
    return is_state or axis.variable.group == ACTION


def _roots(
    path: object, line: int, variables: Variables, factors: Sequence[Factor]
) -> tuple[Root, ...]:
    """One root for every observed state that the initial belief gives a probability to."""
    frame = Frame(path, {}, np.ones(1))
    for factor in in_order(path, factors):
        slices = normalised(path, factor.table, factor.describe)
        only = slices.at(np.zeros(len(frame.weight), dtype=np.int64))
        frame.extend(Distribution.of(factor, slices), only)
    total = float(frame.weight.sum())
    if abs(total - 1) > TOTAL_TOLERANCE:
        raise FileError(
            path, line, f"found an initial belief with a total of {total:.9g}, expected 1"
        )
    index = [np.zeros(len(frame.weight), dtype=np.int64)] * 2
    for i, product in enumerate((variables.observed, variables.hidden)):
        if product.variables:
            group = product.variables[0].group
            columns = [frame.columns[group, v.place, False] for v in product.variables]
            index[i] = combine(product, columns)
    x, y = index
    order = np.argsort(x, kind="stable")
    x, y, weight = x[order], y[order], frame.weight[order]
    states, first = np.unique(x, return_index=True)
    roots: list[Root] = []
    for i, state in enumerate(states):
        own = slice(first[i], first[i + 1] if i + 1 < len(first) else None)
        belief = np.zeros(variables.hidden.size)
        belief[y[own]] = weight[own]
        chance = float(belief.sum())
        name = variables.observed.names[int(state)]
        roots.append(Root(int(state), belief / chance, chance, name))
    if len(roots) == 1:
        return (Root(roots[0].x, roots[0].belief),)
    return tuple(roots)

"""The simulated people of a sweep, made from what a grid says of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

from coadapt.errors import excerpt
from coadapt.formalism import Model
from coadapt.requirements import FieldError
from coadapt.simulation.partners import KINDS, DescribedPartner, PartnerError, partner_from

OTHER = "other"
"""As ``mode``: the goal that is worth less, where there are two."""

Person = dict[str, object]
"""A simulated person by names and values, see `coadapt.simulation.partners.partner_from`."""


def settled(values: Mapping[str, object], rewards: Mapping[str, float]) -> Person:
    """One person as a cell holds them: all that is left out given, the first goal by its name.

    So people who are alike are written alike.

    Args:
        values: names and values, one each.
        rewards: what each goal of the task is worth.

    Raises:
        FieldError: if a value cannot be used.
    """
    found = dict(values)
    kind = KINDS.get(str(found.setdefault("kind", "follower")))
    inner = found.get("of")
    if isinstance(inner, Mapping):
        try:
            found["of"] = settled(cast("Mapping[str, object]", inner), rewards)
        except FieldError as error:
            raise FieldError(("of", *error.key), error.problem) from error
    else:
        found.setdefault("adaptability", 0.5)
        _settle_mode(found, rewards)
    numbers: Mapping[str, float] = {} if kind is None else kind.numbers
    for name, default in numbers.items():
        found.setdefault(name, default)
    whole = () if kind is None else kind.whole
    settled_values = {name: v if name in whole else _as_float(v) for name, v in found.items()}
    try:
        _ = partner_from(settled_values, tuple(rewards))
    except PartnerError as error:
        raise FieldError((error.key,), error.problem) from error
    return settled_values


def partner_of(values: Mapping[str, object], model: Model) -> DescribedPartner:
    """The person that a cell holds.

    Raises:
        PartnerError: if a value cannot be used.
    """
    return partner_from(values, model.mode_names)


def _settle_mode(found: dict[str, object], rewards: Mapping[str, float]) -> None:
    mode = found.get("mode")
    if mode == OTHER and OTHER not in rewards:
        if len(rewards) != 2:
            raise FieldError(("mode",), f"is {OTHER!r}, which is for tasks with two goals")
        found["mode"] = min(rewards, key=lambda name: rewards[name])
    elif mode is not None and mode not in rewards:
        known = ", ".join(rewards)
        raise FieldError(("mode",), f"is {excerpt(str(mode))}, expected one of {known}, {OTHER}")


def _as_float(value: object) -> object:
    """Whole numbers as floats, those of lists too."""
    if isinstance(value, list | tuple):
        return [_as_float(part) for part in cast("list[object]", value)]
    return float(value) + 0.0 if isinstance(value, int | float) else value

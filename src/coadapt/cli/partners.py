"""``coadapt partners``: the kinds of simulated people, and how they are named in options."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from coadapt.errors import InputError, excerpt

if TYPE_CHECKING:
    from coadapt.formalism import Model
    from coadapt.simulation import DescribedPartner


@click.command(name="partners")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(*, as_json: bool) -> None:
    """List the kinds of simulated people.

    With each are the numbers that describe them, and their defaults.
    """
    from coadapt.simulation.partners import KINDS

    if as_json:
        kinds = {name: {"about": k.about, "numbers": dict(k.numbers)} for name, k in KINDS.items()}
        click.echo(json.dumps(kinds))
        return
    width = 2 + max(map(len, KINDS))
    for name, kind in KINDS.items():
        click.echo(f"{name:<{width}}{kind.about}")
        for number, default in kind.numbers.items():
            click.echo(f"{'':<{width}}{number}={default:g}")


def partner_of(
    kind: str, numbers: Sequence[str], alpha: Sequence[float], mode: int | None, model: Model
) -> DescribedPartner:
    """The person whom the options of a command describe, found usable.

    Args:
        kind: ``--partner-kind``.
        numbers: ``--partner-number``, each ``NAME=VALUE``.
        alpha: adaptability, one number or one for each goal.
        mode: the first mode, or None.
        model: of the robot.

    Raises:
        InputError: if they cannot be used; names the option.
    """
    from coadapt.simulation.partners import KINDS, PartnerError, partner_from

    description: dict[str, object] = {"kind": kind, "mode": mode}
    description["adaptability"] = alpha[0] if len(alpha) == 1 else tuple(alpha)
    for given in numbers:
        name, _, value = given.partition("=")
        known = list(KINDS[kind].numbers) if kind in KINDS else []
        if name not in known:
            names = ", ".join(known) or "none"
            raise InputError(
                f"--partner-number must be NAME=VALUE for one of: {names}, not {excerpt(given)}"
            )
        description[name] = _number(given, value)
    try:
        person = partner_from(description)
        _ = person.tables(model)
    except PartnerError as error:
        option = {"kind": "--partner-kind", "adaptability": "--partner"}
        raise InputError(f"{option.get(error.key, error.key)} {error.problem}") from error
    except ValueError as error:
        raise InputError(f"--partner-kind {kind} cannot be used: {error}") from error
    return person


def _number(given: str, value: str) -> float:
    try:
        return int(value) if value.lstrip("+-").isdecimal() else float(value)
    except ValueError as error:
        raise InputError(
            f"--partner-number must be NAME=VALUE with a number, not {excerpt(given)}"
        ) from error

"""Partners by their names, for files and the command line."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import cast

from coadapt.errors import InputError
from coadapt.simulation.partners.contrarian import Contrarian
from coadapt.simulation.partners.drift import drifting, tiring
from coadapt.simulation.partners.lapse import Lapsing
from coadapt.simulation.partners.memory import OwnMemory
from coadapt.simulation.partners.noise import Noisy
from coadapt.simulation.partners.person import DescribedPartner
from coadapt.simulation.partners.simulated import SimulatedPartner
from coadapt.simulation.partners.temperature import Tempered
from coadapt.simulation.partners.wandering import Wandering
from coadapt.simulation.partners.yielding import Yielding

Alpha = float | Sequence[float]
Numbers = Mapping[str, float]


class PartnerError(InputError):
    """A description of a partner cannot be used.

    Attributes:
        key: the key that is meant.
        problem: the rest of the sentence that begins with it.
    """

    def __init__(self, key: str, problem: str) -> None:
        super().__init__(f"{key} {problem}")
        self.key = key
        self.problem = problem


@dataclass(frozen=True)
class Kind:
    """A kind of partner.

    Attributes:
        about: what such a person does, in a few words.
        numbers: the numbers that describe one, with their defaults.
        around: makes one of another person; None if `alone` is given.
        alone: makes one of alpha and the first mode.
        whole: names of the numbers that are whole.
    """

    about: str
    numbers: Mapping[str, float] = field(default_factory=dict[str, float])
    around: Callable[[DescribedPartner, Numbers], DescribedPartner] | None = None
    alone: Callable[[Alpha, int | None, Numbers], DescribedPartner] | None = None
    whole: tuple[str, ...] = ()


KINDS: dict[str, Kind] = {
    "follower": Kind(
        "follows the adaptation model", alone=lambda alpha, mode, _: SimulatedPartner(alpha, mode)
    ),
    "memory": Kind(
        "remembers another number of the robot's steps",
        {"memory": 3},
        around=lambda person, n: OwnMemory(person, int(n["memory"])),
        whole=("memory",),
    ),
    "noisy": Kind(
        "gives another input than they mean with probability `rate`",
        {"rate": 0.1},
        around=lambda person, n: Noisy(person, n["rate"]),
    ),
    "lapsing": Kind(
        "is absent-minded in a share `rate` of the steps, for `length` steps on average",
        {"rate": 0.1, "length": 3.0},
        around=lambda person, n: Lapsing(person, n["rate"], n["length"]),
    ),
    "drifting": Kind(
        "has an alpha that moves up or down by 0.1 with probability `rate` a step",
        {"rate": 0.3},
        alone=lambda alpha, mode, n: drifting(_one(alpha), n["rate"], mode),
    ),
    "tiring": Kind(
        "has an alpha that falls by 0.1 with probability `rate` a step",
        {"rate": 0.3},
        alone=lambda alpha, mode, n: tiring(_one(alpha), n["rate"], mode),
    ),
    "yielding": Kind(
        "has the alpha `before` for `steps` steps, and then their own",
        {"steps": 5, "before": 0.0},
        alone=lambda alpha, mode, n: Yielding(_one(alpha), int(n["steps"]), n["before"], mode),
        whole=("steps",),
    ),
    "wandering": Kind(
        "changes their goal with probability `rate` a step, whatever the robot does",
        {"rate": 0.05},
        around=lambda person, n: Wandering(person, n["rate"]),
    ),
    "tempered": Kind(
        "chooses inputs at another temperature",
        {"temperature": 2.0},
        around=lambda person, n: Tempered(person, n["temperature"]),
    ),
    "contrarian": Kind(
        "switches away from the goal that the robot seems to head for",
        around=lambda person, _: Contrarian(person),
    ),
}
"""All kinds, by name."""


def partner_from(
    description: Mapping[str, object], mode_names: Sequence[str] = ()
) -> DescribedPartner:
    """The partner that a small table describes, such as one in a TOML file.

    ``{"kind": "noisy", "adaptability": 0.5, "mode": "left", "rate": 0.1}``: the kind is one of
    `KINDS`, and its numbers may be given or left at their defaults. ``adaptability`` is a number,
    or a list with one for each goal; ``mode``, the first mode, is a name or an index, and drawn
    from the model's prior if left out. Instead of these two a kind that changes a person in one
    respect may be put around another one: ``{"kind": "noisy", "of": {"kind": "contrarian",
    "adaptability": 0.5}}``.

    Args:
        description: the table; the kind is "follower" if it names none.
        mode_names: names of the modes, in their order.

    Raises:
        PartnerError: if it cannot be used; names the key.
    """
    rest = dict(description)
    name = rest.pop("kind", "follower")
    if not isinstance(name, str) or name not in KINDS:
        raise PartnerError("kind", f"must be one of {', '.join(KINDS)}, not {name!r}")
    kind = KINDS[name]
    numbers = {key: _number(kind, key, rest.pop(key, kind.numbers[key])) for key in kind.numbers}
    inner = rest.pop("of", None)
    try:
        if inner is not None:
            if kind.around is None or not isinstance(inner, Mapping):
                raise PartnerError("of", f"is for a table, around which {name} cannot be put")
            person = partner_from(cast("Mapping[str, object]", inner), mode_names)
            _require_nothing(rest, name, (*kind.numbers, "of"))
            return kind.around(person, numbers)
        alpha, mode = _alpha(rest.pop("adaptability", 0.5)), _mode(rest, mode_names)
        _require_nothing(rest, name, ("adaptability", "mode", *kind.numbers))
        if kind.alone is not None:
            return kind.alone(alpha, mode, numbers)
        assert kind.around is not None
        return kind.around(SimulatedPartner(alpha, mode), numbers)
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise PartnerError(name, f"cannot be used: {error}") from error


def _require_nothing(rest: Mapping[str, object], name: str, known: Sequence[str]) -> None:
    for key in rest:
        raise PartnerError(key, f"is not one of {', '.join(known)}, which a {name} partner has")


def _number(kind: Kind, key: str, value: object) -> float:
    whole = key in kind.whole
    right = isinstance(value, int) if whole else isinstance(value, int | float)
    if not right or isinstance(value, bool):
        raise PartnerError(key, f"must be a {'whole ' if whole else ''}number, not {value!r}")
    return cast("float", value)


def _alpha(value: object) -> Alpha:
    parts = cast("Sequence[object]", value if isinstance(value, list | tuple) else [value])
    if not all(isinstance(part, int | float) and not isinstance(part, bool) for part in parts):
        raise PartnerError("adaptability", f"must be a number or a list of them, not {value!r}")
    numbers = cast("Sequence[float]", parts)
    return tuple(map(float, numbers)) if isinstance(value, list | tuple) else float(numbers[0])


def _one(alpha: Alpha) -> float:
    if not isinstance(alpha, float):
        raise PartnerError("adaptability", f"must be one number for this kind, not {alpha}")
    return alpha


def _mode(rest: dict[str, object], names: Sequence[str]) -> int | None:
    mode = rest.pop("mode", None)
    if mode is None or (isinstance(mode, int) and not isinstance(mode, bool)):
        return mode
    if mode not in names:
        raise PartnerError("mode", f"must be one of {', '.join(names)}, not {mode!r}")
    return list(names).index(cast("str", mode))

"""The part of a task that describes the person: what they steer with, how they adapt."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import msgspec
import numpy as np

from coadapt.arrays import FloatArray
from coadapt.errors import excerpt
from coadapt.formalism.shared_autonomy import PAPER_ADAPTABILITY
from coadapt.human import Adaptability
from coadapt.human.inputs import Inputs
from coadapt.requirements import FieldError, require, require_chance, require_distribution

MOST_ADAPTABILITIES = 100

LARGEST_CONCENTRATION = 500.0


class ActionInputs(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    forbid_unknown_fields=True,
    tag_field="kind",
    tag="actions",
):
    """The person asks for the robot's actions, as in the paper.

    Attributes:
        error: probability of another input than the wanted one, all alike, in [0, 1].
        silence: probability that there is no input in a step, in [0, 1).
    """

    error: float = 0.0
    silence: float = 0.0

    def __post_init__(self) -> None:
        require_chance(("error",), self.error, most_included=True)
        require_chance(("silence",), self.silence, most_included=False)

    def build(self, actions: Sequence[str], directions: FloatArray) -> Inputs:
        """For a world's ``actions`` and where they point, ``[A, 2]``."""
        return Inputs.actions(actions, directions, self.error, self.silence)


class JoystickInputs(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    forbid_unknown_fields=True,
    tag_field="kind",
    tag="joystick",
):
    """The person pushes a joystick in one of eight directions.

    Attributes:
        concentration: how well they aim, at least 0, see `Inputs.joystick`.
        silence: probability that there is no input in a step, in [0, 1).
    """

    concentration: float = 4.0
    silence: float = 0.0

    def __post_init__(self) -> None:
        most = LARGEST_CONCENTRATION
        require_chance(("concentration",), self.concentration, most, most_included=True)
        require_chance(("silence",), self.silence, most_included=False)

    def build(self, actions: Sequence[str], directions: FloatArray) -> Inputs:
        """For a world's ``actions`` and where they point, ``[A, 2]``.

        Raises:
            FieldError: if none of the actions points anywhere.
        """
        if not directions.any():
            raise FieldError(
                ("inputs", "kind"),
                "is 'joystick', expected actions that point somewhere: name them left, forward, "
                "right ..., or give their directions",
            )
        return Inputs.joystick(directions, self.concentration, self.silence)


class SwitchInputs(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    forbid_unknown_fields=True,
    tag_field="kind",
    tag="switch",
):
    """The person has one button.

    Attributes:
        pressed_for: the actions for which they press it; they leave it alone for the others.
        error: probability of the other thing, in [0, 0.5].
        silence: probability that a step does not look at the button, in [0, 1).
    """

    pressed_for: tuple[str, ...]
    error: float = 0.05
    silence: float = 0.0

    def __post_init__(self) -> None:
        require_chance(("error",), self.error, 0.5, most_included=True)
        require_chance(("silence",), self.silence, most_included=False)

    def build(self, actions: Sequence[str], directions: FloatArray) -> Inputs:
        """For a world's ``actions``; where they point does not matter.

        Raises:
            FieldError: if the button is not pressed for some of the actions, and not for all.
        """
        key = ("inputs", "pressed_for")
        for name in self.pressed_for:
            require(key, name in actions, f"some of {', '.join(actions)}", excerpt(name))
        pressed = {actions.index(name) for name in self.pressed_for}
        require(key, 0 < len(pressed) < len(actions), "some actions and not all", len(pressed))
        return Inputs.switch(len(actions), pressed, self.error, self.silence)


AnyInputs = ActionInputs | JoystickInputs | SwitchInputs


class TaskAdaptability(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What the robot assumes of the person's adaptability.

    Attributes:
        values: values of alpha in [0, 1], increasing; or rows of one value for each goal.
        prior: their probabilities; all alike by default.
        beta: instead of values and prior, the two parameters of a beta distribution.
        points: number of values that stand for it.
        drift, fatigue, switching: how alpha changes, at most one of them, a rate per step: see
            `Adaptability.drifting`, `Adaptability.tiring`, `Adaptability.switching`.
    """

    values: tuple[float | tuple[float, ...], ...] | None = None
    prior: tuple[float, ...] | None = None
    beta: tuple[float, float] | None = None
    points: int | None = None
    drift: float | None = None
    fatigue: float | None = None
    switching: float | None = None

    def __post_init__(self) -> None:
        if self.beta is not None:
            for name, given in (("values", self.values), ("prior", self.prior)):
                require(
                    (name,), given is None, "left out where there is a beta distribution", given
                )
            require(("beta",), min(self.beta) >= 0.1, "two numbers from 0.1 to 1000", self.beta)
            require(("beta",), max(self.beta) <= 1000, "two numbers from 0.1 to 1000", self.beta)
        elif self.points is not None:
            raise FieldError(("points",), "needs a beta distribution")
        points = self.points
        if points is not None:
            wanted = f"from 1 to {MOST_ADAPTABILITIES}"
            require(("points",), 1 <= points <= MOST_ADAPTABILITIES, wanted, points)
        if self.values is not None:
            self._require_values(self.values)
        if self.prior is not None:
            require_distribution(("prior",), self.prior, len(self.values or PAPER_ADAPTABILITY))
        changes = [name for name in ("drift", "fatigue", "switching") if getattr(self, name)]
        if len(changes) > 1:
            raise FieldError((changes[1],), f"is given beside {changes[0]}, expected one of them")
        for name in ("drift", "fatigue", "switching"):
            rate: float | None = getattr(self, name)
            require_chance((name,), 0.0 if rate is None else rate, most_included=True)

    def _require_values(self, values: tuple[float | tuple[float, ...], ...]) -> None:
        wanted = f"1 to {MOST_ADAPTABILITIES} values"
        require(("values",), 1 <= len(values) <= MOST_ADAPTABILITIES, wanted, len(values))
        rows = [value if isinstance(value, tuple) else (value,) for value in values]
        by_goal = isinstance(values[0], tuple)
        alike = all(isinstance(value, tuple) == by_goal for value in values)
        alike = alike and all(len(row) == len(rows[0]) for row in rows)
        require(("values",), alike, "all numbers, or all rows of one length", list(values))
        shown = ",".join("/".join(f"{v:g}" for v in row) for row in rows)
        inside = all(0 <= v <= 1 for row in rows for v in row)
        require(("values",), inside, "values from 0 to 1", shown)
        if by_goal:
            require(("values",), len(set(rows)) == len(rows), "rows that differ", shown)
        else:
            increasing = all(a < b for a, b in pairwise(rows))
            require(("values",), increasing, "increasing values", shown)

    def build(self, goals: int) -> Adaptability:
        """For a task of ``goals`` goals.

        Raises:
            FieldError: if there are values for another number of goals, or the change does not fit.
        """
        if self.beta is not None:
            a, b = self.beta
            points = 10 if self.points is None else self.points
            # The logarithm of x**(a-1) (1-x)**(b-1) at its highest, so that nothing underflows.
            peak = (a - 1) / (a + b - 2) if a > 1 and b > 1 else 0.5
            top = (a - 1) * np.log(peak) + (b - 1) * np.log1p(-peak)

            def density(x: float) -> float:
                return float(np.exp((a - 1) * np.log(x) + (b - 1) * np.log1p(-x) - top))

            alpha = Adaptability.from_density(density, points)
        else:
            values = np.array(PAPER_ADAPTABILITY if self.values is None else self.values)
            if values.ndim == 2:
                wanted = f"rows of {goals} values, one for each goal"
                key = ("adaptability", "values")
                require(key, values.shape[1] == goals, wanted, f"{values.shape[1]}")
            alpha = Adaptability.over(values, self.prior)
        if self.drift:
            return alpha.drifting(self.drift)
        if self.switching:
            return alpha.switching(self.switching)
        if self.fatigue:
            try:
                return alpha.tiring(self.fatigue)
            except ValueError as error:
                raise FieldError(("adaptability", "fatigue"), f"cannot be used: {error}") from error
        return alpha

"""Options that several commands share: what a robot is built from."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, TypeVar

import click

from coadapt.errors import InputError

if TYPE_CHECKING:
    from coadapt.robots.built_setup import BuiltSetup
    from coadapt.robots.task_setup import AnySetup
    from coadapt.tasks import BuiltTask

Function = TypeVar("Function", bound=Callable[..., Any])

ROBOTS = ("mutual_adaptation", "one_way_adaptation", "no_adaptation")


def numbers(text: str) -> tuple[float, ...]:
    """``"0,0.5,1"`` as ``(0.0, 0.5, 1.0)``."""
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        raise click.BadParameter(f"{text!r} is not a list of numbers like 0,0.5,1") from None


def number_option(
    flag: str, kind: click.FloatRange, default: float, meaning: str
) -> Callable[[Function], Function]:
    """An option for a number, whose default the help shows."""
    return click.option(flag, type=kind, default=default, show_default=True, help=meaning)


# Name, type, default, meaning. The defaults are those of `RobotSetup`, repeated so that the help
# need not import it; a test compares them. A task has defaults of its own.
SETUP_OPTIONS: tuple[tuple[str, Any, object, str], ...] = (
    ("robot", click.Choice(ROBOTS), "mutual_adaptation", "The robot."),
    ("columns", int, 13, "Width of the grid in cells, for table clearing."),
    ("rows", int, 4, "Depth of the grid in cells, for table clearing."),
    ("left_reward", float, 10.0, "Reward of the left goal, for table clearing."),
    ("right_reward", float, 11.0, "Reward of the right goal, for table clearing."),
    ("memory", int, 1, "Steps from which the person infers the robot's goal."),
    ("adaptability", numbers, (0.0, 0.25, 0.5, 0.75, 1.0), "Values of alpha, increasing."),
    ("disagreement_cost", float, -0.32, "Penalty C of a step in disagreement, at most 0."),
    ("discount", float, 0.99, "Discount per step."),
    ("step_cost", float, 3.0, "Step cost of the modal policies, in nats."),
    ("match_threshold", float, 0.9, "Agreement from which the input is executed."),
    ("gap", float, 1e-3, "Planning stops when its bounds are this close."),
)


def setup_options(function: Function) -> Function:
    """Add the options of `SETUP_OPTIONS`. One that is not given arrives as None."""
    for name, kind, default, meaning in reversed(SETUP_OPTIONS):
        option = click.option(
            _flag(name), name, type=kind, default=None, help=f"{meaning}  [{_shown(default)}]"
        )
        function = option(function)
    return function


def changed_setup(base: AnySetup, given: Mapping[str, object]) -> AnySetup:
    """``base`` with the options that were given in place of its values, found usable.

    Raises:
        InputError: if a value cannot be used; names the option.
    """
    from coadapt.requirements import FieldError
    from coadapt.robots.setup import SetupError
    from coadapt.robots.task_setup import changed

    changes = {name: value for name, value in given.items() if value is not None}
    try:
        setup = changed(base, changes)
        _ = setup.model()
    except SetupError as error:
        raise InputError(f"{_flag(error.field)} {error.problem}") from error
    except FieldError as error:
        # The task itself was found usable: it is an option that does not go with the rest.
        name = str(error.key[-1]) if error.key else ""
        if name in changes:
            raise InputError(f"{_flag(name)} {error.problem}") from error
        raise InputError(f"the options do not fit the task: {error}") from error
    return setup


def changed_built(task: BuiltTask, given: Mapping[str, object]) -> BuiltSetup:
    """The setup of a built task with the options that were given, found usable.

    Raises:
        InputError: if a value cannot be used; names the option.
    """
    from coadapt.robots.built_setup import built_setup
    from coadapt.robots.setup import SetupError

    try:
        return built_setup(task, {n: value for n, value in given.items() if value is not None})
    except SetupError as error:
        raise InputError(f"{_flag(error.field)} {error.problem}") from error


def _flag(name: str) -> str:
    return f"--{name.replace('_', '-')}"


def _shown(default: object) -> str:
    if isinstance(default, tuple):
        return ",".join(f"{part:g}" for part in default)  # pyright: ignore
    return f"{default:g}" if isinstance(default, float) else f"{default}"

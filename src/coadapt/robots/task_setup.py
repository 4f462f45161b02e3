"""A robot for any task, written down: the task itself and what to build for it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import cast

import msgspec

from coadapt.formalism import SharedAutonomy
from coadapt.requirements import FieldError
from coadapt.robots.setup import (
    ConditionRobot,
    Progress,
    RobotName,
    RobotSetup,
    SetupError,
    planned_robot,
    require_planned,
)
from coadapt.tasks import Task
from coadapt.tasks.person import TaskAdaptability

MODEL_FIELDS = ("memory", "disagreement_cost", "discount", "step_cost")
"""Values of a task's model that can be changed by their names."""

LAYOUT_FIELDS = ("columns", "rows", "left_reward", "right_reward")
"""Values of `RobotSetup` that no other task has."""


class TaskSetup(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a robot for a task is built from.

    Attributes:
        task: the task, all of it.
        robot: which of the robots of Sec. 6.1.
        match_threshold: agreement at which the input is executed, at least 0; above 1 it never is.
        gap: the planner stops when its bounds are this close.

    Raises:
        SetupError: if a value is out of its range; names the value.
    """

    task: Task
    robot: RobotName = "mutual_adaptation"
    match_threshold: float = 0.9
    gap: float = 1e-3

    def __post_init__(self) -> None:
        require_planned(self)

    def model(self) -> SharedAutonomy:
        """World and people, the same for all three robots.

        Raises:
            FieldError: if the parts of the task do not fit together.
        """
        return self.task.build()

    def build(self, progress: Progress | None = None) -> ConditionRobot:
        """The robot, its policy planned now, see `planned_robot`.

        Raises:
            FieldError: as `model`.
        """
        return planned_robot(self, progress)


AnySetup = RobotSetup | TaskSetup


def changed(setup: AnySetup, changes: Mapping[str, object]) -> AnySetup:
    """``setup`` with other values for some names, those of `RobotSetup`.

    Raises:
        SetupError: if a value is out of its range, or the task has no such value.
    """
    if isinstance(setup, RobotSetup):
        return msgspec.structs.replace(setup, **changes)
    task = setup.task
    for name in changes:
        if name in LAYOUT_FIELDS:
            raise SetupError(name, f"is for table clearing alone, not for {task.name}")
    try:
        model = {name: changes[name] for name in MODEL_FIELDS if name in changes}
        if model:
            new = msgspec.structs.replace(task.model, **model)
            task = msgspec.structs.replace(task, model=new)
        if "adaptability" in changes:
            values = cast("tuple[float, ...]", changes["adaptability"])
            adaptability = TaskAdaptability(values=values)
            task = msgspec.structs.replace(task, adaptability=adaptability)
    except FieldError as error:
        raise SetupError(_field(error), error.problem) from error
    rest = {
        name: value
        for name, value in changes.items()
        if name not in (*MODEL_FIELDS, "adaptability")
    }
    return msgspec.structs.replace(setup, task=task, **rest)


def differences(a: AnySetup, b: AnySetup) -> Iterator[str]:
    """The names of the values in which two setups differ; those of a task's parts with dots."""
    before, now = (msgspec.to_builtins(setup) for setup in (a, b))
    if type(a) is not type(b):
        yield "task"
        return
    yield from _differences(before, now, "")


def read_setup(data: bytes) -> AnySetup:
    """The setup in the JSON object ``data``, of either kind.

    Raises:
        ValueError: if it is none, or a value is out of its range.
    """
    try:
        kind = TaskSetup if msgspec.json.decode(data, type=_Kind).task else RobotSetup
        return msgspec.json.decode(data, type=kind)
    except msgspec.MsgspecError as error:
        raise ValueError(str(error)) from error


class _Kind(msgspec.Struct):
    """Tells the two kinds of setup apart."""

    task: msgspec.Raw = msgspec.Raw()


def _differences(before: object, now: object, place: str) -> Iterator[str]:
    old, new = _parts(before), _parts(now)
    is_row = not isinstance(now, dict)
    if old is None or new is None or (is_row and old.keys() != new.keys()):
        if before != now:
            yield place
        return
    for name in sorted({*old, *new}):
        inner = f"{place}{name}" if name.startswith("[") else f"{place}.{name}".lstrip(".")
        yield from _differences(old.get(name), new.get(name), inner)


def _parts(value: object) -> dict[str, object] | None:
    """The parts of a table, or of a row of tables such as goals; None of anything else."""
    if isinstance(value, dict):
        return cast("dict[str, object]", value)
    if isinstance(value, list | tuple):
        parts = cast("Sequence[object]", value)
        if all(isinstance(part, dict) for part in parts):
            return {f"[{i}]": part for i, part in enumerate(parts)}
    return None


def _field(error: FieldError) -> str:
    """The name of the value that is meant, as in `RobotSetup`."""
    name = str(error.key[-1]) if error.key else "task"
    return "adaptability" if name in ("values", "prior") else name

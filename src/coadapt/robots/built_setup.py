"""A robot for a task in which the person moves the world too."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from coadapt.formalism import Collaboration
from coadapt.robots.collaborator import Collaborator
from coadapt.robots.setup import Progress, SetupError, planned_policy, require_field
from coadapt.tasks import BuiltTask

MODEL_FIELDS = ("memory", "adaptability", "discount")
"""Values of the model that can be changed by their names."""


@dataclass(frozen=True)
class BuiltSetup:
    """What a robot for a built task is built from.

    Attributes:
        task: the task.
        changes: values of its model in place of the task's own, by the names in `MODEL_FIELDS`.
        gap: the planner stops when its bounds are this close.
    """

    task: BuiltTask
    changes: Mapping[str, object] = field(default_factory=dict[str, object])
    gap: float = 1e-3

    def model(self) -> Collaboration:
        """World and people.

        Raises:
            SetupError: if a value is out of its range.
        """
        model = self.task.build()
        for name, value in self.changes.items():
            try:
                model = replace(model, **{name: value})
            except ValueError as error:
                raise SetupError(name, f"cannot be used: {error}") from error
        return model

    def build(self, progress: Progress | None = None) -> Collaborator:
        """The robot, its policy planned now.

        Raises:
            SetupError: as `model`.
            KeyboardInterrupt: if planning was interrupted.
        """
        model = self.model()
        return Collaborator(model, planned_policy(model.to_momdp(), self.gap, progress))


def built_setup(task: BuiltTask, changes: Mapping[str, object]) -> BuiltSetup:
    """A setup with other values for some names, those of `coadapt.robots.setup.RobotSetup`.

    Raises:
        SetupError: if a value is out of its range, or there is no such value in a built task.
    """
    for name in changes:
        if name not in (*MODEL_FIELDS, "gap"):
            raise SetupError(name, f"is not for {task.name}, in which the person moves the world")
    model = {name: changes[name] for name in MODEL_FIELDS if name in changes}
    gap = changes.get("gap", BuiltSetup.gap)
    assert isinstance(gap, float)
    require_field("gap", 0 < gap < float("inf"), "a number above 0", gap)
    setup = BuiltSetup(task, model, gap)
    _ = setup.model()
    return setup

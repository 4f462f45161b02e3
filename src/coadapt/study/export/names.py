"""What the numbers of a study's events stand for."""

from __future__ import annotations

import os
from dataclasses import dataclass

from coadapt.formalism import SharedAutonomy
from coadapt.human.history import NO_ACTION
from coadapt.study.protocol import Study
from coadapt.study.protocol.reader import study_task


@dataclass(frozen=True)
class Names:
    """Names of goals, inputs and actions, in the order of their indices.

    Attributes:
        model: the world and the inputs, the same in all conditions but for the rewards.
        goals, inputs, actions: names.
    """

    model: SharedAutonomy
    goals: tuple[str, ...]
    inputs: tuple[str, ...]
    actions: tuple[str, ...]

    @classmethod
    def of(cls, study: Study, directory: str | os.PathLike[str]) -> Names:
        """Those of ``study``, whose task is found from ``directory``.

        Raises:
            InputError: if there is no such task.
        """
        return cls.of_model(study_task(study, directory).build())

    @classmethod
    def of_model(cls, model: SharedAutonomy) -> Names:
        """Those of a model."""
        return cls(
            model=model,
            goals=tuple(goal.name for goal in model.world.goals),
            inputs=tuple(model.interface.names),
            actions=tuple(model.world.action_names),
        )

    def goal(self, index: int | None) -> str | None:
        """The goal's name; None for none."""
        return None if index is None else self.goals[index]

    def input(self, index: int | None) -> str | None:
        """The input's name; None for none."""
        return None if index is None else self.inputs[index]

    def action(self, index: int | None) -> str | None:
        """The action's name; None for none."""
        return None if index is None else self.actions[index]

    def is_disagreement(self, human_input: int | None, action: int | None) -> bool:
        """Whether the input asks for an action, and this is another."""
        if human_input is None:
            return False
        asked = int(self.model.interface.asks[human_input])
        return asked not in (NO_ACTION, action)

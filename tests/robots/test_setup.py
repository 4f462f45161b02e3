"""A setup builds the robot it describes, the same each time, and refuses what it cannot."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np
import pytest

from coadapt.errors import InputError
from coadapt.formalism import SharedAutonomy
from coadapt.robots import MatchRule, MutualAdaptation, NoAdaptation, OneWayAdaptation
from coadapt.robots.setup import RobotSetup, SetupError
from coadapt.worlds import table_clearing


def test_defaults_are_those_of_the_parts() -> None:
    setup = RobotSetup()
    model, other = setup.model(), SharedAutonomy(table_clearing())
    assert model.world.goals == other.world.goals
    assert np.array_equal(model.world.moves, other.world.moves)
    assert np.array_equal(model.prior, other.prior)
    assert np.array_equal(model.reward, other.reward)
    assert np.array_equal(model.modal_policies, other.modal_policies)
    assert model.discount == other.discount
    assert setup.match_threshold == MatchRule().threshold


def test_a_setup_survives_json() -> None:
    setup = RobotSetup(robot="one_way_adaptation", adaptability=(0.1, 1 / 3), gap=1e-2)
    text = msgspec.json.encode(setup)
    assert msgspec.json.decode(text, type=RobotSetup) == setup


@pytest.mark.parametrize(
    ("robot", "kind"),
    [
        ("mutual_adaptation", MutualAdaptation),
        ("one_way_adaptation", OneWayAdaptation),
        ("no_adaptation", NoAdaptation),
    ],
)
def test_build(robot: Any, kind: type) -> None:
    stages: list[str] = []
    setup = RobotSetup(robot=robot, columns=7, rows=3, match_threshold=0.8)
    built, again = setup.build(stages.append), setup.build()
    assert isinstance(built, kind)
    assert built.name == robot
    assert stages[0] == "Building the model"
    if isinstance(built, MutualAdaptation):
        assert built.match_rule.threshold == 0.8
    if isinstance(built, MutualAdaptation | OneWayAdaptation):
        assert isinstance(again, MutualAdaptation | OneWayAdaptation)
        assert built.policy.vectors.tobytes() == again.policy.vectors.tobytes()
        assert built.policy.actions.tobytes() == again.policy.actions.tobytes()
        assert any(stage.startswith("Planning: value between") for stage in stages)


def test_what_progress_raises_ends_the_planning() -> None:
    class Enough(Exception):
        pass

    def stop(stage: str) -> None:
        if stage.startswith("Planning"):
            raise Enough

    with pytest.raises(Enough):
        RobotSetup(columns=7, rows=3).build(stop)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("robot", "kind"),
        ("columns", 2),
        ("columns", 10**9),
        ("rows", 0),
        ("left_reward", float("nan")),
        ("memory", 0),
        ("memory", 101),
        ("right_reward", float("inf")),
        ("adaptability", ()),
        ("adaptability", (0.5, 0.5)),
        ("adaptability", (0.0, 1.5)),
        ("adaptability", (float("nan"),)),
        ("adaptability", tuple(i / 200 for i in range(101))),
        ("disagreement_cost", 0.1),
        ("disagreement_cost", float("-inf")),
        ("discount", 1.0),
        ("step_cost", 0.0),
        ("step_cost", float("inf")),
        ("match_threshold", -0.1),
        ("match_threshold", float("inf")),
        ("gap", 0.0),
        ("gap", float("nan")),
    ],
)
def test_what_cannot_be_used_is_named(field: str, value: object) -> None:
    with pytest.raises(SetupError, match=f"^{field} must be ") as caught:
        RobotSetup(**{field: value})  # pyright: ignore
    assert caught.value.field == field
    assert isinstance(caught.value, InputError)


def test_a_memory_that_makes_too_many_windows() -> None:
    # About 52 * 3^9 of them; see tests/human/test_history.py.
    with pytest.raises(SetupError, match=r"memory must be so short that .* windows") as caught:
        RobotSetup(memory=10).model()
    assert caught.value.field == "memory"
    assert RobotSetup(memory=4).model().memory == 4


def test_a_step_cost_for_which_paths_have_no_distribution() -> None:
    # The modal policies need a cost above ln 3 = 1.0986 on a grid without ends (see modal.py).
    with pytest.raises(SetupError, match=r"step_cost cannot be used: .*infinite"):
        RobotSetup(step_cost=0.2).model()

"""A task in TOML is the world and the model it says, or is refused with file, key and line."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt import SharedAutonomy
from coadapt.errors import FileError
from coadapt.human import Adaptability
from coadapt.requirements import FieldError
from coadapt.tasks import Task, parse_task, read_task
from coadapt.tasks.map import DIRECTIONS
from coadapt.tasks.show import description
from coadapt.worlds import table_clearing

MAP = """
format = 1
name = "room"  # line 3

[map]
drawing = \"\"\"
LL#..R
......
.@..@.
\"\"\"
moves = ["left", "forward", "right"]

[[goals]]
name = "left"
symbol = "L"
reward = 10

[[goals]]
name = "right"
symbol = "R"
reward = 11
"""

GRAPH = """
format = 1
name = "drawer"

[graph]
states = ["closed", "ajar", "open", "jammed"]
actions = ["pull", "push"]
start = { closed = 0.75, ajar = 0.25 }

[graph.moves]
closed = { pull = { ajar = 0.9, closed = 0.1 } }
ajar = { pull = "open", push = "closed" }

[[goals]]
name = "open"
reward = 1

[[goals]]
name = "stuck"
states = ["jammed"]
reward = -1
"""


def parse(text: str) -> Task:
    return parse_task(text.encode(), "t.toml")


def test_a_map_is_its_drawing() -> None:
    task = parse(MAP)
    world = task.world()
    # Three rows of six cells without the obstacle; rows count away from the person.
    assert world.states == 17
    assert world.state_names[0] == "column 0 row 0"
    assert world.action_names == ("left", "forward", "right")
    left, right = world.goals
    assert [world.state_names[x] for x in left.states] == ["column 0 row 2", "column 1 row 2"]
    assert [world.state_names[x] for x in right.states] == ["column 5 row 2"]
    assert (left.reward, right.reward) == (10, 11)
    starts = {world.state_names[x]: p for x, p in world.start_chances.items()}
    assert starts == {"column 1 row 0": 0.5, "column 4 row 0": 0.5}
    assert world.is_deterministic
    assert world.costs is None


def test_the_defaults_are_those_of_the_model() -> None:
    model, other = parse(MAP).build(), SharedAutonomy(table_clearing())
    assert model.memory == other.memory
    assert model.discount == other.discount
    assert model.disagreement_cost == other.disagreement_cost
    assert model.action_disagreement_cost == other.action_disagreement_cost
    assert model.step_cost == other.step_cost
    np.testing.assert_array_equal(model.alpha.values, other.alpha.values)
    np.testing.assert_array_equal(model.prior, other.prior)
    assert model.inputs is None


def test_a_map_with_everything() -> None:
    text = MAP.replace('"right"]', '"right", "back", "forward left", "stay"]\nslip = 0.2')
    text = text.replace("slip = 0.2", "slip = 0.2\nmove_cost = 0.5")
    text = text.replace("reward = 10", "reward = 10\nprior = 0.25")
    text = text.replace("reward = 11", "reward = 11\nprior = 0.75")
    text += """
[inputs]
kind = "joystick"
concentration = 2
silence = 0.25

[adaptability]
values = [[0, 0.5], [0.25, 1]]
prior = [0.5, 0.5]
fatigue = 0.1

[model]
memory = 2
disagreement_cost = -1
action_disagreement_cost = -0.5
discount = 0.9
step_cost = 4
"""
    model = parse(text).build()
    world = model.world
    assert world.directions.tolist() == [list(DIRECTIONS[name]) for name in world.action_names]
    # Another of the other five moves with 0.2: the chances of forward from the free middle.
    x = world.state_names.index("column 3 row 0")
    to = dict(zip(world.outcomes[x, 1].tolist(), world.outcome_chances[x, 1].tolist(), strict=True))
    assert to[world.state_names.index("column 3 row 1")] == pytest.approx(0.8)
    assert to[world.state_names.index("column 2 row 1")] == pytest.approx(0.04)
    assert to[x] == pytest.approx(0.08)  # back is off the grid, and stay
    np.testing.assert_array_equal(world.costs, 0.5)
    assert model.interface.names[0] == "right"
    assert len(model.interface) == 8
    assert model.interface.silence == 0.25
    np.testing.assert_array_equal(model.alpha.values, [[0, 0.5], [0.25, 1]])
    np.testing.assert_allclose(model.alpha.transition, [[1, 0], [0.1, 0.9]])
    np.testing.assert_allclose(model.prior, [[0.125, 0.375]] * 2)
    assert (model.memory, model.discount, model.step_cost) == (2, 0.9, 4)
    assert (model.disagreement_cost, model.action_disagreement_cost) == (-1, -0.5)


def test_a_graph_is_what_it_lists() -> None:
    task = parse(GRAPH)
    world = task.world()
    assert world.state_names == ("closed", "ajar", "open", "jammed")
    assert world.start_chances == {0: 0.75, 1: 0.25}

    def ends(state: str, action: str) -> dict[str, float]:
        x, a = world.state_names.index(state), world.action_names.index(action)
        pairs = zip(world.outcomes[x, a], world.outcome_chances[x, a], strict=True)
        return {world.state_names[y]: p for y, p in pairs if p > 0}

    assert ends("closed", "pull") == {"ajar": 0.9, "closed": 0.1}
    assert ends("closed", "push") == {"closed": 1.0}  # left out: it stays
    assert ends("ajar", "pull") == {"open": 1.0}
    assert [goal.states for goal in world.goals] == [(2,), (3,)]
    assert world.goals[1].reward == -1
    # By the moves from the start: both starts, then open; jammed cannot be reached.
    assert world.positions.tolist() == [[0, 0], [1, 0], [0, 1], [0, 2]]
    assert not world.directions.any()


def test_positions_and_directions_of_a_graph() -> None:
    text = GRAPH.replace(
        "[graph.moves]",
        "positions = { closed = [0, 0], ajar = [0, 1], open = [0, 2], jammed = [1, 1] }\n"
        "directions = { pull = [0, 1] }\n[graph.moves]",
    )
    world = parse(text).world()
    assert world.positions.tolist() == [[0, 0], [0, 1], [0, 2], [1, 1]]
    assert world.directions.tolist() == [[0, 1], [0, 0]]


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        ("", Adaptability.over([0, 0.25, 0.5, 0.75, 1])),
        ("values = [0, 1]\nprior = [0.25, 0.75]", Adaptability.over([0, 1], [0.25, 0.75])),
        ("drift = 0.1", Adaptability.over([0, 0.25, 0.5, 0.75, 1]).drifting(0.1)),
        ("values = [0, 1]\nfatigue = 0.1", Adaptability.over([0, 1]).tiring(0.1)),
        ("switching = 0.1", Adaptability.over([0, 0.25, 0.5, 0.75, 1]).switching(0.1)),
        (
            "beta = [2, 5]\npoints = 4",
            Adaptability.from_density(lambda x: x * (1 - x) ** 4, 4),
        ),
        (
            "beta = [0.5, 0.5]",
            Adaptability.from_density(lambda x: (x * (1 - x)) ** -0.5, 10),
        ),
    ],
)
def test_adaptability(lines: str, expected: Adaptability) -> None:
    found = parse(f"{MAP}\n[adaptability]\n{lines}\n").adaptability.build(2)
    np.testing.assert_array_equal(found.values, expected.values)
    np.testing.assert_allclose(found.prior, expected.prior, rtol=1e-9)
    np.testing.assert_allclose(found.transition, expected.transition, rtol=1e-12)


def test_a_switch() -> None:
    model = parse(
        f'{MAP}\n[inputs]\nkind = "switch"\npressed_for = ["left"]\nerror = 0.2\n'
    ).build()
    assert model.interface.names == ("press", "leave")
    np.testing.assert_allclose(
        model.interface.likelihood, [[0.8, 0.2], [0.2, 0.8], [0.2, 0.8]], atol=1e-15
    )


@pytest.mark.parametrize("text", [MAP, GRAPH])
def test_a_task_survives_json(text: str) -> None:
    task = parse(text)
    again = msgspec.json.decode(msgspec.json.encode(task), type=Task)
    assert again == task
    assert description(again) == description(task)


BAD: list[tuple[str, str, int | None, list[str]]] = [
    (MAP.replace("format = 1", "format = 2"), "", 2, ["format is 2, newer than"]),
    (MAP.replace("format = 1", "format = 0"), "", 2, ["format must be 1, not 0"]),
    (MAP.replace("format = 1", ""), "", None, ["missing required field `format`"]),
    (MAP.replace('"room"', '""'), "", 3, ["name must be 1 to 60 letters"]),
    (MAP.replace('"room"', "7"), "", 3, ["name: expected `str`, got `int`"]),
    (MAP.replace('"room"', '"room'), "", 3, ["found no TOML"]),
    (MAP.replace('"room"', '"ro\\u001bom"'), "", 3, ["name must be"]),
    (MAP, "tittle = 1", 23, ["goals[1]: ", "tittle"]),
    (MAP.replace("reward = 11", "reward = nan"), "", 21, ["goals[1].reward must be a number"]),
    (MAP.replace("reward = 11", 'reward = "much"'), "", 21, ["goals[1].reward: expected `float`"]),
    (MAP.replace("reward = 11", ""), "", 18, ["goals[1]: ", "`reward`"]),
    (MAP.replace("reward = 11", "reward = 11\nprior = 0.5"), "", 13, ["goals[0].prior is missing"]),
    (MAP.replace('name = "right"', 'name = "left"'), "", None, ["goals has 'left' twice"]),
    (MAP.replace('symbol = "R"', 'symbol = "L"'), "", 20, ["goals[1].symbol is 'L' like that"]),
    (MAP.replace('symbol = "R"', 'symbol = "X"'), "", 6, ["no cell 'X', expected one for right"]),
    (MAP.replace('symbol = "R"', 'symbol = "#"'), "", 20, ["goals[1].symbol must be one char"]),
    (MAP.replace('symbol = "R"', 'states = ["R"]'), "", 20, ["is for graphs"]),
    (MAP.replace(".@..@.", "......"), "", 6, ["has no @, expected one where it starts"]),
    (MAP.replace("......\n", ".....\n"), "", 6, ["5 cells in its line 2, expected 6"]),
    (MAP.replace("......\n", "...q..\n"), "", 6, ["'q' in its line 2, column 4, expected one of"]),
    (MAP.replace("......", "." * 30_000), "", 6, ["drawing must be so small"]),
    (MAP.replace('"left", ', '"lift", '), "", 11, ["map.moves must be some of left, forward"]),
    (MAP.replace('"left", ', '"right", '), "", 11, ["map.moves has 'right' twice"]),
    (MAP.replace('["left", "forward", "right"]', "[]"), "", 11, ["1 to 30 names, not 0"]),
    (MAP.replace("moves", "slip = 1\nmoves"), "", 11, ["map.slip must be at least 0 and below 1"]),
    (MAP.replace("[map]", "[graph]"), "", 6, ["graph: ", "`drawing`"]),
    (GRAPH.replace("[graph", "[graf"), "", 5, ["`graf`"]),
    (
        GRAPH.replace("[[goals]]", '[map]\ndrawing = "@"\n[[goals]]', 1),
        "",
        None,
        ["both a map and"],
    ),
    (GRAPH.replace('pull = "open"', 'pull = "opne"'), "", 12, ["names 'opne', expected one of"]),
    (GRAPH.replace('push = "closed"', 'pusch = "closed"'), "", 12, ["'pusch'", "the actions"]),
    (GRAPH.replace("ajar = {", "ajjar = {"), "", 12, ["'ajjar'", "the states"]),
    (GRAPH.replace("closed = 0.1", "closed = 0.2"), "", 11, ["sum to 1, not a sum of 1.1"]),
    (GRAPH.replace("closed = 0.1", "closed = -0.1"), "", 11, ["positive probabilities"]),
    (GRAPH.replace("ajar = 0.25", "ajar = 0.5"), "", 8, ["graph.start must be prob"]),
    (GRAPH.replace('["jammed"]', '["hot"]'), "", 20, ["goals[1].states names 'hot'"]),
    (GRAPH.replace('["jammed"]', '["open"]'), "", 5, ["two goals share a state"]),
    (GRAPH.replace('["jammed"]', '["closed"]'), "", 5, ["the start, closed, is a goal"]),
    (GRAPH.replace('["jammed"]', "[]"), "", 20, ["at least one state"]),
    (GRAPH, "[inputs]\nkind = 'joystick'", 24, ["inputs.kind is 'joystick', expected actions"]),
    (GRAPH, "[inputs]\nkind = 'mouse'", 24, ["mouse"]),
    (MAP, "[inputs]\nkind = 'joystick'\nsilence = 1", 25, ["inputs.silence must be at least 0"]),
    (MAP, "[inputs]\nkind = 'switch'\npressed_for = ['up']", 25, ["some of left, forward, right"]),
    (MAP, "[inputs]\nkind = 'switch'\npressed_for = []", 25, ["some actions and not all"]),
    (MAP, "[inputs]\nkind = 'switch'", 23, ["inputs: ", "`pressed_for`"]),
    (MAP, "[adaptability]\nvalues = [1, 0]", 24, ["adaptability.values must be increasing"]),
    (MAP, "[adaptability]\nvalues = [0, 2]", 24, ["values from 0 to 1, not 0,2"]),
    (MAP, "[adaptability]\nvalues = [[0, 1], 1]", 24, ["all numbers, or all rows"]),
    (MAP, "[adaptability]\nvalues = [[0, 1, 1]]", 24, ["rows of 2 values, one for each goal"]),
    (MAP, "[adaptability]\nvalues = [[0, 1], [0, 1]]", 24, ["rows that differ"]),
    (MAP, "[adaptability]\nprior = [1]", 24, ["adaptability.prior must be 5 probabilities"]),
    (MAP, "[adaptability]\nbeta = [0, 1]", 24, ["adaptability.beta must be two numbers"]),
    (MAP, "[adaptability]\nbeta = [1, 1]\nvalues = [0]", 25, ["left out"]),
    (MAP, "[adaptability]\npoints = 3", 24, ["adaptability.points needs a beta"]),
    (MAP, "[adaptability]\ndrift = 2", 24, ["adaptability.drift must be from 0 to 1"]),
    (MAP, "[adaptability]\ndrift = 0.1\nfatigue = 0.1", 25, ["fatigue is given beside drift"]),
    (MAP, "[adaptability]\nvalues = [[0,1],[1,0]]\nfatigue = 0.1", 25, ["cannot be used"]),
    (MAP, "[model]\nmemory = 0", 24, ["model.memory must be from 1 to 100, not 0"]),
    (MAP, "[model]\nmemory = 30", 24, ["model.memory must be so short", "windows"]),
    (MAP, "[model]\ndiscount = 1", 24, ["model.discount must be at least 0 and below 1"]),
    (MAP, "[model]\ndisagreement_cost = 1", 24, ["a number of at most 0, not 1"]),
    (MAP, "[model]\nstep_cost = 0.3", 24, ["model.step_cost cannot be used", "too small"]),
    (MAP, "[model]\nstep_cost = inf", 24, ["above 0 and at most 1000"]),
    ("", "", None, ["missing required field"]),
    ("[" * 50_000, "", 1, ["found no TOML"]),
    (MAP, f"x = {'[' * 50_000}", None, ["found no TOML"]),
    (MAP, f"about2 = {'9' * 10_000}", None, ["found no TOML"]),
]


@pytest.mark.parametrize(("text", "more", "line", "words"), BAD)
def test_what_cannot_be_used_is_named(
    text: str, more: str, line: int | None, words: list[str]
) -> None:
    with pytest.raises(FileError) as caught:
        parse(f"{text}\n{more}\n" if more else text)
    message = str(caught.value)
    place = "t.toml: " if line is None else f"t.toml:{line}: "
    assert message.startswith(place), message
    assert message.isprintable()
    assert len(message) < 500
    for word in words:
        assert word in message, message


@given(st.lists(st.sampled_from([*MAP.splitlines(), *GRAPH.splitlines(), "[", "x=1"]), max_size=30))
def test_any_lines_are_a_task_or_refused(lines: list[str]) -> None:
    try:
        task = parse("\n".join(lines))
    except FileError as error:
        assert str(error).isprintable()
    else:
        assert task.build().prior.sum() == pytest.approx(1.0)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="no readable file"):
        read_task(tmp_path)
    (tmp_path / "bytes.toml").write_bytes(b"format = 1\n\xff")
    with pytest.raises(FileError, match=r"bytes\.toml:2: found byte 0xff, expected UTF-8"):
        read_task(tmp_path / "bytes.toml")
    (tmp_path / "large.toml").write_bytes(b"#" * 1_000_001)
    with pytest.raises(FileError, match="more than 1,000,000 bytes"):
        read_task(tmp_path / "large.toml")


def test_line_ends_do_not_matter(tmp_path: Path) -> None:
    (tmp_path / "dos.toml").write_bytes(MAP.replace("\n", "\r\n").encode())
    assert read_task(tmp_path / "dos.toml") == parse(MAP)


def test_from_python_the_key_is_named() -> None:
    with pytest.raises(FieldError, match=r"^memory must be from 1 to 100, not 0$") as caught:
        msgspec.structs.replace(parse(MAP).model, memory=0)
    assert caught.value.key == ("memory",)
    replace: Any = msgspec.structs.replace
    with pytest.raises(FieldError, match="takes at most 60,000 bytes"):
        states = tuple(f"a rather long name of a state numbered {i}" for i in range(2000))
        graph = replace(parse(GRAPH).graph, states=("closed", "ajar", "open", "jammed", *states))
        replace(parse(GRAPH), graph=graph)

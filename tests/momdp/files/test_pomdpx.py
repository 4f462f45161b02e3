"""Each rule of the `.pomdpx` format on a file small enough to work out by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from coadapt.momdp import MOMDPWarning, check_momdp
from tests.momdp.files.helpers import joint, problem_from

# A robot in one of three cells, seen; a rock, bad or good, hidden; its colour, hidden, numbered.
VARIABLES = """<Variable>
<StateVar vnamePrev="cell_0" vnameCurr="cell_1" fullyObs="true">
  <ValueEnum>west mid east</ValueEnum></StateVar>
<StateVar vnamePrev="rock_0" vnameCurr="rock_1"><ValueEnum>bad good</ValueEnum></StateVar>
<ObsVar vname="sound"><ValueEnum>low high</ValueEnum></ObsVar>
<ActionVar vname="act"><ValueEnum>go wait</ValueEnum></ActionVar>
<RewardVar vname="gain"/><RewardVar vname="cost"/>
</Variable>"""

START = """<InitialStateBelief>
<CondProb><Var>cell_0</Var><Parent>null</Parent><Parameter type="TBL">
<Entry><Instance>-</Instance><ProbTable>0 1 0</ProbTable></Entry></Parameter></CondProb>
<CondProb><Var>rock_0</Var><Parent>null</Parent><Parameter type="TBL">
<Entry><Instance>-</Instance><ProbTable>uniform</ProbTable></Entry></Parameter></CondProb>
</InitialStateBelief>"""


def table(variable: str, parents: str, entries: str, *, reward: bool = False) -> str:
    """The table of a variable; entries are lines ``instance = numbers``."""
    element, kind = ("Func", "ValueTable") if reward else ("CondProb", "ProbTable")
    rows = [line.split("=") for line in entries.strip().splitlines()]
    text = "".join(
        f"<Entry><Instance>{instance}</Instance><{kind}>{numbers}</{kind}></Entry>\n"
        for instance, numbers in rows
    )
    return (
        f"<{element}><Var>{variable}</Var><Parent>{parents}</Parent>"
        f'<Parameter type="TBL">{text}</Parameter></{element}>'
    )


CELL = table("cell_1", "act cell_0", "wait - - = identity\ngo west mid = 1\ngo mid - = 0 0 1\n"
             "go east east = 1.0")  # fmt: skip
ROCK = table("rock_1", "rock_0", "- - = identity")
SOUND = table("sound", "act", "* - = uniform")
GAIN = table("gain", "act", "go = 1", reward=True)
COST = table("cost", "null", " = -0.25", reward=True)


def document(
    *, cell: str = CELL, rock: str = ROCK, sound: str = SOUND, gain: str = GAIN, cost: str = COST,
    start: str = START, variables: str = VARIABLES,
) -> str:  # fmt: skip
    return f"""<?xml version="1.0" encoding="ISO-8859-1"?>
<pomdpx version="1.0" id="test" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance">
<Description>A <b>test</b> &amp; more</Description>
<Discount> 0.75 </Discount>
{variables}
{start}
<StateTransitionFunction>{cell}{rock}</StateTransitionFunction>
<ObsFunction>{sound}</ObsFunction>
<RewardFunction>{gain}{cost}</RewardFunction>
</pomdpx>
"""


def test_names_shape_and_start(tmp_path: Path) -> None:
    problem = problem_from(tmp_path, document(), ".pomdpx")
    assert problem.shape == (3, 2, 2, 2)
    assert problem.observed_names == ("west", "mid", "east")
    assert problem.hidden_names == ("bad", "good")
    assert problem.action_names == ("go", "wait")
    assert problem.observation_names == ("low", "high")
    assert problem.discount == 0.75
    assert [(r.x, r.probability, r.belief.tolist()) for r in problem.roots] == [(1, 1, [0.5, 0.5])]


def test_transitions_and_shared_maps(tmp_path: Path) -> None:
    problem = problem_from(tmp_path, document(), ".pomdpx")
    assert [list(joint(problem, x, 0)) for x in range(3)] == [[1], [2], [2]]
    assert [list(joint(problem, x, 1)) for x in range(3)] == [[0], [1], [2]]
    assert problem.transition.count == 1
    np.testing.assert_array_equal(problem.transition.matrix(0), np.eye(2))


def test_rewards_are_summed(tmp_path: Path) -> None:
    problem = problem_from(tmp_path, document(), ".pomdpx")
    np.testing.assert_array_equal(problem.reward[:, 0], 0.75)
    np.testing.assert_array_equal(problem.reward[:, 1], -0.25)


@pytest.mark.parametrize(
    ("entries", "matrix"),
    [
        ("- - = identity", [[1, 0], [0, 1]]),
        ("- - = uniform", [[0.5, 0.5], [0.5, 0.5]]),
        ("- - = 0.25 0.75 1 0", [[0.25, 0.75], [1, 0]]),
        ("* - = 0.25 0.75", [[0.25, 0.75], [0.25, 0.75]]),
        # Enumerated along the parent, for each named value.
        ("- bad = 0.25 1\n- good = 0.75 0", [[0.25, 0.75], [1, 0]]),
        ("* * = 0.5", [[0.5, 0.5], [0.5, 0.5]]),
        ("* * = uniform", [[0.5, 0.5], [0.5, 0.5]]),
        ("* good = 1", [[0, 1], [0, 1]]),
        # The last entry wins; an entry of 0 deletes.
        ("- - = identity\nbad * = 0\nbad good = 1", [[0, 1], [0, 1]]),
        ("bad good = 1\n- - = identity", [[1, 0], [0, 1]]),
    ],
)
def test_entries(tmp_path: Path, entries: str, matrix: list[list[float]]) -> None:
    rock = table("rock_1", "rock_0", entries)
    problem = problem_from(tmp_path, document(rock=rock), ".pomdpx")
    np.testing.assert_array_equal(problem.transition.matrix(0), matrix)


def test_hidden_by_action_and_observed_state(tmp_path: Path) -> None:
    # Waiting in the east turns the rock bad.
    rock = table("rock_1", "act cell_0 rock_0", "* * - - = identity\nwait east * - = 1 0")
    problem = problem_from(tmp_path, document(rock=rock), ".pomdpx")
    np.testing.assert_array_equal(joint(problem, 2, 1)[2], [[1, 0], [1, 0]])
    np.testing.assert_array_equal(joint(problem, 2, 0)[2], np.eye(2))
    assert problem.transition.count == 2


def test_observed_by_hidden_and_hidden_by_next_observed(tmp_path: Path) -> None:
    # Going from the west: a good rock lets the robot through to mid with 3/4. Who gets to mid
    # finds the rock bad afterwards; who stays keeps it.
    cell = table(
        "cell_1",
        "act cell_0 rock_0",
        "* west * west = 1\n* mid * mid = 1\n* east * east = 1\n"
        "go west good west = 0.25\ngo west good mid = 0.75",
    )
    rock = table("rock_1", "cell_1 rock_0", "* - - = identity\nmid * - = 1 0")
    problem = problem_from(tmp_path, document(cell=cell, rock=rock), ".pomdpx")
    moves = joint(problem, 0, 0)
    np.testing.assert_array_equal(moves[0], [[1, 0], [0, 0.25]])
    np.testing.assert_array_equal(moves[1], [[0, 0], [0.75, 0]])


def test_observation_by_action_cell_and_rock(tmp_path: Path) -> None:
    sound = table(
        "sound",
        "act cell_1 rock_1",
        "* * * - = 1 0\nwait mid - - = 0.875 0.125 0.125 0.875",
    )
    problem = problem_from(tmp_path, document(sound=sound), ".pomdpx")
    observation = problem.observation[problem.observation_index]  # [A, X, Y, O]
    np.testing.assert_array_equal(observation[0], np.tile([[1.0, 0.0], [1.0, 0.0]], (3, 1, 1)))
    np.testing.assert_array_equal(observation[1, 1], [[0.875, 0.125], [0.125, 0.875]])
    assert len(problem.observation) == 2


def test_reward_of_the_next_state_is_expected(tmp_path: Path) -> None:
    # From the west, going leads to mid. A bad rock becomes good with 1/4.
    rock = table("rock_1", "rock_0", "bad - = 0.75 0.25\ngood good = 1")
    gain = table("gain", "cell_1 rock_1", "mid good = 8\nmid bad = 4\neast * = 2", reward=True)
    problem = problem_from(tmp_path, document(rock=rock, gain=gain), ".pomdpx")
    np.testing.assert_array_equal(problem.reward[0, 0], [0.75 * 4 + 0.25 * 8 - 0.25, 7.75])
    np.testing.assert_array_equal(problem.reward[1, 0], [1.75, 1.75])
    np.testing.assert_array_equal(problem.reward[0, 1], [-0.25, -0.25])


def test_initial_belief_over_both(tmp_path: Path) -> None:
    start = (
        "<InitialStateBelief>"
        + table("rock_0", "cell_0", "* - = uniform\nwest - = 0.25 0.75")
        + table("cell_0", "null", "- = 0.5 0 0.5")
        + "</InitialStateBelief>"
    )
    roots = problem_from(tmp_path, document(start=start), ".pomdpx").roots
    assert [(root.x, root.probability) for root in roots] == [(0, 0.5), (2, 0.5)]
    assert [root.label for root in roots] == ["west", "east"]
    assert [root.belief.tolist() for root in roots] == [[0.25, 0.75], [0.5, 0.5]]


def test_several_variables_of_each_kind(tmp_path: Path) -> None:
    variables = """<Variable>
<ActionVar vname="a"><NumValues>2</NumValues></ActionVar>
<ActionVar vname="b"><ValueEnum>p q</ValueEnum></ActionVar>
<ObsVar vname="o"><NumValues>2</NumValues></ObsVar><ObsVar vname="p"><NumValues>3</NumValues>
</ObsVar>
<StateVar vnamePrev="x" vnameCurr="xx" fullyObs="1"><NumValues>2</NumValues></StateVar>
<StateVar vnamePrev="y" vnameCurr="yy"><NumValues>2</NumValues></StateVar>
<StateVar vnamePrev="w" vnameCurr="ww" fullyObs="true"><ValueEnum>u v</ValueEnum></StateVar>
<StateVar vnamePrev="z" vnameCurr="zz" fullyObs="false"><ValueEnum>j k l</ValueEnum></StateVar>
<RewardVar vname="r"/></Variable>"""
    start = "<InitialStateBelief>" + "".join(
        table(name, "null", "- = uniform") for name in ("x", "y", "w", "z")
    ) + "</InitialStateBelief>"  # fmt: skip
    moves = "".join(table(f"{name}{name}", name, "- - = identity") for name in ("x", "y", "w", "z"))
    sights = table("o", "yy", "- - = identity") + table("p", "zz", "- - = identity")
    gain = table("r", "b z w", "q k v = 1", reward=True)
    problem = problem_from(
        tmp_path,
        document(variables=variables, start=start, cell=moves, rock="", sound=sights, gain=gain,
                 cost=""),
        ".pomdpx",
    )  # fmt: skip
    assert problem.observed_names == ("s0,u", "s0,v", "s1,u", "s1,v")
    assert problem.hidden_names == ("s0,j", "s0,k", "s0,l", "s1,j", "s1,k", "s1,l")
    assert problem.action_names == ("a0,p", "a0,q", "a1,p", "a1,q")
    assert problem.observation_names == ("o0,o0", "o0,o1", "o0,o2", "o1,o0", "o1,o1", "o1,o2")
    # o tells y and p tells z, so the observation is the hidden state.
    np.testing.assert_array_equal(problem.observation[0], np.eye(6))
    expected = np.zeros((4, 4, 6))
    for x in (1, 3):
        for a in (1, 3):
            expected[x, a, [1, 4]] = 1
    np.testing.assert_array_equal(problem.reward, expected)
    assert len(problem.roots) == 4
    check_momdp(problem)


def test_without_observations_there_is_one(tmp_path: Path) -> None:
    variables = VARIABLES.replace(
        '<ObsVar vname="sound"><ValueEnum>low high</ValueEnum></ObsVar>', ""
    )
    text = document(variables=variables, sound="").replace("<ObsFunction></ObsFunction>", "")
    problem = problem_from(tmp_path, text, ".pomdpx")
    assert problem.observation_names == ("o0",)
    np.testing.assert_array_equal(problem.observation, np.ones((1, 2, 1)))


def test_without_hidden_variables_there_is_one_hidden_state(tmp_path: Path) -> None:
    variables = VARIABLES.replace('vnamePrev="rock_0"', 'vnamePrev="rock_0" fullyObs="true"')
    problem = problem_from(tmp_path, document(variables=variables), ".pomdpx")
    assert problem.shape == (6, 1, 2, 2)
    assert problem.hidden_names == ("y0",)
    with pytest.warns(MOMDPWarning, match="west,bad"):
        check_momdp(problem)


DIAGRAM = """<CondProb><Var>rock_1</Var><Parent>act cell_0 rock_0</Parent>
<Parameter type="DD"><DAG><Node var="act">
<Edge val="go"><SubDAG type="persistent" var="rock_1"/></Edge>
<Edge val="wait"><Node var="cell_0">
<Edge val="west"><SubDAG type="deterministic" var="rock_1" val="bad"/></Edge>
<Edge val="mid"><SubDAG type="uniform" var="rock_1"/></Edge>
<Edge val="east"><SubDAG type="template" idref="fade"/></Edge>
</Node></Edge></Node></DAG>
<SubDAGTemplate id="fade"><Node var="rock_0">
<Edge val="good"><Node var="rock_1">
<Edge val="good"><Terminal>0.75</Terminal></Edge><Edge val="bad"><Terminal>0.25</Terminal></Edge>
</Node></Edge>
<Edge val="bad"><SubDAG type="persistent" var="rock_1"/></Edge>
</Node></SubDAGTemplate></Parameter></CondProb>"""


def test_decision_diagram_of_a_distribution(tmp_path: Path) -> None:
    problem = problem_from(tmp_path, document(rock=DIAGRAM), ".pomdpx")
    for x in range(3):
        np.testing.assert_array_equal(*joint(problem, x, 0).values(), np.eye(2))
    found = [joint(problem, x, 1)[x].tolist() for x in range(3)]
    assert found == [[[1, 0], [1, 0]], [[0.5, 0.5], [0.5, 0.5]], [[1, 0], [0.25, 0.75]]]


def test_decision_diagram_of_a_reward(tmp_path: Path) -> None:
    gain = (
        "<Func><Var>gain</Var><Parent>act rock_0</Parent><Parameter type='DD'><DAG>"
        '<Node var="rock_0"><Edge val="good"><Terminal> 8 </Terminal></Edge>'
        '<Edge val="bad"><Node var="act"><Edge val="go"><Terminal>-2</Terminal></Edge></Node>'
        "</Edge></Node></DAG></Parameter></Func>"
    )
    problem = problem_from(tmp_path, document(gain=gain), ".pomdpx")
    np.testing.assert_array_equal(problem.reward[0], [[-2.25, 7.75], [-0.25, 7.75]])


def test_what_cannot_happen_may_be_left_out(tmp_path: Path) -> None:
    # The west is left and never entered: its observation after going is not needed.
    sound = table("sound", "act cell_1", "wait * - = 1 0\ngo mid - = 0 1\ngo east - = 0 1")
    problem = problem_from(tmp_path, document(sound=sound), ".pomdpx")
    observation = problem.observation[problem.observation_index]
    np.testing.assert_array_equal(observation[0, 0], 0.5)


def test_encodings(tmp_path: Path) -> None:
    text = document().replace("west", "wëst")
    for encoding in ("ISO-8859-1", "UTF-8", "UTF-16"):
        data = text.replace("ISO-8859-1", encoding).encode(encoding)
        assert problem_from(tmp_path, data, ".pomdpx").observed_names[0] == "wëst"

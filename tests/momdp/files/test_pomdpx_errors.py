"""What is wrong with a `.pomdpx` file: the line, what was found, what was expected."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.momdp.files.helpers import problem_from, refusal

# One entry a line, so that lines can be counted.
TEXT = """<?xml version="1.0"?>
<pomdpx>
<Discount>0.5</Discount>
<Variable>
<StateVar vnamePrev="x" vnameCurr="xx" fullyObs="true"><ValueEnum>u v</ValueEnum></StateVar>
<StateVar vnamePrev="y" vnameCurr="yy"><NumValues>2</NumValues></StateVar>
<ObsVar vname="o"><NumValues>2</NumValues></ObsVar>
<ActionVar vname="a"><NumValues>2</NumValues></ActionVar>
<RewardVar vname="r"/>
</Variable>
<InitialStateBelief>
<CondProb><Var>x</Var><Parent>null</Parent><Parameter type="TBL">
<Entry><Instance>-</Instance><ProbTable>0.5 0.5</ProbTable></Entry>
</Parameter></CondProb>
<CondProb><Var>y</Var><Parent>x</Parent><Parameter type="TBL">
<Entry><Instance>* -</Instance><ProbTable>uniform</ProbTable></Entry>
</Parameter></CondProb>
</InitialStateBelief>
<StateTransitionFunction>
<CondProb><Var>xx</Var><Parent>a x</Parent><Parameter type="TBL">
<Entry><Instance>* - -</Instance><ProbTable>identity</ProbTable></Entry>
</Parameter></CondProb>
<CondProb><Var>yy</Var><Parent>a x y</Parent><Parameter type="TBL">
<Entry><Instance>* * - -</Instance><ProbTable>identity</ProbTable></Entry>
</Parameter></CondProb>
</StateTransitionFunction>
<ObsFunction>
<CondProb><Var>o</Var><Parent>a xx yy</Parent><Parameter type="TBL">
<Entry><Instance>* * * -</Instance><ProbTable>1 0</ProbTable></Entry>
</Parameter></CondProb>
</ObsFunction>
<RewardFunction>
<Func><Var>r</Var><Parent>a y</Parent><Parameter type="TBL">
<Entry><Instance>* *</Instance><ValueTable>1</ValueTable></Entry>
</Parameter></Func>
</RewardFunction>
</pomdpx>
"""

LINES = dict(enumerate(TEXT.splitlines(), 1))
X_ENTRY, Y_ENTRY, O_ENTRY, R_ENTRY = 21, 24, 29, 34


def entry(instance: str, numbers: str, kind: str = "ProbTable") -> str:
    return f"<Entry><Instance>{instance}</Instance><{kind}>{numbers}</{kind}></Entry>"


@pytest.mark.parametrize(
    ("line", "new", "message"),
    [
        (2, "<problem>", "2: found <problem>, expected <pomdpx>"),
        (3, "", "33: found no <Discount>, expected one"),
        (3, "<Discount>1</Discount>", "3: found discount '1', expected at least 0 and below 1: "),
        (3, "<Discount>x</Discount>", "3: found 'x', expected a discount"),
        (3, "<Discount>.5</Discount><Discount>.5</Discount>", "3: found <Discount> again"),
        (3, "<Discount>.5</Discount><Horizon/>", "3: found <Horizon> in <pomdpx>, expected <Desc"),
        (3, "<Discount>.5</Discount> words", "4: found 'words' in <pomdpx>, expected elements"),
        (5, "", "12: found a table of 'x', expected one of y"),
        (5, "<StateVar vnamePrev='x'><NumValues>2</NumValues></StateVar>",
         "5: found <StateVar> without vnameCurr, expected vnameCurr='...'"),
        (5, "<StateVar vnamePrev='x' vnameCurr='y' fullyObs='true'><NumValues>2</NumValues>"
            "</StateVar>", "6: found 'y', expected a new name"),
        (6, "<StateVar vnamePrev='y' vnameCurr='yy' fullyObs='maybe'><NumValues>2</NumValues>"
            "</StateVar>", "6: found fullyObs='maybe', expected true or false"),
        (7, "<ObsVar vname='o'/>", "7: found neither of <ValueEnum> and <NumValues>"),
        (7, "<ObsVar vname='o'><NumValues>0</NumValues></ObsVar>", "7: found '0', expected the nu"),
        (7, "<ObsVar vname='o'><NumValues>1e3</NumValues></ObsVar>", "7: found '1e3', expected"),
        (7, "<ObsVar vname='o'><NumValues>1000000000</NumValues></ObsVar>",
         "7: found 1000000000 values, expected at most 1,000,000"),
        (7, "<ObsVar vname='o'><ValueEnum>p q p</ValueEnum></ObsVar>", "7: found 'p', expected a"),
        (7, "<ObsVar vname='o'><ValueEnum> </ValueEnum></ObsVar>", "7: found 0 values, expected"),
        (7, "<ObsVar vname='o'><ValueEnum>p *</ValueEnum></ObsVar>", "7: found '*', expected a"),
        (8, "", "4: found no <ActionVar>, expected at least one"),
        (9, "", "4: found no <RewardVar>, expected at least one"),
        (6, "<StateVar vnamePrev='y' vnameCurr='yy'><NumValues>900000</NumValues></StateVar>"
            "<StateVar vnamePrev='z' vnameCurr='zz'><NumValues>900000</NumValues></StateVar>",
         "6: found 900000 x 900000 hidden states, expected at most 1,000,000 in all"),
        (12, "<CondProb><Var>z</Var><Parent>null</Parent><Parameter>",
         "12: found a table of 'z', expected one of x, y"),
        (12, "<CondProb><Var>x y</Var><Parent>null</Parent><Parameter>",
         "12: found 'x y', expected one variable"),
        (12, "<CondProb><Var>y</Var><Parent>null</Parent><Parameter>",
         "15: found a second table of 'y', expected one"),
        (12, "<CondProb><Var>x</Var><Parent>y</Parent><Parameter>",
         "13: found 1 words in the instance, expected 2"),
        (12, "<CondProb><Var>x</Var><Parent>q</Parent><Parameter>",
         "12: found parent 'q', expected a variable, once"),
        (12, "<CondProb><Var>x</Var><Parent>null</Parent><Parameter type='CONT'>",
         "12: found type 'CONT', expected TBL or DD"),
        (13, entry("-", "0.5"), "13: found 1 numbers, expected 2"),
        (13, entry("-", "0.5 0.25"), "13: found probabilities of x that sum to 0.75, expected 1"),
        (13, entry("-", "1.5 -0.5"), "13: found '1.5', expected a probability from 0 to 1"),
        (13, entry("-", "0.5 half"), "13: found 'half', expected a probability"),
        (13, entry("-", "nan 1"), "13: found 'nan', expected a probability"),
        (13, entry("-", "inf 0"), "13: found 'inf', expected a probability"),
        (13, "", "11: found an initial belief with a total of 0, expected 1"),
        (13, "<Entry><Instance>-</Instance></Entry>", "13: found an <Entry> without table of nu"),
        (13, "<Entry><ProbTable>1 0</ProbTable></Entry>", "13: found an <Entry> without Instance"),
        (13, entry("-", "0.5 0.5", "ValueTable"),
         "13: found <ValueTable> in <InitialStateBelief>, expected <ProbTable>"),
        (15, "<CondProb><Var>y</Var><Parent>xx</Parent><Parameter>",
         "15: found parent xx of y, expected state variables before the step"),
        (X_ENTRY, entry("* w -", "1 0"), "21: found 'w', expected '*', '-' or a value such as"),
        (X_ENTRY, entry("a0 - -", "identity"),
         "20: found successors of action a1, state u and s0 with a total probability of 0, exp"),
        (X_ENTRY, entry("* - -", "1 0 0 0.5"), "21: found probabilities of xx given a = a0, x = v"),
        (Y_ENTRY, entry("* - - -", "identity"), "24: found identity for '* - - -', expected two"),
        (Y_ENTRY, entry("* * - s0", "identity"), "24: found identity for '* * - s0', expected two"),
        (Y_ENTRY, entry("* * * s0", "uniform"), "24: found 's0' before uniform, expected '-'"),
        (Y_ENTRY, entry("* * - -", "uniform uniform"), "24: found 'uniform', expected a probab"),
        (O_ENTRY, entry("a0 * * -", "1 0"), "28: found no observation after action a1 in state u"),
        (28, "<CondProb><Var>o</Var><Parent>a x</Parent><Parameter>",
         "29: found 4 words in the instance, expected 3"),
        (33, "<Func><Var>r</Var><Parent>a o</Parent><Parameter>",
         "33: found parent o of r, expected state and action variables"),
        (R_ENTRY, entry("* *", "x", "ValueTable"), "34: found 'x', expected a number"),
        (R_ENTRY, entry("* *", "identity", "ValueTable"), "34: found 'identity', expected a num"),
        (R_ENTRY, entry("* *", "1e999", "ValueTable"), "34: found '1e999', expected a number"),
        (R_ENTRY, entry("* *", "1"), "34: found <ProbTable> in <RewardFunction>, expected <Val"),
        (37, "", "38: found malformed XML (no element found), expected elements that are compl"),
        (37, "</pomdpx><more/>", "37: found malformed XML (junk after document element)"),
        (36, "<oops", "37: found malformed XML (not well-formed (invalid token))"),
    ],
)  # fmt: skip
def test_lines(tmp_path: Path, line: int, new: str, message: str) -> None:
    text = "\n".join(new if number == line else old for number, old in LINES.items()) + "\n"
    assert refusal(tmp_path, text, ".pomdpx").startswith(message)


def test_the_unchanged_file_is_read(tmp_path: Path) -> None:
    assert problem_from(tmp_path, TEXT, ".pomdpx").shape == (2, 2, 2, 2)


@pytest.mark.parametrize(
    "section", ["InitialStateBelief", "StateTransitionFunction", "ObsFunction", "RewardFunction"]
)
def test_missing_and_repeated_sections(tmp_path: Path, section: str) -> None:
    begin, end = TEXT.index(f"<{section}>"), TEXT.index(f"</{section}>") + len(section) + 3
    message = refusal(tmp_path, TEXT[:begin] + TEXT[end:], ".pomdpx")
    assert message.startswith(f"4: found no <{section}>, expected one")
    again = TEXT[:end] + f"<{section}>\n</{section}>" + TEXT[end:]
    assert f"found <{section}> again, expected it once" in refusal(tmp_path, again, ".pomdpx")
    empty = TEXT[:begin] + f"<{section}></{section}>" + TEXT[end:]
    assert "found no table of" in refusal(tmp_path, empty, ".pomdpx")


def test_circles(tmp_path: Path) -> None:
    text = TEXT.replace("<Parent>a x y</Parent>", "<Parent>a xx y</Parent>")
    text = text.replace("<Var>xx</Var><Parent>a x</Parent>", "<Var>xx</Var><Parent>yy x</Parent>")
    message = refusal(tmp_path, text, ".pomdpx")
    assert message.startswith("20: found xx depending on itself by way of its parents")


DIAGRAM = """<Func><Var>r</Var><Parent>a y</Parent><Parameter type="DD">
<DAG>{}</DAG>
<SubDAGTemplate id="t">{}</SubDAGTemplate>
</Parameter></Func>"""
LEAF = "<Node var='a'><Edge val='a0'><Terminal>1</Terminal></Edge></Node>"


@pytest.mark.parametrize(
    ("diagram", "template", "message"),
    [
        ("", LEAF, "34: found 0 elements, expected one node"),
        ("<Node var='z'><Edge val='1'/></Node>", LEAF, "34: found variable 'z', expected the"),
        ("<Node var='a'><Edge val='up'><Terminal>1</Terminal></Edge></Node>", LEAF,
         "34: found value 'up', expected one such as 'a0'"),
        ("<Node var='a'><Edge val='a0'/></Node>", LEAF, "34: found an unusable edge, expected"),
        ("<Node var='a'><Edge val='a0'><Terminal>x</Terminal></Edge></Node>", LEAF,
         "34: found 'x', expected a number"),
        ("<Node var='a'><Edge val='a0'><SubDAG type='template' idref='t'/></Edge></Node>", LEAF,
         "35: found 'a' a second time on a path, expected once"),
        ("<SubDAG type='template' idref='u'/>", LEAF, "34: found template 'u', expected the id"),
        ("<SubDAG type='template' idref='t'/>", "<SubDAG type='template' idref='t'/>",
         "35: found template 't', expected the id of one that does not lead back to itself"),
        ("<SubDAG type='uniform' var='a'/>", LEAF, "34: found 'uniform' for 'a', expected it for"),
    ],
)  # fmt: skip
def test_diagrams(tmp_path: Path, diagram: str, template: str, message: str) -> None:
    begin, end = TEXT.index("<Func>"), TEXT.index("</Func>") + len("</Func>")
    text = TEXT[:begin] + DIAGRAM.format(diagram, template) + TEXT[end:]
    assert refusal(tmp_path, text, ".pomdpx").startswith(message)


def test_a_diagram_needs_its_type(tmp_path: Path) -> None:
    text = TEXT.replace(LINES[R_ENTRY], f"<DAG>{LEAF}</DAG>")
    assert refusal(tmp_path, text, ".pomdpx").startswith("34: found <DAG>, expected <Entry>")

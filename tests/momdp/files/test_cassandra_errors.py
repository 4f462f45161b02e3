"""What is wrong with a `.pomdp` file: the line, what was found, what was expected."""

from __future__ import annotations

from pathlib import Path

import pytest

from coadapt.errors import InputError
from coadapt.momdp.files import read_pomdp
from tests.momdp.files.helpers import refusal

# Lines 1 to 5.
HEAD = "discount: 0.5\nvalues: reward\nstates: left right\nactions: stay swap\nobservations: 2\n"

# Lines 6 and 7.
BODY = "T: * identity\nO: * uniform\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "1: found no discount before the tables, expected 'discount: ...'"),
        ("discount: 1.0", "1: found discount '1.0', expected at least 0 and below 1: without"),
        ("discount: -0.1", "1: found discount '-0.1', expected at least 0 and below 1"),
        ("\ndiscount: x", "2: found 'x', expected a discount of at least 0 and below 1"),
        ("discount: nan", "1: found 'nan', expected a discount"),
        ("discount: 0.5\ndiscount: 0.5", "2: found discount again, expected it once"),
        ("discount 0.5", "1: found '0.5', expected ':'"),
        ("values: gold", "1: found 'gold', expected reward or cost"),
        ("states: 1000000000", "1: found 1000000000 states, expected at most 1,000,000"),
        ("states: 99999999999999999999", "1: found '99999999999999999999', expected how many"),
        ("states: 0", "1: found '0', expected how many states there are, or their names"),
        ("states: 2.5", "1: found '2.5', expected how many states"),
        ("states:\nactions: 2", "2: found 'actions', expected how many states"),
        ("states: a b a", "1: found 'a', expected each name of a state once"),
        ("states: a 3", "1: found '3', expected the name of a state, which starts with a letter"),
        ("actions: up *", "1: found '*', expected the name of an action"),
        ("rewards: 3", "1: found 'rewards', expected discount, values, states"),
        ("start: 0", "1: found start, expected states before it"),
        ("states: 2\nstart: 0.5 0.25 0.25",
         "2: found start probabilities that sum to 0.75, expected 1"),
        ("states: 2\nstart: 5", "2: found '5', expected a state, 'uniform', or a probability"),
        ("states: 2\nstart: -1.0 2.0", "2: found start probability -1, expected at least 0"),
        ("states: 2\nstart include: 7", "2: found '7', expected a state, its number below 2"),
        ("states: 2\nstart exclude: *", "2: found no state to start from"),
    ],
)  # fmt: skip
def test_declarations(tmp_path: Path, text: str, message: str) -> None:
    assert refusal(tmp_path, text).startswith(message)


@pytest.mark.parametrize("word", ["discount", "states", "actions", "observations"])
def test_missing_declarations(tmp_path: Path, word: str) -> None:
    lines = [line for line in HEAD.splitlines() if not line.startswith(word)]
    message = refusal(tmp_path, "\n".join(lines) + "\n" + BODY)
    assert message.startswith(f"5: found no {word} before the tables")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("states: 3", "8: found 'states', expected T, O or R"),
        ("T: up identity", "8: found 'up', expected an action, its number below 2, or '*'"),
        ("T: 2 identity", "8: found '2', expected an action"),
        ("T: stay : 2\n1 0", "8: found '2', expected a state"),
        ("T stay", "8: found 'stay', expected ':'"),
        ("T: stay : left : right", "8: found the end of the file, expected a probability"),
        ("T: stay : left : right nan", "8: found 'nan', expected a probability"),
        ("T: stay : left : right inf", "8: found 'inf', expected a probability"),
        ("T: stay : left : right 1e999", "8: found '1e999', expected a probability"),
        ("T: stay : left : right 1_0", "8: found '1_0', expected a probability"),
        ("T: stay : left : right -0.5", "8: found -0.5, expected a probability from 0 to 1"),
        ("T: stay : left : right 1.5", "8: found 1.5, expected a probability from 0 to 1"),
        ("T: stay : left : right 0.5",
         "8: found probabilities of T for action stay, state left that sum to 1.5, expected 1"),
        ("T: stay : left\n0 0", "8: found no probabilities of T for action stay, state left"),
        ("T: stay : left\n1", "9: found the end of the file after 1 of 2 numbers, expected 2"),
        ("T: stay\n1 0\n0 x", "10: found 'x', expected 4 probabilities, 'uniform' or 'identity'"),
        ("T: stay : left\n1 0 0", "9: found '0', expected T, O or R"),
        ("T: stay : left\n2 -1", "8: found 2, expected a probability from 0 to 1"),
        ("O: swap : right\n0.5 0.25", "8: found probabilities of O for action swap, state right"),
        ("O: swap : right : 2 1", "8: found '2', expected an observation"),
        ("O: * : *\n0 0", "8: found no probabilities of O for action stay, state left"),
        ("R: stay : left : right : 0 x", "8: found 'x', expected a reward"),
        ("R: stay : left : right\n1 x", "9: found 'x', expected 2 rewards"),
        ("R: stay : left : right : 0 nan", "8: found 'nan', expected a reward"),
    ],
)  # fmt: skip
def test_tables(tmp_path: Path, text: str, message: str) -> None:
    assert refusal(tmp_path, f"{HEAD}{BODY}{text}\n").startswith(message)


def test_what_was_never_given(tmp_path: Path) -> None:
    message = refusal(tmp_path, HEAD + "T: stay identity\nO: * uniform\n")
    assert message == (
        "7: found no probabilities of T for action swap, state left, expected a sum of 1"
    )


def test_the_line_is_that_of_the_last_entry_for_the_row(tmp_path: Path) -> None:
    message = refusal(tmp_path, HEAD + BODY + "T: * : right\n0.5 0.25\nT: swap : left\n1 0\n")
    assert message.startswith("8: found probabilities of T for action stay, state right that sum")


def test_sizes_are_checked_before_memory_is_taken(tmp_path: Path) -> None:
    message = refusal(
        tmp_path, "discount: 0\nstates: 1000000\nactions: 1000000\nobservations: 1000000\n"
    )
    assert message.startswith("found 1000000 x 1000000 states and actions, expected at most")


def test_messages_are_short_and_printable(tmp_path: Path) -> None:
    message = refusal(tmp_path, "values: \x1b[31m" + "z" * 5000)
    assert message.isprintable()
    assert len(message) < 200


def test_other_suffixes_and_missing_files(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"found a name that ends in '\.txt', expected"):
        read_pomdp(tmp_path / "a.txt")
    with pytest.raises(InputError, match="cannot be read: No such file"):
        read_pomdp(tmp_path / "a.POMDP")
    (tmp_path / "b.pomdp").mkdir()
    with pytest.raises(InputError, match="expected a file"):
        read_pomdp(tmp_path / "b.pomdp")
    with pytest.raises(InputError, match="cannot be read"):
        read_pomdp(tmp_path / "nul\x00.pomdp")

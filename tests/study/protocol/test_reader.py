"""The protocol file: the one that a new study starts from, and what is wrong with others."""

from __future__ import annotations

from pathlib import Path

import msgspec
import pytest

from coadapt.errors import FileError
from coadapt.robots.setup import ROBOT_NAMES
from coadapt.study.protocol import Study, read_study
from coadapt.study.protocol.reader import template

TEMPLATE = template().decode()


def read(directory: Path, text: str) -> Study:
    (directory / "study.toml").write_text(text)
    return read_study(directory)


def test_the_template_is_the_study_of_the_paper(tmp_path: Path) -> None:
    study = read(tmp_path, TEMPLATE)
    # Sec. 6.1 and 6.3: three robots, two training sessions, three trials; 6.5: rewards.
    assert {c.robot for c in study.conditions} == set(ROBOT_NAMES)
    assert (study.practice, study.trials) == (2, 3)
    assert (study.rewards.optimal, study.rewards.other) == (11, 10)
    # Sec. 6.2: 51 participants.
    assert sum(c.quota or 0 for c in study.conditions) == 51
    # Table I: two items of trust, five of collaboration, on five points.
    scored = {s.name: [i for i in s.items if i.expected is None] for s in study.scales}
    assert {name: len(items) for name, items in scored.items()} == {"trust": 2, "collaboration": 5}
    assert {len(s.points) for s in study.scales} == {5}


def test_a_protocol_survives_json(tmp_path: Path) -> None:
    study = read(tmp_path, TEMPLATE)
    assert msgspec.json.decode(msgspec.json.encode(study), type=Study) == study


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("format = 1", "format = 2", "format is 2, newer than this coadapt reads"),
        ("trials = 3", "trials = 0", "trials must be from 1 to 100, not 0"),
        ("trials = 3", "trails = 3", "unknown field `trails`"),
        ("step = 0.5", "step = 0.01", "clock.step must be from 0.05 to 10 seconds, not 0.01"),
        ("optimal = 11", "optimal = 9", "rewards.optimal must be above that of the other"),
        ('robot = "no_adaptation"', 'robot = "none"', "conditions[0]"),
        ('name = "no_adaptation"', 'name = "Bad name"', "conditions[0].name must be lower-case"),
        ('name = "no_adaptation"', 'name = "mutual_adaptation"', "'mutual_adaptation' twice"),
        ("expected = 4", "expected = 6", "items[3].expected must be a point from 1 to 5, not 6"),
        ('name = "trust_trustworthy"', 'name = "trust_right_thing"', "'trust_right_thing' twice"),
        ('name = "comments"', 'name = "trust_trustworthy"', "questions[1].name must be new"),
        ('participant = "PROLIFIC_PID"', 'participant = "ID"', "must be one of the parameters"),
        ('return_link = ""', 'return_link = "http://x.org"', "a link that begins with https://"),
        ('welcome = """', 'hello = """', "unknown field `hello`"),
        ('task = "table_clearing"', 'task = "remote_manipulator"', "a task with two goals"),
        ('task = "table_clearing"', 'task = "hallway"', "the person moves the world too"),
        ('task = "table_clearing"', 'task = "nowhere"', "found no such task"),
        ('method = "balanced"', 'method = "coin"', "allocation.method"),
    ],
)
def test_errors_name_the_line_and_what_was_expected(
    tmp_path: Path, old: str, new: str, expected: str
) -> None:
    assert TEMPLATE.count(old) >= 1
    text = TEMPLATE.replace(old, new, 1)
    with pytest.raises(FileError) as caught:
        read(tmp_path, text)
    message = str(caught.value)
    assert expected in message
    assert message.startswith(str(tmp_path / "study.toml"))
    assert caught.value.line is None or 1 <= caught.value.line <= text.count("\n")


def test_the_line_is_the_one_that_is_wrong(tmp_path: Path) -> None:
    text = TEMPLATE.replace("step = 0.5", "step = 0.01")
    with pytest.raises(FileError) as caught:
        read(tmp_path, text)
    assert caught.value.line is not None
    assert text.splitlines()[caught.value.line - 1].startswith("step = 0.01")

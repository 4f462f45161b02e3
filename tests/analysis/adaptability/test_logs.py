"""Recordings from logs are those that were simulated; other logs are refused in one line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from coadapt import SimulatedPartner, simulate
from coadapt.analysis.adaptability import Recordings
from coadapt.analysis.adaptability.logs import read_logs
from coadapt.errors import FileError
from coadapt.robots.setup import RobotSetup
from coadapt.simulation.log_reader import open_log
from coadapt.simulation.log_writer import whole_log

SETUP = RobotSetup(robot="no_adaptation", columns=5, rows=3)
ROBOT = SETUP.build()


def written(path: Path, people: int, trials: int, named: bool = True) -> Recordings:
    """A log of simulated people, and their recordings."""
    rng = np.random.default_rng(people)
    episodes = simulate(ROBOT, SimulatedPartner(0.5), people * trials, rng)
    with whole_log(path, ROBOT, SETUP, participants=named) as log:
        for i, episode in enumerate(episodes):
            for t, decision in enumerate(episode.decisions):
                log.write(float(t), i + 1, decision, f"P{i // trials}" if named else None)
    names = [f"P{p}" for p in range(people)]
    return Recordings.from_episodes(
        {name: episodes[p * trials : (p + 1) * trials] for p, name in enumerate(names)}
    )


def same_steps(a: Recordings, b: Recordings) -> bool:
    return all(
        np.array_equal(getattr(a, name), getattr(b, name))
        for name in ("first_trial", "first_step", "state", "human_input", "action")
    )


def test_participants_and_their_trials_are_read(tmp_path: Path) -> None:
    recordings = written(tmp_path / "study.csv", 3, 2)
    logs = read_logs([tmp_path / "study.csv"])
    assert logs.setup == SETUP
    assert logs.recordings.names == ("P0", "P1", "P2")
    assert same_steps(logs.recordings, recordings)
    with open_log(tmp_path / "study.csv") as log:
        rows = list(log.rows(("left", "forward", "right")))
    assert [row.participant for row in rows if row.trial == 3] == ["P1"] * recordings_len(rows, 3)


def recordings_len(rows: list, trial: int) -> int:
    return sum(row.trial == trial for row in rows)


def test_a_log_without_names_is_one_participant(tmp_path: Path) -> None:
    for name, people in (("a", 1), ("b", 2)):
        written(tmp_path / f"{name}.csv", people, 2, named=False)
    paths = [tmp_path / "a.csv", tmp_path / "b.csv"]
    logs = read_logs(paths)
    assert logs.recordings.names == ("a", "b")
    assert logs.recordings.trials.tolist() == [2, 4]
    each = read_logs(paths, each_trial=True).recordings
    assert each.names[:3] == ("a trial 1", "a trial 2", "b trial 1")
    assert len(each) == 6


def test_the_same_name_in_two_logs_is_two_people(tmp_path: Path) -> None:
    (tmp_path / "x").mkdir()
    written(tmp_path / "s.csv", 1, 1)
    written(tmp_path / "x" / "s.csv", 1, 1)
    logs = read_logs([tmp_path / "s.csv", tmp_path / "x" / "s.csv"])
    assert logs.recordings.names == ("s P0", "s P0'")


def test_a_participant_cannot_change_within_a_trial(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("time,input,trial,participant\n0,left,1,a\n1,left,1,b\n")
    with open_log(path) as log, pytest.raises(FileError, match=r":3: found participant 'b' in a"):
        list(log.rows(("left",)))


def test_logs_that_cannot_be_fitted(tmp_path: Path) -> None:
    path, other = tmp_path / "mine.csv", tmp_path / "other.csv"
    path.write_text("time,input\n0,left\n")
    with pytest.raises(FileError, match="found no robot's setup"):
        read_logs([path])
    written(path, 1, 1)
    wide = RobotSetup(robot="no_adaptation", columns=7, rows=3)
    with whole_log(other, wide.build(), wide) as log:
        (episode,) = simulate(wide.build(), SimulatedPartner(0.5), 1, np.random.default_rng(0))
        log.write(0.0, 1, episode.decisions[0])
    with pytest.raises(FileError, match=r"other.csv: found another columns than in .*mine.csv"):
        read_logs([path, other])
    text = path.read_text().splitlines()
    cells = text[4].split(",")
    cells[4] = "nowhere"
    path.write_text("\n".join([*text[:4], ",".join(cells)]) + "\n")
    with pytest.raises(FileError, match=r":5: found 'nowhere' as state"):
        read_logs([path])

"""Recordings from logs, those of `coadapt play`, of simulations or of a study."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from coadapt.analysis.adaptability.recordings import RecordedTrial, Recordings
from coadapt.errors import FileError, excerpt
from coadapt.formalism import SharedAutonomy
from coadapt.robots import NO_INPUT
from coadapt.robots.task_setup import AnySetup, differences
from coadapt.simulation.log import LogRow
from coadapt.simulation.log_reader import open_log

ROBOTS_OWN = (
    "robot",
    "match_threshold",
    "gap",
    "adaptability",
    "disagreement_cost",
    "discount",
    "left_reward",
    "right_reward",
    "reward",
)
"""Values of a setup that say nothing of the person: logs may differ in them."""


@dataclass(frozen=True)
class Logs:
    """What some logs hold together.

    Attributes:
        setup: of the first log; the others describe the same task and person.
        model: world and people.
        recordings: all participants.
    """

    setup: AnySetup
    model: SharedAutonomy
    recordings: Recordings


def logs_in(paths: Sequence[Path]) -> list[Path]:
    """``paths``, with the logs of a study's export in place of its folder.

    Raises:
        FileError: if a folder holds no logs.
    """
    found: list[Path] = []
    for path in paths:
        if not path.is_dir():
            found.append(path)
            continue
        inside = sorted((path / "logs").glob("*.csv"))
        if not inside:
            wanted = "found no logs in this folder, expected an export of a study with some"
            raise FileError(path, None, wanted)
        found += inside
    return found


def read_logs(paths: Sequence[str | os.PathLike[str]], *, each_trial: bool = False) -> Logs:
    """The recordings in at least one log.

    Participants are told apart by the column ``participant``. A log without it is one participant,
    named after the file; one whose name occurs in several logs is several participants.

    Args:
        paths: of the logs.
        each_trial: take every trial for another participant.

    Raises:
        FileError: if a log cannot be read, does not hold what the robot did, or is of another task
            or model than the first.
    """
    setup: AnySetup | None = None
    model: SharedAutonomy | None = None
    people: dict[str, list[RecordedTrial]] = {}
    for path in paths:
        with open_log(path) as log:
            if log.setup is None:
                raise FileError(
                    path,
                    None,
                    "found no robot's setup, expected a log that coadapt wrote; `coadapt replay` "
                    "makes one, but of what another robot would have done",
                )
            if setup is None or model is None:
                setup, model = log.setup, log.setup.model()
            other = [
                name
                for name in differences(setup, log.setup)
                if name.rpartition(".")[2] not in ROBOTS_OWN
            ]
            if other:
                raise FileError(
                    path, None, f"found another {other[0]} than in {paths[0]}, expected the same"
                )
            prefix = f"{Path(path).stem} " if len(paths) > 1 else ""
            found = _participants(log.rows(model.input_names), path, model, each_trial)
            for name, trials in found.items():
                label = f"{prefix}{name}".strip() or Path(path).stem
                while label in people:
                    label += "'"
                people[label] = trials
    assert setup is not None and model is not None, "no logs"
    return Logs(setup, model, Recordings.of(people))


def _participants(
    rows: Iterable[LogRow],
    path: str | os.PathLike[str],
    model: SharedAutonomy,
    each_trial: bool,
) -> dict[str, list[RecordedTrial]]:
    states = {name: i for i, name in enumerate(model.world.state_names)}
    actions = {name: i for i, name in enumerate(model.world.action_names)}
    inputs = {name: i for i, name in enumerate(model.input_names)}

    def found(row: LogRow, column: str, index: dict[str, int]) -> int:
        name = row.recorded.get(column)
        if not isinstance(name, str) or name not in index:
            what = "nothing" if name is None else excerpt(str(name))
            raise FileError(path, row.line, f"found {what} as {column}, expected one of the task's")
        return index[name]

    people: dict[str, list[RecordedTrial]] = {}
    for number, group in groupby(rows, key=lambda row: row.trial):
        steps = list(group)
        name = steps[0].participant or ""
        if each_trial:
            name = f"{name} trial {number}".strip()
        people.setdefault(name, []).append(
            RecordedTrial(
                state=[found(row, "state", states) for row in steps],
                human_input=[
                    NO_INPUT if row.human_input is None else inputs[row.human_input]
                    for row in steps
                ],
                action=[found(row, "action", actions) for row in steps],
            )
        )
    return people

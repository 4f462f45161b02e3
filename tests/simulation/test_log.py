"""The log format: whatever a file holds, it is read or refused in one line; nothing is rounded."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.errors import FileError, InputError
from coadapt.robots.setup import RobotSetup
from coadapt.simulation import Trial, log_reader
from coadapt.simulation.log import (
    DECISION_COLUMNS,
    FORMAT,
    FORMAT_LINE,
    INPUT,
    LARGEST_FILE,
    LONGEST_LINE,
    LONGEST_TRIAL,
    MOST_ROWS,
    PARTICIPANT,
    TIME,
    TRIAL,
    DecisionCells,
    LogRow,
)
from coadapt.simulation.log_reader import open_log
from coadapt.simulation.log_writer import LiveLog, LogWriter, whole_log

INPUTS = ("left", "forward", "right")
OURS = b"# coadapt log, format 1\n"
SETUP = RobotSetup(robot="no_adaptation", columns=5, rows=3)


def read(data: bytes) -> tuple[RobotSetup | None, list[LogRow]]:
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory, "log.csv")
        path.write_bytes(data)
        with open_log(path) as log:
            return log.setup, list(log.rows(INPUTS))


BAD_LOGS = [
    (b"", 1, ["empty file", "time and input"]),
    (b"\n\n", 2, ["the end", "header"]),
    (b"# a comment\n", 1, ["the end", "header"]),
    (b"time,input\n", 1, ["no rows", "at least one"]),
    (b"time\n1\n", 1, ["'time'", "input missing"]),
    (b"# a comment\n\ninput\nleft\n", 3, ["'input'", "time missing"]),
    (b"time;input\n1;left\n", 1, ["'time;input'", "time and input missing"]),
    (b"time,input,time\n", 1, ["'time' twice"]),
    (b"time,input\n0,left\n1,lfet\n", 3, ["'lfet'", "left, forward, right or nothing"]),
    (b"time,input\n1,left\n0.5,left\n", 3, ["0.5 after 1.0", "never decrease"]),
    (b"time,input\nnan,left\n", 2, ["'nan'", "finite"]),
    (b"time,input\n1e999,left\n", 2, ["'1e999'", "finite"]),
    (b"time,input\n1_0,left\n", 2, ["'1_0'", "finite"]),
    (b"time,input\n,left\n", 2, ["time ''", "finite"]),
    (b"time,input\n1\n", 2, ["1 field,", "2: 'time, input'"]),
    (b"time,input\n1,left,2\n", 2, ["3 fields", "2: 'time, input'"]),
    (b"time,input,trial\n0,left,2\n", 2, ["'2'", "expected 1"]),
    (b"time,input,trial\n0,left,1\n0,left,3\n", 3, ["'3'", "1 or 2"]),
    (b"time,input,trial\n0,left,2.0\n", 2, ["'2.0'", "expected 1"]),
    (b"time,input,trial\n0,left," + b"9" * 6000 + b"\n", 2, ["999...", "expected 1"]),
    (b"time,input\n1,\xe9\n", 2, ["0xe9", "UTF-8"]),
    (b"\xff\xfet\0i\0", 1, ["0xff", "UTF-8"]),
    (b"time,input\n0,\0\n", 2, ["NUL", "UTF-8"]),
    (b"time,input\r0,left\r", 1, ["carriage return", "LF"]),
    (b'time,input\n0,"left\n', 2, ["quotes"]),
    (b'time,input\n0,"left"x\n', 2, ["quotes"]),
    (b'time,input\n0,"' + b"x\n" * 100_000, 2, ["quoted field without an end"]),
    (b'time,input,note\n0,left,"a\nb"\n1,foo,\n', 4, ["'foo'"]),
    (b"time,input\n0," + b"x" * 70_000, 2, ["longer line", "65,536"]),
    (b"time,input\n0,le\x1b[31mft\n", 2, [r"le\x1b[31mft"]),
    (b"# coadapt log, format 3\ntime,input\n", 1, ["format 3", "newer than this coadapt"]),
    (b"# coadapt log, format 0\ntime,input\n", 1, ["format 0", "expected 2"]),
    (b"# coadapt log, format x\ntime,input\n", 1, ["'x'", "expected 2"]),
    (OURS + b"# setup {\ntime,input\n", 2, ["setup that cannot be used"]),
    (OURS + b"# setup " + b"[" * 60_000 + b"\n", 2, ["setup that cannot be used"]),
    (OURS + b'# setup {"columns":2}\n', 2, ["columns must be at least 3, not 2"]),
    (OURS + b'# setup {"colums":9}\n', 2, ["colums"]),
    (OURS + b'# setup {"robot":"kind"}\n', 2, ["kind"]),
    (OURS + b"# setup {}\n# setup {}\n", 3, ["second setup"]),
    (OURS + b"time,input,matched\n0,left,TRUE\n", 3, ["'TRUE'", "true or false"]),
    (OURS + b"time,input,agreement\n0,left,inf\n", 3, ["agreement 'inf'", "a number"]),
]


@pytest.mark.parametrize(
    ("data", "line", "words"), BAD_LOGS, ids=[", ".join(words) for _, _, words in BAD_LOGS]
)
def test_a_bad_log_is_refused_in_one_line(data: bytes, line: int, words: list[str]) -> None:
    with pytest.raises(FileError) as caught:
        read(data)
    message = str(caught.value)
    assert caught.value.line == line
    assert f"log.csv:{line}: found " in message
    assert "expected " in message
    assert message.isprintable()
    for word in words:
        assert word in message


@pytest.mark.parametrize(
    ("data", "inputs"),
    [
        (b"time,input\n0,left\n0,\n1.5,right\n", ["left", None, "right"]),
        (b"\xef\xbb\xbftime,input\r\n0,left\r\n\r\n", ["left"]),  # a BOM, CR LF, a blank line
        (b"# a remark\n\ninput, time \n left , 0\n", ["left"]),
        (b'"time","input"\n"0","forward"\n', ["forward"]),
        (b"time,input\n-1e-3,left", ["left"]),  # no newline at the end
        (b"time,input,action,matched,,\n0,left,fly,maybe,,\n", ["left"]),  # columns not ours
        (b'time,input,note\n0,left,"a\nb"\n', ["left"]),
    ],
)
def test_a_log_from_elsewhere_is_read(data: bytes, inputs: list[str | None]) -> None:
    setup, rows = read(data)
    assert setup is None
    assert [row.human_input for row in rows] == inputs
    assert all(row.trial == 1 and row.recorded == {} for row in rows)


def test_time_may_begin_anew_with_a_trial() -> None:
    _, rows = read(b"time,input,trial\n5,left,1\n6,left,1\n0,right,2\n0,left,2\n")
    assert [(row.time, row.trial) for row in rows] == [(5, 1), (6, 1), (0, 2), (0, 2)]


def test_limits(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    rows = b"time,input\n" + b"0,left\n" * 9
    monkeypatch.setattr(log_reader, "MOST_ROWS", 8)
    with pytest.raises(FileError, match=r"row 9, expected at most .* 8 rows"):
        read(rows)
    monkeypatch.setattr(log_reader, "LONGEST_TRIAL", 5)
    with pytest.raises(
        FileError, match=r":7: found step 6 of trial 1, expected .* 5 steps a trial"
    ):
        read(rows)
    huge = tmp_path / "huge.csv"
    with huge.open("wb") as stream:
        stream.truncate(100_000_001)  # takes no room on the disk
    with (
        pytest.raises(FileError, match="100,000,001 bytes, expected at most 100 MB"),
        open_log(huge),
    ):
        pass


def test_files_that_are_no_logs(tmp_path: Path) -> None:
    for path, words in [
        (tmp_path, "directory"),
        (tmp_path / "missing.csv", "No such file"),
        (tmp_path / ("x" * 300), "name too long"),
        (Path(os.devnull), "not a file"),
    ]:
        with pytest.raises(FileError, match=words) as caught, open_log(path):
            pass
        assert caught.value.line is None


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="root reads everything")
def test_a_file_without_permission(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_bytes(b"time,input\n0,left\n")
    path.chmod(0)
    with pytest.raises(FileError, match="Permission denied"), open_log(path):
        pass


# Pieces of logs, so that the search gets past the header.
PIECES = st.sampled_from(
    [
        *(
            b"time",
            b"input",
            b"trial",
            b"action",
            b"matched",
            b"agreement",
            b"belief[alpha=0 left]",
        ),
        *(b",", b"\n", b"\r\n", b"\r", b'"', b"#", b" ", b"\0", b"\xef\xbb\xbf", b"\xff"),
        *(b"0", b"1", b"2", b"nan", b"1e5", b"-", b"left", b"true", b"# setup ", b'{"rows":'),
        *(
            b"# coadapt log, format ",
            OURS,
            b"time,input\n",
            b"time,input,trial,matched\n",
            b"0,left\n",
        ),
    ]
)


@given(st.binary() | st.text().map(str.encode) | st.lists(PIECES, max_size=30).map(b"".join))
def test_any_bytes_are_a_log_or_an_input_error(data: bytes) -> None:
    try:
        _, rows = read(data)
    except InputError as error:
        assert str(error).isprintable()
    else:
        assert rows


FINITE = st.floats(allow_nan=False, allow_infinity=False)
SETUPS = st.builds(
    RobotSetup,
    robot=st.sampled_from(["mutual_adaptation", "one_way_adaptation", "no_adaptation"]),
    left_reward=st.floats(-1e6, 1e6),
    discount=st.floats(0, 1, exclude_max=True),
    gap=st.floats(1e-300, 1e300),
    adaptability=st.lists(st.floats(0, 1), min_size=1, unique=True).map(sorted).map(tuple),
)


@st.composite
def logs(draw: st.DrawFn) -> list[LogRow]:
    beliefs = [f"belief[alpha={a} {mode}]" for a in (0, 0.25) for mode in ("left", "right")]
    rows: list[LogRow] = []
    for trial in range(1, draw(st.integers(1, 3)) + 1):
        for time in sorted(draw(st.lists(FINITE, min_size=1, max_size=4))):
            values = {
                "state": draw(st.sampled_from(["column 0 row 0", "column 12 row 3"])),
                "action": draw(st.sampled_from(INPUTS)),
                "planned": draw(st.sampled_from(INPUTS)),
                "matched": draw(st.booleans()),
                "agreement": draw(FINITE),
                **{name: draw(FINITE) for name in beliefs},
            }
            kept = {name: v for name, v in values.items() if draw(st.booleans())}
            human_input = draw(st.sampled_from([None, *INPUTS]))
            rows.append(LogRow(len(rows) + 5, time, human_input, trial, kept))
    return rows


@given(SETUPS, logs())
def test_what_is_written_is_read_back_to_the_bit(setup: RobotSetup, rows: list[LogRow]) -> None:
    columns = [*DECISION_COLUMNS, *sorted({c for r in rows for c in r.recorded if "[" in c})]
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory, "log.csv")
        with path.open("w", encoding="utf-8", newline="") as stream:
            writer = LogWriter(stream, setup, columns)
            for row in rows:
                writer.write(row.time, row.human_input, row.trial, row.recorded)
        with open_log(path) as log:
            found = list(log.rows(INPUTS))
    assert log.setup == setup
    assert [repr(row) for row in found] == [repr(row) for row in rows]  # -0.0 is not 0.0


def test_a_live_log_is_whole_after_every_step(tmp_path: Path) -> None:
    robot, path = SETUP.build(), tmp_path / "live.csv"
    trial = Trial(robot)
    cells = DecisionCells(robot)
    with LiveLog(path, robot, SETUP) as live:
        for step, given_input in enumerate([0, None, 1], start=1):
            decision = trial.step(given_input)
            live.write(step / 3, 1, decision)
            with open_log(path) as log:  # while it is being written
                rows = list(log.rows(INPUTS))
            assert len(rows) == step
            assert rows[-1].time == step / 3
            assert rows[-1].human_input == cells.input(decision)
            assert rows[-1].recorded == cells.values(decision)
    assert log.setup == SETUP
    with pytest.raises(FileError, match="File exists"):
        LiveLog(path, robot, SETUP)


def test_a_live_log_without_steps_is_removed(tmp_path: Path) -> None:
    with LiveLog(tmp_path / "live.csv", SETUP.build(), SETUP):
        assert (tmp_path / "live.csv").exists()
    assert not list(tmp_path.iterdir())


def test_a_whole_log_appears_when_it_is_whole(tmp_path: Path) -> None:
    robot, path = SETUP.build(), tmp_path / "whole.csv"
    path.write_text("before")
    with pytest.raises(RuntimeError), whole_log(path, robot, SETUP) as log:
        log.write(0.0, 1, Trial(robot).step(0))
        raise RuntimeError
    assert path.read_text() == "before"
    with whole_log(path, robot, SETUP) as log:
        log.write(0.0, 1, Trial(robot).step(0))
        assert path.read_text() == "before"
    with open_log(path) as found:
        assert len(list(found.rows(INPUTS))) == 1
    assert list(tmp_path.iterdir()) == [path]


def test_a_whole_log_replaces_nothing_but_files(tmp_path: Path) -> None:
    robot = SETUP.build()
    for path, words in [
        (tmp_path, "not a file"),
        (Path(os.devnull), "not a file"),
        (tmp_path / "missing" / "log.csv", "cannot be written"),
    ]:
        with pytest.raises(FileError, match=words), whole_log(path, robot, SETUP):
            pass
    link = tmp_path / "link.csv"
    link.symlink_to("real.csv")
    with whole_log(link, robot, SETUP) as log:
        log.write(0.0, 1, Trial(robot).step(0))
    assert link.is_symlink()
    assert (tmp_path / "real.csv").is_file()


def test_the_reference_names_every_column_and_limit() -> None:
    page = (Path(__file__).parents[2] / "docs" / "reference" / "log-format.md").read_text()
    rows = [line.split("|")[1].strip(" `") for line in page.splitlines() if line.startswith("| `")]
    assert rows == [TIME, INPUT, TRIAL, PARTICIPANT, *DECISION_COLUMNS, "belief[alpha=A MODE]"]
    for limit in (LARGEST_FILE, MOST_ROWS, LONGEST_TRIAL, LONGEST_LINE):
        assert f"{limit:,}" in page
    assert f"{FORMAT_LINE} {FORMAT}\n" in page

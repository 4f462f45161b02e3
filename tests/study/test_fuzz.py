"""Nonsense for a real server; `benchmarks/study_fuzz.py` sends 50,000 forms and messages."""

from __future__ import annotations

from pathlib import Path

from study_fuzz import fuzz
from study_kill import write_study

from coadapt.study.protocol import read_study
from coadapt.study.robots import load_robots


def test_nonsense_spoils_nothing(tmp_path: Path) -> None:
    write_study(tmp_path, trials=100)
    load_robots(read_study(tmp_path), tmp_path)
    report = fuzz(tmp_path, f"sqlite:///{tmp_path / 'study.db'}", messages=300)
    assert report.is_good, report
    assert report.counts.sent >= 300
    # Nonsense was refused, but not all of it was nonsense.
    assert report.counts.answers[403] > 0
    assert report.counts.answers[303] > 0
    assert report.counts.closed[1008] > 0
    assert report.sessions > 10

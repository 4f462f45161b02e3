"""Servers killed with SIGKILL: nothing that was acknowledged is missing, everybody goes on.

`benchmarks/study_kill.py` does the same with 50 kills during 20 live sessions.
"""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest
from study_kill import kill_and_look, write_study


@pytest.mark.parametrize("servers", [1, 2])
def test_killed_servers_lose_nothing(
    servers: int, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    """One process with SQLite; two with one PostgreSQL."""
    url = f"sqlite:///{tmp_path / 'study.db'}"
    if servers == 2:
        url = request.getfixturevalue("postgres_url")
    write_study(tmp_path, trials=1, most_steps=20)
    looking = kill_and_look(tmp_path, url, kills=2, live=4, servers=servers, seed=1)
    report = asyncio.run(looking)
    assert report.is_good, report
    assert report.lost > 0

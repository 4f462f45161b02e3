"""Databases for tests: a new SQLite file, or an empty schema of a real PostgreSQL."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import create_engine, text
from study_postgres import binary, postgres

from coadapt.study.store.database import parse_url


def has_postgres() -> bool:
    try:
        binary("initdb")
    except FileNotFoundError:
        return False
    return True


@pytest.fixture(scope="session")
def postgres_server() -> Iterator[str]:
    """A PostgreSQL that runs as long as the tests do."""
    if not has_postgres():
        if "CI" in os.environ:
            pytest.fail("PostgreSQL is not installed")
        pytest.skip("needs PostgreSQL")
    with postgres("fsync=off") as url:
        yield url


@pytest.fixture
def postgres_url(postgres_server: str) -> str:
    """The URL of an empty database."""
    engine = create_engine(parse_url(postgres_server))
    with engine.begin() as connection:
        connection.execute(text("DROP SCHEMA public CASCADE"))
        connection.execute(text("CREATE SCHEMA public"))
    engine.dispose()
    return postgres_server


@pytest.fixture(params=["sqlite", "postgresql"])
def url(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """The URL of an empty database, of either kind."""
    if request.param == "sqlite":
        return f"sqlite:///{tmp_path / 'study.db'}"
    found: str = request.getfixturevalue("postgres_url")
    return found

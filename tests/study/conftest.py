"""Fixtures for all tests of studies."""

from tests.study.databases import postgres_server, postgres_url, url

__all__ = ["postgres_server", "postgres_url", "url"]

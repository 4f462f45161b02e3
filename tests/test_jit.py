"""The compiled code on disk is thrown away when a kernel changes that it may hold."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from coadapt.jit import FOLDERS, ROOT, stamp


def called(folder: str) -> set[str]:
    """The folders of kernels from which those of ``folder`` import."""
    found: set[str] = set()
    for source in (ROOT / folder).glob("*.py"):
        for node in ast.walk(ast.parse(source.read_text())):
            if isinstance(node, ast.ImportFrom) and node.module is not None:
                parts = node.module.split(".")[1:]
                found |= {f for f in FOLDERS if parts[: len(f.split("/"))] == f.split("/")}
    return found - {folder}


@pytest.mark.parametrize("folder", FOLDERS)
def test_a_stamp_covers_what_a_kernel_may_call(folder: str) -> None:
    # With what those call in turn.
    needed, more = set[str](), called(folder)
    while more - needed:
        needed |= more
        more = {each for part in needed for each in called(part)} - {folder}
    assert needed <= set(FOLDERS[folder])


def test_every_kernel_lies_in_one_of_the_folders() -> None:
    using = {
        source.parent.relative_to(ROOT).as_posix()
        for source in ROOT.rglob("*.py")
        if "from coadapt.jit import" in source.read_text() and source.name != "jit.py"
    }
    assert using <= set(FOLDERS)


def test_a_change_is_seen_by_those_who_call(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for folder in FOLDERS:
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / "kernels.py").write_text("1")
    monkeypatch.setattr("coadapt.jit.ROOT", tmp_path)
    compute = stamp.__wrapped__
    before = {folder: compute(folder) for folder in FOLDERS}
    (tmp_path / "robots/kernels/kernels.py").write_text("2")
    changed = {folder for folder in FOLDERS if compute(folder) != before[folder]}
    assert changed == {"robots/kernels", "simulation/kernels"}

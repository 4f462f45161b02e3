"""The report's files: where they go, and that each is either whole or not there."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import NamedTemporaryFile

from coadapt.errors import InputError
from coadapt.report.figures import style
from coadapt.report.figures.bounds import bounds
from coadapt.report.figures.conditions import conditions
from coadapt.report.figures.filmstrip import filmstrip, largest_belief
from coadapt.report.figures.performance import performance
from coadapt.report.html import render_html
from coadapt.report.reproduce import Reproduction
from coadapt.report.tables import tables, to_json

PAGE = "report.html"
NUMBERS = "results.json"


def make_files(
    found: Reproduction, progress: Callable[[str], None] | None = None
) -> dict[str, bytes]:
    """Every file of the report by its name, directories before it with a slash.

    Args:
        found: all results.
        progress: told what is being done.
    """
    tell = progress if progress is not None else _say_nothing
    tell("Drawing the figures")
    figures = _figures(found)
    tell("Writing the report")
    files = {f"figures/{name}": content for name, content in figures.items()}
    files |= {f"tables/{t.name}.csv": t.csv().encode() for t in tables(found)}
    files[NUMBERS] = to_json(found).encode()
    svgs = {
        name.removesuffix(".svg"): content.decode()
        for name, content in figures.items()
        if name.endswith(".svg")
    }
    return {PAGE: render_html(found, svgs, sorted(files)).encode(), **files}


def require_writable(directory: Path) -> None:
    """Make ``directory`` and try to write into it.

    Raises:
        InputError: if that cannot be done.
    """
    try:
        for part in (directory, directory / "figures", directory / "tables"):
            part.mkdir(parents=True, exist_ok=True)
            with NamedTemporaryFile(dir=part):
                pass
    except OSError as error:
        raise InputError(f"{error.filename}: cannot write: {error.strerror}") from error


def write_files(files: Mapping[str, bytes], directory: Path) -> None:
    """Write ``files`` into ``directory``. Each is replaced at once; others are left alone.

    Raises:
        InputError: if a file cannot be written.
    """
    require_writable(directory)
    for name, content in files.items():
        target = directory / name
        temporary: Path | None = None
        try:
            with NamedTemporaryFile(
                dir=target.parent, prefix=f".{target.name}.", delete=False
            ) as f:
                temporary = Path(f.name)
                f.write(content)
            temporary.chmod(0o666 & ~_umask())
            temporary.replace(target)
        except OSError as error:
            if temporary is not None:
                temporary.unlink(missing_ok=True)
            raise InputError(f"{target}: cannot write: {error.strerror}") from error


def _figures(found: Reproduction) -> dict[str, bytes]:
    model, top = found.settings.model, largest_belief(found.samples)
    with style.settings():
        drawn = {
            **{f"sample_user_{r.user}": filmstrip(model, r, top) for r in found.samples},
            "performance": performance(found),
            "conditions": conditions(found),
            "bounds": bounds(found),
        }
        return {
            f"{name}.{kind}": style.render(figure, kind)
            for name, figure in drawn.items()
            for kind in ("svg", "png")
        }


def _umask() -> int:
    """The process's mask of permissions, which can only be read by setting it."""
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _say_nothing(_: str) -> None:
    return

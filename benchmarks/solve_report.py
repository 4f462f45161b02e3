"""The tables of `solve.py`: what its results look like as CSV and as Markdown."""

from __future__ import annotations

import csv
import os
import platform
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any

from comparison import Comparison, Run, geometric_mean


@dataclass
class Result:
    """A problem and what came of it.

    Attributes:
        name: of the problem.
        reference, ours: the runs, or None.
        comparison: of the two, where both gave bounds.
        confirmation: what ``coadapt evaluate`` found, where it was asked for.
        notes: what else there is to say.
    """

    name: str
    reference: Run | None = None
    ours: Run | None = None
    comparison: Comparison | None = None
    confirmation: dict[str, Any] | None = None
    notes: list[str] = field(default_factory=list)

    @property
    def confirmed(self) -> str:
        """Whether the simulated mean lies at or above our lower bound, up to chance.

        ``"open"`` if that depends on what the episodes that were cut off would still have had.
        """
        found, ours = self.confirmation, self.ours
        if found is None or ours is None:
            return ""
        lower, high = ours.trace[-1].lower, found["mean"] + 3 * found["standard_error"]
        if high >= lower:
            return "yes"
        return "open" if high + found["truncation"] >= lower else "NO"


REACHED = {
    "problem": "problem",
    "reference_seconds": "reference, s",
    "reference_lower": "its lower",
    "reference_upper": "its upper",
    "reference_lower_seconds": "its lower first, s",
    "reference_upper_seconds": "its upper first, s",
    "lower_seconds": "ours to lower, s",
    "upper_seconds": "ours to upper, s",
    "both_seconds": "ours to both, s",
    "ratio_lower": "ratio, lower",
    "ratio_upper": "ratio, upper",
    "ratio": "ratio",
}
"""Columns of the first table, with their headings."""

OURS = {
    "problem": "problem",
    "lower": "lower",
    "upper": "upper",
    "seconds": "seconds",
    "status": "status",
    "vectors": "vectors",
    "backups": "backups",
    "load": "reading, s",
    "mb": "MB",
    "share": "share",
    "notes": "notes",
}
REFERENCE = {
    "problem": "problem",
    "reference_end_lower": "lower",
    "reference_end_upper": "upper",
    "reference_end": "seconds",
    "reference_status": "status",
    "reference_vectors": "vectors",
    "reference_backups": "backups",
    "reference_load": "reading, s",
    "reference_mb": "MB",
    "reference_share": "share",
}
SIMULATED = {
    "problem": "problem",
    "lower": "lower",
    "simulated": "simulated",
    "standard_error": "standard error",
    "truncation": "truncation",
    "runs": "runs",
    "confirmed": "confirmed",
}
COLUMNS = tuple({**REACHED, **REFERENCE, **OURS, **SIMULATED})
"""All columns, in the order of the CSV file."""


def cells(result: Result) -> dict[str, object]:
    """The row of ``result``; what is not known is left out."""
    row: dict[str, object] = {"problem": result.name, "notes": "; ".join(result.notes)}
    row |= _run_cells(result.ours, "")
    row |= {
        f"reference_{name}": cell for name, cell in _run_cells(result.reference, "end_").items()
    }
    both, found = result.comparison, result.confirmation
    if both is not None:
        row |= {
            "reference_seconds": both.reference,
            "reference_lower": both.lower,
            "reference_upper": both.upper,
            "reference_lower_seconds": both.reference_lower,
            "reference_upper_seconds": both.reference_upper,
            "lower_seconds": both.ours_lower,
            "upper_seconds": both.ours_upper,
            "both_seconds": both.ours,
            "ratio_lower": both.ratio_lower,
            "ratio_upper": both.ratio_upper,
            "ratio": both.ratio,
        }
    if found is not None:
        row |= {
            "simulated": found["mean"],
            "standard_error": found["standard_error"],
            "truncation": found["truncation"],
            "runs": found["episodes"],
            "confirmed": result.confirmed,
        }
    return row


def _run_cells(run: Run | None, prefix: str) -> dict[str, object]:
    if run is None:
        return {}
    last = run.trace[-1]
    return {
        f"{prefix}lower": last.lower,
        f"{prefix}upper": last.upper,
        "end" if prefix else "seconds": float(f"{run.seconds:.4g}"),
        "status": run.status,
        "vectors": run.vectors,
        "backups": run.backups,
        "load": float(f"{run.load_seconds:.3g}"),
        "mb": "" if run.memory_mb is None else round(run.memory_mb),
        "share": round(run.share, 2),
    }


def write_csv(results: Sequence[Result], path: Path) -> None:
    """All columns of all problems."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        writer.writerows(cells(result) for result in results)


def markdown(
    results: Sequence[Result], cold: Sequence[dict[str, Any]], limits: tuple[float, float]
) -> str:
    """The report.

    Args:
        results: of all problems so far.
        cold: what the first processes with an empty cache printed, see `solve.cold_start`.
        limits: seconds that the reference and we were given.
    """
    lines = [
        "# Our solver and the reference",
        "",
        f"{datetime.now():%Y-%m-%d %H:%M} on {_machine()}. The reference had {limits[0]:g} s, ours "
        f"{limits[1]:g} s. The columns are explained in benchmarks/README.md.",
        *_section("Seconds to the reference's bounds", results, REACHED),
        *_means(results),
        *_section("Where ours ended", results, OURS),
    ]
    if any(result.reference for result in results):
        lines += _section("Where the reference ended", results, REFERENCE)
    if any(result.confirmation for result in results):
        lines += _section("Our lower bounds, simulated", results, SIMULATED)
    if cold:
        lines += ["", "## Cold start", "", "| | launching, s | of it compiling, s | solving, s |"]
        lines += ["| --- | --- | --- | --- |"]
        for row in cold:
            numbers = (row["launch_seconds"], row["compile_seconds"], row["seconds"])
            shown = ("" if number is None else f"{number:.2f}" for number in numbers)
            lines.append(f"| {row['when']} | {' | '.join(shown)} |")
    return "\n".join(lines) + "\n"


def line(result: Result) -> str:
    """A line about ``result``, while the rest is running."""
    row = cells(result)
    parts = [f"{REACHED[name]}: {row[name]}" for name in list(REACHED)[1:] if name in row]
    confirmed = f"confirmed: {result.confirmed}" if result.confirmed else ""
    return "  ".join(filter(None, [result.name, *parts, confirmed, *result.notes]))


def _section(title: str, results: Sequence[Result], columns: dict[str, str]) -> list[str]:
    rows = [cells(result) for result in results]
    return [
        "",
        f"## {title}",
        "",
        f"| {' | '.join(columns.values())} |",
        f"| {' | '.join('---' for _ in columns)} |",
        *(f"| {' | '.join(_shown(row.get(name, '')) for name in columns)} |" for row in rows),
    ]


def _shown(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else f"{value}"


def _means(results: Sequence[Result]) -> list[str]:
    compared = [r.comparison for r in results if r.comparison is not None]
    if not compared:
        return []
    lower = geometric_mean(c.ratio_lower for c in compared)
    upper = geometric_mean(c.ratio_upper for c in compared)
    both = geometric_mean(c.ratio for c in compared)
    missed = sum(c.ours.sign == ">" for c in compared)
    unclear = sum(c.reference.sign == "<" for c in compared)
    return [
        "",
        f"Geometric means over {len(compared)} problems: {lower} to the lower bound, {upper} to "
        f"the upper, {both} to both. Not reached within our limit, which then counts: {missed}. "
        f"Too short for the reference's clock, whose step then counts: {unclear}.",
    ]


def _machine() -> str:
    """The machine, and how busy it is."""
    cpu = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        names = [text for text in info.read_text().splitlines() if text.startswith("model name")]
        cpu = names[0].partition(":")[2].strip() if names else cpu
    load = f", load {os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""
    return f"{os.cpu_count()} x {cpu}{load}, Python {platform.python_version()}"

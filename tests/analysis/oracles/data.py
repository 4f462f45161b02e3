"""The data of the oracles, and what R said of them."""

from __future__ import annotations

import csv
import json
from functools import cache
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent


@cache
def samples() -> dict[str, dict[str, list[float]]]:
    """By data set and group, the values."""
    found: dict[str, dict[str, list[float]]] = {}
    with (HERE / "samples.csv").open() as file:
        for row in csv.DictReader(file):
            groups = found.setdefault(row["dataset"], {})
            groups.setdefault(row["group"], []).append(float(row["value"]))
    return found


@cache
def items() -> dict[str, np.ndarray]:
    """By data set, the ratings.  # [participants, items]"""
    cells: dict[str, dict[tuple[int, int], float]] = {}
    with (HERE / "items.csv").open() as file:
        for row in csv.DictReader(file):
            place = int(row["participant"]), int(row["item"])
            cells.setdefault(row["dataset"], {})[place] = float(row["value"])
    return {
        name: np.array(
            [[given[p, i] for i in range(1 + max(given)[1])] for p in range(1 + max(given)[0])]
        )
        for name, given in cells.items()
    }


@cache
def from_r() -> dict[str, list[float]]:
    """What R printed, see `statistics.R`."""
    return json.loads((HERE / "statistics.json").read_text())["values"]

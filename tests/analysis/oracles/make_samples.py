"""Write `samples.csv` and `items.csv`, the data that R's and coadapt's numbers are compared on.

python tests/analysis/oracles/make_samples.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

HERE = Path(__file__).parent

SIZES: dict[str, tuple[int, ...]] = {
    "even": (17, 17, 17),
    "uneven": (19, 16, 17),
    "small": (3, 4, 5),
    "lopsided": (40, 8, 15),
    "two": (12, 9),
    "four": (10, 14, 11, 13),
    "large": (60, 55, 70),
}
"""Sizes of the groups."""


def samples() -> list[tuple[str, str, float]]:
    """Rows of data set, group and value: measured without ties, and rated 1 to 5 with many."""
    rng = np.random.default_rng(2017)
    rows: list[tuple[str, str, float]] = []
    for name, sizes in SIZES.items():
        for kind in ("measured", "rated"):
            for g, n in enumerate(sizes):
                drawn = rng.normal(0.6 * g, 1.0 + 0.4 * (g % 2), n)
                rated = np.clip(np.round(drawn + 3), 1, 5)
                values = np.round(drawn, 6) if kind == "measured" else rated
                rows += [(f"{name}_{kind}", f"g{g + 1}", float(v)) for v in values]
    return rows


def items() -> list[tuple[str, int, int, int]]:
    """Rows of data set, participant, item and rating."""
    rng = np.random.default_rng(1951)
    rows: list[tuple[str, int, int, int]] = []
    for name, people, count in (("pair", 51, 2), ("five", 51, 5), ("few", 6, 3)):
        level = rng.normal(size=people)
        rated = np.clip(np.round(3 + level[:, None] + rng.normal(0, 0.8, (people, count))), 1, 5)
        rows += [(name, p, i, int(rated[p, i])) for p in range(people) for i in range(count)]
    return rows


def main() -> None:
    """Write both files."""
    lines = ["dataset,group,value", *(f"{d},{g},{v!r}" for d, g, v in samples())]
    (HERE / "samples.csv").write_text("\n".join(lines) + "\n")
    lines = ["dataset,participant,item,value", *(",".join(map(str, row)) for row in items())]
    (HERE / "items.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()

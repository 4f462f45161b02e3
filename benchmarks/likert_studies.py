"""Simulated questionnaires: does each test find what is there, and nothing where nothing is?

    python benchmarks/likert_studies.py --null 10000 --slow 2000 --studies 500

A participant has a level, normal with variance 1, which their condition may shift. Each item of a
scale is that level plus noise, cut into five points. A score is the mean of the items. With no
shift a test at the level of 5 % should be significant in 5 % of the studies; a family of tests
whose p are corrected by Bonferroni's inequality in at most so many. With shifts of 0, 0.5 and 1 the
population's effects are found from a million participants, and the intervals should hold them in
95 % of the studies.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence

import numpy as np

from coadapt.analysis import tests as ct
from coadapt.analysis.scales import cronbach
from coadapt.analysis.shares import share_interval
from coadapt.analysis.tests.samples import CannotTest

SIZES = (17, 17, 17)
"""Of the groups, as in a study of 51."""

ITEMS = 5

CUTS = np.array([-1.5, -0.5, 0.5, 1.5])
"""Where levels are cut into points."""

NOISE = 1.0
"""Deviation of an item from the level; makes α about .79."""

SLOW = ("Games-Howell, any of 3", "cumulative logit")
"""Tests that take a tenth of a second and more, run on fewer studies."""

AT_MOST = ("Mann-Whitney, either of 2, Bonferroni",)
"""Families whose rate the level bounds. Others are to come near it."""

SHIFTS = (0.0, 0.5, 1.0)

LEVEL = 0.05

NAMES = ("a", "b", "c")


def ratings(n: int, shift: float, rng: np.random.Generator, items: int = ITEMS) -> np.ndarray:
    """Points from 1 to 5.  # [participants, items]"""
    level = rng.normal(shift, 1.0, n)
    return 1.0 + np.searchsorted(CUTS, level[:, None] + rng.normal(0.0, NOISE, (n, items)))


def study(
    shifts: Sequence[float],
    rng: np.random.Generator,
    sizes: Sequence[int] = SIZES,
    items: int = ITEMS,
) -> dict[str, list[float]]:
    """Scores by group."""
    return {
        name: ratings(n, shift, rng, items).mean(axis=1).tolist()
        for name, n, shift in zip(NAMES, sizes, shifts, strict=True)
    }


def significant(test: Callable[[], object]) -> bool:
    """Whether a test, or any of a family, is significant; what says nothing is not."""
    try:
        found = test()
    except CannotTest:
        return False
    results = found if isinstance(found, tuple) else (found,)
    return any(r.adjusted < LEVEL for r in results)


def tests_of(groups: dict[str, list[float]]) -> dict[str, Callable[[], object]]:
    """Every test of a study."""
    high = {name: (sum(v > 3 for v in given), len(given)) for name, given in groups.items()}
    pairs = [{n: groups[n] for n in pair} for pair in (("a", "b"), ("b", "c"))]
    return {
        "Kruskal-Wallis": lambda: ct.kruskal_wallis(groups),
        "Mann-Whitney, a and b": lambda: ct.mann_whitney(pairs[0]),
        "Mann-Whitney, b and c": lambda: ct.mann_whitney(pairs[1]),
        "Mann-Whitney, either of 2, Bonferroni": lambda: ct.correct(
            [ct.mann_whitney(pair) for pair in pairs], "bonferroni"
        ),
        "one-way ANOVA": lambda: ct.one_way_anova(groups),
        "Welch's ANOVA": lambda: ct.welch_anova(groups),
        "Tukey's HSD, any of 3": lambda: ct.tukey(groups),
        "Games-Howell, any of 3": lambda: ct.games_howell(groups),
        "cumulative logit": lambda: ct.cumulative_logit(groups),
        "proportions above 3": lambda: ct.proportions(high),
    }


def false_positives(count: int, slow: int, seed: int, sizes: Sequence[int], items: int) -> None:
    """Print how often each test is significant where nothing differs."""
    rng = np.random.default_rng(seed)
    hits: dict[str, int] = {}
    spent: dict[str, float] = {}
    runs: dict[str, int] = {}
    for i in range(count):
        for name, test in tests_of(study((0.0, 0.0, 0.0), rng, sizes, items)).items():
            if name in SLOW and i >= slow:
                continue
            runs[name] = i + 1
            began = time.process_time()
            hits[name] = hits.get(name, 0) + significant(test)
            spent[name] = spent.get(name, 0.0) + time.process_time() - began
    bound = 0.5
    inside = 0
    for _ in range(count):
        # Equivalence is falsely claimed most often where the difference is just the bound.
        x, y = rng.normal(0.0, 0.7, 17), rng.normal(bound, 0.7, 17)
        inside += significant(lambda x=x, y=y: ct.equivalence({"a": x, "b": y}, bound))
    print(f"\nNothing differs, groups of {sizes}, scales of {items}, level {LEVEL:.0%}\n")
    hits["equivalence, at its bound"], runs["equivalence, at its bound"] = inside, count
    print("| test | studies | significant | 95 % interval of that | CPU ms a test |")
    print("| --- | --- | --- | --- | --- |")
    for name, hit in hits.items():
        n = runs[name]
        low, high = share_interval(hit, n)
        took = f"{1000 * spent[name] / n:.1f}" if name in spent else ""
        bound = "at most 5 %: " if name in AT_MOST else ""
        print(f"| {name} | {n:,} | {bound}{hit / n:.2%} | {low:.2%} to {high:.2%} | {took} |")
    print(flush=True)


def population(rng: np.random.Generator) -> dict[str, float]:
    """Effects among a million participants, a third in each group."""
    n = 333_333
    groups = [ratings(n, shift, rng) for shift in SHIFTS]
    scores = [g.mean(axis=1) for g in groups]
    pooled = np.concatenate(scores)
    _, ranks = np.unique(pooled, return_inverse=True)
    counts = np.bincount(ranks)
    mean_rank = (np.cumsum(counts) - (counts - 1) / 2)[ranks]
    below, equal = 0.0, 0.0
    levels = np.unique(pooled)
    shares = [np.array([(s == level).mean() for level in levels]) for s in scores]
    less = np.concatenate([[0.0], np.cumsum(shares[0])[:-1]])
    below, equal = float(shares[2] @ less), float(shares[2] @ shares[0])
    sd = np.sqrt((scores[0].var() + scores[2].var()) / 2)
    return {
        "η², ANOVA": _explained(pooled, n),
        "ε², Kruskal-Wallis": _explained(mean_rank, n),
        "r of c and a": 2 * (below + equal / 2) - 1,
        "g of c and a": float((scores[2].mean() - scores[0].mean()) / sd),
        "α of all items": cronbach(np.concatenate(groups)).value,
    }


def _explained(values: np.ndarray, n: int) -> float:
    parts = values.reshape(len(SHIFTS), n)
    return float(parts.mean(axis=1).var() / values.var())


def recovery(count: int, seed: int) -> None:
    """Print how close estimates come to the population, and how often intervals hold it."""
    rng = np.random.default_rng(seed)
    true = population(rng)
    estimates: dict[str, list[float]] = {name: [] for name in true}
    held = dict.fromkeys(true, 0)
    found: dict[str, int] = {}
    for _ in range(count):
        items = {n: ratings(k, s, rng) for n, k, s in zip(NAMES, SIZES, SHIFTS, strict=True)}
        groups = {name: given.mean(axis=1).tolist() for name, given in items.items()}
        ends = {name: groups[name] for name in ("c", "a")}
        anova = ct.one_way_anova(groups)
        effects = {
            "η², ANOVA": anova.effects[1],
            "ε², Kruskal-Wallis": ct.kruskal_wallis(groups).effects[0],
            "r of c and a": ct.mann_whitney(ends).effects[0],
            "g of c and a": ct.hedges_g(np.array(ends["c"]), np.array(ends["a"])),
            "α of all items": cronbach(np.concatenate(list(items.values()))),
        }
        for name, effect in effects.items():
            estimates[name].append(effect.value)
            held[name] += effect.low <= true[name] <= effect.high
        for name, test in tests_of(groups).items():
            if name not in SLOW:
                found[name] = found.get(name, 0) + significant(test)
    print(f"\nShifts {SHIFTS}, {count:,} studies of {SIZES}\n")
    print("| effect | population | mean estimate | 95 % interval holds it |")
    print("| --- | --- | --- | --- |")
    for name, value in true.items():
        mean = np.mean(estimates[name])
        print(f"| {name} | {value:.3f} | {mean:.3f} | {held[name] / count:.1%} |")
    print("\n| test | power |\n| --- | --- |")
    for name, hit in found.items():
        print(f"| {name} | {hit / count:.1%} |")


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--null", type=int, default=10_000, help="studies without a difference")
    parser.add_argument("--studies", type=int, default=500, help="studies with one")
    parser.add_argument("--slow", type=int, default=2000, help="of these, for the slow tests")
    parser.add_argument("--sizes", type=int, nargs=3, default=SIZES, help="of the groups without")
    parser.add_argument("--items", type=int, default=ITEMS, help="of the scales there")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    false_positives(options.null, options.slow, options.seed, tuple(options.sizes), options.items)
    if options.studies:
        recovery(options.studies, options.seed + 1)


if __name__ == "__main__":
    main()

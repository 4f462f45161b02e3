"""Allocation to conditions."""

from __future__ import annotations

from collections import Counter

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.study.allocation import Allotted, Standing, allocate
from coadapt.study.protocol import Allocation, Study
from coadapt.study.protocol.reader import template
from coadapt.toml import parse_toml

STUDY, _ = parse_toml(template(), "study.toml", Study, "a study")
NAMES = [c.name for c in STUDY.conditions]


def study(**settings: object) -> Study:
    changed = msgspec.structs.replace(STUDY.allocation, **settings)
    return msgspec.structs.replace(STUDY, allocation=changed)


def unlimited(base: Study) -> Study:
    free = tuple(msgspec.structs.replace(c, quota=None) for c in base.conditions)
    return msgspec.structs.replace(base, conditions=free)


@given(st.lists(st.sampled_from(["completed", "active", "lost"]), max_size=80), st.integers(0, 9))
def test_balanced_within_one_by_those_who_count(standings: list[Standing], seed: int) -> None:
    base = unlimited(study(seed=seed))
    before: list[Allotted] = []
    for standing in standings:
        chosen = allocate(base, before)
        assert chosen is not None
        counts = Counter(a.condition for a in before if a.standing != "lost")
        assert counts[chosen] == min(counts[name] for name in NAMES)
        before.append(Allotted(chosen, standing))
    if "lost" not in standings:
        counts = Counter(a.condition for a in before)
        assert max(counts[n] for n in NAMES) - min(counts[n] for n in NAMES) <= 1


@pytest.mark.parametrize("method", ["balanced", "blocks", "minimisation"])
def test_quotas_are_met_and_never_passed(method: str) -> None:
    base = study(method=method)
    before: list[Allotted] = []
    while (chosen := allocate(base, before)) is not None:
        before.append(Allotted(chosen, "completed"))
    # 17 in each condition, as in the template.
    assert Counter(a.condition for a in before) == dict.fromkeys(NAMES, 17)


@pytest.mark.parametrize("method", ["balanced", "blocks", "minimisation"])
def test_who_is_lost_is_replaced_in_the_same_condition(method: str) -> None:
    base = study(method=method)
    before = [Allotted(name, "completed") for name in NAMES for _ in range(17)]
    before[20] = Allotted(before[20].condition, "lost")
    assert allocate(base, before) == before[20].condition


@given(st.integers(0, 99), st.integers(1, 3))
def test_blocks_hold_every_condition_as_often(seed: int, repeats: int) -> None:
    base = unlimited(study(method="blocks", seed=seed, repeats=repeats))
    before: list[Allotted] = []
    size = repeats * len(NAMES)
    for _ in range(3 * size):
        chosen = allocate(base, before)
        assert chosen is not None
        before.append(Allotted(chosen, "completed"))
    for block in range(3):
        part = before[block * size : (block + 1) * size]
        assert Counter(a.condition for a in part) == dict.fromkeys(NAMES, repeats)


def test_the_seed_alone_decides_and_seeds_differ() -> None:
    def sequence(seed: int, method: str) -> list[str | None]:
        base = unlimited(study(seed=seed, method=method))
        before: list[Allotted] = []
        for _ in range(30):
            chosen = allocate(base, before)
            assert chosen is not None
            before.append(Allotted(chosen, "completed"))
        return [a.condition for a in before]

    for method in ("balanced", "blocks"):
        assert sequence(1, method) == sequence(1, method)
        assert len({tuple(sequence(seed, method)) for seed in range(5)}) == 5


def test_minimisation_balances_the_covariate_better_than_chance() -> None:
    def imbalance(method: str, seed: int) -> int:
        base = unlimited(study(method=method, seed=seed, covariates=("choice",), chance=1.0))
        rng = np.random.default_rng(seed)
        before: list[Allotted] = []
        for _ in range(60):
            covariates = {"choice": str(rng.integers(2))}
            chosen = allocate(base, before, covariates)
            assert chosen is not None
            before.append(Allotted(chosen, "completed", covariates))
        left = Counter(a.condition for a in before if a.covariates["choice"] == "0")
        return max(left[n] for n in NAMES) - min(left[n] for n in NAMES)

    with_it = [imbalance("minimisation", seed) for seed in range(10)]
    without = [imbalance("balanced", seed) for seed in range(10)]
    # With chance 1 the covariate and the totals are balanced together.
    assert max(with_it) <= 2
    assert sum(with_it) < sum(without)


def test_defaults_are_those_of_the_documentation() -> None:
    assert Allocation().method == "balanced"

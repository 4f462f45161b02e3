"""Hypothesis tests: what a reader needs of each, in one object.

scipy and statsmodels do the arithmetic. Samples about which a test says nothing raise `CannotTest`;
no number of a result is ever NaN.
"""

from coadapt.analysis.tests import apa
from coadapt.analysis.tests.corrections import Correction, adjusted, correct
from coadapt.analysis.tests.equivalence import equivalence
from coadapt.analysis.tests.ordinal import cumulative_logit
from coadapt.analysis.tests.pairs import games_howell, hedges_g, tukey
from coadapt.analysis.tests.proportions import difference, proportions
from coadapt.analysis.tests.ranks import kruskal_wallis, mann_whitney, rank_biserial
from coadapt.analysis.tests.result import Check, Effect, Found, NotTested, TestResult, versions
from coadapt.analysis.tests.samples import CannotTest, Group
from coadapt.analysis.tests.variance import one_way_anova, welch_anova

__all__ = [
    "CannotTest",
    "Check",
    "Correction",
    "Effect",
    "Found",
    "Group",
    "NotTested",
    "TestResult",
    "adjusted",
    "apa",
    "correct",
    "cumulative_logit",
    "difference",
    "equivalence",
    "games_howell",
    "hedges_g",
    "kruskal_wallis",
    "mann_whitney",
    "one_way_anova",
    "proportions",
    "rank_biserial",
    "tukey",
    "versions",
    "welch_anova",
]

"""The model behind `coadapt.analysis.tests.ordinal`, with the slope that statsmodels leaves out.

statsmodels differentiates the likelihood of its ordinal model by finite differences, some fifty
likelihoods for every slope.
"""

# statsmodels has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownMemberType=false
# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportUntypedBaseClass=false

from __future__ import annotations

from typing import final

import numpy as np
from scipy.special import expit
from statsmodels.miscmodels.ordinal_model import OrderedModel

from coadapt.arrays import FloatArray


@final
class ProportionalOdds(OrderedModel):
    """``logit P(level <= j) = theta_j - x beta`` (McCullagh 1980).

    Parameters are those of statsmodels: ``beta``, ``theta_0`` and the logs of the steps from each
    threshold to the next.
    """

    def score(self, params: FloatArray) -> FloatArray:
        """The slope of the log likelihood by the parameters.

        With ``P = F(u) - F(l)`` for the level between ``l`` and ``u``, and ``f`` the derivative of
        ``F``, ``d log P = (f(u) du - f(l) dl) / P``.
        """
        low, high = self._bounds(params)
        share = expit(high) - expit(low)
        at_low, at_high = (expit(x) * expit(-x) / share for x in (low, high))
        by_threshold = np.zeros(self.k_levels + 1)
        np.add.at(by_threshold, self.endog, -at_low)
        np.add.at(by_threshold, self.endog + 1, at_high)
        # A threshold is the sum of the first one and all steps before it.
        later = by_threshold[-2:0:-1].cumsum()[::-1]
        steps = np.exp(params[self.k_vars + 1 :])
        return np.concatenate(
            [(at_low - at_high) @ np.asarray(self.exog), later[:1], later[1:] * steps]
        )

"""The match rule (Sec. 5.3): do what the person does when both head for the same goal."""

from __future__ import annotations

from dataclasses import dataclass

from coadapt.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True)
class MatchRule:
    """Execute the person's input once robot and person agree on the mode.

    Stochastic modal policies allow several actions in a state, so that robot and person may
    disagree on the action while they agree on the goal. Such disagreement is unnecessary.

    Attributes:
        threshold: smallest agreement at which the rule fires, in [0, 1]; above 1 it never does.
    """

    threshold: float = 0.9

    def agreement(self, mode_belief: FloatArray, perceived: FloatArray) -> FloatArray:
        """``[...]``: ``sum_m b(m) P(m_r = m | window, a_r)``.

        Args:
            mode_belief: ``[..., M]`` belief over the person's mode.
            perceived: ``[..., M]`` the mode the person would perceive in the planned action, Eq. 2.
        """
        return (mode_belief * perceived).sum(axis=-1)

    def fires(self, agreement: FloatArray, asked: IntArray) -> BoolArray:
        """``[...]``: whether an input is executed instead of the planned action.

        Args:
            agreement: ``[...]``.
            asked: ``[...]`` the action that the input asks for, negative where there was none.
        """
        return (asked >= 0) & (agreement >= self.threshold)


NEVER_MATCH = MatchRule(threshold=float("inf"))
"""The policy alone, as in the planning problem."""

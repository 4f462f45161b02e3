"""What a person may intend, what they perceive, how they adapt."""

from coadapt.human.adaptation import Adaptability, mode_transition
from coadapt.human.demonstrations import CostFit, fit_cost, fit_step_cost
from coadapt.human.inputs import Inputs
from coadapt.human.modal import maximum_entropy_policy, soft_value
from coadapt.human.path_likelihood import Demonstration
from coadapt.human.perceived import perceived_robot_mode

__all__ = [
    "Adaptability",
    "CostFit",
    "Demonstration",
    "Inputs",
    "fit_cost",
    "fit_step_cost",
    "maximum_entropy_policy",
    "mode_transition",
    "perceived_robot_mode",
    "soft_value",
]

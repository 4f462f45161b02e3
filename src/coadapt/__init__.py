"""Human-robot mutual adaptation in shared autonomy.

A person steers a robot towards a goal; the robot knows a better one. It infers what they want and
how willing they are to adapt, and plans under that uncertainty (Nikolaidis, Zhu, Hsu, Srinivasa,
HRI 2017).
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from coadapt import robots, worlds
    from coadapt.formalism import Collaboration, SharedAutonomy
    from coadapt.human import Adaptability, Inputs
    from coadapt.momdp import (
        MOMDP,
        AlphaVectorPolicy,
        MOMDPError,
        MOMDPWarning,
        Root,
        action_values,
        check_momdp,
    )
    from coadapt.momdp.files import read_policy, read_pomdp, write_policy, write_pomdpx
    from coadapt.momdp.sarsop import SARSOP, Solution, Status
    from coadapt.simulation import (
        Batch,
        Episode,
        SimulatedPartner,
        Trial,
        evaluate,
        simulate,
        simulate_batch,
    )

__version__ = "0.1.0"

__all__ = [
    "MOMDP",
    "SARSOP",
    "Adaptability",
    "AlphaVectorPolicy",
    "Batch",
    "Collaboration",
    "Episode",
    "Inputs",
    "MOMDPError",
    "MOMDPWarning",
    "Root",
    "SharedAutonomy",
    "SimulatedPartner",
    "Solution",
    "Status",
    "Trial",
    "action_values",
    "check_momdp",
    "evaluate",
    "read_policy",
    "read_pomdp",
    "robots",
    "simulate",
    "simulate_batch",
    "worlds",
    "write_policy",
    "write_pomdpx",
]

# Where each public name lives. They are imported on first use, so that the command line can show
# its help without waiting for numpy and scipy.
_HOME = {
    "MOMDP": "coadapt.momdp",
    "Adaptability": "coadapt.human",
    "AlphaVectorPolicy": "coadapt.momdp",
    "Batch": "coadapt.simulation",
    "Collaboration": "coadapt.formalism",
    "Episode": "coadapt.simulation",
    "Inputs": "coadapt.human",
    "MOMDPError": "coadapt.momdp",
    "MOMDPWarning": "coadapt.momdp",
    "Root": "coadapt.momdp",
    "SARSOP": "coadapt.momdp.sarsop",
    "Solution": "coadapt.momdp.sarsop",
    "Status": "coadapt.momdp.sarsop",
    "SharedAutonomy": "coadapt.formalism",
    "SimulatedPartner": "coadapt.simulation",
    "Trial": "coadapt.simulation",
    "action_values": "coadapt.momdp",
    "check_momdp": "coadapt.momdp",
    "evaluate": "coadapt.simulation",
    "read_policy": "coadapt.momdp.files",
    "read_pomdp": "coadapt.momdp.files",
    "simulate": "coadapt.simulation",
    "simulate_batch": "coadapt.simulation",
    "write_policy": "coadapt.momdp.files",
    "write_pomdpx": "coadapt.momdp.files",
}
_SUBPACKAGES = ("robots", "worlds")


def __getattr__(name: str) -> object:
    if name in _SUBPACKAGES:
        return import_module(f"coadapt.{name}")
    if name not in _HOME:
        raise AttributeError(f"module 'coadapt' has no attribute {name!r}")
    value: object = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})

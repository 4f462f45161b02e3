"""The formalism: a world and a model of its person compiled to a planning problem."""

from coadapt.formalism.collaboration import Collaboration
from coadapt.formalism.shared_autonomy import SharedAutonomy

Model = SharedAutonomy | Collaboration
"""A world and a model of its person: all that a course of events needs."""

__all__ = ["Collaboration", "Model", "SharedAutonomy"]

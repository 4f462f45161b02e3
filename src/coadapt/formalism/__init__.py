"""The formalism: a world and a model of its person compiled to a planning problem."""

from coadapt.formalism.shared_autonomy import SharedAutonomy

__all__ = ["SharedAutonomy"]

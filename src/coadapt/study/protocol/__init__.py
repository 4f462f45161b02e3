"""The protocol of a study as data: what `study.toml` holds."""

from coadapt.study.protocol.allocation import Allocation
from coadapt.study.protocol.clock import Clock
from coadapt.study.protocol.condition import Condition
from coadapt.study.protocol.questions import Item, Question, Scale
from coadapt.study.protocol.reader import read_study
from coadapt.study.protocol.recruitment import Recruitment
from coadapt.study.protocol.study import Study
from coadapt.study.protocol.texts import Texts

__all__ = [
    "Allocation",
    "Clock",
    "Condition",
    "Item",
    "Question",
    "Recruitment",
    "Scale",
    "Study",
    "Texts",
    "read_study",
]

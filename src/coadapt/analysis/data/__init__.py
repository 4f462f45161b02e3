"""Data of studies, read from files with all that is wrong in them named."""

from coadapt.analysis.data.declaration import Declaration, read_declaration
from coadapt.analysis.data.problems import Problem
from coadapt.analysis.data.reader import read_data
from coadapt.analysis.data.study_data import Flow, Person, Step, StudyData, Trial

__all__ = [
    "Declaration",
    "Flow",
    "Person",
    "Problem",
    "Step",
    "StudyData",
    "Trial",
    "read_data",
    "read_declaration",
]

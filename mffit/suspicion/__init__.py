"""Which readings are suspected, and what follows: ``rules`` lists all suspicions, ``applying`` runs them."""

from mffit.suspicion.applying import after_the_fit, before_the_fit
from mffit.suspicion.declarations import under_axes
from mffit.suspicion.groups import parts_of_sweeps
from mffit.suspicion.misread import Misread, misread
from mffit.suspicion.others import Doubt, FittedModel, JudgedSweeps
from mffit.suspicion.outliers import Outlier, marks, outliers, outliers_sentence
from mffit.suspicion.rule import Subject, When
from mffit.suspicion.rules import RULES
from mffit.suspicion.slopes import contradictions, signatures
from mffit.suspicion.trust import (
    SOUND,
    FinishedFit,
    HeldNumber,
    JudgedMeasurement,
    LeftOutSweeps,
    Trust,
    judge,
)
from mffit.suspicion.unpublished import CamberReduction

__all__ = [
    "RULES",
    "SOUND",
    "CamberReduction",
    "Doubt",
    "FinishedFit",
    "FittedModel",
    "HeldNumber",
    "JudgedMeasurement",
    "JudgedSweeps",
    "LeftOutSweeps",
    "Misread",
    "Outlier",
    "Subject",
    "Trust",
    "When",
    "after_the_fit",
    "before_the_fit",
    "contradictions",
    "judge",
    "marks",
    "misread",
    "outliers",
    "outliers_sentence",
    "parts_of_sweeps",
    "signatures",
    "under_axes",
]

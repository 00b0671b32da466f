"""Rules by which readings are suspected, and the outcome of each; ``rules`` lists them all."""

from typing import TYPE_CHECKING

from mffit.on_demand import on_demand

if TYPE_CHECKING:
    from mffit.suspicion.declarations import under_axes
    from mffit.suspicion.groups import parts_of_sweeps
    from mffit.suspicion.misread import Misread
    from mffit.suspicion.others import Doubt, FittedModel, JudgedSweeps, after_the_fit
    from mffit.suspicion.outliers import Outlier, marks, outliers_sentence
    from mffit.suspicion.rule import When
    from mffit.suspicion.rules import RULES, before_the_fit
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

__getattr__ = on_demand(__name__)

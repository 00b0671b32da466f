"""Find where simulation and measurement disagree, name the missing effect, add it, show the gap shrink."""

from mffit.diagnosis.correction import corrected_points
from mffit.diagnosis.engine import diagnose
from mffit.diagnosis.result import Diagnosis, Found
from mffit.diagnosis.validate import Gap, gap, validate
from mffit.diagnosis.where import where

__all__ = ["Diagnosis", "Found", "Gap", "corrected_points", "diagnose", "gap", "validate", "where"]

"""Find where simulation and measurement disagree, name the missing effect, add it, show the gap shrink."""

from mffit.diagnose.correction import corrected_points
from mffit.diagnose.engine import diagnose
from mffit.diagnose.result import Diagnosis, Found
from mffit.diagnose.validate import gap, validate
from mffit.diagnose.where import where

__all__ = ["Diagnosis", "Found", "corrected_points", "diagnose", "gap", "validate", "where"]

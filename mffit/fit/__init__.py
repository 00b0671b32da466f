"""Points and direct measurements to an MF-6.2 tyre with standard errors."""

from mffit.fit.files import file_names
from mffit.fit.fitting import fit
from mffit.fit.posterior import Posterior
from mffit.fit.result import Agreement, Coefficient, FitResult, StageRecord

__all__ = ["Agreement", "Coefficient", "FitResult", "Posterior", "StageRecord", "file_names", "fit"]

"""Numbers read straight off the data, with budgets: alignment, radii, stiffnesses, turn-slip force, eps_gamma."""

from mffit.measured.alignment import Alignment, align
from mffit.measured.backlash import odd_alpha
from mffit.measured.budget_rows import Contribution
from mffit.measured.camber_reduction import DirectInputs, direct_method
from mffit.measured.direct import at_the_axis, measure
from mffit.measured.radii import RadiusReading, radius_readings
from mffit.measured.result import KEYS, LoadResult, Measured, SetupResult, SetupScatter, SideslipZeros

__all__ = [
    "KEYS",
    "Alignment",
    "Contribution",
    "DirectInputs",
    "LoadResult",
    "Measured",
    "RadiusReading",
    "SetupResult",
    "SetupScatter",
    "SideslipZeros",
    "align",
    "at_the_axis",
    "direct_method",
    "measure",
    "odd_alpha",
    "radius_readings",
]

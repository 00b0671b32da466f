"""Numbers read straight off the data, with budgets: alignment, radii, stiffnesses, turn-slip force, eps_gamma."""

from mffit.measured.alignment import Alignment, AlignmentStep, align
from mffit.measured.backlash import backlash_corrected, odd_alpha
from mffit.measured.camber_reduction import DirectInputs, TurnSlip, direct_method
from mffit.measured.direct import at_the_axis, measure
from mffit.measured.radii import RadiusReading, radius_readings
from mffit.measured.result import KEYS, Contribution, LoadResult, Measured

__all__ = [
    "KEYS",
    "Alignment",
    "AlignmentStep",
    "Contribution",
    "DirectInputs",
    "LoadResult",
    "Measured",
    "RadiusReading",
    "TurnSlip",
    "align",
    "at_the_axis",
    "backlash_corrected",
    "direct_method",
    "measure",
    "odd_alpha",
    "radius_readings",
]

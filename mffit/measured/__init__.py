"""The direct method: alignment, radii, stiffnesses, turn-slip force and eps_gamma from the data without a model, with budgets."""

from mffit.measured.alignment import align
from mffit.measured.camber_reduction import camber_of_no_spin, unspun, was_coupled
from mffit.measured.direct import adding_to_camber, at_the_axis, measure
from mffit.measured.evidence import odd_alpha
from mffit.measured.one_way import OneWayLag
from mffit.measured.radii import RadiusReading, measured_path_radius, radius_readings
from mffit.measured.result import (
    Alignment,
    Drift,
    LoadResult,
    Measured,
    SetupResult,
    SetupScatter,
    SideslipZeros,
)
from mffit.measured.uncertain import Contribution

"""Joint estimate of many tyres of one rig from their builds. See docs/fleet.md."""

from mffit.fleet.hierarchy import Hierarchy, Population, TyreEstimate, estimate
from mffit.fleet.information import Information, information, to_json
from mffit.fleet.record import EPSILON, Fleet, Row, Scatter, with_estimate
from mffit.fleet.specimen import INFORMATION, Specimen, read

__all__ = [
    "EPSILON",
    "INFORMATION",
    "Fleet",
    "Hierarchy",
    "Information",
    "Population",
    "Row",
    "Scatter",
    "Specimen",
    "TyreEstimate",
    "estimate",
    "information",
    "read",
    "to_json",
    "with_estimate",
]

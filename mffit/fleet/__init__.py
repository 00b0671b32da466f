"""Many tyres of one rig: what their builds say together. See docs/fleet.md."""

from mffit.fleet.hierarchy import ENOUGH, Hierarchy, Population, TyreEstimate, estimate
from mffit.fleet.information import Information, information, to_json
from mffit.fleet.record import EPSILON, FAR, STRAINED, Fleet, Row, Scatter, with_estimate
from mffit.fleet.specimen import INFORMATION, Specimen, read

__all__ = [
    "ENOUGH",
    "EPSILON",
    "FAR",
    "INFORMATION",
    "STRAINED",
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

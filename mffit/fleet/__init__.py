"""Joint estimate of many tyres of one rig from their builds. See docs/fleet.md."""

from mffit.fleet.hierarchy import Hierarchy, TyreEstimate, estimate
from mffit.fleet.record import EPSILON, Fleet, Row, kinds_of
from mffit.fleet.specimen import INFORMATION, Specimen, read

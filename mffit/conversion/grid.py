"""The conditions over which a converted file has the old forces."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from mffit.constants import ANGLES_OF_A_CURVE
from mffit.conversion import constants
from tir.constants import SIDESLIP_BEYOND_PEAK, SLIP_BEYOND_PEAK


class Reach(NamedTuple):
    """Ranges of the conversion: the file's own, as far as cars go."""

    Fz: tuple[float, float]  #: [N]
    alpha: float  #: to either side [rad]
    gamma: float  #: to either side [rad]
    kappa: float  #: to either side [-]


class Conditions(NamedTuple):
    """Operating conditions; arrays (n,)."""

    Fz: np.ndarray
    alpha: np.ndarray
    gamma: np.ndarray
    kappa: np.ndarray

    @property
    def small_camber(self) -> np.ndarray:
        """Whether each condition is within the camber up to which cars use their tyres."""
        return np.asarray(np.abs(self.gamma) <= constants.SMALL_CAMBER.rad * (1.0 + 1e-9))

    @property
    def weight(self) -> np.ndarray:
        """Weight of each condition in the fit."""
        return np.where(self.small_camber, 1.0, float(constants.WEIGHT_OF_LARGE_CAMBER))

    def largest_alike(self, force: np.ndarray) -> np.ndarray:
        """The largest absolute force among the conditions of the same load and region: small camber or not, slipping or not."""
        key = np.column_stack([self.Fz, self.small_camber, self.kappa != 0.0])
        _, group = np.unique(key, axis=0, return_inverse=True)
        most = np.zeros(group.max() + 1)
        np.maximum.at(most, group.ravel(), np.abs(force))
        return most[group.ravel()]

    def u(self, force: np.ndarray) -> np.ndarray:
        """Uncertainty of each force (n,) for a fit: a good share of the largest alike, by the weight of the condition.

        Where all alike are 0, it is a share of the largest of all.
        """
        alike = self.largest_alike(force)
        unit = float(constants.GOOD_SHARE) * np.where(alike > 0.0, alike, np.max(alike))
        return np.asarray(unit / np.sqrt(self.weight / self.weight.sum()))


def reach_of(values: Mapping[str, Any], present: frozenset[str]) -> Reach:
    """The ranges of an old file within those of cars; the latter where the file states none."""
    nominal = float(values["FNOMIN"]) * float(values["LFZO"])
    least, most = (share * nominal for share in constants.CONVERTED_LOADS)
    low = max(least, float(values["FZMIN"])) if "FZMIN" in present else least
    high = min(most, float(values["FZMAX"])) if "FZMAX" in present else most

    def side(name: str, widest: float) -> float:
        return min(widest, abs(float(values[name]))) if name in present and values[name] else widest

    return Reach(
        (low, high if high > low else most),
        side("ALPMAX", SIDESLIP_BEYOND_PEAK.rad),
        side("CAMMAX", constants.CONVERTED_CAMBER.rad),
        side("KPUMAX", float(SLIP_BEYOND_PEAK)),
    )


def conditions(reach: Reach) -> Conditions:
    """A grid over the ranges, closer together at small angles, where the curves bend."""
    slips = float(reach.kappa) * np.array(constants.SLIPS_OF_THE_GRID)
    share = np.linspace(-1.0, 1.0, int(ANGLES_OF_A_CURVE))
    axes = np.meshgrid(
        loads(reach),
        reach.alpha * np.sign(share) * np.abs(share) ** 1.5,
        cambers(reach),
        np.unique(np.concatenate([-slips, slips])),
        indexing="ij",
    )
    return Conditions(*(axis.ravel() for axis in axes))


def loads(reach: Reach) -> np.ndarray:
    """The loads of the grid [N]."""
    return np.linspace(*reach.Fz, int(constants.LOADS_OF_THE_GRID))


def cambers(reach: Reach) -> np.ndarray:
    """The cambers of the grid to either side [rad]: half of them within the small camber, its end among them."""
    n = int(constants.CAMBERS_OF_THE_GRID)
    small = min(constants.SMALL_CAMBER.rad, reach.gamma)
    side = np.unique(np.concatenate([np.linspace(0.0, small, n), np.linspace(small, reach.gamma, n)]))
    return np.concatenate([-side[:0:-1], side])

"""The conditions over which a converted file has the old forces."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from mffit.conversion import constants


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
    def weight(self) -> np.ndarray:
        """Weight of each condition in the fit."""
        large = np.abs(self.gamma) > constants.SMALL_CAMBER.rad * (1.0 + 1e-9)
        return np.where(large, float(constants.WEIGHT_OF_LARGE_CAMBER), 1.0)


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
        side("ALPMAX", constants.CONVERTED_SIDESLIP.rad),
        side("CAMMAX", constants.CONVERTED_CAMBER.rad),
        side("KPUMAX", float(constants.CONVERTED_SLIP)),
    )


def conditions(reach: Reach) -> Conditions:
    """A grid over the ranges, closer together at small angles, where the curves bend."""
    loads = np.linspace(*reach.Fz, int(constants.LOADS_OF_THE_GRID))
    slips = float(reach.kappa) * np.array(constants.SLIPS_OF_THE_GRID)
    axes = np.meshgrid(
        loads,
        _towards_zero(reach.alpha, int(constants.SIDESLIPS_OF_THE_GRID)),
        _towards_zero(reach.gamma, int(constants.CAMBERS_OF_THE_GRID)),
        np.unique(np.concatenate([-slips, slips])),
        indexing="ij",
    )
    return Conditions(*(axis.ravel() for axis in axes))


def _towards_zero(end: float, n: int) -> np.ndarray:
    """``n`` values from -end to end, in steps that grow with the distance from zero."""
    share = np.linspace(-1.0, 1.0, n)
    return end * np.sign(share) * np.abs(share) ** 1.5

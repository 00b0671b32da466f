"""Conditions on a straight path over the ranges of a file, their weights, and the forces of a file at them."""

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from mffit.fit import constants
from mffit.quantities import SIDEWAYS
from mffit.rig import Readings
from tir.outputs import outputs_of


class Road(NamedTuple):
    """Conditions, arrays (n,)."""

    Fz: np.ndarray  #: [N]
    alpha: np.ndarray  #: [rad]
    gamma: np.ndarray  #: [rad]
    pressure: np.ndarray  #: [Pa]


def road_grid(tested: Mapping[str, float], written: Mapping[str, float], nominal_load: float) -> Road:
    """Conditions over the written ranges, denser inside the tested ranges; the end pressures appear at one load only."""
    gamma = np.linspace(-written["CAMMAX"], written["CAMMAX"], 11)
    inside = np.linspace(-tested["ALPMAX"], tested["ALPMAX"], 13)
    beyond = np.linspace(tested["ALPMAX"], written["ALPMAX"], 4)[1:]
    alpha = np.unique(np.concatenate([-beyond, inside, beyond]))
    main = 0.5 * (tested["PRESMIN"] + tested["PRESMAX"])
    within = np.linspace(tested["FZMIN"], tested["FZMAX"], 4)
    loads = np.unique([written["FZMIN"], *within, written["FZMAX"]])
    middle = float(np.clip(nominal_load, tested["FZMIN"], tested["FZMAX"]))
    cases = [(load, main) for load in loads]
    cases += [(middle, pressure) for pressure in sorted({written["PRESMIN"], written["PRESMAX"]} - {main})]
    at = [np.meshgrid([load], alpha, gamma, [pressure], indexing="ij") for load, pressure in cases]
    return Road(*(np.concatenate([axes[i].ravel() for axes in at]) for i in range(4)))


def camber_lines(written: Mapping[str, float]) -> tuple[Road, int]:
    """Lines of camber without sideslip over the written range, one per load, and the number of conditions per line."""
    loads, n = int(constants.LOADS_OF_A_GRID), 2 * int(constants.STEPS_OF_A_GRID) - 1
    Fz, gamma = np.meshgrid(
        np.linspace(written["FZMIN"], written["FZMAX"], loads),
        np.linspace(-written["CAMMAX"], written["CAMMAX"], n),
        indexing="ij",
    )
    pressure = np.full(Fz.size, 0.5 * (written["PRESMIN"] + written["PRESMAX"]))
    return Road(Fz.ravel(), np.zeros(Fz.size), gamma.ravel(), pressure), n


CORNER = {"everything": float(constants.WEIGHT_IN_CORNER), "road": float(constants.LITTLE_WEIGHT)}
"""By ``[normal] weight``, the weight of conditions with large camber and large sideslip."""


def weights(road: Road, tested: Mapping[str, float], weight: str = "everything") -> np.ndarray:
    """Weight (n,) of each condition, smaller for large camber together with large sideslip.

    On the road, large camber goes with small sideslip and vice versa; both at once is a fall. Inside the tested ranges the weight
    is ``1/2 + 1/2 / (1 + (alpha/4 deg * gamma/25 deg)**2)``: 1 along both axes, nearly 1/2 at 8 deg of sideslip and 50 deg of
    camber. With ``weight = "road"`` the limit in this corner is a fiftieth instead of 1/2. Outside the tested ranges the weight
    is a fiftieth of this.
    """
    both = (road.alpha / constants.LARGE_SIDESLIP.rad * road.gamma / constants.LARGE_CAMBER.rad) ** 2
    corner = CORNER[weight]
    share = np.where(inside(road, tested), 1.0, constants.LITTLE_WEIGHT)
    return np.asarray(share * (corner + (1.0 - corner) / (1.0 + both)))


def held_to_camber(ranges: Mapping[str, float], camber: float | None) -> dict[str, float]:
    """The ranges with camber limited to an angle [rad]; None for no limit."""
    end = ranges["CAMMAX"] if camber is None else min(camber, ranges["CAMMAX"])
    return {**ranges, "CAMMIN": -end, "CAMMAX": end}


def inside(road: Road, tested: Mapping[str, float]) -> np.ndarray:
    """Mask (n,) of the conditions inside the tested ranges, with a tolerance for rounding."""
    within: np.ndarray = np.abs(road.alpha) <= tested["ALPMAX"] + 1e-9
    within &= np.abs(road.gamma) <= tested["CAMMAX"] + 1e-9
    within &= (road.Fz >= 0.999 * tested["FZMIN"]) & (road.Fz <= 1.001 * tested["FZMAX"])
    within &= (road.pressure >= 0.999 * tested["PRESMIN"]) & (road.pressure <= 1.001 * tested["PRESMAX"])
    return within


def forces(values: Mapping[str, Any], road: Road, *, turn_slip: bool, phi_t: float = 0.0) -> Readings:
    """Fy [N] and Mz [Nm] of a file at the conditions."""
    found = _outputs(tuple(SIDEWAYS), values, road, turn_slip, phi_t)
    return Readings(**dict(zip(SIDEWAYS, found, strict=True)))


def force(channel: str, values: Mapping[str, Any], road: Road, *, turn_slip: bool, phi_t: float = 0.0) -> Any:
    """One channel of a file at the conditions, plain or traced."""
    return _outputs((channel,), values, road, turn_slip, phi_t)[0]


def _outputs(
    names: tuple[str, ...], values: Mapping[str, Any], road: Road, turn_slip: bool, phi_t: float
) -> list[Any]:
    path = {"phi_t": phi_t} if phi_t else {}
    return outputs_of(names, SimpleNamespace(**values), {**road._asdict(), **path}, turn_slip=turn_slip)

"""Differences between a written file and the fitted model, over the ranges of the file."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from mffit.as_json import keys
from mffit.fit.rig.zeros import BESIDE_ZERO
from mffit.fit.written.road import Road, forces, inside, weights
from mffit.scatter import rms
from tir import Tyre
from tir.derivatives import gradient, traced
from tir.outputs import outputs_of


@dataclass(frozen=True, slots=True)
class Misfit:
    """Difference of one channel from the fitted model [N] or [Nm], over the tested ranges unless stated otherwise."""

    rms: float  #: with equal weight of all conditions
    weighted: float  #: rms with the weights of :func:`mffit.fit.written.road.weights`
    largest: float
    beyond: float  #: rms outside the tested but inside the written ranges
    ridden: float = 0.0
    """Rms with the "road" weights, by which large camber together with large sideslip hardly counts."""


@dataclass(frozen=True, slots=True)
class FileFigures:
    """A written file and its misfit to the fitted model."""

    tyre: Tyre
    misfit: Mapping[str, Mapping[str, Misfit]]  #: by place and channel; every file has the place "straight"
    camber_stiffness: float  #: slope of Fy over camber at zero on a straight path [N/rad]

    @property
    def straight(self) -> Mapping[str, Misfit]:
        """By channel, misfit on a straight path in the file's use; for a file of both uses, with turn slip off."""
        return self.misfit["straight"]


keys(
    FileFigures,
    "USE_MODE **misfit camber_stiffness_N_per_rad",
    USE_MODE=lambda file: int(file.tyre["USE_MODE"]),
)


def figures(
    tyre: Tyre, use: str, model: Mapping[str, Any], road: Road, tested: Mapping[str, float], phi_t: float
) -> FileFigures:
    """The misfit and camber stiffness of a file for the use "turn-slip", "normal" or "both".

    ``model`` has the values of the fitted model, ``tested`` the tested ranges; ``phi_t`` is the curvature of the disc's path
    [1/m], 0 on a flat track.
    """
    turn_slip = use == "turn-slip"
    places = {"straight": (turn_slip, 0.0)}
    if use == "both":
        places |= {"straight_with_turn_slip": (True, 0.0), "disc": (True, phi_t)}
    misfit = {}
    for place, (on, path) in places.items():
        own = forces(tyre.values, road, turn_slip=on, phi_t=path)
        aim = forces(model, road, turn_slip=bool(phi_t), phi_t=path)
        misfit[place] = {channel: _misfit(own[channel] - aim[channel], road, tested) for channel in own}
    return FileFigures(tyre, misfit, camber_stiffness(tyre, float(model["FNOMIN"]), turn_slip=turn_slip))


def _misfit(difference: np.ndarray, road: Road, tested: Mapping[str, float]) -> Misfit:
    within = inside(road, tested)
    off = difference[within]

    def weighted(*weight: str) -> float:
        return float(np.sqrt(np.average(off**2, weights=weights(road, tested, *weight)[within])))

    beyond = rms(difference[~within]) if np.any(~within) else 0.0
    return Misfit(rms(off), weighted(), float(np.max(np.abs(off))), beyond, weighted("road"))


def camber_stiffness(tyre: Tyre, load: float, *, turn_slip: bool) -> float:
    """Slope of Fy over camber at zero on a straight path [N/rad]."""
    camber = traced({"gamma": np.array(BESIDE_ZERO)})
    (Fy,) = outputs_of(("Fy",), tyre.p, {"Fz": load, **camber}, turn_slip=turn_slip)
    return float(gradient(Fy, list(camber.values())).mean())

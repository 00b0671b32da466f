"""Differences between a written file and the fitted model, over the ranges of the file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from mffit.fit.rig.zeros import BESIDE_ZERO
from mffit.fit.written.road import Road, forces, inside, weights
from mffit.scatter import rms
from tir import Tyre
from tir.derivatives import gradient, traced
from tir.outputs import outputs_of


@dataclass(frozen=True, slots=True)
class Misfit:
    """Difference of one channel from the fitted model [N] or [Nm]; over the tested ranges where not stated otherwise."""

    rms: float  #: all conditions with equal weight
    weighted: float  #: rms with the weights of :func:`mffit.fit.written.road.weights`
    largest: float
    beyond: float  #: rms of the conditions outside the tested but inside the written ranges
    ridden: float = 0.0
    """Rms with the weights of the road, where much lean and much sideslip together hardly count."""


@dataclass(frozen=True, slots=True)
class FileFigures:
    """A written file and how far it is from the fitted model."""

    tyre: Tyre
    misfit: Mapping[str, Mapping[str, Misfit]]  #: by place and channel; every file has the place "straight"
    camber_stiffness: float  #: slope of Fy over camber at zero on a straight path [N/rad]

    @property
    def straight(self) -> Mapping[str, Misfit]:
        """By channel on a straight path, in the file's own use; turn slip off for a file that serves both uses."""
        return self.misfit["straight"]


class Reference(NamedTuple):
    """The fitted model and the conditions at which files are compared with it."""

    model: Mapping[str, Any]  #: every value
    road: Road
    tested: Mapping[str, float]
    phi_t: float  #: curvature of the disc's path [1/m]; 0 on a flat track

    def figures(self, tyre: Tyre, use: str) -> FileFigures:
        """The figures of a file for "turn-slip", "normal" or "both"."""
        turn_slip = use == "turn-slip"
        misfit = {"straight": self._misfits(tyre, turn_slip=turn_slip, phi_t=0.0)}
        if use == "both":
            misfit["straight_with_turn_slip"] = self._misfits(tyre, turn_slip=True, phi_t=0.0)
            misfit["disc"] = self._misfits(tyre, turn_slip=True, phi_t=self.phi_t)
        load = float(self.model["FNOMIN"])
        return FileFigures(tyre, misfit, camber_stiffness(tyre, load, turn_slip=turn_slip))

    def _misfits(self, tyre: Tyre, *, turn_slip: bool, phi_t: float) -> dict[str, Misfit]:
        own = forces(tyre.values, self.road, turn_slip=turn_slip, phi_t=phi_t)
        aim = forces(self.model, self.road, turn_slip=bool(self.phi_t), phi_t=phi_t)
        return {channel: self._misfit(own[channel] - aim[channel]) for channel in own}

    def _misfit(self, difference: np.ndarray) -> Misfit:
        within = inside(self.road, self.tested)
        weight = weights(self.road, self.tested)
        return Misfit(
            rms=rms(difference[within]),
            weighted=float(np.sqrt(np.average(difference[within] ** 2, weights=weight[within]))),
            largest=float(np.max(np.abs(difference[within]))),
            beyond=rms(difference[~within]) if np.any(~within) else 0.0,
            ridden=float(
                np.sqrt(
                    np.average(
                        difference[within] ** 2, weights=weights(self.road, self.tested, "road")[within]
                    )
                )
            ),
        )


def camber_stiffness(tyre: Tyre, load: float, *, turn_slip: bool) -> float:
    """Slope of Fy over camber at zero on a straight path [N/rad]."""
    camber = traced({"gamma": np.array(BESIDE_ZERO)})
    (Fy,) = outputs_of(("Fy",), tyre.p, {"Fz": load, **camber}, turn_slip=turn_slip)
    return float(gradient(Fy, list(camber.values())).mean())

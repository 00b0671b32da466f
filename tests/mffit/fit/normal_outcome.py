"""The file for turn slip off of a tyre of known truth, compared with the tyre over a box of conditions."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares

import tir
from mffit.fit.constraints import Envelope, violations
from mffit.fit.ranges import plausible_ranges
from mffit.fit.written.normal import CAMBER_FORCE, CAMBER_MOMENT, derive
from mffit.fit.written.road import Road, forces, weights
from mffit.scatter import rms
from tir.parameters import BY_NAME

STARTS: tuple[Mapping[str, float], ...] = (
    {}, {"PEY5": 5.0, "QEZ5": 3.0}, {"PVY3": 0.5, "QDZ4": -2.0}, {"PDY3": 1.0, "QBZ5": 1.0}, {"QBZ5": -0.5, "QEZ5": -3.0}
)  # fmt: skip
UNIT = {"Fy": 10.0, "Mz": 0.5}
"""Misfit that counts as 1 in the search for the limit [N], [Nm]."""


class Outcome(NamedTuple):
    """Misfit of the normal file over the box: rms, but for ``largest_Fy`` [N], [Nm]."""

    Fy: float
    weighted_Fy: float
    Mz: float
    largest_Fy: float
    stiffness: float  #: slope of Fy over camber at zero, of the file over the tyre
    seconds: float


def box(nominal_load: float, pressure: float) -> Road:
    """Sideslip to 8 deg and camber to 50 deg, at 0.7 to 1.4 times the nominal load."""
    axes = np.meshgrid(
        np.linspace(0.7, 1.4, 5) * nominal_load,
        np.radians(np.linspace(-8, 8, 17)),
        np.radians(np.linspace(-50, 50, 11)),
        [pressure],
        indexing="ij",
    )
    return Road(*(axis.ravel() for axis in axes))


def usual_ranges(tyre: tir.Tyre) -> dict[str, float]:
    """The ranges of the usual campaign."""
    load, pressure = tyre["FNOMIN"], tyre["NOMPRES"]
    alpha, gamma = np.radians(8.0), np.radians(50.0)
    return {
        "FZMIN": 0.6 * load, "FZMAX": 1.5 * load, "ALPMIN": -alpha, "ALPMAX": alpha, "CAMMIN": -gamma,
        "CAMMAX": gamma, "PRESMIN": 0.8 * pressure, "PRESMAX": 1.2 * pressure,
    }  # fmt: skip


def outcome(tyre: tir.Tyre) -> Outcome:
    """Derive the normal file of a tyre and compare it with the tyre with turn slip on, on a straight path."""
    values, data = dict(tyre.values), usual_ranges(tyre)
    began = time.perf_counter()
    written = plausible_ranges(values, data, turn_slip=True)
    normal = {**values, **derive(values, data, written)}
    seconds = time.perf_counter() - began
    road = box(values["FNOMIN"], values["NOMPRES"])
    true, made = forces(values, road, turn_slip=True), forces(normal, road, turn_slip=False)
    step = np.radians([-0.1, 0.1])
    lean = Road(np.full(2, values["FNOMIN"]), np.zeros(2), step, np.full(2, values["NOMPRES"]))
    slopes = [np.diff(forces(v, lean, turn_slip=on).Fy)[0] for v, on in ((normal, False), (values, True))]
    gap = made.Fy - true.Fy
    return Outcome(
        Fy=rms(gap),
        weighted_Fy=float(np.sqrt(np.average(gap**2, weights=weights(road, data)))),
        Mz=rms(made.Mz - true.Mz),
        largest_Fy=float(np.max(np.abs(gap))),
        stiffness=float(slopes[0] / slopes[1]),
        seconds=seconds,
    )


def limit(tyre: tir.Tyre) -> list[float]:
    """The smallest rms misfits of Fy [N] and Mz [Nm] over the box that the camber terms can reach.

    The terms are optimised for these conditions alone, without weights, ties or limits outside them.
    """
    values, road = dict(tyre.values), box(tyre["FNOMIN"], tyre["NOMPRES"])
    best, ends = dict(values), []
    for channel, names in (("Fy", CAMBER_FORCE), ("Mz", CAMBER_MOMENT)):
        found = [_least(values, {**best, **start}, names, channel, road) for start in STARTS]
        misfit, ended = min(found, key=lambda pair: pair[0])
        best.update(ended)
        ends.append(misfit)
    return ends


def _least(
    values: Mapping[str, Any], start: Mapping[str, Any], names: Sequence[str], channel: str, road: Road
) -> tuple[float, dict[str, float]]:
    target = getattr(forces(values, road, turn_slip=True), channel)
    pressures = (road.pressure[0], road.pressure[0])
    limits = Envelope((road.Fz.min(), road.Fz.max()), road.gamma.max(), road.alpha.max(), pressures)

    def residual(x: np.ndarray) -> np.ndarray:
        tried = {**start, **dict(zip(names, x, strict=True))}
        misfit = getattr(forces(tried, road, turn_slip=False), channel) - target
        return np.concatenate([misfit / UNIT[channel], 300.0 * violations(SimpleNamespace(**tried), limits)])

    lower, upper = (np.array([BY_NAME[n].bounds[i] for n in names]) for i in (0, 1))
    begun = np.clip([start[n] for n in names], lower + 1e-3 * (upper - lower), upper - 1e-3 * (upper - lower))
    out = least_squares(residual, begun, bounds=(lower, upper), x_scale="jac", max_nfev=100)
    return UNIT[channel] * rms(out.fun[: len(target)]), dict(zip(names, out.x, strict=True))

"""The derived file for simulations without turn slip: camber acts through its own terms, not through spin."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares

from mffit.fit.constraints import Envelope, violations
from mffit.fit.ranges import envelope
from mffit.fit.stages import ODD_TERMS
from tir.evaluate import evaluate
from tir.parameters import BY_NAME

CAMBER_STIFFNESS = ("PKY6", "PKY7")
CAMBER_FORCE = ("PKY3", "PKY5", "PDY3", "PVY3", "PVY4", "PEY4", "PEY5", *CAMBER_STIFFNESS)
CAMBER_MOMENT = (
    "QDZ3", "QDZ4", "QDZ8", "QDZ9", "QDZ10", "QDZ11", "QBZ4", "QBZ5", "QEZ5", "QHZ3", "QHZ4"
)  # fmt: skip
FORCE_STARTS: tuple[Mapping[str, float], ...] = ({}, {"PEY5": -3.0, "PDY3": 0.3}, {"PVY3": -0.5, "PDY3": 1.0})
MOMENT_STARTS: tuple[Mapping[str, float], ...] = (
    {},
    {"QDZ4": -1.0, "QEZ5": -2.0},
    {"QBZ5": 0.8, "QEZ5": 2.0},
)
OUTSIDE, CORNER = 0.02, 0.5
SLIP, LEAN = np.radians(4.0), np.radians(25.0)
LIMIT_WEIGHT = 300.0
"""Residual per unit of a broken limit, the rms misfit being of the order of 1."""
TIE, TIE_SHARE = 0.1, 0.03
"""Spread of the measured camber stiffness as PKY6 and PKY7 see it, and its weight beside the whole grid."""
SCALE = {"Fy": 0.01, "Mz": 0.001}
"""Unit of the residual, per nominal load [N/N, m]: the size of the misfit that the formula cannot avoid."""


class Road(NamedTuple):
    """Conditions on a straight path, arrays (n,)."""

    Fz: np.ndarray  #: [N]
    alpha: np.ndarray  #: [rad]
    gamma: np.ndarray  #: [rad]
    pressure: np.ndarray  #: [Pa]

    def forces(self, values: Mapping[str, Any], *, turn_slip: bool):
        """Forces of a file on it; with turn slip on, path curvature is 0 and only camber makes spin."""
        return evaluate(
            SimpleNamespace(**values),
            self.Fz,
            self.alpha,
            self.gamma,
            pressure=self.pressure,
            turn_slip=turn_slip,
        )[0]


def derive_normal(
    values: Mapping[str, Any],
    tested: Mapping[str, float],
    written: Mapping[str, float],
    measured: Mapping[str, float],
    *,
    symmetric: bool = False,
) -> dict[str, float]:
    """Coefficients of the file for turn slip off, where they differ from the fitted model.

    The target is the fitted model on a straight path, turn slip on, on a grid over the written ranges. Only coefficients
    that act through camber move, so that the upright wheel stays exact. First those of Fy, then those of Mz, which sees
    the shifts of Fy. Several starts on a coarse grid, the best of them finished on the fine one.

    Parameters
    ----------
    values : the fitted model, right with turn slip on
    tested, written : ranges of the data and of the file, by name of the file's limits
    measured : PKY6 and PKY7 of the measured camber stiffness, from :func:`mffit.fit.start.camber_stiffness_terms`; may be empty
    symmetric : hold the terms that a symmetric tyre does not have
    """
    limits = envelope(written)
    coarse, fine = (
        road_grid(tested, written, float(values["FNOMIN"]), dense=dense) for dense in (False, True)
    )
    found = dict(values)
    for channel, names, starts in (
        ("Fy", CAMBER_FORCE, FORCE_STARTS),
        ("Mz", CAMBER_MOMENT, MOMENT_STARTS),
    ):
        free = tuple(n for n in names if not (symmetric and n in ODD_TERMS))
        on_coarse, on_fine = (
            _residual(channel, road, values, found, weights(road, tested), limits, measured)
            for road in (coarse, fine)
        )
        begun = {name: measured.get(name, float(values[name])) for name in free}
        tried = [_solve(on_coarse, {**begun, **start}, 25, 1e-3) for start in starts]
        best, _ = min(tried, key=lambda end: end[1])
        found.update(_solve(on_fine, best, 30, 1e-4)[0])
    return {name: found[name] for name in (*CAMBER_FORCE, *CAMBER_MOMENT) if found[name] != values[name]}


def road_grid(
    tested: Mapping[str, float], written: Mapping[str, float], nominal_load: float, *, dense: bool = True
) -> Road:
    """Straight-path conditions over the written ranges: denser inside the tested ones, other pressures at one load."""
    sides, inner, outer = (11, 13, 3) if dense else (7, 7, 1)
    gamma = np.linspace(-written["CAMMAX"], written["CAMMAX"], sides)
    inside = np.linspace(-tested["ALPMAX"], tested["ALPMAX"], inner)
    beyond = np.linspace(tested["ALPMAX"], written["ALPMAX"], outer + 1)[1:]
    alpha = np.unique(np.concatenate([-beyond, inside, beyond]))
    main = 0.5 * (tested["PRESMIN"] + tested["PRESMAX"])
    loads = np.unique(
        [
            written["FZMIN"],
            *np.linspace(tested["FZMIN"], tested["FZMAX"], 4 if dense else 2),
            written["FZMAX"],
        ]
    )
    middle = float(np.clip(nominal_load, tested["FZMIN"], tested["FZMAX"]))
    cases = [(load, main) for load in loads]
    cases += [(middle, pressure) for pressure in sorted({written["PRESMIN"], written["PRESMAX"]} - {main})]
    at = [np.meshgrid([load], alpha, gamma, [pressure], indexing="ij") for load, pressure in cases]
    return Road(*(np.concatenate([axes[i].ravel() for axes in at]) for i in range(4)))


def weights(road: Road, tested: Mapping[str, float]) -> np.ndarray:
    """Weight (n,) of each condition: what a vehicle visits counts more than the corners of the ranges.

    A wheel leans far with little sideslip and slips far with little lean; both at once is a fall. Inside the tested
    ranges the weight is ``1/2 + 1/2 / (1 + (alpha/4 deg * gamma/25 deg)**2)``: 1 along both axes, nearly 1/2 in the
    corner of 8 deg of sideslip and 50 deg of camber. Conditions that only the written ranges hold count a fiftieth:
    enough to keep the file plausible there, too little to cost newtons where there are data.
    """
    both = (road.alpha / SLIP * road.gamma / LEAN) ** 2
    return np.where(inside(road, tested), 1.0, OUTSIDE) * (CORNER + (1.0 - CORNER) / (1.0 + both))


def inside(road: Road, tested: Mapping[str, float]) -> np.ndarray:
    """Which conditions (n,) lie inside the tested ranges."""
    within = np.abs(road.alpha) <= tested["ALPMAX"] + 1e-9
    within &= np.abs(road.gamma) <= tested["CAMMAX"] + 1e-9
    within &= (road.Fz >= 0.999 * tested["FZMIN"]) & (road.Fz <= 1.001 * tested["FZMAX"])
    return (
        within & (road.pressure >= 0.999 * tested["PRESMIN"]) & (road.pressure <= 1.001 * tested["PRESMAX"])
    )


Residual = Callable[[Mapping[str, float]], np.ndarray]


def _residual(
    channel: str,
    road: Road,
    model: Mapping[str, Any],
    fixed: Mapping[str, Any],
    weight: np.ndarray,
    limits: Envelope,
    measured: Mapping[str, float],
) -> Residual:
    """Misfit of one channel, then the broken limits, the camber stiffness and the turning back of camber thrust."""
    target = getattr(road.forces(model, turn_slip=True), channel)
    factor = np.sqrt(weight / weight.sum()) / (SCALE[channel] * float(model["FNOMIN"]))
    fixed = dict(fixed)
    line = _camber_line(limits)
    falls = np.diff(line.forces(model, turn_slip=True).Fy.reshape(3, -1)) < 0.0
    stiffness = max(abs(measured.get("PKY6", 1.0)), 0.1)

    def residual(free: Mapping[str, float]) -> np.ndarray:
        values = {**fixed, **free}
        rows = [
            (getattr(road.forces(values, turn_slip=False), channel) - target) * factor,
            LIMIT_WEIGHT / 20.0 * violations(SimpleNamespace(**values), limits),
        ]
        if channel == "Fy":
            step = np.diff(line.forces(values, turn_slip=False).Fy.reshape(3, -1))
            rows.append(np.where(falls, np.maximum(step, 0.0), 0.0).ravel() / (SCALE["Fy"] * fixed["FNOMIN"]))
            rows.append(
                np.array(
                    [(values[n] - measured[n]) / (TIE * stiffness) for n in CAMBER_STIFFNESS if n in measured]
                )
                * TIE_SHARE
            )
        return np.concatenate(rows)

    return residual


def _camber_line(limits: Envelope) -> Road:
    """Camber alone, over the whole range, at three loads."""
    Fz, gamma = np.meshgrid(
        np.linspace(*limits.Fz, 3), np.linspace(-limits.gamma, limits.gamma, 17), indexing="ij"
    )
    shape = Fz.ravel().shape
    return Road(Fz.ravel(), np.zeros(shape), gamma.ravel(), np.full(shape, 0.5 * sum(limits.pressure)))


def _solve(
    residual: Residual, start: Mapping[str, float], steps: int, tolerance: float
) -> tuple[dict[str, float], float]:
    """Where bounded least squares end from a start, and the sum of squares there."""
    names = list(start)
    lower, upper = (np.array([BY_NAME[name].bounds[i] for name in names]) for i in (0, 1))
    margin = 1e-3 * (upper - lower)
    out = least_squares(
        lambda x: residual(dict(zip(names, x.tolist(), strict=True))),
        np.clip(list(start.values()), lower + margin, upper - margin),
        bounds=(lower, upper),
        x_scale="jac",
        max_nfev=steps,
        ftol=tolerance,
        xtol=tolerance,
    )
    return dict(zip(names, out.x.tolist(), strict=True)), float(out.cost)

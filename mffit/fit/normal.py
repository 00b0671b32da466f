"""The derived file for simulations without turn slip: camber acts through its own terms, not through spin."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from mffit.fit.constraints import Envelope
from mffit.fit.coverage import StageCoverage
from mffit.fit.problem import Problem
from mffit.fit.start import camber_stiffness_terms
from mffit.least_squares import Number, solve
from mffit.parts import Parts
from mffit.points import Points, main_pressure
from mffit.rig import Simulation
from tir.parameters import BY_NAME

CAMBER_FORCE = ("PKY3", "PKY5", "PDY3", "PVY3", "PVY4", "PEY4", "PEY5")
CAMBER_MOMENT = ("QDZ8", "QDZ9", "QDZ10", "QDZ11")


class Normal(NamedTuple):
    """Coefficients that differ from the fitted model, and what the derivation costs."""

    values: dict[str, float]
    stderr: dict[str, float]
    measured: frozenset[str]  #: set to a measured stiffness
    difference_N: float  #: of both modes at the largest camber, on a straight path


def derive_normal(
    values: Mapping[str, Any],
    points: Points,
    parts: Parts,
    cover: tuple[StageCoverage, ...],
    C_gamma: Mapping[float, float],
    envelope: Envelope | None,
) -> Normal:
    """Coefficients of the file for turn slip off.

    PKY6 and PKY7 give the measured camber stiffness; the other camber terms of Fy are refitted to the odd part with
    spin off. The camber terms of Mz follow the fitted model on a straight path, because the odd part of Mz still
    carries the loss of trail on the disc.

    Parameters
    ----------
    values : the fitted model, right with turn slip on
    C_gamma : measured camber stiffness [N/rad] by load [N], at the main pressure
    """
    free = {name for row in cover for name in row.free}
    imposed = camber_stiffness_terms(values, C_gamma, float(points.p[main_pressure(points)].mean()))
    start = {**values, **imposed}
    straight = points.replace(phi_t=np.zeros(len(points)), direction=np.ones_like(points.direction))
    straight = straight.replace(mount=np.ones_like(points.mount))
    symmetric = {**start, **dict.fromkeys(("PHY1", "PHY2", "PVY1", "PVY2"), 0.0)}

    force = [name for name in CAMBER_FORCE if name in free]
    used = (parts.paired != "unpaired") & (points.direction > 0)
    odd = straight.replace(
        alpha=parts.alpha_odd, Fy=np.where(used, parts.Fy_odd, np.nan), Mz=np.full(len(points), np.nan)
    )
    fitted_force, errors_force = _refit(odd, symmetric, force, envelope, points.u_Fy)

    fitted = {**start, **fitted_force}
    on_road = Simulation(values).readings(straight)
    road = straight.replace(Fy=np.full(len(points), np.nan), Mz=on_road.Mz)
    moment = [name for name in CAMBER_MOMENT if name in free]
    fitted_moment, errors_moment = _refit(road, fitted, moment, envelope, points.u_Mz)

    changed = {**imposed, **fitted_force, **fitted_moment}
    normal = Simulation({**values, **changed}, turn_slip=False).readings(straight)
    largest = np.abs(points.gamma) > 0.98 * np.max(np.abs(points.gamma))
    difference = float(np.sqrt(np.mean((normal.Fy - on_road.Fy)[largest] ** 2)))
    return Normal(changed, {**errors_force, **errors_moment}, frozenset(imposed), difference)


def _refit(points: Points, values, names, envelope, u) -> tuple[dict[str, float], dict[str, float]]:
    if not names:
        return {}, {}
    sigma = np.where(np.isfinite(u), u, np.nanmedian(u) if np.any(np.isfinite(u)) else 1.0)
    problem = Problem(
        points=points,
        simulation=Simulation(values, turn_slip=False),
        sigma_Fy=np.where(np.isfinite(points.Fy), sigma, np.inf),
        sigma_Mz=np.where(np.isfinite(points.Mz), sigma, np.inf),
        envelope=envelope,
    )
    numbers = [
        Number(n, float(values[n]), *BY_NAME[n].bounds, float(values[n]), 0.5 * BY_NAME[n].width)
        for n in names
    ]
    solution = solve(problem.free(names), numbers)
    misfit = max(1.0, float(np.sqrt(np.mean(solution.data**2))))
    errors = misfit * np.sqrt(np.diag(solution.covariance))
    return dict(solution.values), dict(zip(names, errors.tolist(), strict=True))

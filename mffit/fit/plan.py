"""The free numbers of a fit and their priors."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mffit.config.constants import PLAUSIBLE_CONICITY
from mffit.fit import constants
from mffit.fit.coverage import StageCoverage, coverage
from mffit.fit.known import Known
from mffit.fit.priors import Prior, scatters
from mffit.fit.problem import FitProblem
from mffit.fit.rig_numbers import rig_numbers
from mffit.fit.stages import ODD_TERMS, STAGES
from mffit.fit.zeros import TurningZeros
from mffit.least_squares import FreeNumber
from mffit.points import Points
from tir.parameters import BY_NAME


@dataclass(frozen=True, slots=True)
class FitPlan:
    """The free numbers of a fit, their priors, and the numbers that are held."""

    cover: tuple[StageCoverage, ...]
    expected: Mapping[str, float]  #: centre of every coefficient's prior
    scatter: Mapping[str, float]  #: its standard deviation
    rig: tuple[FreeNumber, ...] = ()  #: rig errors, free in the polish
    extra: tuple[str, ...] = ()  #: coefficients that are free in the polish only
    held: Mapping[str, float] = field(default_factory=dict)
    """Standard uncertainty of coefficients that the fit takes as exact."""
    noise_stated: bool = True  #: whether the points state their uncertainty

    @property
    def free(self) -> list[str]:
        """Coefficients that the stages free."""
        return [name for row in self.cover for name in row.free]

    def coefficients(self, names: Iterable[str], problem: FitProblem) -> list[FreeNumber]:
        """The named coefficients from their current values, with the table's bounds and their priors."""
        return [
            FreeNumber(
                name=name,
                start=BY_NAME[name].inside(float(problem.simulation.values[name])),
                lower=BY_NAME[name].bounds[0],
                upper=BY_NAME[name].bounds[1],
                expected=self.expected[name],
                spread=self.scatter.get(name, math.inf),
            )
            for name in names
        ]

    def numbers(self, problem: FitProblem) -> list[FreeNumber]:
        """All free coefficients and rig errors, from their current values."""
        return [*self.coefficients([*self.free, *self.extra], problem), *problem.starting_here(self.rig)]


def fit_plan(
    config: Any,
    points: Points,
    measured: Any,
    known: Known,
    start: Mapping[str, float],
    fleet: Mapping[str, Prior],
    turning: TurningZeros | None = None,
) -> FitPlan:
    """The plan for these points; ``turning`` are zeros that determine PECP1 where eps_gamma was not measured."""
    cover = coverage(points, config.tyre.side or "left")
    rig = rig_numbers(config, measured, points.used_setups)
    staged = {name: start[name] for stage in STAGES for name in stage.parameters}
    scatter = scatters(staged, known.origin, curved=bool(np.any(points.phi_t)))
    if config.rig.on_disc and "PVY1" in scatter and config.rig.u_conicity != PLAUSIBLE_CONICITY:
        scatter["PVY1"] = max(config.rig.u_conicity, float(constants.LEAST_CONICITY))
    scatter |= {name: prior.spread for name, prior in fleet.items()}
    absent = ODD_TERMS if config.tyre.side == "symmetric" else frozenset()
    held = {name: scatter[name] for row in cover for name in row.held if name not in absent}
    extra = ["Q_RE0"] if rig and config.rig.on_disc and config.rolling_radius else []
    expected = {**start, **{name: prior.expected for name, prior in fleet.items()}}
    if measured.epsilon_gamma is not None and config.spin.pecp1 == "model":
        extra.append("PECP1")
    elif measured.epsilon_gamma is not None:
        debiased = measured.epsilon_gamma_debiased if config.spin.pecp1 == "debiased" else None
        held["PECP1"] = (debiased or measured.epsilon_gamma).u
    elif turning is not None:
        scatter.setdefault("PECP1", constants.CAMBER_REDUCTION_SPREAD)
        for name in turning.start:
            held.pop(name, None)
            expected[name] = turning.before[name]
        extra += [name for name in turning.start if not any(name in row.free for row in cover)]
    return FitPlan(
        cover=cover,
        expected=expected,
        scatter=scatter,
        rig=rig,
        extra=tuple(extra),
        held=held,
        noise_stated=bool(np.any(np.isfinite(points.u_Fy))),
    )

"""What a fit begins with: known values, plan, starting values and problem; and a first fit, for plans while a test runs."""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from mffit.config import Config
from mffit.fit.by_hand import Hand, hand_of
from mffit.fit.coefficients import coefficient_records
from mffit.fit.known import Known, known_after_fit, known_before_fit
from mffit.fit.plan import FitPlan, fit_plan
from mffit.fit.polish import first_fit
from mffit.fit.priors import of_fleet
from mffit.fit.problem import FitProblem, fit_problem
from mffit.fit.result import FitResult
from mffit.fit.rig.zeros import TurningZeros, turning_zeros
from mffit.fit.start import starting_values
from mffit.fit.wheel.vertical import Vertical, vertical_coefficients
from mffit.measured import Measured
from mffit.points import Points
from mffit.rig import Simulation
from tir import Tyre


class Begun(NamedTuple):
    """All that is decided before the search."""

    base: Tyre | None
    hand: Hand
    known: Known
    radii: Vertical
    turning: TurningZeros | None
    start: Mapping[str, float]
    plan: FitPlan
    problem: FitProblem

    @property
    def simulation(self) -> Simulation:
        """The rig with the tyre from which the search starts: its slopes at zero are the measured ones."""
        free = (*self.plan.free, *self.plan.extra)
        return self.problem.with_values({name: self.start[name] for name in free}).simulation


def begin(config: Config, points: Points, measured: Measured, base: Tyre | None) -> Begun:
    """What :func:`mffit.fit.fit` begins with."""
    fleet = of_fleet(config)
    hand = hand_of(config, base)
    known = known_before_fit(config, points, measured, base, fleet, hand)
    settled = {*hand.held, *(name for name, origin in known.origin.items() if origin == "measured")}
    radii = vertical_coefficients(known.values, points, settled)
    known = known.having({**{name: q.value for name, q in radii.found.items()}, **radii.switched}, "fitted")
    known = replace(known, u={**known.u, **{name: q.u for name, q in radii.found.items()}})
    known = known.having({n: known.values[n] for n in radii.found if n in radii.regularised}, "regularised")
    rolling = points.select(points.free_rolling) if np.any(points.free_rolling) else points
    turning = None if "PECP1" in hand.held else turning_zeros(known.values, rolling, measured)
    start = {
        **starting_values(known.values, points, measured, hand.held),
        **(turning.start if turning else {}),
    }
    plan = fit_plan(config, points, measured, known, start, fleet, turning)
    start = hand.starting(start)
    problem = fit_problem(config, points, measured, known.values, plan.channels)
    return Begun(base, hand, known, radii, turning, start, plan, problem)


def sketch(config: Config, points: Points, measured: Measured, base: Tyre | None) -> FitResult:
    """The first of the fits of a build alone: no influences other than coefficients and declared rig errors, no written files, no
    judgement. It takes a second and serves to plan runs; raises as :func:`mffit.fit.fit`.
    """
    begun = begin(config, points, measured, base)
    fitted = first_fit(begun.problem, begun.start, begun.plan)
    known = known_after_fit(begun.known, fitted.values, fitted.regularised, {}, base)
    tyre = Tyre.from_values(known.values)
    return FitResult(
        tyre=tyre,
        written=tyre,
        coefficients=coefficient_records(known, fitted, {}),
        channels={},
        odd={},
        simulation=fitted.simulation,
        rig=fitted.rig_stated,
        model=fitted.problem.readings(),
        posterior=fitted.posterior,
        coverage=begun.plan.cover,
        explanations=(),
        warnings=(),
        seconds=0.0,
        search=fitted,
    )

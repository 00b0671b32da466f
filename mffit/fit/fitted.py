"""The record of a finished fit: values, uncertainties and weights at the solution."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from mffit.fit import constants
from mffit.fit.by_hand import NO_HAND, Hand
from mffit.fit.problem import FitProblem
from mffit.fit.stages import is_asymmetry
from mffit.fit.told import known_beforehand, numbers_told, told_by_curves
from mffit.least_squares import FreeNumber, solve
from mffit.linearised import LinearisedFit, Uncertain, linearised
from mffit.numbers import Numbers
from mffit.rig import Simulation
from mffit.rig_errors import ZEROS, error_of
from tir.parameters import BY_NAME

SPIN = ("PECP1", "PECP2")
"""Coefficients that the readings on a disc inform although the fit holds them at the result of the direct method."""


@dataclass(frozen=True, slots=True)
class Fitted:
    """Values and uncertainties of the free numbers after the joint fit."""

    values: Mapping[str, float]  #: fitted coefficients
    rig: Mapping[str, tuple[float, float]]  #: rig error -> (value, standard error)
    correlation: Mapping[str, tuple[str, float]]  #: strong ones only: number -> (partner, correlation)
    posterior: Numbers  #: of tyre and rig, held values included
    problem: FitProblem  #: at the solution, with the final weights
    numbers: tuple[FreeNumber, ...]  #: numbers that were free in the last search
    held: Mapping[str, float]  #: standard uncertainty of coefficients that the fit took as exact
    held_rig: Mapping[str, float]  #: standard uncertainty of rig errors that the fit took as exact
    at_bound: frozenset[str]  #: numbers at their own bound or at a physical limit
    at_limit: frozenset[str]  #: numbers at a physical limit and not at their own bound
    regularised: frozenset[str]  #: coefficients that depend on their priors as much as on the points
    left: float  #: predicted decrease of the sum of squares by one more step: 0 at the minimum
    hand: Hand = NO_HAND  #: entries of [coefficients]
    u_at_bound: Mapping[str, float] = field(default_factory=dict)
    """Standard uncertainty that numbers at a bound would have off it; that of the others holds with these fixed."""

    @property
    def simulation(self) -> Simulation:
        """The fitted tyre on the rig as fitted."""
        return self.problem.simulation

    @property
    def rig_stated(self) -> dict[str, tuple[float, float]]:
        """The rig errors, and the reference conditions relative to which they are defined."""
        errors = (error_of(name) for name in self.rig)
        references = {error.counts_from for error in errors if error is not None and error.counts_from}
        return {**self.rig, **{name: (self.problem.value(name), 0.0) for name in sorted(references)}}

    @property
    def zeros(self) -> dict[str, tuple[float, float]]:
        """The fitted and the held zeros of the rig, with standard uncertainties."""
        held = {name: (self.problem.value(name), u) for name, u in self.held_rig.items()}
        return {name: row for name, row in {**held, **self.rig}.items() if error_of(name) in ZEROS}

    @property
    def stderr(self) -> dict[str, float]:
        """Standard uncertainty of every number."""
        return {**self.posterior.stderr, **self.u_at_bound}

    @property
    def at_own_bound(self) -> frozenset[str]:
        """Numbers at their own bound."""
        return self.at_bound - self.at_limit

    @property
    def inner(self) -> list[FreeNumber]:
        """The numbers inside their bounds, with their values as starting values."""
        return self.problem.starting_here([n for n in self.numbers if n.name not in self.at_bound])

    @property
    def taken_as_exact(self) -> dict[str, float]:
        """Standard uncertainty, where positive, of all numbers that the fit took as exact."""
        return {name: u for name, u in {**self.held, **self.held_rig}.items() if u > 0.0}


def with_prior(number: FreeNumber) -> FreeNumber:
    """The number; one without a prior gets one around its starting value, half the usual width among tyres wide."""
    if np.isfinite(number.spread):
        return number
    width = BY_NAME[number.name].width if number.name in BY_NAME else number.upper - number.lower
    return replace(number, expected=number.start, spread=0.5 * width)


def uncertain(number: FreeNumber) -> Uncertain:
    """The number's prior relative to its starting value."""
    known = with_prior(number)
    return Uncertain(known.name, known.expected - known.start, known.spread)


def left_by(
    fitted: Fitted,
    of: FitProblem | None = None,
    without: np.ndarray | None = None,
    near: LinearisedFit | None = None,
) -> LinearisedFit:
    """The linear model of the fit's residuals at its own points, or at the points of the problem ``of``.

    ``without`` are rows that the fit did not use. Coefficients at a bound are held there. The search for the variance components
    starts at those of ``near``, if given.
    """
    free = fitted.problem.starting_here(fitted.numbers)
    numbers = [uncertain(n) for n in free if error_of(n.name) or n.name not in fitted.at_bound]
    problem = of or fitted.problem
    # Asymmetries keep the values at which they are held, but the readings narrow their uncertainty.
    beside = problem.points.curved
    numbers += [
        Uncertain(name, 0.0, u, held=not (beside and is_asymmetry(name)))
        for name, u in fitted.taken_as_exact.items()
    ]
    return linearised(problem.points, fitted.simulation, problem.sigma, numbers, without=without, near=near)


def priors_of(fitted: Fitted) -> Numbers:
    """The fitted numbers, those held with an uncertainty, and on a disc PECP1 and PECP2."""
    held = fitted.taken_as_exact
    if fitted.problem.simulation.turn_slip:
        held = dict.fromkeys((name for name in SPIN if name not in fitted.hand.held), 0.0) | held
    return known_beforehand(fitted.problem, [with_prior(number) for number in fitted.numbers], held)


def with_errors_of(fitted: Fitted, left: LinearisedFit) -> Fitted:
    """The fit with the uncertainty that repeated campaigns would show, from the linear model ``left`` of its residuals."""
    priors = priors_of(fitted)
    told = told_by_curves(fitted.problem, left, priors.names)
    free = numbers_told(told, priors)
    fixed = {name: free.stderr[name] for name in fitted.at_own_bound}
    posterior = free.given(fixed)
    stderr = {**posterior.stderr, **fixed}
    rig = {name: (value, stderr[name]) for name, (value, _) in fitted.rig.items()}
    return replace(fitted, posterior=posterior, u_at_bound=fixed, rig=rig)


def with_free_epsilon(fitted: Fitted) -> Simulation:
    """The simulation refitted from the solution with PECP1 free.

    If PECP1 is held at a slightly wrong value, the other spin coefficients compensate for it, which distorts the effect of finite
    spin on the slopes of the model. That effect is uncertain by a third of itself, so the search need not be exact.
    """
    name, problem = "PECP1", fitted.problem
    if any(number.name == name for number in fitted.numbers):
        return fitted.simulation
    row, held = BY_NAME[name], float(fitted.simulation.values[name])
    free = FreeNumber(name, row.inside(held), *row.bounds, expected=held)
    numbers = [*problem.starting_here(fitted.numbers), free]
    free_problem = problem.free([n.name for n in numbers])
    solution = solve(free_problem, numbers, tolerance=constants.REFIT_TOLERANCE)
    return problem.with_values(solution.values).simulation

"""The record of a finished fit: values, uncertainties and weights at the solution."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mffit.fit.by_hand import NO_HAND, Hand
from mffit.fit.posterior import Posterior, beside_held
from mffit.fit.problem import FitProblem
from mffit.least_squares import FreeNumber, inverse, solve
from mffit.linearised import LinearisedFit, Uncertain, linearised
from mffit.rig import Simulation
from mffit.rig_errors import error_of
from tir.parameters import BY_NAME


@dataclass(frozen=True, slots=True)
class Fitted:
    """Values and uncertainties of the free numbers after the joint fit."""

    values: Mapping[str, float]  #: fitted coefficients
    rig: Mapping[str, tuple[float, float]]  #: rig error -> (value, standard error)
    correlation: Mapping[str, tuple[str, float]]  #: strong ones only: number -> (partner, correlation)
    posterior: Posterior  #: of tyre and rig, held values included
    problem: FitProblem  #: at the solution, with the final weights
    numbers: tuple[FreeNumber, ...]  #: numbers that were free in the last search
    held: Mapping[str, float]  #: standard uncertainty of coefficients that the fit took as exact
    held_rig: Mapping[str, float]  #: standard uncertainty of rig errors that the fit took as exact
    at_bound: frozenset[str]  #: numbers at their own bound or at a physical limit
    at_limit: frozenset[str]  #: numbers at a physical limit and not at their own bound
    regularised: frozenset[str]  #: coefficients that depend on their priors as much as on the points
    left: float  #: predicted decrease of the sum of squares by one more step: 0 at the minimum
    hand: Hand = NO_HAND  #: entries of [coefficients]

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
    def stderr(self) -> dict[str, float]:
        """Standard uncertainty of every number."""
        return self.posterior.stderr

    @property
    def inner(self) -> list[FreeNumber]:
        """The numbers inside their bounds, with their values as starting values."""
        return self.problem.starting_here([n for n in self.numbers if n.name not in self.at_bound])

    @property
    def taken_as_exact(self) -> dict[str, float]:
        """Standard uncertainty, where positive, of all numbers that the fit took as exact."""
        return {name: u for name, u in {**self.held, **self.held_rig}.items() if u > 0.0}


def uncertain(number: FreeNumber) -> Uncertain:
    """The number's prior relative to its starting value; without a prior, its spread is half the usual width among tyres."""
    if np.isfinite(number.spread):
        return Uncertain(number.name, number.expected - number.start, number.spread)
    width = BY_NAME[number.name].width if number.name in BY_NAME else number.upper - number.lower
    return Uncertain(number.name, 0.0, 0.5 * width)


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
    numbers += [Uncertain(name, 0.0, u, held=True) for name, u in fitted.taken_as_exact.items()]
    problem = of or fitted.problem
    return linearised(problem.points, fitted.simulation, problem.sigma, numbers, without=without, near=near)


def told_by_readings(
    fitted: Fitted, left: LinearisedFit, names: Sequence[str]
) -> tuple[np.ndarray, np.ndarray]:
    """Information matrix (k, k) of all readings about the named numbers, and the score (k,) at their values; without priors.

    Errors of the readings follow the linear model of the residuals ``left``: a model error common to all runs, and one per run.
    Repeating readings within a run therefore adds little information.
    """
    problem = fitted.problem
    residual, by_radii = problem.radii_rows(names)
    information, pull = by_radii.T @ by_radii, -by_radii.T @ residual
    for name, channel in left.channels.items():
        part = problem.points.select(channel.rows, with_table=False)
        told = channel.told_of(fitted.simulation.sensitivities(part, names, [name])[1][name])
        information, pull = information + told.information, pull + told.pull
    return information, pull


def with_errors_of(fitted: Fitted, left: LinearisedFit) -> Fitted:
    """The fit with a posterior for correlated errors of the readings, as the linear model of its residuals describes them.

    The fit itself weighs readings as independent, so its solution differs from the most probable one of that model. The
    difference is added to the covariance.
    """
    held = {**fitted.held, **fitted.held_rig}
    numbers = [uncertain(number) for number in fitted.problem.starting_here(fitted.numbers)]
    free, k = [number.name for number in numbers], len(numbers)
    information, pull = told_by_readings(fitted, left, [*free, *held])
    precision = np.array([number.spread**-2.0 for number in numbers])
    covariance = inverse(information[:k, :k] + np.diag(precision))
    moved = covariance @ (pull[:k] + precision * [number.expected for number in numbers])
    posterior = beside_held(free, covariance, held, information[:k, k:]).without(
        fitted.held_rig.keys() - fitted.rig.keys()
    )
    posterior.covariance[:k, :k] += np.outer(moved, moved)
    return _with_posterior(fitted, posterior)


def with_errors_around(fitted: Fitted, best: Fitted) -> Fitted:
    """The fit with the covariance of ``best`` plus the squared distance between the two solutions.

    For a fit that does not model influences which ``best`` models, so that its coefficients absorb them.
    """
    names = fitted.posterior.names
    rows = [best.posterior.names.index(name) for name in names]
    moved = [fitted.problem.value(name) - best.problem.value(name) for name in names]
    covariance = best.posterior.covariance[np.ix_(rows, rows)] + np.outer(moved, moved)
    return _with_posterior(fitted, Posterior(names, covariance))


def _with_posterior(fitted: Fitted, posterior: Posterior) -> Fitted:
    stderr = posterior.stderr
    rig = {name: (value, stderr[name]) for name, (value, _) in fitted.rig.items()}
    return replace(fitted, posterior=posterior, rig=rig)


def with_free_epsilon(fitted: Fitted) -> Simulation:
    """The simulation refitted from the solution with PECP1 free.

    If PECP1 is held at a slightly wrong value, the other spin coefficients compensate for it, which distorts the effect of finite
    spin on the slopes of the model.
    """
    name, problem = "PECP1", fitted.problem
    if any(number.name == name for number in fitted.numbers):
        return fitted.simulation
    row, held = BY_NAME[name], float(fitted.simulation.values[name])
    free = FreeNumber(name, row.inside(held), *row.bounds, expected=held)
    numbers = [*problem.starting_here(fitted.numbers), free]
    solution = solve(problem.free([n.name for n in numbers]), numbers)
    return problem.with_values(solution.values).simulation

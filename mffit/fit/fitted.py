"""The record of a finished search: values, errors and weights at the solution; and the same with PECP1 free."""

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
    """Values and errors of the free numbers after the polish."""

    values: Mapping[str, float]  #: coefficients
    rig: Mapping[str, tuple[float, float]]  #: rig error -> (value, standard error)
    correlation: Mapping[str, tuple[str, float]]  #: strong ones only: number -> (partner, correlation)
    posterior: Posterior  #: of tyre and rig, held values included
    problem: FitProblem  #: at the solution, with the final weights
    numbers: tuple[FreeNumber, ...]  #: that were free in the end
    held: Mapping[str, float]  #: standard uncertainty of coefficients that the fit took as exact
    held_rig: Mapping[str, float]  #: the same of rig errors that it took as absent
    at_bound: frozenset[str]  #: numbers at their own bound or at a physical limit
    at_limit: frozenset[str]  #: those of them that only a physical limit holds
    regularised: frozenset[str]  #: coefficients that the priors decide as much as the points
    left: float  #: fall of the sum of squares that a step still promises: 0 at its minimum
    hand: Hand = NO_HAND  #: coefficients that [coefficients] sets

    @property
    def simulation(self) -> Simulation:
        """The fitted tyre on the rig as fitted."""
        return self.problem.simulation

    @property
    def rig_stated(self) -> dict[str, tuple[float, float]]:
        """The rig errors, and the conditions from which they count."""
        errors = (error_of(name) for name in self.rig)
        references = {error.counts_from for error in errors if error is not None and error.counts_from}
        return {**self.rig, **{name: (self.problem.value(name), 0.0) for name in sorted(references)}}

    @property
    def stderr(self) -> dict[str, float]:
        """Standard uncertainty of every number."""
        return self.posterior.stderr

    @property
    def inner(self) -> list[FreeNumber]:
        """The numbers that are at no bound, with their values as starting values."""
        return self.problem.starting_here([n for n in self.numbers if n.name not in self.at_bound])

    @property
    def taken_as_exact(self) -> dict[str, float]:
        """Standard uncertainty of all numbers that the fit took as exact and that have one."""
        return {name: u for name, u in {**self.held, **self.held_rig}.items() if u > 0.0}


def uncertain(number: FreeNumber) -> Uncertain:
    """A number at its start with its prior; one without has half the width of the values that tyres have."""
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
    """What a fit leaves of its points, as one linear model; or of all points of a problem, ``without`` rows of which it was made.

    A coefficient at a bound stays there. The search for the components begins at those ``near``, if there are any.
    """
    free = fitted.problem.starting_here(fitted.numbers)
    numbers = [uncertain(n) for n in free if error_of(n.name) or n.name not in fitted.at_bound]
    numbers += [Uncertain(name, 0.0, u, held=True) for name, u in fitted.taken_as_exact.items()]
    problem = of or fitted.problem
    return linearised(problem.points, fitted.simulation, problem.sigma, numbers, without=without, near=near)


def told_by_readings(
    fitted: Fitted, left: LinearisedFit, names: Sequence[str]
) -> tuple[np.ndarray, np.ndarray]:
    """Information (k, k) of all readings about numbers, and the pull (k,) on them where they are; without priors.

    The errors of the readings are those of the linear model of what the fit leaves: what the formula misses is common to all
    runs, and each run has its own, so that runs count and not readings.
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
    """The fit with the uncertainty of its numbers by errors of the readings as the linear model of what it leaves describes them.

    The fit weighs its readings as independent. That its numbers are not the most probable ones of that model counts as an error
    of this size.
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
    """A fit that took up influences for which a better one has numbers: as uncertain as that, and as far as it is from it."""
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
    """The simulation refitted from its solution with PECP1 free.

    If PECP1 is held at a value that is a little off, the other spin coefficients compensate for it, which distorts the effect of
    finite spin on the slopes of the model.
    """
    name, problem = "PECP1", fitted.problem
    if any(number.name == name for number in fitted.numbers):
        return fitted.simulation
    row, held = BY_NAME[name], float(fitted.simulation.values[name])
    free = FreeNumber(name, row.inside(held), *row.bounds, expected=held)
    numbers = [*problem.starting_here(fitted.numbers), free]
    solution = solve(problem.free([n.name for n in numbers]), numbers)
    return problem.with_values(solution.values).simulation

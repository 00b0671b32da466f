"""Information of each curve about the numbers of a fit, and the uncertainty for a campaign that is run again."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from mffit.fit.problem import FitProblem
from mffit.least_squares import FreeNumber, inverse
from mffit.linearised import LinearisedFit
from mffit.numbers import Numbers
from mffit.points import Points
from mffit.points.like import curves as curves_of

ROUNDING = 1e-12
"""Rounding error of a scaled information matrix, which can become singular by it."""


class Told(NamedTuple):
    """Information of the readings of one curve about numbers (k,), with the weights of the fit."""

    information: np.ndarray  #: (k, k) derivative of the score
    scatter: np.ndarray  #: (k, k) covariance of the score, from noise and from what the run has of its own
    missed: np.ndarray  #: (k,) the score by the model error
    pull: np.ndarray  #: (k,) the score by the residuals

    def __add__(self, other: Told) -> Told:  # type: ignore[override]
        return Told(*(mine + its for mine, its in zip(self, other, strict=True)))

    def only(self, rows: Sequence[int]) -> Told:
        """The same of some of the numbers."""
        return Told(
            self.information[np.ix_(rows, rows)],
            self.scatter[np.ix_(rows, rows)],
            self.missed[rows],
            self.pull[rows],
        )


def told_by_curves(problem: FitProblem, left: LinearisedFit, names: Sequence[str]) -> list[Told]:
    """Information of every curve about the named numbers at the values of ``problem``; the last item is that of measured radii.

    ``left`` is the linear model of what the fit leaves.
    """
    found: dict[int, Told] = {}
    curve = curves_of(problem.points)
    for name, channel in left.channels.items():
        part = problem.points.select(channel.rows, with_table=False)
        weight = 1.0 / problem.sigma[name][channel.rows]  # 0 for a reading that the fit left out
        seen = _Readings(
            slopes=_slopes(problem, part, name, names) * weight[:, None],
            noise=channel.components.noise * channel.unit * weight,
            own=channel.own_effects * weight[:, None],
            missed=channel.missed_at_readings * weight,
            residual=channel.model.residual * channel.unit * weight,
        )
        of = curve[channel.rows]
        for run in part.rows_of_sweeps.values():
            by_own = seen.by_own(run)
            for one in np.unique(of[run]).tolist():
                told = seen.told(run[of[run] == one], channel.stride, by_own)
                found[one] = found[one] + told if one in found else told
    residual, by_radii = problem.radii_rows(names)
    of_radii = by_radii.T @ by_radii
    return [*found.values(), Told(of_radii, of_radii, np.zeros(len(names)), -by_radii.T @ residual)]


def told_by_run(
    problem: FitProblem,
    left: LinearisedFit,
    names: Sequence[str],
    run: Points,
    sigma: Mapping[str, float],
    still: Collection[str] = (),
) -> Told:
    """What a further run, at set-points ``run`` (n,) and with weights by ``sigma``, is expected to tell of the named numbers.

    The numbers ``still`` do not move its readings.
    """
    moving = np.array([name not in still for name in names])
    out = Told(*(np.zeros(shape) for shape in 2 * ((len(names),) * 2,) + 2 * (len(names),)))
    force = problem.simulation.readings(run, sigma)
    for name, u in sigma.items():
        n = len(run)
        slopes = _slopes(problem, run, name, names) * moving / u
        channel = left.channels.get(name)
        if channel is None:  # not measured until now
            seen = _Readings(slopes, np.ones(n), np.zeros((n, 0)), np.zeros(n), np.zeros(n))
        else:
            missed, own = channel.foreseen(run, force[name])
            seen = _Readings(slopes, np.full(n, channel.noise / u), own / u, missed / u, np.zeros(n))
        rows = np.arange(n)
        out = out + seen.told(rows, 1, seen.by_own(rows))
    return out


def told_by_weights(problem: FitProblem, numbers: Sequence[FreeNumber], held: Mapping[str, float]) -> Numbers:
    """The numbers if all readings are independent and scatter by their weights; ``held`` ones keep their uncertainties."""
    priors = known_beforehand(problem, numbers, held)
    slope = problem.free(priors.names).linear(priors.values).slope
    return replace(priors, information=slope.T @ slope)


def _slopes(problem: FitProblem, points: Points, channel: str, names: Sequence[str]) -> np.ndarray:
    """Derivatives (n, k) of a channel by the named numbers."""
    return np.asarray(np.nan_to_num(problem.simulation.sensitivities(points, names, [channel])[1][channel]))


class _Readings(NamedTuple):
    """Readings (n,) of one channel over their uncertainties in the fit."""

    slopes: np.ndarray  #: (n, k) derivatives by the numbers
    noise: np.ndarray  #: (n,) standard deviation of the noise
    own: np.ndarray  #: (n, q) changes by one standard deviation of each effect that a run has of its own
    missed: np.ndarray  #: (n,) model error
    residual: np.ndarray  #: (n,) measured less model

    def by_own(self, rows: np.ndarray) -> np.ndarray:
        """Changes (k, q) of the score of some rows by one standard deviation of each effect that their run has of its own."""
        return np.asarray(self.slopes[rows].T @ self.own[rows])

    def told(self, rows: np.ndarray, stride: int, of_run: np.ndarray) -> Told:
        """Information of some rows of a run, each of which represents ``stride`` readings.

        What a run has of its own moves all its readings at once; ``of_run`` is :meth:`by_own` of them all. Each part of the run
        has a share of that scatter, and the shares add up to the whole.
        """
        slopes = self.slopes[rows]
        noisy, share = slopes * self.noise[rows, None], stride**2 * self.by_own(rows) @ of_run.T
        return Told(
            information=stride * (slopes.T @ slopes),
            scatter=stride * (noisy.T @ noisy) + 0.5 * (share + share.T),
            missed=stride * slopes.T @ self.missed[rows],
            pull=stride * slopes.T @ self.residual[rows],
        )


def known_beforehand(problem: FitProblem, free: Sequence[FreeNumber], held: Mapping[str, float]) -> Numbers:
    """The ``free`` numbers with their priors, and those ``held`` with a standard uncertainty, at the values of ``problem``."""
    known = {n.name: (n.expected, n.spread) for n in free}
    held = {name: u for name, u in held.items() if name not in known}
    names = (*known, *held)
    values = np.array([problem.value(name) for name in names])
    expected = np.array([*(mean for mean, _ in known.values()), *values[len(known) :]])
    spread = np.array([*(u for _, u in known.values()), *held.values()])
    return Numbers.beforehand(names, values, expected, spread, held)


def numbers_told(told: Sequence[Told], priors: Numbers) -> Numbers:
    """The numbers with the information of all curves, so that their covariance is that of repeated campaigns.

    A fit gives every reading the weight of independent noise. Its estimate therefore moves, from campaign to campaign, by noise
    and by what runs have of their own, as modelled, and by the model error: the conditions of other curves in the same ranges
    would pull it elsewhere around the best that the formula can do. How far, the pulls of the present curves tell, each curve
    left out in turn (the jackknife over clusters, to first order). Together, with H the curvature of the fit and D the
    covariance by the jackknife: C = H^-1 (scatter + priors) H^-1 + D. An error of a held number moves the others as in the fit,
    by -H_ff^-1 H_fh. The information returned has these covariances and moves, and of the held numbers what they would have if
    all were free; it is without the priors. Where C exceeds a prior, the readings have no information.
    """
    is_held = np.array([name in priors.held for name in priors.names], dtype=bool)
    held, free = np.flatnonzero(is_held).tolist(), np.flatnonzero(~is_held).tolist()
    precision = np.where(is_held, np.inf, priors.spread) ** -2.0
    score = precision * (priors.values - priors.expected)
    curvature, precise = _repeated([one.only(free) for one in told], precision[free])
    own = _positive(precise - np.diag(precision[free]), np.diag(curvature))
    information = np.zeros((len(is_held), len(is_held)))
    information[np.ix_(free, free)] = own
    if held:
        every, of_all = _repeated(told, precision)
        moves = inverse(curvature) @ every[np.ix_(free, held)]
        across = (own + np.diag(precision[free])) @ moves
        shared = of_all[np.ix_(free, held)]
        of_held = _positive(
            of_all[np.ix_(held, held)] - shared.T @ inverse(of_all[np.ix_(free, free)]) @ shared,
            np.diag(every)[held],
        )
        information[np.ix_(free, held)], information[np.ix_(held, free)] = across, across.T
        information[np.ix_(held, held)] = of_held + moves.T @ across
        # The free numbers are at their best; the held ones would move as far as in the fit with its weights.
        pull = sum((one.pull for one in told), -score)[held]
        score[held] = of_held @ inverse(every)[np.ix_(held, held)] @ pull
    return replace(priors, information=information, score=score)


def _repeated(told: Sequence[Told], precision: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Curvature (k, k) of a fit with priors of this ``precision`` (k,), and precision (k, k) of its estimate."""
    curvature = sum((one.information for one in told), np.diag(precision))
    scatter = sum((one.scatter for one in told), np.diag(precision)) + _by_model_error(told, curvature)
    scale = np.sqrt(np.maximum(np.diag(curvature), 1e-24))
    unit = np.outer(scale, scale)
    return curvature, curvature @ (inverse(scatter / unit) / unit) @ curvature


def _positive(information: np.ndarray, size: np.ndarray) -> np.ndarray:
    """The information (k, k) with its negative eigenvalues set to 0; ``size`` (k,) is the scale of its diagonal."""
    unit = np.sqrt(np.outer(np.maximum(size, 1e-24), np.maximum(size, 1e-24)))
    along, axes = np.linalg.eigh(0.5 * (information + information.T) / unit)
    return np.asarray((axes * np.maximum(along, 0.0)) @ axes.T * unit)


def _by_model_error(told: Sequence[Told], curvature: np.ndarray) -> np.ndarray:
    """Covariance (k, k) of the score by the model error, from the change of the estimate without each curve.

    A curve is left out but for one part in their number, so that what it alone tells stays told.
    """
    curves = [one for one in told if np.any(one.missed)]
    if len(curves) < 2:
        return np.zeros_like(curvature)
    share = 1.0 - 1.0 / len(curves)
    seen = np.diag(curvature) > 0.0
    scale = np.sqrt(np.diag(curvature)[seen])
    whole = curvature[np.ix_(seen, seen)] / np.outer(scale, scale)
    informed = [one.information[np.ix_(seen, seen)] / np.outer(scale, scale) for one in curves]
    without = whole + ROUNDING * np.eye(len(scale)) - share * np.array(informed)
    missed = np.array([one.missed[seen] / scale for one in curves])
    moves = np.linalg.solve(without, missed[:, :, None])[:, :, 0]
    pulls = np.zeros((len(curves), len(curvature)))
    pulls[:, seen] = (moves - moves.mean(axis=0)) @ whole * scale
    return np.asarray(share * pulls.T @ pulls)

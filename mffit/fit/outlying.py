"""Single readings that all others contradict: they get no weight, and the fit is repeated without them."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from mffit.constants import PREDICTION_FALSE_ALARM
from mffit.fit.fitted import Fitted, left_by
from mffit.fit.polish import refitted
from mffit.fit.problem import FitProblem
from mffit.linearised import LinearisedChannel, LinearisedFit
from mffit.linearised.components import own_columns
from mffit.linearised.fitted import unit_of
from mffit.linearised.inputs import along, settings_of, steadied, turned
from mffit.linearised.mixed import Mixed, MixedPosterior
from mffit.scatter import beyond
from tir.frozen import ReadOnlyArrays


def without_outliers(fitted: Fitted, stated: FitProblem) -> tuple[Fitted, FitProblem, LinearisedFit]:
    """The fit without the contradicted readings, the ``stated`` problem without them, and the linear model of the residuals.

    Wrong readings enlarge the noise and bend the model beside them, so all suspects are left out before any is judged.
    """
    left, weighted = left_by(fitted), stated
    suspects = np.zeros((len(stated.sigma), len(stated.points)), dtype=bool)
    while True:
        found, wrong = _judged(fitted.problem, left, stated, suspects)
        out = wrong if np.array_equal(found, suspects) else found
        if not np.array_equal(out, suspects):
            sigma = zip(stated.sigma, np.where(out, np.inf, list(stated.sigma.values())), strict=True)
            weighted = replace(stated, sigma=dict(sigma))
            fitted = refitted(fitted, weighted)
            left = left_by(fitted, near=left)
        if out is wrong:
            return fitted, weighted, left
        suspects = out


def _judged(
    problem: FitProblem, left: LinearisedFit, stated: FitProblem, suspects: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """By channel, masks (c, n) of the suspects with further ones, and of those that stand out once all suspects are left out.

    ``left`` is the linear model of the residuals of ``problem``, which uses no ``suspects``; the noise is at least the
    uncertainty in ``stated``. Readings where a moving sweep turns back are not judged.
    """
    points, readings, turning = problem.points, problem.readings(), problem.turning()
    felt, found, wrong = problem.simulation.felt(points), suspects.copy(), np.zeros_like(suspects)
    far = beyond(PREDICTION_FALSE_ALARM / sum(np.isfinite(u).sum() for u in stated.sigma.values()))
    for i, (name, u) in enumerate(stated.sigma.items()):
        if name not in left.channels:
            continue
        channel, residual = left.channels[name], points.channel(name) - readings[name]
        inputs, unit = channel.smooth.inputs, unit_of(points, name, problem.sigma[name][channel.rows])
        place = along(felt, inputs)
        steady = problem.simulation.readings(steadied(points, inputs), [name])
        others = _OfOthers(
            channel=channel,
            sweep=points.sweep,
            residual=np.where(np.isfinite(u) & ~turning[name], residual / unit, np.nan),
            unit=unit,
            noise=np.maximum(channel.components.noise, u / unit),
            columns=(turned(points, name) / unit)[:, None]
            * channel.smooth.columns(settings_of(felt, inputs)),
            place=place,
            own=own_columns(steady[name], place) / unit[:, None],
        )
        found[i], standing = others.suspects(suspects[i], far)
        wrong[i] = found[i] & (standing > far)
    return found, wrong


@dataclass(frozen=True, eq=False)
class _OfOthers(ReadOnlyArrays):
    """The readings (n,) of a channel and the columns of its linear model, with fixed coefficients."""

    channel: LinearisedChannel
    sweep: np.ndarray
    residual: np.ndarray  #: measured less model [unit]; NaN where not judged
    unit: np.ndarray  #: as in ``channel``, but of all readings
    noise: np.ndarray  #: [unit]
    columns: np.ndarray  #: (n, m) smooth functions of the model error [1/unit]
    place: np.ndarray  #: position in the range of what the sweep moves
    own: np.ndarray  #: (n, q) columns of the effects of runs

    def suspects(self, out: np.ndarray, far: float) -> tuple[np.ndarray, np.ndarray]:
        """Mask (n,) of the readings beyond ``far`` standard deviations, with those already ``out``, and how far all stand out.

        The farthest of each sweep is left out, then the farthest that all but these put far off, and so on. A suspect stands out
        if it does so without the reading before it and without the one after: else one of these may be the wrong one.
        """
        out, sweeps = out.copy(), {*range(len(self.channel.sweeps))}
        standing = np.zeros(len(out))
        while sweeps:
            known = self._known(out)
            for k in sorted(sweeps):
                rows = self._rows(k)
                standing[rows] = self._distance(rows, k, *known)
                left = np.where(out[rows], 0.0, standing[rows])
                if np.max(left, initial=0.0) > far:
                    out[rows[np.argmax(left)]] = True
                else:
                    sweeps.remove(k)
        for k in range(len(self.channel.sweeps)):
            rows = self._rows(k)
            for i in np.flatnonzero(out[rows] & (standing[rows] > far)).tolist():
                standing[rows[i]] = min(standing[rows[i]], *self._without_one_beside(rows, i, k, out))
        return out, standing

    def _without_one_beside(self, rows: np.ndarray, i: int, k: int, out: np.ndarray) -> Iterator[float]:
        """Distance of a suspect from its prediction without the reading before it, and without the one after."""
        inside = np.flatnonzero(~out[rows])
        for beside in (inside[inside < i][-1:], inside[inside > i][:1]):
            less = out.copy()
            less[rows[beside]] = True
            yield float(self._distance(rows, k, *self._known(less))[i])

    def _rows(self, k: int) -> np.ndarray:
        """The readings (m,) of a sweep that are judged."""
        return np.flatnonzero(np.isfinite(self.residual) & (self.sweep == self.channel.sweeps[k]))

    def _known(self, out: np.ndarray) -> tuple[Mixed, MixedPosterior]:
        """The linear model of the readings that are not ``out``, with fixed coefficients, and what they tell."""
        channel, functions = self.channel, len(self.channel.missed)
        given = channel.variances._replace(common=channel.variances.common[:functions])
        groups = [g[~out[channel.rows[g]]] for g in channel.model.groups]
        model = replace(channel.model, common=channel.model.common[:, :functions], groups=groups)
        return model, model.posterior(given)

    def _distance(self, rows: np.ndarray, k: int, model: Mixed, found: MixedPosterior) -> np.ndarray:
        """Distance (m,) of the ``rows`` of the sweep ``k`` from their predictions, each in standard deviations."""
        noise = self.channel.variances.noise
        own = self.own[rows] * np.any(model.own)  # a single sweep has no effects of its own
        error, spread = model.predict_further(
            found, noise, k, Mixed(self.residual[rows], self.columns[rows], own, ())
        )
        # Of a reading that is in the model, the others predict what it would be without it.
        inside = np.isin(rows, self.channel.rows[model.groups[k]])
        unexplained = 1.0 - np.exp(-noise) * spread * inside
        # All that is known of some readings is they themselves, and what is left of 1 is rounding.
        known = unexplained > np.sqrt(np.finfo(float).eps)
        unexplained = np.where(known, unexplained, 1.0)
        error, spread = np.where(known, error, 0.0) / unexplained, spread / unexplained
        # Nothing holds the last readings of a sweep, and the last but one by them alone, so that an error looks like a bend
        # there: the model error is as uncertain as where nothing was read.
        before = np.searchsorted(np.unique(self.place[rows]), self.place[rows])
        end = np.minimum(before, np.max(before, initial=0) - before) < 2
        unknown = self.channel.components.missed**2 * np.sum(self.columns[rows[end]] ** 2, axis=1)
        spread[end] = np.maximum(spread[end], unknown)
        return np.asarray(np.abs(error) / np.sqrt(self.noise[rows] ** 2 + spread))

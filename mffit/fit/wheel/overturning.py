"""The overturning moment before the fit: starting values of its coefficients, and the terms that the points need."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from mffit.constants import FEWEST_SWEEPS_TO_PREDICT
from mffit.fit import constants
from mffit.fit.by_hand import Hand
from mffit.fit.coverage import coverage
from mffit.fit.stages import STAGES
from mffit.least_squares import FreeNumber, Solution, of_model, solve
from mffit.left_out import left_out_errors, predicted
from mffit.points import Points
from mffit.scatter import robust
from mffit.suspicion import parts_of_sweeps
from tir.equations import normalise, overturning

OFFSET = "offset"
FIRST = "Mx"
"""Stage of the terms that every fit of Mx has."""
MORE = tuple(stage.name for stage in STAGES if stage.if_predicted and stage.channels == ("Mx",))
"""Stages of further terms, which describe nearly the same: one of them at most is taken."""
AWAY_FROM_ZERO = {"QSX2": 0.1, "QSX10": 0.1, "QSX11": 1.0}
"""Starting values of the factors of a product: if all started at 0, none would have a derivative."""


class Overturning(NamedTuple):
    """Starting values of coefficients of Mx, and the stages of further terms that predict left-out sweeps better."""

    start: Mapping[str, float]
    predicting: tuple[str, ...]


NOT_MEASURED = Overturning({}, ())


def overturning_terms(points: Points, values: Mapping[str, Any], side: str, hand: Hand) -> Overturning:
    """What Mx shows, with the measured Fy in the formula and one offset of the rig.

    Further terms are taken only if sweeps that were left out are predicted clearly better with them.
    """
    rows = np.flatnonzero(np.isfinite(points.Mx) & np.isfinite(points.Fy))
    if not len(rows):
        return NOT_MEASURED
    used = points.select(rows)
    cover = {row.stage: row.free for row in coverage(points, side, hand.held, MORE)}
    fit = _Fit(used, values, hand, robust(used.Mx) or 1.0)
    first = fit.solved(cover.get(FIRST, ()))
    group = parts_of_sweeps(used)
    start = {name: x for name, x in first.values.items() if name != OFFSET}
    if len(np.unique(group)) < FEWEST_SWEEPS_TO_PREDICT:
        return Overturning(start, ())
    least, taken = (1.0 - constants.LEAST_GAIN_OF_MORE_TERMS) * _left_out(first, group), ""
    for stage in MORE:
        if not cover.get(stage):
            continue
        found = fit.solved([*cover[FIRST], *cover[stage]])
        missed = _left_out(found, group)
        if missed < least:
            least, taken = missed, stage
            start = {name: x for name, x in found.values.items() if name != OFFSET}
    return Overturning(start, (taken,) if taken else ())


class _Fit(NamedTuple):
    """The moment as a function of its coefficients and an offset."""

    points: Points
    values: Mapping[str, Any]
    hand: Hand
    scale: float  #: size of Mx [Nm], the unit of residuals

    def solved(self, names: Sequence[str]) -> Solution:
        """The best fit with these coefficients free."""
        spread = float(np.ptp(self.points.Mx)) + 1.0
        numbers = [
            FreeNumber(
                name,
                self.hand.inside(name, float(self.values[name]) or AWAY_FROM_ZERO.get(name, 0.0)),
                *self.hand.bounds(name),
            )
            for name in names
        ]
        numbers.append(FreeNumber(OFFSET, float(np.median(self.points.Mx)), -spread, spread))
        every = [number.name for number in numbers]

        def moment(free: Mapping[str, Any]) -> Any:
            return self._moment({n: v for n, v in free.items() if n != OFFSET}) + free[OFFSET]

        return solve(of_model(moment, every, self.points.Mx, self.scale), numbers)

    def _moment(self, coefficients: Mapping[str, Any]) -> Any:
        p = SimpleNamespace(**{**self.values, **coefficients})
        points = self.points
        q = normalise.inputs(
            p, points.Fz, points.Fz, points.kappa, points.alpha, points.gamma, 0.0, points.p, False, False
        )
        return overturning.moment(p, q, points.Fz, points.Fy)


def _left_out(found: Solution, group: np.ndarray) -> float:
    """Misfit of all sweeps, each predicted from the others."""
    slope = found.jacobian
    # A weak prior keeps what one sweep alone determines finite.
    information = slope.T @ slope + np.diag(np.maximum(np.mean(slope**2, axis=0), 1e-24))
    error = left_out_errors(slope, found.data, information, slope.T @ found.data, group)
    return predicted(error, group, np.zeros(len(group), dtype=int), channels=1).total

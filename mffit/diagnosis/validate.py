"""Does the gap shrink where the effect was not fitted? Whole sweeps are left out, never single points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mffit.diagnosis.candidates import Hypothesis, Problem
from mffit.diagnosis.inexact import EXACT, Inexactness
from mffit.diagnosis.noise import Noise
from mffit.quantities import CHANNELS
from mffit.scatter import rms

MOST_FOLDS = 8
FOLDS_OF_MANY = 4
MANY = 1000
"""Points from which on fewer folds do."""


@dataclass(frozen=True, slots=True)
class Gap:
    """Measured minus simulated, in one number per channel."""

    Fy_rmse_N: float
    Mz_rmse_Nm: float
    chi2_per_dof: float

    def rms(self, channel: str) -> float:
        """Of "Fy" [N] or "Mz" [Nm]."""
        return {"Fy": self.Fy_rmse_N, "Mz": self.Mz_rmse_Nm}[channel]


@dataclass(frozen=True, slots=True)
class Validation:
    """The gap on held-out conditions."""

    folds: int  #: groups of whole sweeps, left out in turn
    gap_before: Gap
    gap_after: Gap
    raised: tuple[str, ...] = ()
    """Channels that are farther off afterwards, by more than numbers without any meaning would bring by chance."""


def gap(residual: np.ndarray, noise: Noise) -> Gap:
    """Gap of residuals (2n,), Fy then Mz; chi2 reading by reading, as the gap in newtons is."""
    n = len(residual) // 2
    z = residual[noise.used] / noise.u[noise.used]
    return Gap(rms(residual[:n]), rms(residual[n:]), float(z @ z) / max(len(z), 1))


def validate(
    problem: Problem, hypothesis: Hypothesis, inexact: Inexactness = EXACT, *, seen: bool = False
) -> Validation:
    """Refit the hypothesis without each group of sweeps and predict that group; the gap is in units of the noise.

    Parameters
    ----------
    problem : seen through the scatter of the readings alone, or with what else the fits shall allow for
    hypothesis : its effects and where to start from
    inexact : the prior of the model's coefficients, which are refitted as well
    seen : whether the model was fitted to these points: then it is refitted without the group for the gap before as well,
        as it would otherwise have seen what it is to predict
    """
    points, n = problem.points, len(problem.points)
    measured = np.concatenate([points.Fy, points.Mz])
    before = measured - problem.start.predict(points)
    held_out = before.copy()
    sweeps = np.unique(points.sweep)
    count = min(MOST_FOLDS if n < MANY else FOLDS_OF_MANY, len(sweeps))
    folds = [sweeps[k::count] for k in range(count)]
    for fold in folds:
        out = np.isin(points.sweep, fold)
        if (hypothesis.effects or inexact) and 0 < out.sum() < n:
            rest = problem.part(~out)
            fitted = rest.evaluate(hypothesis.effects, hypothesis.numbers)
            if hypothesis.effects and not inexact:
                fitted = rest.fit(hypothesis.effects, hypothesis.numbers)
            both, chosen = np.concatenate([out, out]), points.select(out)
            held_out[both] = measured[both] - rest.refine(fitted, inexact)[0].state.predict(chosen)
            if seen:
                before[both] = measured[both] - rest.refine(rest.null, inexact)[0].state.predict(chosen)
    numbers = sum(len(e.free) for e in hypothesis.effects) + len(inexact.names)
    raised = _raised(before, held_out, problem.noise, numbers)
    return Validation(len(folds), gap(before, problem.noise), gap(held_out, problem.noise), raised)


def _raised(before: np.ndarray, after: np.ndarray, noise: Noise, numbers: int) -> tuple[str, ...]:
    """Channels whose chi2 rises: ``numbers`` fitted to noise raise that of left-out sweeps by as much, give or take."""
    u = np.where(np.isfinite(noise.u), noise.u, np.inf)
    change = np.nan_to_num(after / u) ** 2 - np.nan_to_num(before / u) ** 2
    chance = numbers + 2.0 * np.sqrt(2.0 * numbers)
    return tuple(
        name for name, rows in zip(CHANNELS, np.split(change, 2), strict=True) if rows.sum() > chance
    )

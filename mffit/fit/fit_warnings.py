"""Warnings of a fit in sentences."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mffit.fit import constants
from mffit.fit.agreement import agreement
from mffit.fit.doubts import Doubt
from mffit.fit.fitted import Fitted
from mffit.fit.outliers import Outlier
from mffit.points import Points
from mffit.quantities import CHANNELS
from mffit.rig import Readings
from mffit.scatter import rms


def warnings(
    fitted: Fitted, distrusted: Sequence[str], doubts: Sequence[Doubt], outlying: Sequence[Outlier]
) -> tuple[str, ...]:
    """All warnings of a fit, the most important first.

    Parameters
    ----------
    fitted : the fit
    distrusted : from :func:`distrust`
    doubts : sweeps that contradict the others
    outlying : readings without weight
    """
    out = [*distrusted]
    if fitted.attempts:
        attempts = ", ".join(fitted.attempts)
        out.append(f"the fit was started again from {attempts}; the best of all fits is kept")
    if fitted.at_bound:
        names = ", ".join(sorted(fitted.at_bound))
        out.append(f"at the bound of plausible values: {names}; check the sweeps that determine them")
    out += [_doubt(doubt) for doubt in doubts]
    if outlying:
        out.append(_outliers(outlying))
    return tuple(out)


def distrust(fitted: Fitted, points: Points, readings: Readings) -> tuple[str, ...]:
    """Why the file is not to be trusted; empty for a sound fit.

    Parameters
    ----------
    fitted : the fit
    points : raw points
    readings : of the fitted model at the points
    """
    out = []
    for name, scale in fitted.scale.items():
        model, measured, u = getattr(readings, name), getattr(points, name), getattr(points, f"u_{name}")
        if scale > constants.TRUSTED_MISFIT and np.any(np.isfinite(u)):
            out.append(
                f"the file is not to be trusted: the model misses {name} by {scale:.1f} times the stated uncertainty"
                f"{_where(points, (model - measured) / u)}; check these sweeps, or run mffit diagnose"
            )
        share = agreement(model, measured).r2
        if share < constants.TRUSTED_EXPLAINED_VARIANCE:
            out.append(
                f"the file is not to be trusted: the model explains {100.0 * max(share, 0.0):.0f} % of the variance of "
                f"{name}; check that the wheel rolled freely at steady state, and that units and axes are declared "
                "correctly"
            )
    return tuple(out)


def _where(points: Points, z: np.ndarray) -> str:
    """The sweeps with the largest misfit (n,), in words."""
    total = rms(z)
    own = {k: rms(z[points.sweep == k]) for k in np.unique(points.sweep[np.isfinite(z)])}
    large = [k for k in own if own[k] > constants.MISFITTING_SWEEP_RATIO * total]
    worst = sorted(large, key=lambda k: -own[k])[: constants.MISFITTING_SWEEPS_NAMED]
    return f", most of it in {', '.join(points.sweep_names[k] for k in worst)}" if worst else ""


def _doubt(doubt: Doubt) -> str:
    explained = f"; it looks like {doubt.looks}" if doubt.looks else ""
    return (
        f"{doubt.sweep} contradicts the other sweeps: their prediction of {doubt.channel} is off by {doubt.rms:.3g} "
        f"{CHANNELS[doubt.channel].unit}, which is at least {100 * doubt.share:.0f} % of its usual size and "
        f"{doubt.ratio:.1f} times what noise and model explain{explained}; check this sweep or repeat it"
    )


def _outliers(outlying: Sequence[Outlier]) -> str:
    """The readings without weight, the worst by name."""
    worst = sorted(outlying, key=lambda o: -o.ratio)[: constants.OUTLIERS_NAMED]
    named = "; ".join(
        f"{o.place} {o.channel} = {o.measured:.4g} {CHANNELS[o.channel].unit} where {o.expected:.4g} is expected"
        for o in worst
    )
    more = (
        f"; and {len(outlying) - len(worst)} more, all in result.json" if len(outlying) > len(worst) else ""
    )
    count = (
        "1 reading is an outlier in its sweep and has"
        if len(outlying) == 1
        else f"{len(outlying)} readings are outliers in their sweeps and have"
    )
    return f"{count} no weight: {named}{more}; correct or remove the wrong readings"

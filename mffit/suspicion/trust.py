"""Why a fitted model is not to be trusted: its misfit is far above the noise, or it explains little of a channel."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from mffit.points import Points
from mffit.quantities import CHANNELS
from mffit.rig import Readings
from mffit.scatter import rms
from mffit.suspicion import constants
from mffit.suspicion.rule import Outcome, Subject, When, rule


@rule(
    id="misfit-above-noise",
    subject=Subject.MODEL,
    when=(When.AFTER,),
    limits=(constants.MISFIT_OVER_NOISE, constants.CARRIED_MISFIT),
    outcome=Outcome.DISTRUSTED,
    sentence="the file is not to be trusted: the model misses {channel} by {scale:.1f} times the stated uncertainty{carriers}; "
    "look at these sweeps, or run mffit diagnose",
)
def above_noise(points: Points, model: Readings, scale: Mapping[str, float]) -> Iterator[dict[str, Any]]:
    """Misfit of the model over the stated uncertainty, channel by channel."""
    for name, ratio in scale.items():
        u = getattr(points, f"u_{name}")
        if ratio > constants.MISFIT_OVER_NOISE and np.any(np.isfinite(u)):
            z = (getattr(model, name) - getattr(points, name)) / u
            yield {"channel": name, "scale": ratio, "carriers": _carriers(points, z)}


@rule(
    id="unexplained-variance",
    subject=Subject.MODEL,
    when=(When.AFTER,),
    limits=(constants.EXPLAINED_VARIANCE,),
    outcome=Outcome.DISTRUSTED,
    sentence="the file is not to be trusted: the model explains {percent:.0f} % of the variance of {channel}; are these "
    "readings of free rolling at steady state, and their units and axes right?",
)
def unexplained(r2: Mapping[str, float]) -> Iterator[dict[str, Any]]:
    """Share of a channel's variance that the model explains."""
    for name in CHANNELS:
        if r2[name] < constants.EXPLAINED_VARIANCE:
            yield {"channel": name, "percent": 100.0 * max(r2[name], 0.0)}


def distrust(
    points: Points, model: Readings, scale: Mapping[str, float], r2: Mapping[str, float]
) -> tuple[str, ...]:
    """Why the file of a fit is not to be trusted; empty for a sound fit.

    Parameters
    ----------
    points, model : what was measured, and what the fitted model reads there
    scale : by channel, robust misfit over stated uncertainty
    r2 : by channel, share of the variance that the model explains
    """
    return (
        *(above_noise.said(facts) for facts in above_noise.find(points, model, scale)),
        *(unexplained.said(facts) for facts in unexplained.find(r2)),
    )


def _carriers(points: Points, z: np.ndarray) -> str:
    """The sweeps with most of a misfit (n,), in words."""
    known = np.isfinite(z)
    total = rms(z)
    own = {k: rms(z[points.sweep == k]) for k in np.unique(points.sweep[known])}
    large = [k for k in sorted(own, key=lambda k: -own[k]) if own[k] > constants.CARRIED_MISFIT * total]
    names = ", ".join(points.sweep_names[k] for k in large[: constants.SWEEPS_NAMED_WITH_MISFIT])
    return f", most of it in {names}" if names else ""

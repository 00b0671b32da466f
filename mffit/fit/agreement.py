"""Agreement of a model with measured values, channel by channel."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from mffit.fit.stages import ODD_TERMS
from mffit.parts import Parts
from mffit.points import Points
from mffit.quantities import SIDEWAYS
from mffit.rig import Readings, Simulation
from mffit.scatter import rms


@dataclass(frozen=True, slots=True)
class Agreement:
    """Agreement of one channel of the model with the points."""

    rmse: float
    nrmse: float  #: rmse over the range of the measured values
    r2: float
    max_abs: float
    n: int


def agreement(model: np.ndarray, measured: np.ndarray) -> Agreement:
    """The agreement of a channel (n,); points without a measured value are ignored."""
    used = np.isfinite(model) & np.isfinite(measured)
    difference, measured = (model - measured)[used], measured[used]
    if not len(measured):
        return Agreement(rmse=math.nan, nrmse=math.nan, r2=math.nan, max_abs=math.nan, n=0)
    rmse = rms(difference)
    spread = float(np.ptp(measured))
    variance = float(np.var(measured))
    return Agreement(
        rmse=rmse,
        nrmse=rmse / spread if spread > 0 else math.nan,
        r2=1.0 - rmse**2 / variance if variance > 0 else math.nan,
        max_abs=float(np.max(np.abs(difference))),
        n=len(measured),
    )


def with_points(readings: Readings, points: Points) -> dict[str, Agreement]:
    """By channel, the agreement of the fitted model's readings with the raw points."""
    return {name: agreement(model, points.channel(name)) for name, model in readings.items()}


def with_odd_part(values: Mapping[str, Any], points: Points, parts: Parts) -> dict[str, Agreement]:
    """By channel, the agreement of a file for turn slip off with the odd part, both without odd shift terms."""
    straight = points.replace(
        alpha=parts.alpha_odd, phi_t=np.zeros(len(points)), direction=np.ones_like(points.direction)
    )
    model = Simulation({**values, **dict.fromkeys(ODD_TERMS, 0.0)}, turn_slip=False).readings(straight)
    used = (parts.paired != "unpaired") & (points.direction > 0)
    return {
        name: agreement(getattr(model, name)[used], getattr(parts, f"{name}_odd")[used]) for name in SIDEWAYS
    }

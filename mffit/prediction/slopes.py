"""The slope of a force at zero slip, in the file and as the readings have it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pandas as pd

from mffit.constants import COVERAGE_FACTOR_95
from mffit.points import Points, levels, main_pressure
from mffit.points.points import of_si
from mffit.prediction.predictor import Predictor
from mffit.quantities import COLUMNS, column
from tir import Tyre


class MissedSlope(NamedTuple):
    """A slope of the file that differs from that of the readings by more than its uncertainty."""

    load: float  #: [N]
    share: float  #: slope of the readings over that of the file, less 1


def missed_slopes(
    known: Predictor, fitted: Tyre, points: Points, channel: str, slip: str
) -> tuple[MissedSlope, ...]:
    """The slopes of a channel over its ``slip`` ("alpha" or "kappa") that the file misses, at the tested loads.

    Upright, without other slip, at the pressure with most points; between the ends of the level at zero.
    """
    at = {
        "alpha_deg": 0.0,
        "gamma_deg": 0.0,
        "p_kPa": 1e-3 * float(np.median(points.p[main_pressure(points)])),
    }
    ends = levels.KINDS[slip].tolerance * of_si(COLUMNS[slip]) * np.array([-1.0, 1.0])
    found = []
    for load in np.unique(levels.level_values(points.Fz, levels.LOAD)):
        both = pd.DataFrame({**at, "Fz_N": load, COLUMNS[slip]: ends})
        forces = known.predict(fitted, fitted, both, [channel])
        file, best = (float(np.diff(forces[column(channel, *of)])[0]) for of in ((), ("best",)))
        if abs(best - file) > COVERAGE_FACTOR_95 * known.u_between(fitted, both, channel):
            found.append(MissedSlope(float(load), best / file - 1.0))
    return tuple(found)

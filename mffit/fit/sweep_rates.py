"""Stiffness of the carcass from sweeps of the sideslip angle at several rates.

On its ways up and down a sweep goes through zero force at angles that differ by twice ``sigma r + h``: the relaxation length
times the rate over the rolled distance, and the hysteresis of rig and tyre. At one rate both look the same; their sum changes
with the rate by the length alone. The hysteresis is free at every load, so that nothing but the rate separates the two.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from mffit.fit import constants
from mffit.points import levels
from mffit.points.lag import Lag
from mffit.scatter import rms


class OfRates(NamedTuple):
    """What sweeps at several rates show."""

    stiffness: float  #: of the carcass at nominal load and pressure [N/m]; NaN where the rates show none
    u: float  #: its standard uncertainty, where the slip stiffness is exact; infinite at one rate
    weights: np.ndarray  #: (n,) share of every sweep in the length
    hysteresis: float  #: half the shift of the ways up and down without lag, rms over the loads [rad]
    sweeps: int  #: number of them
    rates: tuple[float, float]  #: smallest and largest [rad/s]


def of_rates(lags: Sequence[Lag], g: np.ndarray) -> OfRates:
    """The stiffness C for which sigma = g / C explains how the shift of the sweeps changes with their rate.

    Parameters
    ----------
    lags : of sweeps whose lag is known
    g : (n,) slip stiffness over the carcass stiffness relative to that at nominal load and pressure [N]
    """
    lag, u, u_shape, r, way, load, V = (
        np.array([getattr(one, name) for one in lags])
        for name in ("lag", "u", "u_shape", "rate", "way", "load", "speed")
    )
    labels = levels.nearest_labels(load, levels.LOAD)
    at_load = (labels[:, None] == np.unique(labels)).astype(float)
    shift, weight = lag * r, 1.0 / (np.hypot(u, u_shape) * r)
    n, sigma, compliance = len(lag), np.maximum(lag, 1e-3), math.nan
    for _ in range(constants.STEPS_OF_RATES):
        # Share of the lag that is built up since the last turn of the sweep, where the force is zero: a length behind the angle.
        built_up = 1.0 - 2.0 * np.exp(-(way + sigma) / sigma)
        design = np.column_stack([g * built_up * r, at_load])
        inverse = np.linalg.pinv(design * weight[:, None])
        known = inverse @ (shift * weight)
        compliance = float(known[0])
        sigma = np.maximum(g * compliance, 1e-3)
    # What distinguishes the sweeps at one load is their rate: without such a difference there is no information.
    of_rate = design[:, 0] * weight
    beside = at_load * weight[:, None]
    own = of_rate - beside @ np.linalg.lstsq(beside, of_rate, rcond=None)[0]
    information = float(own @ own)
    rates = (float(np.min(r * V)), float(np.max(r * V)))
    hysteresis = rms(known[1:])
    if not compliance > 0.0 or information < 1e-9 * float(of_rate @ of_rate):
        return OfRates(math.nan, math.inf, np.zeros(n), hysteresis, n, rates)
    residual = (shift - design @ known) * weight
    freedom = n - design.shape[1]
    scale = max(1.0, float(residual @ residual) / freedom) if freedom > 0 else 1.0
    share = own * of_rate / information
    delayed = float(np.sum(share * constants.DELAY_OF_CHANNELS * V / g))
    u_compliance = math.hypot(math.sqrt(scale / information), delayed)
    return OfRates(1.0 / compliance, u_compliance / compliance**2, share, hysteresis, n, rates)


def rate_to_add(found: OfRates, lags: Sequence[Lag], sigma: float) -> float:
    """Rate [rad/s] of further sweeps that would show a length of ``sigma`` [m] clearly beside the present ones."""
    u_shift = float(np.median([math.hypot(one.u, one.u_shape) * one.rate for one in lags]))
    V = float(np.median([one.speed for one in lags]))
    clear = constants.CLEAR_SHIFT * u_shift / sigma * V
    return max(found.rates[1] + clear, constants.RATIO_OF_RATES * found.rates[1])

"""Time series to steady points: where the rig stood still, and what the mean over that time is worth."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

SETTLED_ANGLE = np.radians(0.15)
"""Change of an angle within a plateau [rad]; a logger's noise is below, a set-point's step above."""
SHORTEST_PLATEAU = 2.0  # s
TRANSIENT_ROLL = 6.0
"""Rolling distance dropped at the start of a plateau, in unloaded radii; about six relaxation lengths."""


class Plateau(NamedTuple):
    """One steady stretch: samples ``begin`` to ``end`` (excluded), the transient left out."""

    begin: int
    end: int


def plateaus(
    time: np.ndarray, alpha: np.ndarray, gamma: np.ndarray, V: np.ndarray, radius: float, point: np.ndarray | None = None
) -> list[Plateau]:
    """Find the stretches at constant angles.

    Parameters
    ----------
    time : (n,) [s], rising
    alpha, gamma : (n,) readings [rad]
    V : (n,) speed [m/s]
    radius : unloaded radius [m], sets how much of each stretch counts as transient
    point : (n,) number of the point of every sample, if the file says it; None finds the stretches from the angles

    Returns
    -------
    list of Plateau, in time order; a stretch too short to leave two seconds after its transient is left out.
    """
    if point is not None:
        edges = np.flatnonzero(np.diff(point) != 0) + 1
    else:
        step = max(1, int(round(0.5 / np.median(np.diff(time)))))
        moving = np.zeros(len(time), bool)
        for angle in (alpha, gamma):
            change = np.abs(angle[step:] - angle[:-step]) > SETTLED_ANGLE
            moving[step:] |= change
            moving[:-step] |= change
        edges = np.flatnonzero(np.diff(moving.astype(int)) != 0) + 1
    starts, ends = np.concatenate([[0], edges]), np.concatenate([edges, [len(time)]])
    out = []
    for begin, end in zip(starts, ends, strict=True):
        if point is None and moving[begin]:
            continue
        transient = TRANSIENT_ROLL * radius / max(float(np.median(V[begin:end])), 0.1)
        first = int(np.searchsorted(time, time[begin] + transient)) if begin > 0 else begin
        if end - first >= 8 and time[end - 1] - time[first] >= SHORTEST_PLATEAU:
            out.append(Plateau(first, end))
    return out


def mean_and_error(x: np.ndarray) -> tuple[float, float]:
    """Mean of a stationary series (n,) and its standard error, with the autocorrelation counted.

    The integrated autocorrelation time is summed until it exceeds a fifth of the lag (Sokal's window), so that slow
    noise is not mistaken for many independent samples.
    """
    n, mean = len(x), float(np.mean(x))
    centred = x - mean
    variance = float(np.mean(centred**2))
    if variance == 0.0 or n < 8:
        return mean, float(np.std(x, ddof=1) / np.sqrt(n)) if n > 1 else float("nan")
    padded = np.fft.rfft(centred, 2 * n)
    correlation = np.fft.irfft(np.abs(padded) ** 2)[:n] / (n * variance)
    tau = 2.0 * np.cumsum(correlation) - 1.0
    window = np.flatnonzero(np.arange(n) >= 5.0 * tau)
    tau_used = max(float(tau[window[0]] if len(window) else tau.max()), 1.0)
    # The spectrum of a finite record underestimates the slow part by about tau/n.
    tau_used *= 1.0 + 2.0 * tau_used / n
    return mean, float(np.sqrt(variance * n / (n - 1) * tau_used / n))

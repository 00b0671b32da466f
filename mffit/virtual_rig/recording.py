"""A sweep as a time series of a data logger: with motion of the steering, noise and ripple."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy  # its parts are loaded on first use

from mffit.virtual_rig.machine import Channels, Machine, at_the_tyre, reported, true_alpha
from mffit.virtual_rig.plan import MEASURED, RecordingTable
from mffit.virtual_rig.settings import Settings


class Recording(NamedTuple):
    """A time series; every array has one value per sample (m,)."""

    time: np.ndarray  #: [s]
    settings: Settings
    forces: Channels  #: with noise and ripple, ISO-W


def record(
    machine: Machine,
    settings: Settings,
    table: RecordingTable,
    generator: np.random.Generator,
    added: Sequence[str] = (),
) -> Recording:
    """The time series of one sweep, whose set-points (n,) are all at one load, speed and pressure.

    ``added`` are columns of the channels measured in addition to Fy, Mz and My.
    """
    time, alpha, gamma, kappa = course(settings, table)
    seen = settings.at(alpha, gamma, kappa)
    state = machine.tyre.state(settings.Fz[0], Vx=settings.Vx[0], p=settings.p[0])
    sigma = machine.faults["relaxation_m"] or state.sigma_y
    follows = seen
    if np.any(kappa):
        follows = replace(seen, kappa=lagged(kappa, settings.V[0], state.sigma_x, table.rate_Hz))
    true = at_the_tyre(
        machine, follows, lagged(true_alpha(machine, seen), settings.V[0], sigma, table.rate_Hz)
    )
    forces = reported(machine, seen, true)
    if np.any(kappa):  # the force lags behind the slip; the reported slip does not
        forces = forces._replace(slip=at_the_tyre(machine, seen, seen.alpha).slip)
    turned = settings.V[0] / state.Re * time
    ripple = {"Fy": table.ripple_Fy_N * np.sin(turned), "Mz": table.ripple_Mz_Nm * np.cos(turned)}
    for name in (*MEASURED, "Fz_N", *added):
        channel = name.partition("_")[0]
        read = getattr(forces, channel) + ripple.get(channel, 0.0)
        read = read + noise(time, getattr(table, f"noise_{name}"), table, generator)
        forces = forces._replace(**{channel: read})
    return Recording(time, seen, forces)


def course(
    settings: Settings, table: RecordingTable
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Time [s], sideslip and camber as read [rad] and slip of every sample (m,): linear to each point, then held."""
    slip = np.broadcast_to(settings.kappa, len(settings))
    stations = np.column_stack([settings.alpha, settings.gamma, slip])
    rates = np.array([math.radians(table.steering_deg_per_s)] * 2 + [table.slip_per_s])
    travel = (np.abs(np.diff(stations, axis=0)) / rates).max(axis=1, initial=0.0)
    arrivals = np.concatenate([[0.0], np.cumsum(travel + table.hold_s)])
    corners = np.column_stack([arrivals, arrivals + table.hold_s]).ravel()
    time = np.arange(math.floor(corners[-1] * table.rate_Hz) + 1) / table.rate_Hz
    alpha, gamma, kappa = (np.interp(time, corners, np.repeat(column, 2)) for column in stations.T)
    return time, alpha, gamma, kappa


def lagged(alpha: np.ndarray, V: float, sigma: float, rate_Hz: float) -> np.ndarray:
    """The lagged angle (m,) that determines the force: ``sigma d(alpha')/dt + V alpha' = V alpha``, settled at the start.

    The sideslip angle (m,) [rad] changes linearly between samples. SI units.
    """
    seconds = sigma / V  # the time constant
    decay = math.exp(-1.0 / (seconds * rate_Hz))
    # Within a sample the response to a ramp of slope 1/T is (t - seconds (1 - exp(-t/seconds)))/T.
    new = 1.0 - seconds * rate_Hz * (1.0 - decay)
    old = 1.0 - decay - new
    lagged_alpha, _ = scipy.signal.lfilter([new, old], [1.0, -decay], alpha, zi=[(1.0 - new) * alpha[0]])
    return np.asarray(lagged_alpha)


def noise(time: np.ndarray, size: float, table: RecordingTable, generator: np.random.Generator) -> np.ndarray:
    """Noise (m,) of standard deviation ``size`` and correlation time ``correlation_s``."""
    fresh = generator.standard_normal(len(time))
    correlation = math.exp(-1.0 / (table.correlation_s * table.rate_Hz)) if table.correlation_s else 0.0
    fresh[1:] *= math.sqrt(1.0 - correlation**2)
    return np.asarray(size * scipy.signal.lfilter([1.0], [1.0, -correlation], fresh))

"""Detection of faulty samples: missing readings, no load, stuck and clipped channels, spikes."""

import math
from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import scipy  # its parts are loaded on first use

from mffit.constants import FALSE_ALARM
from mffit.points import constants
from mffit.points.stretch import runs
from mffit.scatter import beyond, robust
from mffit.sweeps import Sweep

DRIVEN_RULE = "driven-or-braked"
DRIVEN = "driven or braked, and Fx was not measured"
SENSORS = ("Fy", "Mz", "Fz")


class Fault(NamedTuple):
    """Faulty samples of one kind, and the reason."""

    which: np.ndarray  #: mask (n,)
    reason: str
    ends_stretch: bool  #: whether it ends the stretch around it; otherwise only the samples are left out
    rule: str = ""  #: name of the rule


@dataclass(frozen=True, slots=True, kw_only=True)
class FaultRule:
    """One kind of faulty samples."""

    id: str
    looks_at: str
    reason: str  #: with {channel}
    channels: tuple[str, ...] = ("",)
    ends_stretch: bool = True
    may_be_short: bool = False  #: whether short ones are only left out, because no rest can be hidden in them
    find: Callable[[Sweep, str], np.ndarray]  #: mask (n,)


def driven(sweep: Sweep) -> np.ndarray:
    """Samples or points (n,) at which the wheel does not roll freely and no longitudinal force was measured."""
    return np.asarray((np.abs(sweep.kappa) > constants.SLIP) & ~np.isfinite(sweep.Fx))


def faults(sweep: Sweep) -> list[Fault]:
    """All faults in the samples of a series, in the order of the rules.

    Sensors that were not measured, or have one broadcast value, are not checked.
    """
    found: list[Fault] = []
    for rule in FAULTS:
        for channel in rule.channels:
            if rule.channels is SENSORS and not _measured(getattr(sweep, channel)):
                continue
            which, reason = rule.find(sweep, channel), rule.reason.format(channel=channel)
            short = short_gaps(sweep.time, which) & rule.may_be_short
            found += [
                Fault(which & ~short, reason, rule.ends_stretch, rule.id),
                Fault(short, reason, False, rule.id),
            ]
    return [fault for fault in found if np.any(fault.which)]


def short_gaps(time: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """The samples of a mask (n,) in gaps between readings in which no rest of the rig can be hidden."""
    short = np.zeros(len(time), dtype=bool)
    for begin, end in runs(missing):
        if begin > 0 and end < len(time):
            short[begin:end] = time[end] - time[begin - 1] <= constants.SHORTEST_STRETCH
    return short


def bridged(sweep: Sweep, names: Collection[str]) -> Sweep:
    """The recording with straight lines over the short gaps of some channels."""
    filled = {}
    for name in names:
        values = getattr(sweep, name)
        missing = _slip_missing(sweep) if name == "kappa" else ~np.isfinite(values)
        short = short_gaps(sweep.time, missing)
        if np.any(short):
            seen = ~missing
            filled[name] = np.where(short, np.interp(sweep.time, sweep.time[seen], values[seen]), values)
    return replace(sweep, **filled) if filled else sweep


def _slip_missing(sweep: Sweep) -> np.ndarray:
    """Mask (n,) of the samples without slip; all False if slip was not measured at all."""
    if "kappa" not in sweep.table:
        return np.zeros(len(sweep), dtype=bool)
    missing = ~np.isfinite(sweep.table["kappa"].to_numpy(dtype=float))
    return np.asarray(missing & ~np.all(missing))


def _usual_load(sweep: Sweep) -> float:
    return float(np.nanmedian(np.abs(sweep.Fz))) if np.any(np.isfinite(sweep.Fz)) else 0.0


def _spiking(sweep: Sweep, channel: str) -> np.ndarray:
    """Samples far from the median of their neighbours."""
    values = getattr(sweep, channel)
    smallest = constants.SPIKE * _usual_load(sweep) * (constants.ARM if channel == "Mz" else 1.0)
    away = np.abs(values - scipy.ndimage.median_filter(values, constants.SPIKE_WINDOW, mode="nearest"))
    return np.asarray(away > np.fmax(_span_of_noise(len(sweep)) * robust(away), smallest))


def _span_of_noise(n: int) -> float:
    """Difference between two of n samples that noise does not reach, in its standard deviations."""
    return 2.0 * beyond(FALSE_ALARM / n)


def _clipped(sweep: Sweep, channel: str) -> np.ndarray:
    """Mask (n,) of runs of samples at an end of the channel's range."""
    values = getattr(sweep, channel)
    return _long_runs(_at_end(values), _longest_by_chance(values, ~_at_end(values)) + 1)


def _stuck(sweep: Sweep, channel: str) -> np.ndarray:
    """Mask (n,) of runs of one value inside the channel's range."""
    values = getattr(sweep, channel)
    return np.asarray(_still(sweep, values, ~_at_end(values)) & ~_clipped(sweep, channel))


def _stuck_while_moving(sweep: Sweep, channel: str) -> np.ndarray:
    """Mask (n,) of runs of one value in which the side force changes by more than its noise.

    A held set-point may be constant to the last digit, but then the side force does not change.
    """
    out = np.zeros(len(sweep), dtype=bool)
    noise = robust(np.diff(sweep.Fy)) / np.sqrt(2.0)
    for begin, end in runs(_still(sweep, getattr(sweep, channel), ~out)):
        out[begin:end] = np.ptp(sweep.Fy[begin:end]) > _span_of_noise(len(sweep)) * noise
    return out


def _measured(values: np.ndarray) -> bool:
    """Whether a channel has readings, and not one broadcast value for all samples."""
    return values.strides != (0,) and not np.all(np.isnan(values))


def _at_end(values: np.ndarray) -> np.ndarray:
    return np.asarray((values == np.nanmax(values)) | (values == np.nanmin(values)))


def _longest_by_chance(values: np.ndarray, some: np.ndarray) -> int:
    """Longest run of samples equal to the one before that chance allows.

    If a share p of the samples among ``some`` (n,) repeats because of coarse resolution, a run of k occurs with probability
    n p^k. A channel that repeats more often than not holds set-points, so any run is allowed.
    """
    steps = np.diff(values)[some[1:] & some[:-1]]
    repeats = (np.sum(steps == 0.0) + 1.0) / (len(steps) + 2.0)
    if repeats >= 0.5:
        return len(values)
    return math.ceil(math.log(FALSE_ALARM / max(len(values), 1)) / math.log(repeats))


def _still(sweep: Sweep, values: np.ndarray, some: np.ndarray) -> np.ndarray:
    """Mask (n,) of the samples in runs of exactly one value that are longer than chance and a minimum time allow."""
    rate = 1.0 / max(float(np.median(np.diff(sweep.time))), 1e-9) if len(sweep) > 1 else 1.0
    shortest = max(_longest_by_chance(values, some), round(constants.COMPARED_APART * rate) - 1)
    return _long_runs(np.r_[False, np.diff(values) == 0.0], shortest)


def _long_runs(mask: np.ndarray, shortest: int) -> np.ndarray:
    """The mask (n,) restricted to runs of at least ``shortest`` samples."""
    edges = np.flatnonzero(np.diff(np.r_[False, mask, False].astype(np.int8))).reshape(-1, 2)
    changes = np.zeros(len(mask) + 1, dtype=np.int32)
    changes[edges[edges[:, 1] - edges[:, 0] >= shortest]] = 1, -1
    return np.asarray(np.cumsum(changes)[:-1] > 0)


FAULTS = (
    FaultRule(
        id="no-reading",
        looks_at="Samples without a number",
        reason="no reading of {channel}",
        channels=("alpha", "gamma", "Fz", "Fy", "p", "V"),
        may_be_short=True,
        find=lambda sweep, channel: ~np.isfinite(getattr(sweep, channel)),
    ),
    FaultRule(
        id="no-reading-of-slip",
        looks_at="Samples without a number, of a slip that was measured elsewhere in the recording",
        reason="no reading of {channel}",
        channels=("kappa",),
        may_be_short=True,
        find=lambda sweep, _: _slip_missing(sweep),
    ),
    FaultRule(
        id="no-load",
        looks_at="Load over the usual load of the recording",
        reason="no load on the tyre",
        find=lambda sweep, _: np.asarray(sweep.Fz < constants.UNLOADED * _usual_load(sweep)),
    ),
    FaultRule(
        id=DRIVEN_RULE,
        looks_at="Longitudinal slip, where Fx was not measured",
        reason=DRIVEN,
        may_be_short=True,
        find=lambda sweep, _: driven(sweep),
    ),
    FaultRule(
        id="spike",
        looks_at="Distance of a reading from the median of its neighbours",
        reason="spikes of {channel}",
        channels=SENSORS,
        ends_stretch=False,
        find=_spiking,
    ),
    FaultRule(
        id="clipped-channel",
        looks_at="Readings in a row at the end of the channel's range, against the chance of them",
        reason="{channel} clipped",
        channels=SENSORS,
        find=_clipped,
    ),
    FaultRule(
        id="stuck-channel",
        looks_at="Readings in a row of one value, against the chance of them",
        reason="{channel} stuck",
        channels=SENSORS,
        find=_stuck,
    ),
    FaultRule(
        id="stuck-angle",
        looks_at="Sideslip readings in a row of one value while the side force moves",
        reason="{channel} stuck while Fy moves",
        channels=("alpha",),
        find=_stuck_while_moving,
    ),
)

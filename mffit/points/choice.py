"""Which stretches of a recording give points, and why the others do not."""

from __future__ import annotations

import numpy as np

from mffit.points import constants
from mffit.points.faulty import Fault
from mffit.points.settling import settled
from mffit.points.steady import Scale, SteadySettings, stretches
from mffit.points.stretch import MOVE, PLATEAU, SWEEP, Stretch
from mffit.sweeps import Sweep

ROLLING_IN = f"the first {constants.TRANSIENT_ROLL:g} m of rolling behind a gap or a change"


def settings_of(sweep: Sweep) -> SteadySettings:
    """The settings of a time series."""
    return SteadySettings(**{name: getattr(sweep, name) for name in SteadySettings._fields})


def chosen(sweep: Sweep, wrong: list[Fault], scale: Scale | None) -> list[Stretch]:
    """All stretches of a recording in time order: without their transients, or with the reason why they are dropped.

    ``scale`` is the usual size of the settings in the whole campaign; of this series if None.
    """
    return _judged(sweep, _stretches(sweep, wrong, scale))


def _stretches(sweep: Sweep, wrong: list[Fault], scale: Scale | None) -> list[Stretch]:
    """The stretches between the faults that end one, and the faulty stretches themselves."""
    n = len(sweep)
    if n < 2:
        return [Stretch(0, n, "only one sample", MOVE)]
    ends = [fault for fault in wrong if fault.ends_stretch]
    reason = np.full(n, -1)
    for k, fault in enumerate(ends):
        reason[fault.which & (reason < 0)] = k
    if np.all(reason >= 0):
        return [Stretch(0, n, ends[reason[0]].reason, MOVE)]
    cuts = np.r_[np.flatnonzero(np.diff(reason)) + 1, np.flatnonzero(np.diff(sweep.direction)) + 1]
    settings = settings_of(sweep)
    if np.any(reason >= 0):
        settings = SteadySettings(*(np.where(np.isfinite(x), x, 0.0) for x in settings))
    found = []
    for stretch in stretches(settings, sweep.point, cuts.tolist(), scale):
        k = int(reason[stretch.begin]) if sweep.point is None else -1
        found.append(stretch if k < 0 else Stretch(stretch.begin, stretch.end, ends[k].reason, MOVE))
    return _merged(found)


def _merged(found: list[Stretch]) -> list[Stretch]:
    """The stretches, with neighbours that are dropped for the same reason joined."""
    out: list[Stretch] = []
    for stretch in sorted(found):
        last = out[-1] if out else None
        if last and stretch.dropped and stretch == last._replace(begin=last.end, end=stretch.end):
            out[-1] = last._replace(end=stretch.end)
        else:
            out.append(stretch)
    return out


def _judged(sweep: Sweep, found: list[Stretch]) -> list[Stretch]:
    """The stretches without their transients, or with the reason why they are dropped."""
    settings = settings_of(sweep)
    responses = [(sweep.Fy, constants.HARMLESS_DRIFT_OF_FORCE * float(np.nanmedian(sweep.Fz)), "N")]
    if np.all(np.isfinite(sweep.Mz)):
        responses.append((sweep.Mz, constants.HARMLESS_DRIFT_OF_MOMENT * float(np.nanmedian(sweep.Fz)), "Nm"))
    tried = []
    for stretch in found:
        if stretch.dropped or stretch.kind == MOVE:
            tried.append(stretch)
        elif stretch.kind == PLATEAU:
            tried.append(settled(stretch, settings, responses))
        else:
            rolled = _rolled_in(sweep, stretch)
            if rolled.begin > stretch.begin:
                tried.append(Stretch(stretch.begin, rolled.begin, ROLLING_IN, MOVE))
            tried.append(rolled)
    return _without_cold(sweep, tried)


def _rolled_in(sweep: Sweep, stretch: Stretch) -> Stretch:
    """A sweep without the first metres behind a gap or a change; dropped if its load is not held."""
    begin, end = stretch.begin, stretch.end
    if begin > 0:
        speed = max(float(np.median(sweep.V[begin:end])), constants.SLOWEST_ROLLING)
        settled_at = sweep.time[begin] + constants.TRANSIENT_ROLL / speed
        begin = min(int(np.searchsorted(sweep.time, settled_at)), end - 1)
    low, middle, high = np.nanpercentile(sweep.Fz[begin:end], [5, 50, 95])
    if high - low > constants.WANDERING_LOAD * middle:
        return stretch._replace(dropped=f"the load wanders from {low:.0f} to {high:.0f} N")
    return stretch._replace(begin=begin)


def _without_cold(sweep: Sweep, tried: list[Stretch]) -> list[Stretch]:
    """The stretches, with the first sweeps dropped while the tread is much colder than later."""
    swept = [k for k, s in enumerate(tried) if s.kind == SWEEP and not s.dropped]
    if len(swept) <= constants.FEWEST_WARM_SWEEPS or sweep.T.strides == (0,):
        return tried
    heat = [float(np.nanmedian(sweep.T[tried[k].begin : tried[k].end])) for k in swept]
    usual = float(np.median(heat))
    out = list(tried)
    for k, T in list(zip(swept, heat, strict=True))[: -constants.FEWEST_WARM_SWEEPS]:
        if not usual - T > constants.COLD_TREAD:
            break
        out[k] = tried[k]._replace(dropped=f"the tread is cold: {T:.0f} degC, later {usual:.0f}")
    return out

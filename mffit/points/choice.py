"""Which stretches of a recording give points, and why the others give none."""

from __future__ import annotations

import numpy as np

from mffit.points.faulty import Fault
from mffit.points.steady import TRANSIENT_ROLL, Scale, Settings, settled, stretches
from mffit.points.stretch import MOVE, PLATEAU, SWEEP, Stretch
from mffit.sweeps import Sweep

HARMLESS_FORCE = 0.02
"""Drift of Fy within a stretch, per load, that is averaged rather than refused."""
HARMLESS_ARM = 0.002
"""The same for Mz [m]."""
ROLLING_IN = f"the first {TRANSIENT_ROLL:g} m of rolling behind a gap or a change"
COLD = 10.0
"""Degrees [K] by which the tread of the first sweeps is below that of the middle one: the tyre was still warming up."""
FEWEST_WARM = 3
"""Sweeps that must remain for the first ones to be left out as cold."""
WANDERING_LOAD = 0.5
"""Range of the load within a sweep (5th to 95th percentile), per median, beyond which it is no sweep at one load."""


def settings_of(sweep: Sweep) -> Settings:
    """What the rig was told to do in a time series."""
    return Settings(sweep.time, sweep.alpha, sweep.gamma, sweep.Fz, sweep.p, sweep.V)


def chosen(sweep: Sweep, wrong: list[Fault], scale: Scale | None) -> list[Stretch]:
    """All stretches of a recording in time order, without their transients, or with the reason why they give no point.

    Parameters
    ----------
    sweep : a time series
    wrong : what is wrong with samples of it
    scale : usual size of the settings in the whole campaign; of this series if None
    """
    return _judged(sweep, _stretches(sweep, wrong, scale))


def _stretches(sweep: Sweep, wrong: list[Fault], scale: Scale | None) -> list[Stretch]:
    """The stretches between the faults that end one, and those faults."""
    n = len(sweep)
    if n < 2:
        return [Stretch(0, n, "only one sample", MOVE)]
    ends = [fault for fault in wrong if fault.stretch]
    reason = np.full(n, -1)
    for k, fault in enumerate(ends):
        reason[fault.which & (reason < 0)] = k
    if np.all(reason >= 0):
        return [Stretch(0, n, ends[reason[0]].reason, MOVE)]
    cuts = np.r_[np.flatnonzero(np.diff(reason)) + 1, np.flatnonzero(np.diff(sweep.direction)) + 1]
    settings = settings_of(sweep)
    if np.any(reason >= 0):
        settings = Settings(*(np.where(np.isfinite(x), x, 0.0) for x in settings))
    found = []
    for stretch in stretches(settings, sweep.point, cuts.tolist(), scale):
        k = int(reason[stretch.begin]) if sweep.point is None else -1
        found.append(stretch if k < 0 else Stretch(stretch.begin, stretch.end, ends[k].reason, MOVE))
    return _merged(found)


def _merged(found: list[Stretch]) -> list[Stretch]:
    """Neighbours that are left out for the same reason as one."""
    out: list[Stretch] = []
    for stretch in sorted(found):
        last = out[-1] if out else None
        if (
            last
            and stretch.dropped
            and (last.dropped, last.kind, last.end)
            == (
                stretch.dropped,
                stretch.kind,
                stretch.begin,
            )
        ):
            out[-1] = last._replace(end=stretch.end)
        else:
            out.append(stretch)
    return out


def _judged(sweep: Sweep, found: list[Stretch]) -> list[Stretch]:
    """The stretches without their transients, or with the reason why they give no point."""
    settings = settings_of(sweep)
    responses = [(sweep.Fy, HARMLESS_FORCE * float(np.nanmedian(sweep.Fz)), "N")]
    if np.all(np.isfinite(sweep.Mz)):
        responses.append((sweep.Mz, HARMLESS_ARM * float(np.nanmedian(sweep.Fz)), "Nm"))
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
    """A sweep without the first metres behind a gap or a change, and only at one load."""
    begin, end = stretch.begin, stretch.end
    if begin > 0:
        speed = max(float(np.median(sweep.V[begin:end])), 0.1)
        begin = min(int(np.searchsorted(sweep.time, sweep.time[begin] + TRANSIENT_ROLL / speed)), end - 1)
    low, middle, high = np.nanpercentile(sweep.Fz[begin:end], [5, 50, 95])
    if high - low > WANDERING_LOAD * middle:
        return stretch._replace(dropped=f"the load wanders from {low:.0f} to {high:.0f} N")
    return stretch._replace(begin=begin)


def _without_cold(sweep: Sweep, tried: list[Stretch]) -> list[Stretch]:
    """The first sweeps left out as long as the tread is much colder than later."""
    swept = [k for k, s in enumerate(tried) if s.kind == SWEEP and not s.dropped]
    if len(swept) <= FEWEST_WARM or sweep.T.strides == (0,):
        return tried
    heat = [float(np.nanmedian(sweep.T[tried[k].begin : tried[k].end])) for k in swept]
    usual = float(np.median(heat))
    out = list(tried)
    for k, T in list(zip(swept, heat, strict=True))[:-FEWEST_WARM]:
        if not usual - T > COLD:
            break
        out[k] = tried[k]._replace(dropped=f"the tread is cold: {T:.0f} degC, later {usual:.0f}")
    return out

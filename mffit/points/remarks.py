"""Rows of a table about every stretch of a recording, and sentences about what was left out."""

from __future__ import annotations

import numpy as np

from mffit.constants import NAMED_IN_SENTENCE
from mffit.points.choice import settings_of
from mffit.points.faulty import DRIVEN, Fault
from mffit.points.lag import Lag
from mffit.points.steady import RANGE
from mffit.points.stretch import PLATEAU, SWEEP, Stretch, StretchNote
from mffit.scatter import finite_median
from mffit.sweeps import Sweep

COLUMN_OF = {"alpha": "alpha_deg", "gamma": "gamma_deg", "kappa": "kappa"}
"""Column of a setting."""


def left_out(sweep: Sweep, wrong: list[Fault], tried: list[Stretch]) -> tuple[str, ...]:
    """Sentences about plateaus, samples and sweeps that are left out."""
    return (*_of_plateaus(sweep, tried), *_of_samples_and_sweeps(sweep, wrong, tried))


def driven(sweep: Sweep, free: np.ndarray) -> tuple[str, ...]:
    """A sentence about finished points that were driven or braked; ``free`` are the rows of the others."""
    lost = np.setdiff1d(np.arange(len(sweep)), free)
    if not len(lost):
        return ()
    rows = f"{len(lost)} of {len(sweep)} points are" if len(lost) > 1 else "one point is"
    return (f"{sweep.file}:{int(sweep.line[lost[0]])}: {rows} {DRIVEN}; left out",)


def note(sweep: Sweep, stretch: Stretch, label: str, points: int, lag: Lag) -> StretchNote:
    """The row about a stretch."""
    part = slice(stretch.begin, stretch.end)
    last = stretch.end - 1
    low, high = (float(np.degrees(f(sweep.alpha[part]))) for f in (np.nanmin, np.nanmax))
    has_slip = "kappa" in sweep.table
    return StretchNote(
        file=sweep.file,
        sweep=label,
        kind=stretch.kind,
        swept=swept(sweep, stretch) if stretch.kind == SWEEP else "",
        begin_s=float(sweep.time[stretch.begin]),
        end_s=float(sweep.time[last]),
        first_line=int(sweep.line[stretch.begin]),
        last_line=int(sweep.line[last]),
        alpha_from_deg=low,
        alpha_to_deg=high,
        kappa_from=float(np.min(sweep.kappa[part])) if has_slip else np.nan,
        kappa_to=float(np.max(sweep.kappa[part])) if has_slip else np.nan,
        gamma_deg=float(np.degrees(finite_median(sweep.gamma[part]))),
        Fz_N=finite_median(sweep.Fz[part]),
        p_kPa=1e-3 * finite_median(sweep.p[part]),
        T_degC=finite_median(sweep.T[part]),
        points=points,
        lag_m=lag.lag,
        u_lag_m=float(np.hypot(lag.u, lag.u_shape)),
        dropped=stretch.dropped,
    )


def swept(sweep: Sweep, stretch: Stretch) -> str:
    """Column of the setting that moves most along a sweep, measured in smallest sweeps."""
    part, settings = slice(stretch.begin, stretch.end), settings_of(sweep)
    ranges = {name: float(np.ptp(getattr(settings, name)[part])) / least for name, least in RANGE.items()}
    return COLUMN_OF[max(ranges, key=lambda name: ranges[name])]


def _of_samples_and_sweeps(sweep: Sweep, wrong: list[Fault], tried: list[Stretch]) -> tuple[str, ...]:
    """Sentences about faulty samples, and about dropped sweeps with their reasons."""
    out = []
    for fault in wrong:
        first, number = int(np.argmax(fault.which)), int(np.sum(fault.which))
        out.append(
            f"{sweep.file}:{int(sweep.line[first])}: {fault.reason} at {sweep.time[first]:.2f} s"
            f"{f' and in {number - 1} more samples' if number > 1 else ''}; left out"
        )
    swept = [s for s in tried if s.kind == SWEEP]
    lost = [s for s in swept if s.dropped]
    if lost:
        named = _named([f"at {sweep.time[s.begin]:.1f} s {s.dropped}" for s in lost])
        out.append(f"{sweep.file}: {len(lost)} of {len(swept)} sweeps are left out: {named}")
    return tuple(out)


def _of_plateaus(sweep: Sweep, found: list[Stretch]) -> tuple[str, ...]:
    """A sentence about the plateaus that were dropped."""
    tried = [stretch for stretch in found if stretch.kind == PLATEAU]
    dropped = [stretch for stretch in tried if stretch.dropped]
    if not dropped:
        return ()
    named = _named(
        [
            f"at {sweep.time[stretch.begin]:.1f} s ({np.degrees(sweep.alpha[stretch.begin]):.2f} deg sideslip, "
            f"{np.degrees(sweep.gamma[stretch.begin]):.2f} deg camber) {stretch.dropped}"
            for stretch in dropped
        ]
    )
    return (f"{sweep.file}: {len(dropped)} of {len(tried)} steady stretches give no point: {named}",)


def _named(places: list[str]) -> str:
    """The first places, and the number of the others."""
    shown = NAMED_IN_SENTENCE
    more = f" and {len(places) - shown} more" if len(places) > shown else ""
    return "; ".join(places[:shown]) + more

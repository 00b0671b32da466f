"""What became of every stretch of a recording: rows of a table, and sentences about what was left out."""

from __future__ import annotations

import numpy as np

from mffit.points.faulty import DRIVEN, Fault
from mffit.points.lag import Lag
from mffit.points.stretch import PLATEAU, SWEEP, Stretch, StretchNote
from mffit.sweeps import Sweep

SHOWN = 3
"""Dropped stretches named one by one."""


def left_out(sweep: Sweep, wrong: list[Fault], tried: list[Stretch]) -> tuple[str, ...]:
    """Sentences about plateaus, samples and sweeps that give no point."""
    return (*_dropped(sweep, tried), *_said(sweep, wrong, tried))


def driven(sweep: Sweep, free: np.ndarray) -> tuple[str, ...]:
    """A sentence about finished points that were driven or braked; ``free`` are the rows of the others."""
    lost = np.setdiff1d(np.arange(len(sweep)), free)
    if not len(lost):
        return ()
    rows = f"{len(lost)} of {len(sweep)} points are" if len(lost) > 1 else "one point is"
    return (f"{sweep.file}:{int(sweep.line[lost[0]])}: {rows} {DRIVEN}; left out",)


def note(sweep: Sweep, stretch: Stretch, label: str, points: int, lag: Lag) -> StretchNote:
    """The row of a stretch, with its number of points and its lag."""
    part = slice(stretch.begin, stretch.end)
    last = stretch.end - 1

    def middle(values: np.ndarray) -> float:
        some = values[part]
        some = some[np.isfinite(some)]
        return float(np.median(some)) if len(some) else float("nan")

    low, high = (float(np.degrees(f(sweep.alpha[part]))) for f in (np.nanmin, np.nanmax))
    return StretchNote(
        file=sweep.file,
        sweep=label,
        kind=stretch.kind,
        begin_s=float(sweep.time[stretch.begin]),
        end_s=float(sweep.time[last]),
        first_line=int(sweep.line[stretch.begin]),
        last_line=int(sweep.line[last]),
        alpha_from_deg=low,
        alpha_to_deg=high,
        gamma_deg=float(np.degrees(middle(sweep.gamma))),
        Fz_N=middle(sweep.Fz),
        p_kPa=1e-3 * middle(sweep.p),
        T_degC=middle(sweep.T),
        points=points,
        lag_m=lag.lag,
        u_lag_m=float(np.hypot(lag.u, lag.u_shape)),
        hysteresis_N=lag.hysteresis,
        dropped=stretch.dropped,
    )


def _said(sweep: Sweep, wrong: list[Fault], tried: list[Stretch]) -> tuple[str, ...]:
    """What was left out beside plateaus: faulty samples, and sweeps with their reason."""
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
        named = "; ".join(f"at {sweep.time[s.begin]:.1f} s {s.dropped}" for s in lost[:SHOWN])
        more = f" and {len(lost) - SHOWN} more" if len(lost) > SHOWN else ""
        out.append(f"{sweep.file}: {len(lost)} of {len(swept)} sweeps are left out: {named}{more}")
    return tuple(out)


def _dropped(sweep: Sweep, found: list[Stretch]) -> tuple[str, ...]:
    tried = [stretch for stretch in found if stretch.kind == PLATEAU]
    dropped = [stretch for stretch in tried if stretch.dropped]
    if not dropped:
        return ()
    named = [
        f"at {sweep.time[stretch.begin]:.1f} s ({np.degrees(sweep.alpha[stretch.begin]):.2f} deg sideslip, "
        f"{np.degrees(sweep.gamma[stretch.begin]):.2f} deg camber) {stretch.dropped}"
        for stretch in dropped[:SHOWN]
    ]
    more = f" and {len(dropped) - SHOWN} more" if len(dropped) > SHOWN else ""
    return (
        f"{sweep.file}: {len(dropped)} of {len(tried)} steady stretches give no point: {'; '.join(named)}{more}",
    )

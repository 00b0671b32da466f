"""One sweep to points: finished rows as they are, a recording averaged over its steady stretches and along its sweeps."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from mffit.errors import InputError
from mffit.points import lag as lags
from mffit.points.faulty import Fault, faults
from mffit.points.lag import UNKNOWN, Lag
from mffit.points.mean import mean_and_error
from mffit.points.points import Points, concatenate, make_points
from mffit.points.steady import TRANSIENT_ROLL, Settings, settled, stretches
from mffit.points.stretch import MOVE, PLATEAU, SWEEP, Stretch, StretchNote
from mffit.sweeps import Sweep
from mffit.sweeps.assembly import rows_of

CHANNELS = ("alpha", "gamma", "Fz", "p", "V", "Fy", "Mz", "Mx", "My", "T", "t", "u_Fy", "u_Mz", "iteration")
HARMLESS_FORCE = 0.02
"""Drift of Fy within a stretch, per load, that is averaged rather than refused."""
HARMLESS_ARM = 0.002
"""The same for Mz [m]."""
SHOWN = 3  # dropped stretches named one by one
CONTINUOUS_STEP = 0.1  # s, over which a continuous sweep is averaged
CONTINUOUS_ANGLE = np.radians(0.5)
"""Angle [rad] over which it is averaged at most."""
ROLLING_IN = f"the first {TRANSIENT_ROLL:g} m of rolling behind a gap or a change"
MOST_REPEATED = 0.01
"""Share of samples with the time of the one before that a recorder may have written twice."""
COLD = 10.0
"""Degrees [K] by which the tread of the first sweeps is below that of the middle one: the tyre was still warming up."""
FEWEST_WARM = 3
"""Sweeps that must remain for the first ones to be left out as cold."""
WANDERING_LOAD = 0.5
"""Range of the load within a sweep (5th to 95th percentile), per median, beyond which it is no sweep at one load."""


class Reduced(NamedTuple):
    """Points of one sweep, and what was left out of them."""

    points: Points
    warnings: tuple[str, ...]
    stretches: tuple[StretchNote, ...] = ()  #: of a recording, in time order
    lags: tuple[Lag, ...] = ()  #: of each sweep name in ``points``


def reduce(sweep: Sweep, phi_t: float) -> Reduced:
    """Points of one sweep.

    Parameters
    ----------
    sweep : finished points or a time series
    phi_t : turn slip of the path [1/m]

    Returns
    -------
    Reduced
        Where an angle keeps moving, means over a tenth of a second, marked ``continuous``, every stretch of them a sweep
        of its own name; else means over the plateaus.

    Raises
    ------
    InputError
        The time of a series does not rise.
    """
    if not sweep.is_series:
        return Reduced(_points(sweep, phi_t, {}, sweep.table, np.arange(len(sweep))), ())
    sweep, repeated = _without_repeats(sweep)
    _check_time(sweep)
    wrong = faults(sweep)
    tried = _judged(sweep, _stretches(sweep, wrong))
    bad = (
        np.logical_or.reduce([fault.which for fault in wrong]) if wrong else np.zeros(len(sweep), dtype=bool)
    )
    plateaus = [stretch for stretch in tried if stretch.kind == PLATEAU and not stretch.dropped]
    swept = [stretch for stretch in tried if stretch.kind == SWEEP and not stretch.dropped]
    parts = [_averaged(sweep, phi_t, plateaus)] if plateaus else []
    numbers = np.cumsum([stretch.kind == SWEEP for stretch in tried])
    labels = [
        f"{sweep.name}:{k:02d}" if s.kind == SWEEP else sweep.name
        for s, k in zip(tried, numbers, strict=True)
    ]
    counts = np.zeros(0, dtype=int)
    if swept:
        names = [
            label
            for stretch, label in zip(tried, labels, strict=True)
            if stretch.kind == SWEEP and not stretch.dropped
        ]
        parts.append(_continuous(sweep, phi_t, swept, names, bad))
        counts = np.bincount(parts[-1].sweep, minlength=len(swept))
    found = [_lag(sweep, stretch, bad) for stretch in swept]
    by_stretch = {
        stretch: (int(count), lag) for stretch, count, lag in zip(swept, counts, found, strict=True)
    }
    by_stretch |= dict.fromkeys(plateaus, (1, UNKNOWN))
    notes = [
        _note(sweep, stretch, label, *by_stretch.get(stretch, (0, UNKNOWN)))
        for stretch, label in zip(tried, labels, strict=True)
    ]
    warnings = (*repeated, *_dropped(sweep, tried), *_said(sweep, wrong, tried))
    if not parts:
        parts = [_points(sweep, phi_t, {}, sweep.table, np.zeros(0, dtype=int))]
    order = ((UNKNOWN,) if plateaus or not swept else ()) + tuple(found)
    return Reduced(concatenate(parts), warnings, tuple(notes), order)


def _stretches(sweep: Sweep, wrong: list[Fault]) -> list[Stretch]:
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
    settings = Settings(sweep.time, sweep.alpha, sweep.gamma, sweep.Fz, sweep.p, sweep.V)
    if np.any(reason >= 0):
        settings = Settings(*(np.where(np.isfinite(x), x, 0.0) for x in settings))
    found = []
    for stretch in stretches(settings, sweep.point, cuts.tolist()):
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
    settings = Settings(sweep.time, sweep.alpha, sweep.gamma, sweep.Fz, sweep.p, sweep.V)
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


def _lag(sweep: Sweep, stretch: Stretch, bad: np.ndarray) -> Lag:
    """The lag of a sweep of the sideslip angle."""
    rows = np.flatnonzero(~bad[stretch.begin : stretch.end]) + stretch.begin
    if len(rows) < 2 or np.ptp(sweep.alpha[rows]) < np.ptp(sweep.gamma[rows]):
        return UNKNOWN
    time, V = sweep.time[rows], sweep.V[rows]
    rolled = np.r_[0.0, np.cumsum(np.diff(time) * 0.5 * (V[1:] + V[:-1]))]
    if not rolled[-1] > 0.0 or np.any(np.diff(rolled) <= 0.0):
        return UNKNOWN
    return lags.measure(
        sweep.alpha[rows], sweep.Fy[rows], rolled, round(CONTINUOUS_STEP / np.median(np.diff(time)))
    )


def _note(sweep: Sweep, stretch: Stretch, label: str, points: int, lag: Lag) -> StretchNote:
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


def _without_repeats(sweep: Sweep) -> tuple[Sweep, tuple[str, ...]]:
    """The series without the few samples that a recorder wrote twice, and what to say of them."""
    repeated = np.flatnonzero(np.diff(sweep.time) == 0.0) + 1
    if not len(repeated) or len(repeated) > MOST_REPEATED * len(sweep):
        return sweep, ()
    kept = np.delete(np.arange(len(sweep)), repeated)
    said = f"{sweep.file}:{int(sweep.line[repeated[0]])}: {len(repeated)} samples have the time of the one before; left out"
    return rows_of(sweep, kept, sweep.name), (said,)


def _check_time(sweep: Sweep) -> None:
    falls = np.flatnonzero(np.diff(sweep.time) <= 0.0)
    if len(falls):
        sentence = (
            "time does not rise from row to row; sort the rows, or give every run its own label in column run"
        )
        line = int(sweep.line[falls[0] + 1])
        raise InputError(sentence, file=sweep.file, line=line, column="time_s")


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


def _averaged(sweep: Sweep, phi_t: float, kept: list[Stretch]) -> Points:
    """Means over the stretches; their standard errors where the file states none."""
    parts = [slice(stretch.begin, stretch.end) for stretch in kept]
    means = {name: np.array([np.mean(getattr(sweep, name)[part]) for part in parts]) for name in CHANNELS}
    for channel, u in (("Fy", "u_Fy"), ("Mz", "u_Mz")):
        errors = np.array([mean_and_error(getattr(sweep, channel)[part])[1] for part in parts])
        # A record without any scatter does not say how good it is.
        means[u] = np.where(np.isfinite(means[u]), means[u], np.where(errors > 0.0, errors, np.nan))
    table = _averaged_table(sweep.table, parts)
    table["u_Fy_N"], table["u_Mz_Nm"] = means["u_Fy"], means["u_Mz"]
    first = np.array([stretch.begin for stretch in kept])
    return _points(sweep, phi_t, means, table.dropna(axis="columns", how="all"), first)


def _averaged_table(table: pd.DataFrame, parts: list[slice]) -> pd.DataFrame:
    """Mean of every number and first of every text; without time, so that rows read as finished points."""
    averaged = {
        name: [
            column.iloc[part].mean() if pd.api.types.is_numeric_dtype(column) else column.iloc[part.start]
            for part in parts
        ]
        for name, column in table.items()
        if name != "time_s"
    }
    return pd.DataFrame(averaged)


def _continuous(
    sweep: Sweep, phi_t: float, stretches: list[Stretch], labels: list[str], bad: np.ndarray
) -> Points:
    """Means over a tenth of a second, or half a degree, of sweeps; faulty samples left out."""
    whole, begins, numbers, count = [], [], [], 0
    for k, stretch in enumerate(stretches):
        rows = np.flatnonzero(~bad[stretch.begin : stretch.end]) + stretch.begin
        first, size = _blocks(sweep, rows)
        enough = np.diff(np.r_[first, len(rows)]) >= 0.5 * size
        whole.append(rows)
        begins.append(np.column_stack([first + count, enough]))
        numbers.append(np.full(len(first), k))
        count += len(rows)
    rows, blocks, number = np.concatenate(whole), np.concatenate(begins), np.concatenate(numbers)
    first, enough = blocks[:, 0], blocks[:, 1].astype(bool)
    counts = np.diff(np.r_[first, len(rows)])

    def mean(values: np.ndarray) -> np.ndarray:
        if values.strides == (0,):  # not measured, or the same throughout
            return np.broadcast_to(values[:1], (int(enough.sum()),))
        return (np.add.reduceat(values[rows], first) / counts)[enough]

    means = {name: mean(getattr(sweep, name)) for name in CHANNELS}
    table = pd.DataFrame(
        {
            name: mean(column.to_numpy(dtype=float))
            if pd.api.types.is_numeric_dtype(column)
            else column.to_numpy()[rows[first[enough]]]
            for name, column in sweep.table.items()
            if name != "time_s"
        }
    )
    found = _points(sweep, phi_t, means, table, rows[first[enough]])
    return found.replace(
        continuous=True, time=mean(sweep.time), sweep=number[enough], sweep_names=tuple(labels)
    )


def _blocks(sweep: Sweep, rows: np.ndarray) -> tuple[np.ndarray, int]:
    """First of the rows of every block to be averaged, and how many samples one should have."""
    time = sweep.time[rows]
    interval = float(np.median(np.diff(time))) if len(rows) > 1 else CONTINUOUS_STEP
    moved = max(float(np.median(np.abs(np.diff(x[rows])))) for x in (sweep.alpha, sweep.gamma)) / interval
    step = min(CONTINUOUS_STEP, CONTINUOUS_ANGLE / moved) if moved > 0.0 else CONTINUOUS_STEP
    size = max(1, round(step / interval))
    block = np.floor((time - time[0]) / (size * interval) + 1e-6)
    return np.r_[0, np.flatnonzero(np.diff(block)) + 1], size


def _points(
    sweep: Sweep,
    phi_t: float,
    means: dict[str, np.ndarray],
    table: pd.DataFrame,
    first: np.ndarray,
) -> Points:
    values: dict[str, Any] = {
        name: means.get(name, getattr(sweep, name)[first]) for name in CHANNELS if name not in means
    }
    return make_points(
        **{**values, **means},
        phi_t=phi_t,
        direction=sweep.direction[first],
        mount=sweep.mount,
        line=sweep.line[first],
        sweep_names=(sweep.name,),
        files=(sweep.file,),
        table=table.iloc[first] if len(table) != len(first) else table,
    )

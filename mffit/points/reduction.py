"""One sweep to points: finished rows as they are, a time series averaged over its steady stretches."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from mffit.errors import InputError
from mffit.points.mean import mean_and_error
from mffit.points.points import Points, make_points
from mffit.points.steady import Settings, Stretch, settled, stretches
from mffit.sweeps import Sweep

CHANNELS = ("alpha", "gamma", "Fz", "p", "V", "Fy", "Mz", "Mx", "My", "T", "t", "u_Fy", "u_Mz", "iteration")
HARMLESS_FORCE = 0.02
"""Drift of Fy within a stretch, per load, that is averaged rather than refused."""
HARMLESS_ARM = 0.002
"""The same for Mz [m]."""
SHOWN = 3  # dropped stretches named one by one
CONTINUOUS_STEP = 0.1  # s, over which a continuous sweep is averaged


class Reduced(NamedTuple):
    """Points of one sweep, and what was left out of them."""

    points: Points
    warnings: tuple[str, ...]


def reduce(sweep: Sweep, phi_t: float) -> Reduced:
    """Points of one sweep.

    Parameters
    ----------
    sweep : finished points or a time series
    phi_t : turn slip of the path [1/m]

    Returns
    -------
    Reduced
        A series that keeps moving comes back as means over a tenth of a second, marked ``continuous``.

    Raises
    ------
    InputError
        The time of a series does not rise.
    """
    if not sweep.is_series:
        return Reduced(_points(sweep, phi_t, {}, sweep.table, np.arange(len(sweep))), ())
    _check_time(sweep)
    settings = Settings(sweep.time, sweep.alpha, sweep.gamma, sweep.Fz, sweep.p, sweep.V)
    found = stretches(settings, sweep.point) if len(sweep) > 1 else []
    if not found:
        return Reduced(_continuous(sweep, phi_t), ())
    responses = [(sweep.Fy, HARMLESS_FORCE * float(np.median(sweep.Fz)), "N")]
    if np.all(np.isfinite(sweep.Mz)):
        responses.append((sweep.Mz, HARMLESS_ARM * float(np.median(sweep.Fz)), "Nm"))
    tried = [settled(stretch, settings, responses) for stretch in found]
    kept = [stretch for stretch in tried if not stretch.dropped]
    warnings = _dropped(sweep, [stretch for stretch in tried if stretch.dropped], len(tried))
    if not kept:
        return Reduced(_continuous(sweep, phi_t).select(np.zeros(0, dtype=int)), warnings)
    return Reduced(_averaged(sweep, phi_t, kept), warnings)


def _check_time(sweep: Sweep) -> None:
    falls = np.flatnonzero(np.diff(sweep.time) <= 0.0)
    if len(falls):
        sentence = (
            "time does not rise from row to row; sort the rows, or give every run its own label in column run"
        )
        line = int(sweep.line[falls[0] + 1])
        raise InputError(sentence, file=sweep.file, line=line, column="time_s")


def _dropped(sweep: Sweep, dropped: list[Stretch], tried: int) -> tuple[str, ...]:
    if not dropped:
        return ()
    named = [
        f"at {sweep.time[stretch.begin]:.1f} s ({np.degrees(sweep.alpha[stretch.begin]):.2f} deg sideslip, "
        f"{np.degrees(sweep.gamma[stretch.begin]):.2f} deg camber) {stretch.dropped}"
        for stretch in dropped[:SHOWN]
    ]
    more = f" and {len(dropped) - SHOWN} more" if len(dropped) > SHOWN else ""
    return (
        f"{sweep.file}: {len(dropped)} of {tried} steady stretches give no point: {'; '.join(named)}{more}",
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


def _continuous(sweep: Sweep, phi_t: float) -> Points:
    """Means over a tenth of a second of a sweep that never rests."""
    interval = float(np.median(np.diff(sweep.time))) if len(sweep) > 1 else CONTINUOUS_STEP
    size = max(1, round(CONTINUOUS_STEP / interval))
    parts = [slice(begin, min(begin + size, len(sweep))) for begin in range(0, len(sweep), size)]
    if size > 1:
        means = {name: np.array([np.mean(getattr(sweep, name)[part]) for part in parts]) for name in CHANNELS}
        table = _averaged_table(sweep.table, parts)
    else:
        means, table = {}, sweep.table.drop(columns="time_s")
    first = np.array([part.start for part in parts])
    time = np.array([np.mean(sweep.time[part]) for part in parts])
    return _points(sweep, phi_t, means, table, first).replace(continuous=True, time=time)


def _points(
    sweep: Sweep, phi_t: float, means: dict[str, np.ndarray], table: pd.DataFrame, first: np.ndarray
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
        table=table,
    )

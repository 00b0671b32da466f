"""Settings that move through the recordings while the points made from them stay at one place."""

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts are loaded on first use

from mffit.constants import FEWEST, MOST
from mffit.points import constants
from mffit.points.faulty import DRIVEN
from mffit.points.points import Points, of_si
from mffit.points.remarks import COLUMN_OF
from mffit.points.steady import LEVEL, STEP, samples_in
from mffit.points.stretch import SWEEP, StretchNote
from mffit.quantities import CONDITIONS
from mffit.sweeps import Sweep

Ranges = Mapping[str, tuple[float, float]]
"""Smallest and largest value of each swept setting."""


def ranges_of(sweep: Sweep, faulty: np.ndarray) -> Ranges:
    """The ranges of a recording without its faulty samples (n,) and without the noise of a sample."""
    sound = ~faulty
    if not np.any(sound):
        return {}
    lag = samples_in(sweep.time, constants.COMPARED_APART)
    smooth = {
        name: scipy.ndimage.uniform_filter1d(getattr(sweep, name)[sound], lag, mode="nearest")
        for name in STEP
    }
    return {name: (float(np.min(x)), float(np.max(x))) for name, x in smooth.items()}


class LostSweep(NamedTuple):
    """A setting that moves in the recordings by more than twice as much as in the points made from them."""

    sentence: str
    whole: bool  #: whether the points hold one level of an angle that was swept


def lost_sweeps(
    recorded: Iterable[Ranges], points: Points, notes: Sequence[StretchNote]
) -> tuple[LostSweep, ...]:
    """The settings of which no sweep is left."""
    found = []
    recorded = [ranges for ranges in recorded if ranges]
    for name, step in STEP.items() if recorded else ():
        low, high = min(r[name][0] for r in recorded), max(r[name][1] for r in recorded)
        kept = getattr(points, name)
        kept = kept[np.isfinite(kept)]
        lowest, highest = (float(kept.min()), float(kept.max())) if len(kept) else (0.0, 0.0)
        if high - low > 2.0 * step and highest - lowest < MOST * (high - low):
            column = COLUMN_OF[name]
            unit = f" {CONDITIONS[column].unit}" if CONDITIONS[column].unit_behind else ""
            factor, digits = of_si(column), 3 if name == "kappa" else 1
            moved, left = (
                f"{factor * a:z.{digits}f} to {factor * b:z.{digits}f}{unit}"
                for a, b in ((low, high), (lowest, highest))
            )
            levels_of = (high - low) / LEVEL[name]
            whole = name != "kappa" and highest - lowest <= LEVEL[name] and levels_of > FEWEST
            cure = (
                "; hold set-points longer, or leave out column time_s to take each row for a finished point"
            )
            said = (
                f"{column} moves from {moved} in the recordings, but the points hold {left} only: no sweep of it is left"
                f"{_reason(notes)}; `mffit sniff` lists the stretches with the reason for each{cure * whole}"
            )
            found.append(LostSweep(said, whole))
    return tuple(found)


def little_used(notes: Sequence[StretchNote]) -> tuple[str, ...]:
    """A doubt if the points hold less than half of the time in which sweeps were recorded; nothing without sweeps."""
    swept = {note.file for note in notes if note.kind == SWEEP}
    judged = [note for note in notes if note.file in swept and note.dropped not in NO_SWEEP]
    seconds = sum(note.end_s - note.begin_s for note in judged)
    used = sum(note.end_s - note.begin_s for note in judged if note.points)
    if not judged or used > MOST * seconds:
        return ()
    return (
        f"the points hold {used:.0f} s of {seconds:.0f} s of recorded sweeps{_reason(judged)}; `mffit sniff` lists the stretches "
        "with the reason for each",
    )


NO_SWEEP = ("no load on the tyre", DRIVEN, "load, pressure or speed changes")
"""Reasons for leaving out samples that lie between sweeps."""


def _reason(notes: Sequence[StretchNote]) -> str:
    """The reason for which most of the time is dropped, in brackets; empty if nothing is dropped."""
    seconds: dict[str, float] = {}
    for note in notes:
        if note.dropped:
            seconds[note.dropped] = seconds.get(note.dropped, 0.0) + note.end_s - note.begin_s
    return f" (mostly because: {max(seconds, key=lambda reason: seconds[reason])})" if seconds else ""

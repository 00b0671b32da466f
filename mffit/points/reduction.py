"""One sweep to points: finished rows unchanged, recordings averaged over steady stretches and along moving sweeps."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mffit.errors import InputError
from mffit.points import averaging, constants, remarks
from mffit.points.choice import chosen
from mffit.points.faulty import DRIVEN, DRIVEN_RULE, Fault, driven, faults
from mffit.points.lag import UNKNOWN, Lag, measure, rolled_distance
from mffit.points.left_out import LeftOut, by_rule, of_recording
from mffit.points.points import Points, concatenate
from mffit.points.steady import Scale
from mffit.points.stretch import PLATEAU, SWEEP, Stretch, StretchNote
from mffit.sweeps import Sweep
from mffit.sweeps.assembly import rows_of
from mffit.sweeps.constants import RARE_SAMPLES


class Reduced(NamedTuple):
    """Points of one sweep, and what was left out."""

    points: Points
    warnings: tuple[str, ...]
    stretches: tuple[StretchNote, ...] = ()  #: of a recording, in time order
    lags: tuple[Lag, ...] = ()  #: of the moving sweeps of an angle that give points
    left_out: tuple[LeftOut, ...] = ()  #: by rules


def reduce(sweep: Sweep, phi_t: float, scale: Scale | None = None) -> Reduced:
    """Points of one sweep.

    ``phi_t`` is the turn slip of the path [1/m]; ``scale`` the usual size of the settings in all series of the campaign, to
    judge changes (None: of this series alone).

    They are means over the plateaus; where an angle keeps moving, means over a tenth of a second, marked ``continuous``, with
    every stretch as a sweep of its own. An InputError says that the time of a series does not rise.
    """
    if not sweep.is_series:
        free = np.flatnonzero(~driven(sweep))
        return Reduced(
            points=averaging.rows_as_points(sweep, phi_t, free),
            warnings=remarks.driven(sweep, free),
            left_out=by_rule(sweep, driven(sweep), DRIVEN_RULE, DRIVEN),
        )
    sweep, repeated, repeats = _without_repeats(sweep)
    _check_time(sweep)
    wrong = faults(sweep)
    faulty = np.any([fault.which for fault in wrong], axis=0) if wrong else np.zeros(len(sweep), dtype=bool)
    tried = _without_faulty_plateaus(chosen(sweep, wrong, scale), wrong, faulty)
    labels = _labels(sweep, tried)
    plateaus = [stretch for stretch in tried if stretch.kind == PLATEAU and not stretch.dropped]
    swept = [stretch for stretch in tried if stretch.kind == SWEEP and not stretch.dropped]
    steady = averaging.over_plateaus(sweep, phi_t, plateaus, faulty)
    moving, averaged = averaging.along_sweeps(
        sweep, phi_t, swept, [labels[stretch] for stretch in swept], faulty
    )
    # A sweep of longitudinal slip shows no lag behind the sideslip angle.
    lags = {
        stretch: _lag(sweep, stretch, faulty)
        for stretch in swept
        if np.ptp(sweep.kappa[stretch.begin : stretch.end]) < constants.SMALLEST_SWEEP_OF_SLIP
    }
    counts = np.bincount(moving.sweep, minlength=len(swept)).tolist()
    used = np.isin(np.arange(len(sweep)), averaged)
    for plateau in plateaus:
        used[averaging.sound_rows(plateau, faulty)] = True
    number = dict.fromkeys(plateaus, 1) | dict(zip(swept, counts, strict=True))
    notes = tuple(remarks.note(sweep, s, labels[s], number.get(s, 0), lags.get(s, UNKNOWN)) for s in tried)
    return Reduced(
        points=concatenate([part for part in (steady, moving) if len(part)] or [steady]),
        warnings=(*repeated, *remarks.left_out(sweep, wrong, tried)),
        stretches=notes,
        lags=tuple(lags.values()),
        left_out=(*repeats, *of_recording(sweep, wrong, tried, used)),
    )


def _without_faulty_plateaus(tried: list[Stretch], wrong: list[Fault], faulty: np.ndarray) -> list[Stretch]:
    """The stretches; a plateau that has only faulty samples (n,) is dropped for the reason of its first."""
    return [
        stretch._replace(dropped=next(fault.reason for fault in wrong if fault.which[stretch.begin]))
        if stretch.kind == PLATEAU and not stretch.dropped and np.all(faulty[stretch.begin : stretch.end])
        else stretch
        for stretch in tried
    ]


def _labels(sweep: Sweep, tried: list[Stretch]) -> dict[Stretch, str]:
    """Name of the sweep of each stretch: sweeps within a recording are numbered, dropped ones too."""
    numbers = np.cumsum([stretch.kind == SWEEP for stretch in tried]).tolist()
    return {
        stretch: f"{sweep.name}:{k:02d}" if stretch.kind == SWEEP else sweep.name
        for stretch, k in zip(tried, numbers, strict=True)
    }


def _lag(sweep: Sweep, stretch: Stretch, faulty: np.ndarray) -> Lag:
    """The lag of a sweep of the sideslip angle."""
    rows = averaging.sound_rows(stretch, faulty)
    if len(rows) < 2 or np.ptp(sweep.alpha[rows]) < max(
        np.ptp(sweep.gamma[rows]), constants.SMALLEST_SWEEP.rad
    ):
        return UNKNOWN
    if stretch.begin == 0:  # what was before is not known, and the force may still be building up
        rolled = rolled_distance(sweep.time[rows], sweep.V[rows])
        rows = rows[rolled >= min(constants.TRANSIENT_ROLL, 0.5 * rolled[-1])]
    time = sweep.time[rows]
    rolled = rolled_distance(time, sweep.V[rows])
    if not rolled[-1] > 0.0 or np.any(np.diff(rolled) <= 0.0):
        return UNKNOWN
    return measure(
        sweep.alpha[rows], sweep.Fy[rows], rolled, round(constants.AVERAGED_TIME / np.median(np.diff(time)))
    )


def _without_repeats(sweep: Sweep) -> tuple[Sweep, tuple[str, ...], tuple[LeftOut, ...]]:
    """The series without the few samples that a recorder wrote twice, and a sentence and an entry about them."""
    repeated = np.flatnonzero(np.diff(sweep.time) == 0.0) + 1
    if not len(repeated) or len(repeated) > RARE_SAMPLES * len(sweep):
        return sweep, (), ()
    kept = np.delete(np.arange(len(sweep)), repeated)
    sentence = f"{sweep.file}:{int(sweep.line[repeated[0]])}: {len(repeated)} samples have the time of the one before; left out"
    which = np.isin(np.arange(len(sweep)), repeated)
    left_out = by_rule(sweep, which, "repeated-time", "the time of the sample before")
    return rows_of(sweep, kept, sweep.name), (sentence,), left_out


def _check_time(sweep: Sweep) -> None:
    falls = np.flatnonzero(np.diff(sweep.time) <= 0.0)
    if len(falls):
        sentence = (
            "time does not rise from row to row; sort the rows, or give every run its own label in column run"
        )
        if not np.any(np.diff(sweep.time)):
            sentence = "time is the same in all rows; map the column that holds the time of the samples"
        line = int(sweep.line[falls[0] + 1])
        raise InputError(sentence, file=sweep.file, line=line, column="time_s")

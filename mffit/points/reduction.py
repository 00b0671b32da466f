"""Points from one sweep: finished rows unchanged, recordings averaged over steady stretches and along moving sweeps."""

from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from mffit.config.lines import line_text
from mffit.errors import InputError
from mffit.points import averaging, remarks
from mffit.points.choice import chosen
from mffit.points.faulty import DRIVEN, DRIVEN_RULE, Fault, driven, faults
from mffit.points.left_out import LeftOut, by_rule, of_recording
from mffit.points.lost import Ranges, ranges_of
from mffit.points.points import Points
from mffit.points.steady import Scale
from mffit.points.stretch import PLATEAU, SWEEP, Stretch, StretchNote
from mffit.sweeps import Sweep
from tir.errors import counted


class Reduced(NamedTuple):
    """Points of one sweep, and the readings left out."""

    points: Points
    warnings: tuple[str, ...]
    stretches: tuple[StretchNote, ...] = ()  #: of a recording, in time order
    left_out: tuple[LeftOut, ...] = ()  #: readings left out by rules
    ranges: Ranges = MappingProxyType({})  #: of the swept settings of a recording, without faulty samples


def reduce(
    sweep: Sweep,
    phi_t: float,
    scale: Scale | None = None,
    whole: Sweep | None = None,
    radius: float = float("nan"),
) -> Reduced:
    """The points of one sweep: means over plateaus and, where an angle keeps moving, over short times, marked ``continuous``.

    Every moving stretch is a sweep of its own. ``phi_t`` is the turn slip of the path [1/m], ``radius`` the wheel's [m].
    ``scale`` is the usual size of the settings in all series of the campaign, to judge changes; None: that of this series.
    ``whole`` is the series with the lines that are left out by hand; None if there are none, or one of them cannot be read.

    Raises InputError if the time of a series does not rise.
    """
    if not sweep.is_series:
        lost = driven(sweep)
        wrong = [Fault(lost, DRIVEN, ends_stretch=False)] if np.any(lost) else []
        return Reduced(
            points=averaging.rows_as_points(sweep, phi_t, np.flatnonzero(~lost)),
            warnings=remarks.faulty(sweep, wrong),
            left_out=by_rule(sweep, lost, DRIVEN_RULE, DRIVEN),
        )
    recorded = sweep
    if whole is not None:
        recorded, sweep = whole, replace(sweep, time=whole.time[np.isin(whole.line, sweep.line)])
    _check_time(sweep)
    wrong = faults(sweep)
    faulty = np.any([fault.which for fault in wrong], axis=0) if wrong else np.zeros(len(sweep), dtype=bool)
    tried = _without_faulty_plateaus(chosen(sweep, wrong, scale, whole), wrong, faulty)
    labels = _labels(sweep, tried)
    giving = [s for kind in (PLATEAU, SWEEP) for s in tried if s.kind == kind and not s.dropped]
    named = [labels[stretch] for stretch in giving]
    sound = ~np.isin(recorded.line, sweep.line[faulty])
    grids = [
        averaging.grid_of(recorded, begin + np.flatnonzero(sound[begin:end]), radius)
        for begin, end in (stretch.recorded for stretch in giving)
    ]
    found = averaging.means(sweep, phi_t, giving, named, faulty, grids)
    number = dict(zip(giving, found.counts, strict=True))
    notes = tuple(remarks.note(sweep, s, labels[s], number.get(s, 0)) for s in tried)
    return Reduced(
        points=found.points,
        warnings=(*remarks.faulty(sweep, wrong), *remarks.dropped(sweep, tried)),
        stretches=notes,
        left_out=of_recording(sweep, wrong, tried, found.used),
        ranges=ranges_of(sweep, faulty),
    )


def _without_faulty_plateaus(tried: list[Stretch], wrong: list[Fault], faulty: np.ndarray) -> list[Stretch]:
    """The stretches, with plateaus of only faulty samples (n,) dropped for the reason of their first sample."""
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


def _check_time(sweep: Sweep) -> None:
    falls = np.flatnonzero(np.diff(sweep.time) <= 0.0)
    if len(falls):
        sentence = (
            "time does not rise from row to row; sort the rows, or give every run its own label in column run"
        )
        repeated = sweep.table.duplicated().to_numpy()
        if np.any(repeated) and np.all(np.diff(sweep.time[~repeated]) > 0.0):
            lines = line_text(sweep.line[repeated])
            entry = f'{{ file = "{sweep.file}", lines = "{lines}", why = "repeated" }}'
            number = counted(int(repeated.sum()), "row")
            sentence = f"{number} repeated from before; remove them, or write exclude = [{entry}] under [fit]"
        if not np.any(np.diff(sweep.time)):
            sentence = "time is the same in all rows; map the column that holds the time of the samples"
        line = int(sweep.line[falls[0] + 1])
        raise InputError(sentence, file=sweep.file, line=line, column="time_s")

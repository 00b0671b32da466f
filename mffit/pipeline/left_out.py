"""Readings that the fit gives no weight or less weight, and sweeps that it doubts, as entries of one list."""

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from mffit.config.lines import line_text
from mffit.diagnosis import Diagnosis
from mffit.fit import FitResult
from mffit.fit.weights import stated_or_nominal
from mffit.points import Points
from mffit.points.left_out import LeftOut
from mffit.points.noise import stating
from mffit.quantities import CHANNELS
from mffit.suspicion import Misread, Outlier
from mffit.suspicion.misread import misread_sweep
from mffit.suspicion.others import doubtful_sweep
from mffit.suspicion.outliers import OUTLYING
from mffit.suspicion.reversals import TURNING

HUBER = "huber-weight"
"""Name of the rule that gives readings far from the model less weight."""


def left_out_by_fit(points: Points, fitted: FitResult) -> tuple[LeftOut, ...]:
    """Outliers, readings with less weight, and doubtful sweeps; lines are those of the points."""
    return (*_outliers(fitted.outliers), *_discounted(points, fitted), *_doubts(points, fitted))


def left_out_by_diagnosis(points: Points, found: Diagnosis) -> tuple[LeftOut, ...]:
    """The sweep that was written down wrongly, and outliers; lines are those of the points."""
    return (*_misread(points, found), *_outliers(found.outliers))


def _entry(points: Points, rows: np.ndarray, rule: str, why: str, **more: Any) -> LeftOut:
    """The entry of a rule about readings (m,) of one file; ``more`` are its channel and weight."""
    lines = line_text(points.line[rows])
    file = points.files[points.file[rows[0]]]
    return LeftOut(file=file, lines=lines, count=len(rows), by="rule", rule=rule, why=why, **more)


def _misread(points: Points, found: Diagnosis) -> Iterator[LeftOut]:
    for wrong in (note for note in found.notes if isinstance(note, Misread)):
        rows = np.flatnonzero(points.sweep == points.sweep_names.index(wrong.sweep))
        yield _entry(points, rows, misread_sweep.id, f"looks like {wrong.looks}")


def _outliers(found: Iterable[Outlier]) -> Iterator[LeftOut]:
    for o in found:
        unit = CHANNELS[o.channel].unit
        yield LeftOut(
            file=o.file,
            lines=str(o.line) if o.line else "",
            count=1,
            by="rule",
            rule=OUTLYING.id,
            channel=o.channel,
            why=f"{o.measured:.4g} {unit} where {o.expected:.4g} {unit} is expected, {o.ratio:.3g} times its uncertainty off",
        )


def _discounted(points: Points, fitted: FitResult) -> Iterator[LeftOut]:
    """Readings whose uncertainty the fit enlarged more than that of the others of their channel."""
    if fitted.search is None:
        return
    for channel, sigma in fitted.search.problem.sigma.items():
        stated = stated_or_nominal(points.u(channel), points.channel(channel))
        used = np.isfinite(stated) & np.isfinite(sigma)
        if not np.any(used):
            continue
        factor, weight = np.where(used, sigma, 1.0) / np.where(used, stated, 1.0), np.ones(len(points))
        states = stating(points.u(channel))
        for own in (used & states, used & ~states):  # the uncertainty of those that state none was estimated
            weight[own] = (np.min(factor[own], initial=np.inf) / factor[own]) ** 2
        reduced = weight < 1.0 - 1e-6  # rounding
        turning = fitted.at_turns.get(channel, np.zeros(len(points), dtype=bool))
        more = "the model misses these readings by more than most others, so they have less weight"
        turns = "a moving sweep turns back here, and the rig accelerates"
        for rule, why, which in ((HUBER, more, ~turning), (TURNING.id, turns, turning)):
            for file in np.unique(points.file[reduced & which]).tolist():
                rows = np.flatnonzero(reduced & which & (points.file == file))
                least = float(np.min(weight[rows]))
                yield _entry(points, rows, rule, why, channel=channel, weight=least)


def _doubts(points: Points, fitted: FitResult) -> Iterator[LeftOut]:
    for doubt in fitted.doubts:
        looks = f"; it looks like {doubt.looks}" if doubt.looks else ""
        why = (
            f"doubted, with full weight: {doubt.worst.rms:.3g} {CHANNELS[doubt.worst.channel].unit} from what all other sweeps "
            f"predict{looks}"
        )
        rows = np.asarray(doubt.index)
        yield _entry(points, rows, doubtful_sweep.id, why, channel=doubt.worst.channel, weight=1.0)

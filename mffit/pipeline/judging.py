"""Whether a build is to be trusted: what the rules need, and their judgement."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

import tir
from mffit.config import Config
from mffit.diagnosis import wording
from mffit.diagnosis.remains import OddSweep, Remains, remains
from mffit.fit import FitResult
from mffit.fit.agreement import with_points
from mffit.fit.wording import at_limits
from mffit.measured import Measured
from mffit.pipeline.measuring import follows_path
from mffit.points import Points
from mffit.rig_errors import error_of
from mffit.suspicion import Doubt, FinishedFit, Outlier, Trust, judge
from tir import Tyre


def judged(
    config: Config, points: Points, measured: Measured, fitted: FitResult, files: Mapping[str, Tyre]
) -> tuple[Trust, Remains]:
    """The judgement of a build with its written ``files`` by use, and what its fit leaves of the readings.

    Where the temperature is modelled, the fit with it is judged: the plain file cannot reach the noise, and its misfit is
    stated. ``over_noise`` is that of the plain one in any case.
    """
    full = fitted.full
    assert full is not None
    assert fitted.left_by_formula is not None
    linear = fitted.left_by_formula
    left = remains(full, linear)
    model = full.simulation.readings(points, fitted.model)
    finished = FinishedFit(
        points=points,
        model=model,
        used=_used(points, model, fitted.outliers),
        r2={name: found.r2 for name, found in with_points(model, points).items()},
        left_out=left.left_out,
        linear=linear,
        held=left.held,
        rig=full.rig,
        at_limits=at_limits(full),
        free=len(full.values),
        left=fitted.left,
        broken=tuple(_refused(files)),
        nominal=measured.nominal,
        radius_counts=not follows_path(config),
        sideslip_zeros=measured.sideslip_zeros,
        drift=measured.drift,
        lag=measured.lag,
    )
    most = left.effect is not None and left.effect.explains_most
    effect = most or (left.effect is not None and left.effect.significant)
    against = sorted(fitted.doubts, key=lambda doubt: -doubt.worst.ratio)
    blamed = [] if most else against  # many sweeps look odd that one effect explains
    finished = replace(
        finished,
        against=tuple(against),
        cause=_cause([one for one in blamed if one.looks or not effect], left),
        cause_is_certain=bool(against or effect),
        cause_is_most=most,
        undeclared="" if blamed or not effect else _undeclared(left),
    )
    if against:
        left = replace(left, sweep=OddSweep(against[0].sweep, against[0].looks))
    plain = replace(finished, model=fitted.model)
    return replace(judge(finished), over_noise=plain.over_noise), left


def _cause(against: Sequence[Doubt], left: Remains) -> str:
    """What would explain a misfit: a sweep that contradicts the others, else the best effect; empty if none is found."""
    if against:
        looks = f" and looks like {against[0].looks}" if against[0].looks else ""
        return f"{against[0].sweep} contradicts the other sweeps{looks}"
    return wording.best_effect(left.effect) if left.effect else ""


def _undeclared(left: Remains) -> str:
    """Key of [rig] of the best effect, if that is a rig error declared as absent; else empty."""
    assert left.effect is not None
    found = [
        None if (error := error_of(name)) is None else error.declared for name in left.effect.best.numbers
    ]
    absent = not left.effect.best.known and len(found) == 1
    return found[0].key if absent and found[0] is not None else ""


def _used(points: Points, channels: Iterable[str], outliers: Iterable[Outlier]) -> dict[str, np.ndarray]:
    """By channel, mask (n,) of the readings that were measured and have a weight."""
    out = {name: np.isfinite(points.channel(name)) for name in channels}
    for outlier in outliers:
        out[outlier.channel][outlier.row] = False
    return out


def _refused(files: Mapping[str, Tyre]) -> Iterable[str]:
    """What ``mffit check`` would refuse in the files."""
    found = [p.sentence for tyre in files.values() for p in tir.check(tyre) if p.level == "error"]
    return dict.fromkeys(found)

"""Sweeps that contradict all others, judged by prediction from a fit without them.

A wrong sweep distorts the fit and widens the estimated scatter, so it can hide in a fit to all sweeps. The fit to all sweeps
therefore only names suspects. Each suspect is judged by a fit to the other sweeps, with its model error and scatter of runs.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.special import chdtrc, chdtri, fdtrc, ndtr

from mffit.as_json import keys
from mffit.constants import (
    CANDIDATES_FITTED,
    CERTAIN_SIGMA,
    FALSE_ALARM,
    FEWEST,
    MOST,
    PREDICTION_FALSE_ALARM,
)
from mffit.errors import InputError
from mffit.points import Points
from mffit.points.constants import UNLIKE_SHARE
from mffit.quantities import CHANNELS
from mffit.rig import Simulation
from mffit.scatter import EFFICIENCY, bends, rms, usual_size
from mffit.suspicion import constants
from mffit.suspicion.groups import Group, alike, confirmed_by_others, groups
from mffit.suspicion.rereadings import Away, Errors, Mistake, certain_mistakes, explaining, explanation, moved
from mffit.suspicion.rule import Facts, Outcome, When, rule
from tir.frozen import ReadOnlyArrays

if TYPE_CHECKING:
    from mffit.linearised import LinearisedFit
    from mffit.linearised.mixed import LeftOutReadings


class FittedModel(NamedTuple):
    """A fit, and the linear model of its residuals at all points."""

    simulation: Simulation
    left: LinearisedFit


class JudgedSweeps(NamedTuple):
    """Inputs for the judgement of all sweeps."""

    points: Points  #: raw points (n,)
    signs: Mapping[str, float]  #: +1 or -1 per channel: from ISO-W to the rig's axes
    fitted: FittedModel  #: fit to all points
    refit: Callable[[np.ndarray], FittedModel]
    """Returns the fit without some rows (m,), and the linear model of residuals at all points, estimated without these rows."""
    mostly_rejected: Callable[[str, np.ndarray], bool]
    """Whether the fit rejected most readings of a channel at some rows (m,) as outliers."""


class Error(NamedTuple):
    """Error of one channel of a sweep as predicted from all other sweeps."""

    channel: str
    rms: float  #: [N] or [Nm], without the worst points
    ratio: float  #: rms error in units of its standard uncertainty from noise, scatter of runs and prediction
    share: float  #: rms error less its uncertainty, as a share of the channel's usual size at this load
    chance: float  #: probability of such an error for a sound sweep
    vague: float  #: standard uncertainty of the prediction, noise included, as a share of the usual size
    usual: float = 0.0
    """Probability of such an error if the formula misses this sweep as it misses those of its kind."""

    @property
    def facts(self) -> dict[str, Any]:
        """Facts for the sentences."""
        return {**self._asdict(), "unit": CHANNELS[self.channel].unit, "percent": 100 * self.share}


@dataclass(frozen=True, slots=True, eq=False)
class Doubt(ReadOnlyArrays):
    """A sweep, or one of its conditions, that the other sweeps do not predict."""

    sweep: str  #: name of the sweep, with the condition if only one condition is in doubt
    file: str
    index: np.ndarray  #: (m,) indices of the points
    errors: tuple[Error, ...]  #: by channel, the worst first
    whole: bool = True  #: False if only one condition is in doubt
    looks: str = ""  #: possible explanation in words; empty if no known cause fits
    mistake: Mistake | None = None  #: recording mistake that explains a gross error
    left: float = 1.0  #: error after undoing the mistake, as a share of the usual size
    confirmed: bool = True  #: whether other sweeps were measured at its load, camber and pressure

    @property
    def worst(self) -> Error:
        """The error with the largest ratio."""
        return self.errors[0]

    @property
    def channels(self) -> tuple[str, ...]:
        """Channels with a significant error that sweeps of its kind do not have: the formula misses those as well."""
        certain = float(ndtr(-CERTAIN_SIGMA))
        return tuple(
            e.channel
            for e in self.errors
            if e.ratio > constants.DISTRUSTED_MISFIT
            and e.chance < certain
            and e.usual < ndtr(-constants.DOUBTFUL_SIGMA)
        )

    @property
    def gross(self) -> Error:
        """The error with the largest share of the usual size."""
        return max(self.errors, key=lambda e: e.share)

    @property
    def sentence(self) -> str:
        """The warning about the sweep."""
        explained = f"; it looks like {self.looks}" if self.looks else ""
        return doubtful_sweep.said({"sweep": self.sweep, "explained": explained, **self.worst.facts})


keys(
    Doubt,
    "sweep file channel=worst.channel rms=worst.rms ratio=worst.ratio share=worst.share looks_like=looks?",
)


def after_the_fit(campaign: JudgedSweeps) -> tuple[Doubt, ...]:
    """Sweeps that contradict the others; raises InputError for a sweep whose error is beyond plausibility."""
    seen = doubts(campaign)
    for facts in contradicting_sweep.find(seen):
        raise contradicting_sweep.refusal(facts)
    return tuple(doubtful_sweep.find(seen))


def doubts(campaign: JudgedSweeps) -> tuple[Doubt, ...]:
    """The suspected sweeps judged by fits without them, the worst suspect first; empty with too few sweeps to compare.

    The search stops at the first sweep that a known mistake explains.
    """
    points = campaign.points
    found = groups(points)
    if len(found) < FEWEST:
        return ()
    size = {
        c: usual_size((points.channel(c) / points.Fz)[g.index] for g in found)
        for c in campaign.fitted.left.channels
    }
    out: list[Doubt] = []
    for group in _suspects(campaign, found, size):
        doubt = _doubt(campaign, group, found, size)
        if doubt is not None:
            out.append(doubt)
            if doubt.mistake is not None:
                break
    return tuple(out)


@rule(
    id="contradicting-sweep",
    when=When.AFTER,
    sentence="contradicts all other sweeps: predicted from them, {channel} is out by {rms:.3g} {unit}, at least {percent:.0f} % "
    "of its usual size{condition}{looks}",
)
def contradicting_sweep(seen: Sequence[Doubt]) -> Iterator[Facts]:
    """Error of the prediction from all other sweeps, as it is and with each known mistake undone; the worst sweep is found.

    Where no other sweep was measured at the load, the camber or the pressure, the formula alone contradicts: then only a unit is
    refused whose factor no formula misses.
    """
    refused = [d for d in seen if d.mistake is not None] or [
        d for d in seen if d.confirmed and d.gross.share > MOST and d.gross.vague < UNLIKE_SHARE
    ]
    if not refused:
        return
    worst = max(refused, key=lambda d: d.gross.share)
    if worst.mistake is not None:
        remedy = worst.mistake.remedy
        looks = f"; it looks like {worst.mistake.looks}, which leaves {100 * worst.left:.2g} %: {remedy}"
    else:
        others = dict.fromkeys(other.file for other in refused if other.file != worst.file)
        perhaps = f", or {' or '.join(others)}, which contradicts it" if others else ""
        looks = (
            ", and no reversed sign, exchanged column or unit explains it; check this "
            f"file{perhaps}, or leave it out"
        )
    condition = "" if worst.whole else f" ({worst.sweep})"
    column = worst.mistake.column if worst.mistake else None
    facts = {**worst.gross.facts, "condition": condition, "looks": looks}
    yield {"file": worst.file, "column": column, **facts}


@rule(
    id="doubtful-sweep",
    when=When.AFTER,
    outcome=Outcome.WARNED,
    sentence="{sweep} does not fit the other sweeps: predicted from them, {channel} is out by {rms:.3g} {unit}, {ratio:.1f} "
    "times what noise and model explain{explained}; check this sweep or repeat it",
)
def doubtful_sweep(seen: Sequence[Doubt]) -> Iterator[Doubt]:
    """Error of the prediction from a fit to all other sweeps, over what noise, runs and formula leave open.

    Single conditions of a sweep are named only if the sweep as a whole is not.
    """
    named: list[set[int]] = []
    for doubt in sorted(seen, key=lambda d: (not d.whole, -d.worst.ratio)):
        if doubt.channels and not any(set(doubt.index) <= rows for rows in named):
            named.append(set(doubt.index))
            yield doubt


def _suspects(campaign: JudgedSweeps, found: Sequence[Group], size: Mapping[str, float]) -> list[Group]:
    """Groups with significant prediction errors, clearly larger than the median group's; the worst first.

    Runs are assumed not to differ. Errors are computed both with and without the estimated model error, because the model error
    can hide a fault that only one sweep shows. A sweep is suspected as well if most of its readings were rejected as outliers:
    those that are left may agree.
    """
    worst: dict[int, float] = {}
    points, channels = campaign.points, campaign.fitted.left.channels
    level = PREDICTION_FALSE_ALARM / (len(found) * len(channels))
    for name, channel in channels.items():
        rows = [np.flatnonzero(np.isin(channel.rows, g.index)) for g in found]
        seen = [k for k, own in enumerate(rows) if len(own)]
        for missed in (True, False):
            predicted = channel.without_runs([rows[k] for k in seen], missed=missed)
            errors = {
                k: _error(name, one, size[name] * float(np.mean(points.Fz[found[k].index])))
                for k, one in zip(seen, predicted, strict=True)
            }
            usual = max(1.0, float(np.median([e.ratio for e in errors.values()])))
            for k, e in errors.items():
                if e.chance < level and e.ratio > constants.DISTRUSTED_MISFIT * usual:
                    worst[k] = max(worst.get(k, 0.0), e.ratio / usual)
        worst |= {k: math.inf for k, g in enumerate(found) if campaign.mostly_rejected(name, g.index)}
    in_order = sorted(worst, key=lambda k: (not found[k].whole, -worst[k]))
    return [found[k] for k in in_order[:CANDIDATES_FITTED]]


def without_worst(sizes: np.ndarray) -> np.ndarray:
    """Indices of the points of a sweep by which it is judged: all but the share with the largest errors ``sizes`` (n,)."""
    return np.argsort(sizes)[: max(1, int((1.0 - constants.SHARE_OF_WORST_POINTS) * len(sizes)))]


def _error(name: str, found: LeftOutReadings, size: float) -> Error:
    """Size and significance of a prediction's error, without the worst points."""
    own = np.sqrt(np.diag(found.covariance))
    kept = without_worst(np.abs(found.error) / own)
    e, V = found.error[kept], found.covariance[np.ix_(kept, kept)]
    chi2 = float(e @ np.linalg.solve(V, e))
    uncertain = rms(own[kept])
    return Error(
        channel=name,
        rms=rms(e),
        ratio=float(np.sqrt(chi2 / len(kept))),
        share=max(rms(e) - constants.DOUBTFUL_SIGMA * uncertain, 0.0) / size,
        chance=float(chdtrc(len(kept), chi2)),
        vague=uncertain / size,
    )


def _beyond_noise(found: LeftOutReadings, noise: float) -> float:
    """Rms error of a prediction beyond what chance makes of the noise, without the worst points."""
    kept = without_worst(np.abs(found.error))
    by_chance = noise**2 * float(chdtri(len(kept), FALSE_ALARM)) / len(kept)
    return math.sqrt(max(rms(found.error[kept]) ** 2 - by_chance, 0.0))


def _scatters(found: LeftOutReadings, noise: float) -> bool:
    """Whether a prediction's errors differ between neighbouring readings by far more than the noise, which no formula makes."""
    away = bends(found.error, 2) / noise
    own = away[without_worst(np.abs(away))]
    # Neighbouring differences share readings, so only half of them count.
    chance = chdtrc(len(own) / 2.0, own @ own / 2.0)
    return bool(rms(own) > constants.DISTRUSTED_MISFIT and chance < ndtr(-CERTAIN_SIGMA))


def _usual(errors: Sequence[float]) -> float:
    """Probability of the first error among those of other sweeps, each relative to its load; 1 without others, which alone
    could say what the sweep should read. An error that is smooth over a sweep shows as much as few readings do.
    """
    own, *others = errors
    if not own or not others:
        return 1.0
    size, known = float(np.median(others)), EFFICIENCY * FEWEST * len(others)
    return float(fdtrc(FEWEST, known, (own / size) ** 2)) if size else 0.0


def _doubt(
    campaign: JudgedSweeps, group: Group, every: Sequence[Group], size: Mapping[str, float]
) -> Doubt | None:
    """The group judged by a fit without it; None if the other points are too few for a fit."""
    try:
        fitted = campaign.refit(group.index)
    except InputError:
        return None
    load = float(np.mean(campaign.points.Fz[group.index]))
    found, usual = {}, {}
    comparable = alike(campaign.points, group, every)
    for name, channel in fitted.left.channels.items():
        rows, *like = (np.flatnonzero(np.isin(channel.rows, g.index)) for g in (group, *comparable))
        if len(rows):
            predicted = channel.by_others(rows, [one for one in like if len(one)])
            one = predicted[0]
            found[name] = one._replace(rows=channel.rows[one.rows])
            Fz = channel.seen.points.Fz
            smooth = [_beyond_noise(one, channel.noise) / float(np.mean(Fz[one.rows])) for one in predicted]
            usual[name] = 0.0 if _scatters(one, channel.noise) else _usual(smooth)
    errors = [_error(name, one, size[name] * load)._replace(usual=usual[name]) for name, one in found.items()]
    if not errors:
        return None
    part = _part(campaign.points, group, found)
    gross = {e.channel: e.rms for e in errors if e.share > UNLIKE_SHARE}
    rest = np.delete(np.arange(len(campaign.points)), group.index)
    others = campaign.points.select(rest, with_table=False)
    away = partial(_away, part, fitted.simulation, found, {name: size[name] * load for name in found})
    candidates = certain_mistakes(part, campaign.signs, others, by_formula=True) if gross else ()
    best = explaining(candidates, gross, away, dict.fromkeys(found, UNLIKE_SHARE))
    errors.sort(key=lambda e: -e.ratio)
    doubt = Doubt(
        group.name,
        group.file,
        group.index,
        tuple(errors),
        group.whole,
        confirmed=confirmed_by_others(part, others),
    )
    if best is not None:
        doubt = replace(doubt, mistake=best.mistake, left=best.left)
    if not doubt.channels:
        return doubt
    return replace(doubt, looks=explanation(part, found, fitted.simulation, campaign.signs))


def _part(points: Points, group: Group, found: Errors) -> Points:
    """The points of a group, with readings that are not judged set to NaN."""
    part = points.select(group.index)
    readings = {
        name: np.where(np.isin(group.index, found[name].rows), part.channel(name), np.nan)
        if name in found
        else np.full(len(part), np.nan)
        for name in CHANNELS
    }
    return part.replace(**readings)


def _away(
    part: Points, simulation: Simulation, found: Errors, size: Mapping[str, float], changed: Points
) -> dict[str, Away]:
    """By channel, the error of a sweep against the prediction from all others if it is read as ``changed``."""
    out = {}
    for name, error in moved(part, found, simulation, changed).items():
        measured = changed.channel(name)[np.isfinite(part.channel(name))]
        e = _error(name, found[name]._replace(error=error), size[name])
        least = min(rms(measured), rms(measured - error))
        out[name] = Away(e.rms, e.share, e.rms <= MOST * least)
    return out

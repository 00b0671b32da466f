"""Every sweep against all others: sweeps that contradict them, by the linear model of the fit without them.

A sweep that is far off bends the fit, widens what counts as usual, and hides in both. So whoever is suspected by the fit to all
sweeps is judged by one to the others: its numbers, what it misses, and what its runs differ by say what to expect of the sweep.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from scipy.special import chdtrc, ndtr

from mffit.constants import PREDICTION_FALSE_ALARM
from mffit.errors import InputError
from mffit.linearised import LinearisedFit
from mffit.linearised.mixed import LeftOutReadings
from mffit.points import Points
from mffit.quantities import CHANNELS
from mffit.rig import Simulation
from mffit.scatter import rms, usual_size
from mffit.suspicion import constants
from mffit.suspicion.groups import Group, groups
from mffit.suspicion.rereadings import MISTAKES, Away, Errors, Mistake, explaining, explanation, moved
from mffit.suspicion.rule import Finding, Outcome, When, rule


class FittedModel(NamedTuple):
    """A fit and what it leaves of all points."""

    simulation: Simulation
    left: LinearisedFit


class JudgedSweeps(NamedTuple):
    """What the judgement of all sweeps needs."""

    points: Points  #: raw points (n,)
    signs: Mapping[str, float]  #: +1 or -1 per channel: from ISO-W to the rig's axes
    fitted: FittedModel  #: to all points
    refit: Callable[[np.ndarray], FittedModel]
    """The fit to all points but some rows (m,), and what it leaves of all points, found without these."""


class Error(NamedTuple):
    """How far a channel of a sweep is from what all others predict."""

    channel: str
    rms: float  #: [N] or [Nm], without the worst points
    ratio: float  #: over what noise, runs and the prediction leave open
    share: float  #: of the channel's usual size at this load, less the prediction's uncertainty
    chance: float  #: probability that a sound sweep is as far off
    vague: float  #: standard error of the prediction, noise included, as a share of the usual size

    @property
    def facts(self) -> dict[str, Any]:
        """Facts for the sentences."""
        return {**self._asdict(), "unit": CHANNELS[self.channel].unit, "percent": 100 * self.share}


@dataclass(frozen=True, slots=True, eq=False)
class Doubt:
    """A sweep, or one condition of it, that the others do not predict."""

    sweep: str  #: its name, with the condition where only that is meant
    file: str
    index: np.ndarray  #: (m,) rows of the points
    errors: tuple[Error, ...]  #: the worst first
    whole: bool = True  #: False if one condition is meant
    looks: str = ""  #: what would explain it; empty if no known cause does
    mistake: Mistake | None = None  #: that explains a gross error
    left: float = 1.0  #: share of the usual size that is left when the mistake is undone

    @property
    def channel(self) -> str:
        """The worst one."""
        return self.errors[0].channel

    @property
    def rms(self) -> float:
        """Error of its prediction [N] or [Nm]."""
        return self.errors[0].rms

    @property
    def ratio(self) -> float:
        """The same over what noise, runs and the prediction leave open."""
        return self.errors[0].ratio

    @property
    def share(self) -> float:
        """The same over the channel's usual size at this load."""
        return self.errors[0].share

    @property
    def channels(self) -> tuple[str, ...]:
        """Those in which chance does not explain it."""
        certain = float(ndtr(-constants.CERTAIN_SIGMA))
        return tuple(
            e.channel for e in self.errors if e.ratio > constants.DISTRUSTED_MISFIT and e.chance < certain
        )

    @property
    def gross(self) -> Error:
        """The error that is largest beside the usual size."""
        return max(self.errors, key=lambda e: e.share)

    @property
    def sentence(self) -> str:
        """The warning about it."""
        explained = f"; it looks like {self.looks}" if self.looks else ""
        return doubtful_sweep.said({"sweep": self.sweep, "explained": explained, **self.errors[0].facts})


def after_the_fit(campaign: JudgedSweeps) -> tuple[Doubt, ...]:
    """Sweeps that do not fit the others, judged by what all others predict; one beyond plausibility is refused."""
    seen = doubts(campaign)
    for finding in contradicting_sweep.find(seen):
        raise contradicting_sweep.refusal(finding)
    return tuple(doubtful_sweep.find(seen))


def doubts(campaign: JudgedSweeps) -> tuple[Doubt, ...]:
    """The suspected sweeps, as fits without them see them, the worst first; none with too few sweeps to compare.

    The search ends at the first sweep that a known mistake explains.
    """
    points = campaign.points
    found = groups(points)
    if len(found) < constants.FEWEST:
        return ()
    size = {
        c: usual_size((points.channel(c) / points.Fz)[g.index] for g in found)
        for c in campaign.fitted.left.channels
    }
    out: list[Doubt] = []
    for group in _suspects(campaign, found, size):
        doubt = _doubt(campaign, group, size)
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
def contradicting_sweep(seen: Sequence[Doubt]) -> Iterator[Finding]:
    """Error of the prediction from all other sweeps, as it is and with each known mistake undone; the worst sweep is found."""
    refused = [d for d in seen if d.mistake is not None] or [
        d
        for d in seen
        if d.gross.share > constants.IMPLAUSIBLE_SHARE and d.gross.vague < constants.GROSS_SHARE
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
    yield Finding(
        {**worst.gross.facts, "condition": condition, "looks": looks}, file=worst.file, column=column
    )


@rule(
    id="doubtful-sweep",
    when=When.AFTER,
    outcome=Outcome.WARNED,
    sentence="{sweep} does not fit the other sweeps: predicted from them, {channel} is out by {rms:.3g} {unit}, {ratio:.1f} "
    "times what noise and model explain{explained}; check this sweep or repeat it",
)
def doubtful_sweep(seen: Sequence[Doubt]) -> Iterator[Doubt]:
    """Error of the prediction from a fit to all other sweeps, over what noise, runs and formula leave open.

    Conditions of a sweep are named only if it is sound as a whole.
    """
    named: list[set[int]] = []
    for doubt in sorted(seen, key=lambda d: (not d.whole, -d.ratio)):
        if doubt.channels and not any(set(doubt.index) <= rows for rows in named):
            named.append(set(doubt.index))
            yield doubt


def _suspects(campaign: JudgedSweeps, found: Sequence[Group], size: Mapping[str, float]) -> list[Group]:
    """Groups that the others do not predict, if runs did not differ, and that are odder than is usual; the worst first.

    With what the formula misses, which hides what only one sweep shows, and without it, as the numbers of the fit predict them.
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
    in_order = sorted(worst, key=lambda k: (not found[k].whole, -worst[k]))
    return [found[k] for k in in_order[: constants.MOST_SUSPECTS]]


def _error(name: str, found: LeftOutReadings, size: float) -> Error:
    """Size and significance of a prediction's error, without the worst points."""
    own = np.sqrt(np.diag(found.covariance))
    number = max(1, int((1.0 - constants.SHARE_OF_WORST_POINTS) * len(own)))
    kept = np.argsort(np.abs(found.error) / own)[:number]
    e, V = found.error[kept], found.covariance[np.ix_(kept, kept)]
    chi2 = float(e @ np.linalg.solve(V, e))
    uncertain = rms(own[kept])
    return Error(
        channel=name,
        rms=rms(e),
        ratio=float(np.sqrt(chi2 / number)),
        share=max(rms(e) - constants.DOUBTFUL_SIGMA * uncertain, 0.0) / size,
        chance=float(chdtrc(number, chi2)),
        vague=uncertain / size,
    )


def _doubt(campaign: JudgedSweeps, group: Group, size: Mapping[str, float]) -> Doubt | None:
    """The group against a fit without it; None if the other points are too few for a fit."""
    try:
        fitted = campaign.refit(group.index)
    except InputError:
        return None
    load = float(np.mean(campaign.points.Fz[group.index]))
    found = {}
    for name, channel in fitted.left.channels.items():
        rows = np.flatnonzero(np.isin(channel.rows, group.index))
        if len(rows):
            one = channel.by_others(rows)
            found[name] = one._replace(rows=channel.rows[one.rows])
    errors = [_error(name, one, size[name] * load) for name, one in found.items()]
    if not errors:
        return None
    part = _part(campaign.points, group, found)
    gross = {e.channel: e.rms for e in errors if e.share > constants.GROSS_SHARE}
    undone = ((m, m.undone(part, campaign.signs)) for m in MISTAKES if m.beyond_doubt and gross)
    away = partial(_away, part, fitted.simulation, found, {name: size[name] * load for name in found})
    best = explaining(undone, gross, away, dict.fromkeys(found, constants.GROSS_SHARE))
    errors.sort(key=lambda e: -e.ratio)
    doubt = Doubt(group.name, group.file, group.index, tuple(errors), group.whole)
    if best is not None:
        doubt = replace(doubt, mistake=best.mistake, left=best.left)
    if not doubt.channels:
        return doubt
    return replace(doubt, looks=explanation(part, found, fitted.simulation, campaign.signs))


def _part(points: Points, group: Group, found: Errors) -> Points:
    """The points of a group with those readings only that are judged."""
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
    """By channel, how far a sweep is from the prediction of all others if it is read as ``changed``."""
    out = {}
    for name, error in moved(part, found, simulation, changed).items():
        measured = changed.channel(name)[np.isfinite(part.channel(name))]
        e = _error(name, found[name]._replace(error=error), size[name])
        least = min(rms(measured), rms(measured - error))
        out[name] = Away(e.rms, e.share, e.rms <= constants.IMPLAUSIBLE_SHARE * least)
    return out

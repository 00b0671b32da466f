"""Every sweep against all others: sweeps that are off, and the fits without them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.special import chdtrc, ndtri

from mffit.constants import EXPLAINED_SHARE
from mffit.errors import InputError
from mffit.points import Points
from mffit.quantities import CHANNELS
from mffit.rig import Simulation
from mffit.scatter import rms, robust, usual_size
from mffit.suspicion import constants
from mffit.suspicion.explanation import explanation
from mffit.suspicion.mistakes import MISTAKES, Away, Mistake, explaining
from mffit.suspicion.prediction import (
    FittedModel,
    Group,
    Leverage,
    PredictedChannel,
    groups,
    leverage,
    predictions,
)
from mffit.suspicion.rule import Finding, Outcome, Subject, When, rule


class JudgedSweeps(NamedTuple):
    """What the judgement of all sweeps needs."""

    points: Points  #: raw points (n,)
    stated: Mapping[str, np.ndarray]
    """By channel of the fit, uncertainty (n,) before any weighting; inf where not measured."""
    signs: Mapping[str, float]  #: +1 or -1 per channel: from ISO-W to the rig's axes
    refit: Callable[[np.ndarray], FittedModel]  #: the fit to some rows (m,) only


class Error(NamedTuple):
    """How far a channel of a sweep is from what all others predict."""

    channel: str
    rms: float  #: [N] or [Nm], without the worst points
    ratio: float  #: in units of a sound sweep's error
    share: float  #: of the channel's usual size at this load, less the prediction's uncertainty
    chance: float  #: probability that a sound sweep is as far off
    vague: float  #: standard error of the prediction, noise included, as a share of the usual size


class View(NamedTuple):
    """One sweep as seen from the fit to all others."""

    group: Group
    error: Error  #: of its worst channel
    mistake: Mistake | None  #: that explains it
    left: float  #: share of the usual size that is left when the mistake is undone

    @property
    def facts(self) -> dict[str, Any]:
        """Facts for the sentences."""
        return {
            "channel": self.error.channel,
            "unit": CHANNELS[self.error.channel].unit,
            "rms": self.error.rms,
            "percent": 100 * self.error.share,
            "condition": "" if self.group.whole else f" ({self.group.name})",
        }


@dataclass(frozen=True, slots=True)
class Doubt:
    """A sweep that does not fit the others, without being impossible."""

    sweep: str  #: its name, with the conditions where only these are meant
    file: str
    index: np.ndarray  #: (m,) rows of the points
    channel: str
    rms: float  #: error of the prediction [N] or [Nm]
    ratio: float  #: in units of a sound sweep's error
    share: float  #: of the channel's usual size at this load
    looks: str  #: what would explain it; empty if no known cause does

    @property
    def sentence(self) -> str:
        """The warning about it."""
        facts = {
            "unit": CHANNELS[self.channel].unit,
            "percent": 100 * self.share,
            "explained": f"; it looks like {self.looks}" if self.looks else "",
        }
        return doubtful_sweep.said(asdict(self) | facts)


class Evidence(NamedTuple):
    """All sweeps that are off, as seen by the fits without them."""

    campaign: JudgedSweeps
    simulation: Simulation  #: fitted to all sweeps
    leverage: Leverage
    usual: float  #: largest ratio that the scatter among the sweeps explains
    views: tuple[View, ...]


def evidence(campaign: JudgedSweeps, fitted: FittedModel) -> Evidence | None:
    """Views of the sweeps that are off, the worst first; None with too few sweeps to compare.

    The search ends at the first sweep that a known mistake explains.
    """
    points = campaign.points
    found = groups(points)
    if len(found) < constants.FEWEST_SWEEPS_TO_COMPARE:
        return None
    size = {c: usual_size((getattr(points, c) / points.Fz)[g.index] for g in found) for c in campaign.stated}
    noise = np.concatenate([u * fitted.scale[name] for name, u in campaign.stated.items()])
    fit = leverage(fitted, noise)
    in_order = sorted(found, key=lambda g: int(g.index[0]))  # so that no point is simulated twice
    own = {id(g): _errors(predictions(fit, g), points.Fz[g.index], size) for g in in_order}
    errors = [(e, g) for g in found for e in own[id(g)]]
    level = constants.FALSE_ALARM_OF_SWEEPS / len(errors)
    usual = _usual_ratio([e for e, _ in errors])
    views = []
    for group in _suspects(errors, level, usual):
        view = _view(campaign, group, size, level)
        if view is not None:
            views.append(view)
        if view is not None and view.mistake is not None:
            break
    return Evidence(
        campaign=campaign, simulation=fitted.simulation, leverage=fit, usual=usual, views=tuple(views)
    )


@rule(
    id="known-mistake",
    subject=Subject.SWEEP,
    when=(When.FIRST, When.AFTER),
    limits=(constants.FALSE_ALARM_OF_SWEEPS, constants.GROSS_SHARE, EXPLAINED_SHARE, constants.MATCHED_SHARE),
    sentence="contradicts all other sweeps: predicted from them, {channel} is out by {rms:.3g} {unit}, at least {percent:.0f} % "
    "of its usual size{condition}; it looks like {looks}, which leaves {left:.2g} %: {remedy}",
)
def known_mistake(seen: Evidence) -> Iterator[Finding]:
    """Error of the prediction from all other sweeps, as it is and with each known mistake undone; the worst sweep is found."""
    explained = [v for v in seen.views if v.mistake is not None]
    if explained:
        v = max(explained, key=lambda v: v.error.share)
        assert v.mistake is not None
        facts = {**v.facts, "looks": v.mistake.looks, "left": 100 * v.left, "remedy": v.mistake.remedy}
        yield Finding(facts, file=v.group.file, column=v.mistake.column)


@rule(
    id="implausible-sweep",
    subject=Subject.SWEEP,
    when=(When.AFTER,),
    limits=(constants.FALSE_ALARM_OF_SWEEPS, constants.IMPLAUSIBLE_SHARE, constants.GROSS_SHARE),
    sentence="contradicts all other sweeps: predicted from them, {channel} is out by {rms:.3g} {unit}, at least {percent:.0f} % "
    "of its usual size{condition}, and no reversed sign, exchanged column or unit explains it; check this "
    "file{perhaps}, or leave it out",
)
def implausible_sweep(seen: Evidence) -> Iterator[Finding]:
    """Error of the prediction from all other sweeps, and uncertainty of the prediction; the worst sweep is found."""
    refused = [
        v
        for v in seen.views
        if v.error.share > constants.IMPLAUSIBLE_SHARE and v.error.vague < constants.GROSS_SHARE
    ]
    if refused:
        v = max(refused, key=lambda v: v.error.share)
        others = dict.fromkeys(other.group.file for other in refused if other.group.file != v.group.file)
        perhaps = f", or {' or '.join(others)}, which contradicts it" if others else ""
        yield Finding({**v.facts, "perhaps": perhaps}, file=v.group.file)


@rule(
    id="doubtful-sweep",
    subject=Subject.SWEEP,
    when=(When.AFTER,),
    limits=(constants.FALSE_ALARM_OF_SWEEPS, constants.DOUBTFUL_SHARE, constants.EXPLAINED_BY_ONE_NUMBER),
    outcome=Outcome.WARNED,
    sentence="{sweep} does not fit the other sweeps: predicted from them, {channel} is out by {rms:.3g} {unit}, at least "
    "{percent:.0f} % of its usual size and {ratio:.1f} times what noise and model explain{explained}; check this sweep "
    "or repeat it",
)
def doubtful_sweep(seen: Evidence) -> Iterator[Doubt]:
    """Error of the prediction from all other sweeps, beside the errors of the other sweeps; conditions only of a sound sweep."""
    doubtful = [
        v for v in seen.views if v.error.ratio > seen.usual and v.error.vague < constants.DOUBTFUL_SHARE
    ]
    seen_rows: list[set[int]] = []
    for v in sorted(doubtful, key=lambda v: (not v.group.whole, -v.error.ratio)):
        if any(set(v.group.index) <= rows for rows in seen_rows):
            continue
        seen_rows.append(set(v.group.index))
        part, errors = _judged(seen, v.group), predictions(seen.leverage, v.group)
        yield Doubt(
            sweep=v.group.name,
            file=v.group.file,
            index=v.group.index,
            channel=v.error.channel,
            rms=v.error.rms,
            ratio=v.error.ratio,
            share=v.error.share,
            looks=explanation(part, errors, seen.simulation, seen.campaign.signs),
        )


def _judged(seen: Evidence, group: Group) -> Points:
    """The points that a group shows, without readings of no weight, such as driven points where Fx is not fitted."""
    part, noise = seen.campaign.points.select(group.shown), seen.leverage.noise
    n = len(seen.campaign.points)
    readings = {
        name: np.where(np.isfinite(noise[k * n + group.shown]), part.channel(name), np.nan)
        for k, name in enumerate(seen.leverage.channels)
    }
    return part.replace(**readings)


def _suspects(errors: list[tuple[Error, Group]], level: float, usual: float) -> list[Group]:
    """Groups with a significant and large error, the worst first."""
    odd = [
        (e, g)
        for e, g in errors
        if e.chance < level
        and (e.share > constants.GROSS_SHARE or (e.share > constants.DOUBTFUL_SHARE and e.ratio > usual))
    ]
    worst_first = [g for _, g in sorted(odd, key=lambda pair: (not pair[1].whole, -pair[0].ratio))]
    return list({id(g): g for g in worst_first}.values())[: constants.MOST_SUSPECTS]


def _errors(
    channels: Mapping[str, PredictedChannel], Fz: np.ndarray, size: Mapping[str, float]
) -> list[Error]:
    """Errors of a prediction, channel by channel, at loads (m,)."""
    load = float(np.mean(Fz))
    return [_error(name, one, size[name] * load) for name, one in channels.items()]


def _error(name: str, prediction: PredictedChannel, size: float) -> Error:
    """Size and significance of a prediction's error, without the worst points."""
    error, covariance = prediction.error, prediction.covariance
    own = np.sqrt(np.diag(covariance))
    number = max(1, int((1.0 - constants.SHARE_OF_WORST_POINTS) * len(error)))
    kept = np.argsort(np.abs(error) / own)[:number]
    e, V = error[kept], covariance[np.ix_(kept, kept)]
    chi2 = float(e @ np.linalg.solve(V, e))
    uncertain = rms(own[kept])
    return Error(
        channel=name,
        rms=rms(e),
        ratio=float(np.sqrt(chi2 / len(kept))),
        share=max(rms(e) - constants.SURE_ERRORS * uncertain, 0.0) / size,
        chance=float(chdtrc(len(kept), chi2)),
        vague=uncertain / size,
    )


def _usual_ratio(errors: list[Error]) -> float:
    """The largest ratio that the scatter among the sweeps explains: a model misses each of them differently."""
    ratio = np.log([max(e.ratio, 1e-9) for e in errors])
    middle = float(np.median(ratio))
    return float(
        np.exp(middle - ndtri(constants.FALSE_ALARM_OF_SWEEPS / len(errors)) * robust(ratio, middle))
    )


def _view(campaign: JudgedSweeps, group: Group, size: Mapping[str, float], level: float) -> View | None:
    """The group against a fit without it; None if it is not off, or if the other points are too few for a fit."""
    rest = np.setdiff1d(np.arange(len(campaign.points)), group.index)
    try:
        fitted = campaign.refit(rest)
    except InputError:
        return None
    part = campaign.points.select(group.shown)
    stated = {name: u[group.shown] for name, u in campaign.stated.items()}

    def away(of: Points) -> dict[str, Away]:
        return {
            e.channel: Away(error=e.rms, share=e.share, matched=matched)
            for e, matched in _predicted(of, fitted, stated, size)
        }

    off = [
        e
        for e, _ in _predicted(part, fitted, stated, size)
        if e.chance < level and e.share > constants.DOUBTFUL_SHARE
    ]
    if not off:
        return None
    gross = {e.channel: e.rms for e in off if e.share > constants.GROSS_SHARE}
    undone = ((m, m.undone(part, campaign.signs)) for m in MISTAKES if m.beyond_doubt and gross)
    best = explaining(undone, gross, away, dict.fromkeys(stated, constants.GROSS_SHARE))
    return View(
        group=group,
        error=max(off, key=lambda e: e.share),
        mistake=None if best is None else best.mistake,
        left=1.0 if best is None else best.left,
    )


def _predicted(
    part: Points, fitted: FittedModel, stated: Mapping[str, np.ndarray], size: Mapping[str, float]
) -> Iterator[tuple[Error, bool]]:
    """Errors of a fit at points (m,) that were not in it, by channel, and whether they are small beside the readings."""
    out, slope = fitted.simulation.sensitivities(part, list(fitted.names), stated)
    load = float(np.mean(part.Fz))
    for name, u in stated.items():
        scale = fitted.scale[name]
        known = np.isfinite(u) & np.isfinite(part.channel(name))
        if not np.any(known):
            continue
        measured, predicted, J = part.channel(name)[known], out[name][known], slope[name][known]
        prediction = PredictedChannel(
            error=predicted - measured,
            covariance=J @ fitted.covariance @ J.T + np.diag((scale * u[known]) ** 2),
        )
        error = _error(name, prediction, size[name] * load)
        yield error, error.rms <= constants.MATCHED_SHARE * min(rms(measured), rms(predicted))

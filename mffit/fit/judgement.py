"""Every sweep against all others: contradictions end the build with the sweep's name, doubts are told."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc, ndtri

from mffit.errors import InputError
from mffit.fit.doubts import Doubt
from mffit.fit.explanation import explanation
from mffit.fit.fitted import Fitted
from mffit.fit.prediction import Group, Leverage, Prediction, groups, leverage, predictions
from mffit.points import Points
from mffit.points.mistakes import MISTAKES, Mistake
from mffit.quantities import CHANNELS
from mffit.rig import Simulation
from mffit.scatter import rms as root_mean_square
from mffit.scatter import robust, usual_size

FALSE_ALARM = 0.01
"""Probability that chance alone makes any sweep of a sound campaign significant (Bonferroni)."""
TRIMMED = 0.2
"""Share of a sweep's points, the worst ones, that do not count: one wild reading is no broken sweep."""
SURE = 3.0
"""Standard errors of the prediction that are taken off an error before it counts as one."""
DOUBTFUL = 0.05
"""Error of a prediction, as a share of the channel's usual size, that a rig's repeatability does not explain."""
GROSS = 0.1
"""Share from which on a known mistake is looked for."""
IMPLAUSIBLE = 0.5
"""Share from which on a sweep is refused though no known mistake explains it."""
EXPLAINED = 1.0 / 3.0
"""A mistake explains an error if less than this of it is left when the mistake is undone."""
MATCHED = 0.5
"""Largest misfit of what the mistake leaves, as a share of what is predicted and of what was measured."""
MOST_TRIED = 6
"""Sweeps, the worst first, for which the fit is done again without them."""


class Error(NamedTuple):
    """How far a channel of a sweep is from what all others predict."""

    channel: str
    rms: float  #: [N] or [Nm], without the worst points
    ratio: float  #: in units of what a sound sweep would show
    share: float  #: of the channel's usual size at this load, beyond what the prediction leaves open
    chance: float  #: probability that a sound sweep is as far off
    vague: float  #: standard error of the prediction, noise included, as a share of the usual size


class View(NamedTuple):
    """What the fit to all other sweeps says of one."""

    group: Group
    error: Error
    mistake: Mistake | None
    left: float  #: share of the usual size that is left when the mistake is undone

    @property
    def refused(self) -> bool:
        """Whether it is beyond plausibility: a known mistake, or a contradiction that the others are sure of."""
        return self.mistake is not None or (self.error.share > IMPLAUSIBLE and self.error.vague < GROSS)


Refit = Callable[[np.ndarray], Fitted]
"""The fit to some rows (m,) only."""


def judge(
    points: Points,
    fitted: Fitted,
    stated: tuple[np.ndarray, np.ndarray],
    signs: Mapping[str, float],
    refit: Refit,
    *,
    only_known: bool = False,
) -> tuple[Doubt, ...]:
    """Judge every sweep by what all others predict of it.

    Parameters
    ----------
    points : raw points (n,)
    fitted : the fit to all of them
    stated : uncertainty of Fy [N] and of Mz [Nm] before any weighting, (n,); inf where not measured
    signs : +1 or -1 per channel, what turns ISO-W into the rig's axes
    refit : fits some of the points; called only for sweeps that are far off
    only_known : refuse only what a known mistake explains, as the fit itself may be at fault

    Raises
    ------
    InputError
        A sweep contradicts all others beyond plausibility; it is named with what it looks like.
    """
    found = groups(points)
    if len(found) < 3:
        return ()
    size = {c: usual_size((getattr(points, c) / points.Fz)[g.index] for g in found) for c in CHANNELS}
    noise = np.concatenate([u * k for u, k in zip(stated, fitted.scale.values(), strict=True)])
    fit = leverage(fitted.problem, fitted.numbers, noise)
    errors = {k: errors_of(predictions(fit, g), g, points, size) for k, g in enumerate(found)}
    level = FALSE_ALARM / sum(len(rows) for rows in errors.values())
    suspects = [(e, found[k]) for k, rows in errors.items() for e in rows if e.chance < level]
    usual = _usual_ratios([e for rows in errors.values() for e in rows])
    odd = [s for s in suspects if s[0].share > GROSS or (s[0].share > DOUBTFUL and s[0].ratio > usual)]
    worst_first = [g for _, g in sorted(odd, key=lambda s: (not s[1].whole, -s[0].ratio))]
    tried = list({id(g): g for g in worst_first}.values())[:MOST_TRIED]
    views = []
    for group in tried:
        view = _view(points, group, stated, size, signs, refit, level)
        if view is not None:
            views.append(view)
        if view is not None and view.mistake is not None:
            break
    refused = [v for v in views if v.refused and (v.mistake is not None or not only_known)]
    if refused:
        raise _refusal(refused)
    doubtful = [v for v in views if v.error.ratio > usual and v.error.vague < DOUBTFUL]
    return _doubts(points, doubtful, fit, fitted.simulation, signs)


def errors_of(
    channels: Mapping[str, Prediction], group: Group, points: Points, size: Mapping[str, float]
) -> list[Error]:
    """The errors of a group's prediction, channel by channel."""
    load = float(np.mean(points.Fz[group.index]))
    return [error_of(name, one, size[name] * load) for name, one in channels.items()]


def error_of(name: str, prediction: Prediction, size: float) -> Error:
    """Size and significance of a prediction's error, without the worst points."""
    error, covariance = prediction.error, prediction.covariance
    own = np.sqrt(np.diag(covariance))
    kept = np.argsort(np.abs(error) / own)[: max(1, int((1.0 - TRIMMED) * len(error)))]
    e, V = error[kept], covariance[np.ix_(kept, kept)]
    total = float(e @ np.linalg.solve(V, e))
    rms = root_mean_square(e)
    open_ = root_mean_square(own[kept])
    return Error(
        channel=name,
        rms=rms,
        ratio=float(np.sqrt(total / len(kept))),
        share=max(rms - SURE * open_, 0.0) / size,
        chance=float(chdtrc(len(kept), total)),
        vague=open_ / size,
    )


def _usual_ratios(errors: list[Error]) -> float:
    """The largest ratio that the scatter among the sweeps themselves explains: a model misses each of them differently."""
    ratio = np.log([max(e.ratio, 1e-9) for e in errors])
    middle = float(np.median(ratio))
    scatter = robust(ratio, middle)
    return float(np.exp(middle - ndtri(FALSE_ALARM / len(errors)) * scatter))


def _view(points: Points, group: Group, stated, size, signs, refit: Refit, level: float) -> View | None:
    """Fit again without the group, and see what that says of it; None if it is nothing."""
    rest = np.setdiff1d(np.arange(len(points)), group.index)
    try:
        fitted = refit(rest)
    except InputError:  # too few points are left to say anything of this one
        return None
    part = points.select(group.shown)

    def seen(of: Points) -> dict[str, tuple[Error, Prediction]]:
        return _predicted(of, fitted, [u[group.shown] for u in stated], size)

    declared = {n: e for n, (e, _) in seen(part).items() if e.chance < level and e.share > DOUBTFUL}
    if not declared:
        return None
    worst = max(declared.values(), key=lambda e: e.share)
    gross = {n: e for n, e in declared.items() if e.share > GROSS}
    undone = [(m, seen(m.undone(part, signs))) for m in MISTAKES if m.beyond_doubt and gross]
    fitting = [(_left(after), m) for m, after in undone if _explains(m, gross, after, part, signs)]
    left, best = min(fitting, key=lambda pair: pair[0], default=(1.0, None))
    return View(group, worst, best, left)


def _refusal(views: list[View]) -> InputError:
    """A sweep that a known mistake explains is named before one that only contradicts: it can drag others along."""
    explained = [v for v in views if v.mistake is not None]
    v = max(explained or views, key=lambda v: v.error.share)
    contradiction = (
        f"contradicts all other sweeps: as they predict it, {v.error.channel} is out by {v.error.rms:.3g} "
        f"{CHANNELS[v.error.channel].unit}, at least {100 * v.error.share:.0f} % of its usual size"
    )
    if not v.group.whole:
        contradiction += f" ({v.group.name})"
    if v.mistake is None:
        others = dict.fromkeys(other.group.file for other in views if other.group.file != v.group.file)
        perhaps = f", or {' or '.join(others)}, which contradicts it" if others else ""
        return InputError(
            f"{contradiction}, and no reversed sign, exchanged column or unit explains it; check this file{perhaps}, "
            "or leave it out",
            file=v.group.file,
        )
    return InputError(
        f"{contradiction}; it looks like {v.mistake.looks}, which leaves {100 * v.left:.2g} %: {v.mistake.remedy}",
        file=v.group.file,
        column=v.mistake.column,
    )


def _predicted(part: Points, fitted: Fitted, stated, size) -> dict[str, tuple[Error, Prediction]]:
    """Errors of a fit at points (m,) that it has not seen."""
    out, slope = fitted.simulation.sensitivities(part, fitted.posterior.names)
    load = float(np.mean(part.Fz))
    found = {}
    for name, u, scale in zip(CHANNELS, stated, fitted.scale.values(), strict=True):
        known = np.isfinite(u) & np.isfinite(getattr(part, name))
        if not np.any(known):
            continue
        J = getattr(slope, name)[known]
        error = (getattr(out, name) - getattr(part, name))[known]
        prediction = Prediction(
            error, J @ fitted.posterior.covariance @ J.T + np.diag((scale * u[known]) ** 2)
        )
        found[name] = (error_of(name, prediction, size[name] * load), prediction)
    return found


def _left(after: Mapping[str, tuple[Error, Prediction]]) -> float:
    """Largest share of the usual size by which a channel is still out."""
    return max(error.share for error, _ in after.values())


def _explains(mistake: Mistake, declared, after, part: Points, signs) -> bool:
    """Whether undoing a mistake leaves little of the errors, makes none elsewhere, and matches in size."""
    if _left(after) > GROSS:
        return False
    changed = mistake.undone(part, signs)
    for name, before in declared.items():
        error, prediction = after[name]
        measured = getattr(changed, name)
        measured = measured[np.isfinite(measured)]
        predicted = measured + prediction.error
        smallest = min(root_mean_square(measured), root_mean_square(predicted))
        if error.rms > EXPLAINED * before.rms or error.rms > MATCHED * smallest:
            return False
    return True


def _doubts(
    points: Points, views: list[View], fit: Leverage, simulation: Simulation, signs
) -> tuple[Doubt, ...]:
    """One record per doubtful sweep, of its worst channel; a sweep's conditions only where itself is not in doubt."""
    out: list[Doubt] = []
    for view in sorted(views, key=lambda v: (not v.group.whole, -v.error.ratio)):
        group, error = view.group, view.error
        if any(set(group.index) <= set(d.index) for d in out):
            continue
        looks = explanation(points.select(group.shown), predictions(fit, group), simulation, signs)
        out.append(
            Doubt(
                sweep=group.name,
                file=group.file,
                index=group.index,
                channel=error.channel,
                rms=error.rms,
                ratio=error.ratio,
                share=error.share,
                looks=looks,
            )
        )
    return tuple(out)

"""Coefficients that another campaign measured on the same tyre, such as longitudinal slip on a belt for a disc's file.

Friction is a number of tyre and surface. Where both campaigns swept the sideslip angle upright at the same loads and pressure,
the ratio of the two fitted lateral frictions is the ratio of grips of the two surfaces. Longitudinal friction is multiplied by
it, and the factors of slip in the weights of combined slip are divided by it, because the slip at which the contact slides is
proportional to friction.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from mffit.constants import ZERO_CAMBER
from mffit.fit import constants
from mffit.fit.bands import BandOfCombined
from mffit.fit.borrowed.sister import BY_FRICTION, LENT, OVER_SLIP
from mffit.fit.coefficients import Coefficient
from mffit.fit.known import DETERMINED, Known
from mffit.fit.posterior import Posterior
from mffit.fit.relaxation import DIRECTIONS
from mffit.fit.upright import sideways
from mffit.fit.wheel.vertical import OF_RADII
from mffit.fit.wording import combined_sentence
from mffit.points import Points, levels
from mffit.rounding import ascii_only, to_uncertainty
from tir import Quantity, Tyre
from tir.derivatives import gradient, plain, traced
from tir.parameters import BY_NAME, TABLE

GROUPS = {
    "longitudinal and combined slip": LENT,
    "overturning moment": tuple(row.name for row in TABLE if row.channel == "Mx"),
    "rolling resistance": tuple(row.name for row in TABLE if row.channel == "My"),
    "vertical stiffness and radii": OF_RADII,
    **{direction.title.lower(): direction.names for direction in DIRECTIONS},
}
"""What a campaign may give, each group as a whole: its coefficients were fitted together."""


class FittedCampaign(NamedTuple):
    """Another campaign of the same tyre, fitted by itself."""

    name: str  #: of its tyre.toml, as the project names it
    tyre: Tyre
    coefficients: Mapping[str, Coefficient]
    posterior: Posterior
    shared: tuple[np.ndarray, float] | None
    """Loads (n,) [N] and pressure [Pa] at which both campaigns swept the sideslip angle upright; None without any."""
    rig: Mapping[str, tuple[float, float]] = MappingProxyType({})
    """Errors of its rig with standard errors; numbers of the campaign or of its set-ups, as joined points call them."""
    misfit: str = ""  #: of its own fit, by channel, in words
    combined: BandOfCombined | None = None  #: of its own fit, where slip was run at one sideslip only

    @property
    def groups(self) -> dict[str, tuple[str, ...]]:
        """The groups in which it determined at least one coefficient, with all their coefficients."""
        return {
            words: names
            for words, names in GROUPS.items()
            if any(self.coefficients[name].status in DETERMINED for name in names)
        }

    def vertical(self) -> dict[str, float]:
        """Vertical stiffness and radii, if the campaign measured them: the rolling radius of a fit depends on them."""
        found = "vertical stiffness and radii" in self.groups
        return {name: self.coefficients[name].value for name in OF_RADII} if found else {}


@dataclass(frozen=True, slots=True)
class Joined:
    """What another campaign gave to a fitted tyre."""

    campaign: FittedCampaign
    grip: Quantity  #: friction of this campaign's surface over that of the other
    groups: tuple[str, ...]  #: in words
    found: Mapping[str, Quantity]  #: every coefficient with its standard uncertainty
    u_scatter: float  #: of the logarithm of the ratio, beyond the two fits
    posterior: Posterior  #: of the fitted coefficients and of these

    @property
    def values(self) -> dict[str, float]:
        """The coefficients, and the range of longitudinal slip that the other campaign covers."""
        driven = any(name in self.found for name in ("PCX1", "PDX1", "PKX1"))
        ends = {name: float(self.campaign.tyre[name]) for name in ("KPUMIN", "KPUMAX") if driven}
        return {name: q.value for name, q in self.found.items()} | ends

    def drawn(self, values: Mapping[str, Any], random: np.random.Generator) -> dict[str, float]:
        """The joined coefficients of a tyre whose other ``values`` were drawn before."""
        other = self.campaign
        names = [name for name in other.posterior.names if name in BY_NAME]
        rows = [other.posterior.names.index(name) for name in names]
        covariance = other.posterior.covariance[np.ix_(rows, rows)]
        mean = np.array([float(other.tyre[name]) for name in names])
        theirs = dict(zip(names, random.multivariate_normal(mean, covariance, method="eigh"), strict=True))
        theirs = {**{n: q.value for n, q in other.coefficients.items()}, **theirs}
        log = _log_of_grip(values, theirs, other.shared).value + self.u_scatter * random.standard_normal()
        known = frozenset(names)
        out = {}
        for name, q in self.found.items():
            own = theirs[name] if name in known else theirs[name] + q.u * random.standard_normal()
            out[name] = own * math.exp(_power(name) * log)
        return out


def shared_conditions(one: Points, other: Points) -> tuple[np.ndarray, float] | None:
    """Loads (n,) [N] and the pressure [Pa] at which both swept the sideslip angle upright, rolling freely; None without any."""
    mine, theirs = (_swept(points) for points in (one, other))
    pairs = [
        (0.5 * (a + c), 0.5 * (b + d), k)
        for a, b, k in mine
        for c, d, _ in theirs
        if abs(a / c - 1.0) < constants.SAME_LOAD_OF_CAMPAIGNS and abs(b - d) < levels.PRESSURE.tolerance
    ]
    if not pairs:
        return None
    pressures = [p for _, p, _ in pairs]
    main = max(pressures, key=lambda p: sum(k for _, q, k in pairs if abs(q - p) < levels.PRESSURE.tolerance))
    loads = {round(load, 3) for load, p, _ in pairs if abs(p - main) < levels.PRESSURE.tolerance}
    return np.array(sorted(loads)), float(main)


def _swept(points: Points) -> list[tuple[float, float, int]]:
    """Load, pressure and number of points of every condition with a sweep of the upright wheel to either side."""
    upright = points.select(points.free_rolling & (np.abs(points.gamma) < ZERO_CAMBER.rad))
    if not len(upright):
        return []
    load, p = levels.level_values(upright.Fz, levels.LOAD), levels.level_values(upright.p, levels.PRESSURE)
    found = []
    for where in {(a, b) for a, b in zip(load.tolist(), p.tolist(), strict=True) if np.isfinite(a + b)}:
        alpha = upright.alpha[(load == where[0]) & (p == where[1])]
        if min(alpha.max(), -alpha.min()) >= constants.SIDESLIP_THAT_SHOWS_GRIP.rad:
            found.append((*where, len(alpha)))
    return found


def join(campaign: FittedCampaign, known: Known, posterior: Posterior) -> Joined:
    """What the campaign gives to a fitted tyre: groups that its own points and the engineer did not decide."""
    taken = {words: names for words, names in campaign.groups.items() if not _decided(names, known)}
    wanted = [name for names in taken.values() for name in names if name not in known.hand.names]
    wanted = [
        name
        for name in dict.fromkeys(wanted)
        if known.origin[name] not in ("measured", "fitted", "regularised")
    ]
    theirs = {name: c.value for name, c in campaign.coefficients.items()}
    own_rows = [i for i, name in enumerate(posterior.names) if name not in wanted]
    own = [posterior.names[i] for i in own_rows]
    other = list(campaign.posterior.names)
    alone = [n for n in wanted if n not in other and campaign.coefficients[n].stderr]
    log = _log_of_grip(known.values, theirs, campaign.shared, own, other)
    scatter = max(log.scatter, 0.0) if campaign.shared else float(constants.UNKNOWN_RATIO_OF_GRIPS)
    spread = [campaign.coefficients[name].stderr or 0.0 for name in alone]
    sizes = [len(own), len(other), 1, len(alone)]
    every = np.zeros((sum(sizes), sum(sizes)))
    blocks = (
        posterior.covariance[np.ix_(own_rows, own_rows)],
        campaign.posterior.covariance,
        np.array([[scatter**2]]),
        np.diag(np.square(spread)) if alone else np.zeros((0, 0)),
    )
    at = np.cumsum([0, *sizes])
    for begin, end, block in zip(at[:-1], at[1:], blocks, strict=True):
        every[begin:end, begin:end] = block
    by_log = np.concatenate([log.slope, [1.0], np.zeros(len(alone))])
    values, rows = {}, []
    for name in wanted:
        factor = math.exp(_power(name) * log.value)
        values[name] = theirs[name] * factor
        row = values[name] * _power(name) * by_log
        if name in other:
            row[at[1] + other.index(name)] += factor
        elif name in alone:
            row[at[3] + alone.index(name)] += factor
        rows.append(row)
    through = np.vstack([np.eye(len(own), sum(sizes)), *rows])
    whole = through @ every @ through.T
    u = np.sqrt(np.diag(whole)).tolist()[len(own) :]
    ratio = math.exp(log.value)
    return Joined(
        campaign=campaign,
        grip=Quantity(ratio, ratio * math.sqrt(float(by_log @ every @ by_log)), "-"),
        groups=tuple(taken),
        found={n: Quantity(values[n], s, BY_NAME[n].unit) for n, s in zip(wanted, u, strict=True)},
        u_scatter=scatter,
        posterior=Posterior((*own, *wanted), whole),
    )


def _decided(names: Collection[str], known: Known) -> bool:
    """Whether the campaign's own points decide coefficients of a group, radii apart: a disc measures these otherwise."""
    return any(known.origin[name] in ("fitted", "regularised") for name in names)


def _power(name: str) -> int:
    """Exponent of the ratio of grips in a coefficient."""
    if any(name in pair for pair in BY_FRICTION):
        return 1
    return -OVER_SLIP[name][0] if name in OVER_SLIP else 0


class _LogOfGrip(NamedTuple):
    """Logarithm of the ratio of lateral frictions: its mean over the shared loads."""

    value: float
    slope: np.ndarray  #: (k,) by the named numbers of both tyres
    scatter: float  #: standard deviation of the mean, from the scatter over the loads


def _log_of_grip(
    values: Mapping[str, Any],
    theirs: Mapping[str, Any],
    shared: tuple[np.ndarray, float] | None,
    by: Sequence[str] = (),
    by_theirs: Sequence[str] = (),
) -> _LogOfGrip:
    """The ratio of this tyre's friction to that of the other campaign; 1 without shared conditions."""
    slope = np.zeros(len(by) + len(by_theirs))
    if shared is None:
        return _LogOfGrip(0.0, slope, 0.0)
    loads, pressure = shared
    logs = []
    for sign, content, names, begin in ((1.0, values, by, 0), (-1.0, theirs, by_theirs, len(by))):
        free = traced({name: float(content[name]) for name in names if name in BY_NAME})
        mu, _ = sideways({**values, **content, **free}, loads, pressure)
        logs.append(sign * np.log(np.broadcast_to(plain(mu), len(loads))))
        if free:
            relative = np.mean(gradient(mu, list(free.values())) / plain(mu)[:, None], axis=0)
            slope[[begin + names.index(name) for name in free]] = sign * relative
    log = logs[0] + logs[1]
    n = len(loads)
    scatter = float(np.std(log, ddof=1)) / math.sqrt(n) if n > 1 else 0.0
    return _LogOfGrip(float(np.mean(log)), slope, scatter)


def campaign_sentence(joined: Joined) -> str:
    """What came from another campaign, and the ratio of grips with what it rests on."""
    if not joined.found:
        return f"The campaign {joined.campaign.name} measured nothing that this one lacks."
    shared, grip = joined.campaign.shared, joined.grip
    if shared is None:
        rests = (
            f"The friction of the two surfaces is taken as equal to within {joined.u_scatter:.0%}, because no sideslip sweep of "
            "the upright wheel was run at one load and pressure in both"
        )
    else:
        loads = ", ".join(f"{load:.0f}" for load in shared[0])
        rests = (
            f"Grip here is {to_uncertainty(grip.value, grip.u)} +- {to_uncertainty(grip.u, grip.u)} times that there, from the "
            f"lateral friction at {loads} N, {shared[1] / 1e3:.0f} kPa, and longitudinal friction is scaled by it"
        )
    own = f" Its own fit leaves {joined.campaign.misfit}." if joined.campaign.misfit else ""
    between = combined_sentence(joined.campaign.combined) if joined.campaign.combined else ""
    own += f" There {between}." if between else ""
    return ascii_only(f"From the campaign {joined.campaign.name}: {', '.join(joined.groups)}. {rests}.{own}")

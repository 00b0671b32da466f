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

from mffit.constants import UPRIGHT
from mffit.fit import constants
from mffit.fit.bands import BandOfCombined
from mffit.fit.beside import BesideNumbers
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
    beside: BesideNumbers  #: the coefficients, those of friction following this campaign's
    found: Mapping[str, Quantity]  #: each of them with its standard uncertainty
    u_scatter: float  #: of the logarithm of the ratio, beyond the two fits

    @property
    def values(self) -> dict[str, float]:
        """The coefficients, and the range of longitudinal slip that the other campaign covers."""
        driven = any(name in self.found for name in ("PCX1", "PDX1", "PKX1"))
        ends = {name: float(self.campaign.tyre[name]) for name in ("KPUMIN", "KPUMAX") if driven}
        return {**self.beside.values, **ends}


def shared_conditions(one: Points, other: Points) -> tuple[np.ndarray, float] | None:
    """Loads (n,) [N] and the pressure [Pa] at which both swept the sideslip angle upright, rolling freely; None without any."""
    mine, theirs = (_swept(points) for points in (one, other))
    pairs = [
        (0.5 * (a + c), 0.5 * (b + d), k)
        for a, b, k in mine
        for c, d, _ in theirs
        if abs(a / c - 1.0) < levels.LOAD.tolerance and abs(b - d) < levels.PRESSURE.tolerance
    ]
    if not pairs:
        return None
    pressures = [p for _, p, _ in pairs]
    main = max(pressures, key=lambda p: sum(k for _, q, k in pairs if abs(q - p) < levels.PRESSURE.tolerance))
    loads = {round(load, 3) for load, p, _ in pairs if abs(p - main) < levels.PRESSURE.tolerance}
    return np.array(sorted(loads)), float(main)


def _swept(points: Points) -> list[tuple[float, float, int]]:
    """Load, pressure and number of points of every condition with a sweep of the upright wheel to either side."""
    upright = points.select(points.free_rolling & (np.abs(points.gamma) < UPRIGHT.rad))
    if not len(upright):
        return []
    load, p = levels.level_values(upright.Fz, levels.LOAD), levels.level_values(upright.p, levels.PRESSURE)
    found = []
    for where in {(a, b) for a, b in zip(load.tolist(), p.tolist(), strict=True) if np.isfinite(a + b)}:
        alpha = upright.alpha[(load == where[0]) & (p == where[1])]
        if min(alpha.max(), -alpha.min()) >= constants.LARGE_SIDESLIP.rad:
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
    own, theirs = posterior.without(wanted), campaign.posterior
    values = {name: c.value for name, c in campaign.coefficients.items()}
    log = _log_of_grip(known.values, values, campaign.shared, own.names, theirs.names)
    by_own, by_theirs = np.split(log.slope, [len(own.names)])
    scatter = log.scatter if campaign.shared else float(constants.UNKNOWN_RATIO_OF_GRIPS)
    factor = {name: math.exp(_power(name) * log.value) for name in wanted}
    found = {name: factor[name] * values[name] for name in wanted}
    by_log = np.array([_power(name) * x for name, x in found.items()])
    slope, alone = np.outer(by_log, by_theirs), np.zeros(len(wanted))
    for row, name in enumerate(wanted):
        if name in theirs.names:
            slope[row, theirs.names.index(name)] += factor[name]
        else:
            alone[row] = factor[name] * (campaign.coefficients[name].stderr or 0.0)
    beside = BesideNumbers(
        values=found,
        covariance=slope @ theirs.covariance @ slope.T
        + scatter**2 * np.outer(by_log, by_log)
        + np.diag(alone**2),
        leans_on=own.names,
        slope=np.outer(by_log, by_own),
    )
    u = own.with_numbers(beside).stderr
    parts = ((by_own, own.covariance), (by_theirs, theirs.covariance))
    u_log = math.sqrt(scatter**2 + sum(float(by @ covariance @ by) for by, covariance in parts))
    return Joined(
        campaign=campaign,
        grip=Quantity(math.exp(log.value), math.exp(log.value) * u_log, "-"),
        groups=tuple(taken),
        beside=beside,
        found={name: Quantity(x, u[name], BY_NAME[name].unit) for name, x in found.items()},
        u_scatter=scatter,
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

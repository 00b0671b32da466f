"""The judgement whether a result can be trusted, for terminal, page, JSON and file.

Some rules judge the direct measurement and need no fit; all others judge a fitted model.

If noise is stated, the misfit is compared with it. No formula describes a real tyre to within the noise of a sensor: smooth model
error that is common to all sweeps is reported as a limit with its size, and does not count against the readings. Reasons against
trust are sweeps that contradict the others, scatter beyond the noise, and misfit that a rig error explains better than smooth
model error.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import chdtr, chdtrc, fdtrc, ndtr

from mffit.as_json import keys
from mffit.constants import (
    CAMBER_OF_SLOPES,
    CERTAIN_SIGMA,
    FALSE_ALARM,
    FEWEST,
    MISFIT_AT_NOISE,
    MOST,
    NAMED_IN_SENTENCE,
    ODD_SWEEP_RATIO,
)
from mffit.measured import Drift, LoadResult, OneWayLag, SideslipZeros
from mffit.measured.result import path_in_words, usual_ply_steer
from mffit.points import Points
from mffit.points.noise import OverNoise, estimated_noise, over_noise, stating
from mffit.quantities import CHANNELS, column
from mffit.rig import Readings
from mffit.rig_errors import error_of, shown, words_of
from mffit.rounding import rounded
from mffit.scatter import EFFICIENCY, clearly_below_zero, finite_median, rms
from mffit.suspicion import constants
from mffit.suspicion.others import Doubt
from mffit.suspicion.rule import Facts, Outcome, Rule, When, rule
from mffit.suspicion.unpublished import OF_MOTORCYCLES, TYRES, causes
from tir.errors import listed
from tir.frozen import ReadOnlyArrays

if TYPE_CHECKING:
    from mffit.linearised import LinearisedFit


@dataclass(frozen=True, slots=True)
class LeftOutSweeps:
    """Prediction errors of left-out sweeps in one channel [N] or [Nm]."""

    sweeps: int  #: number of sweeps
    fitted: float  #: rms residual of the fit
    predicted: float  #: rms prediction error of left-out sweeps
    typical: float  #: median over the sweeps of their rms prediction error


@dataclass(frozen=True, slots=True)
class HeldNumber:
    """A number at a bound or a physical limit, or held by hand."""

    name: str
    sigma: float  #: standard deviations by which the readings contradict the bound or value
    share: float  #: share of the residual sum of squares that it causes
    by_hand: bool = False  #: whether [coefficients] holds or bounds it
    physical: bool = False  #: whether it is a limit of the curves, such as E <= 1, not of published tyres


keys(HeldNumber, "name sigma share")


@dataclass(frozen=True, kw_only=True)
class JudgedMeasurement:
    """Inputs of the rules of trust that need no fit."""

    points: Points
    nominal: LoadResult | None = None  #: result at the nominal load
    radius_counts: bool = True  #: False if r_e was measured along the path, so that an error of R cancels
    sideslip_zeros: tuple[SideslipZeros, ...] = ()  #: of every set-up with several zeros in both directions
    drift: Drift | None = None  #: drift between sweeps, if the temperature is unknown
    lag: OneWayLag | None = None  #: of moving sweeps that all go one way


@dataclass(frozen=True, kw_only=True)
class FinishedFit(ReadOnlyArrays, JudgedMeasurement):
    """Inputs of the rules of trust after a fit."""

    model: Readings  #: readings of the fitted model
    used: Mapping[str, np.ndarray]  #: by channel, mask (n,) of the readings with non-zero weight
    r2: Mapping[str, float]  #: by channel, share of the variance that the model explains
    left_out: Mapping[str, LeftOutSweeps] = field(default_factory=dict)
    linear: LinearisedFit | None = None
    """Linear model of the residuals; None if all residuals count as noise."""
    against: tuple[Doubt, ...] = ()  #: sweeps that contradict the others, the worst first
    cause: str = ""  #: the effect that would explain most of the residuals, in words
    undeclared: str = ""  #: key of [rig] that declares the cause as absent; empty if none does
    cause_is_certain: bool = False  #: whether neither chance nor smooth model error explains the residuals
    cause_is_most: bool = False  #: whether the cause explains most of the residuals, of stated noise or not
    held: tuple[HeldNumber, ...] = ()
    rig: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Fitted rig errors and environment terms: (value, standard uncertainty)."""
    at_limits: tuple[str, ...] = ()
    """Free coefficients at bounds, at physical limits or outside the range of usual tyres."""
    free: int = 0  #: number of free coefficients
    left: float = 0.0  #: predicted decrease of the sum of squares by one more step: 0 at the minimum
    broken: tuple[str, ...] = ()  #: errors that the check finds in the written files, as sentences

    @property
    def averaged(self) -> bool:
        """Whether points are means of a recording's rests, with the standard error of the mean as their uncertainty."""
        return bool(np.any((self.points.last_line > self.points.line) & ~self.points.continuous))

    def misfit(self, channel: str, rows: np.ndarray | None = None) -> OverNoise:
        """Misfit over the stated noise at the used readings, or at those of them in the mask ``rows`` (n,)."""
        return self._over(self.points.u(channel), channel, rows)

    def over_scatter(self, channel: str, rows: np.ndarray | None = None) -> OverNoise:
        """Misfit of the used readings without stated noise, over the noise estimated from neighbouring readings."""
        silent = ~stating(self.points.u(channel))
        return self._over(np.where(silent, self.scatter[channel], np.nan), channel, rows)

    def _over(self, u: np.ndarray, channel: str, rows: np.ndarray | None) -> OverNoise:
        used = self.used[channel] if rows is None else self.used[channel] & rows
        return over_noise(self.model[channel], self.points.channel(channel), u, used)

    @cached_property
    def scatter(self) -> dict[str, float]:
        """By channel, the noise estimated from neighbouring readings, for readings without stated noise."""
        return estimated_noise(self.points, {name: self.model[name] for name in self.used})

    @property
    def over_noise(self) -> dict[str, float]:
        """By channel, misfit over stated noise; NaN if no noise is stated."""
        return {name: self.misfit(name).ratio for name in self.used}

    def rough(self, channel: str, limit: float, sigma: float) -> bool:
        """Whether a misfit that is neither smooth nor scatter between runs exceeds ``limit`` times the noise, at ``sigma``."""
        seen = self.misfit(channel)
        if self.linear is None or channel not in self.linear.channels:
            return far(seen, limit, sigma)
        own = self.linear.channels[channel]
        return (
            seen.n > 0
            and min(seen.ratio, own.components.noise) > limit
            and own.proof_of_noise > 0.5 * sigma**2
        )

    def doubtful(self, channel: str) -> bool:
        """Whether the rough part of a misfit significantly exceeds the noise."""
        return self.rough(channel, MISFIT_AT_NOISE, constants.DOUBTFUL_SIGMA)

    def at_the_noise(self, channel: str) -> bool:
        """Whether all residuals of a channel are noise, as stated or as estimated from neighbouring readings.

        False if the misfit is far below the stated noise, because readings and noise are then in different units.
        """
        stated, seen = self.misfit(channel), self.over_scatter(channel)
        seen = seen._replace(of_noise=EFFICIENCY * seen.n)  # the estimated noise is itself uncertain
        if any(far(one, MISFIT_AT_NOISE, constants.DOUBTFUL_SIGMA) for one in (stated, seen)):
            return False
        return stated.ratio > constants.MISFIT_OF_ANOTHER_UNIT if stated.n else bool(seen.n)

    def wrong(self, channel: str, rows: np.ndarray | None = None) -> bool:
        """Whether the misfit of a channel exceeds the noise so far that the fit is not trusted, smooth or not."""
        return far(self.misfit(channel, rows), constants.DISTRUSTED_MISFIT, CERTAIN_SIGMA)

    def contradicts(self, channel: str, k: int) -> bool:
        """Whether the sweep with index ``k`` contradicts the others; always True without a linear model."""
        return self.linear is None or any(
            k in self.points.sweep[one.index] and channel in one.channels for one in self.against
        )

    def beyond_scatter(self, channel: str) -> bool:
        """Whether the misfit of a channel exceeds the noise although its readings hardly scatter within a sweep."""
        if self.linear is None or channel not in self.linear.channels:
            return False
        seen = self.linear.channels[channel]
        over = OverNoise(seen.misfit / seen.components.noise, len(seen.rows))
        return far(over, MISFIT_AT_NOISE, constants.DOUBTFUL_SIGMA) and not self.doubtful(channel)


def far(found: OverNoise, limit: float, sigma: float) -> bool:
    """Whether a misfit over the noise exceeds ``limit`` and is significant at ``sigma`` standard deviations."""
    if not found.n or not found.ratio > limit:
        return False
    square = found.ratio**2
    if np.isinf(found.of_noise):
        return bool(chdtrc(found.n, found.n * square) < ndtr(-sigma))
    return bool(fdtrc(found.n, found.of_noise, square) < ndtr(-sigma))


@dataclass(frozen=True, slots=True)
class Trust:
    """The judgement of a result."""

    reasons: tuple[str, ...] = ()  #: reasons against trust; empty for a sound result
    doubts: tuple[str, ...] = ()  #: points that the engineer should check
    remarks: tuple[str, ...] = ()  #: limits of a sound result
    limited: tuple[str, ...] = ()  #: channels that are missed beyond the scatter within their sweeps
    over_noise: Mapping[str, float] = field(default_factory=dict)
    """By channel, misfit over stated noise; NaN if no noise is stated."""

    @property
    def trusted(self) -> bool:
        """Whether there is no reason against the result."""
        return not self.reasons


SOUND = Trust()
"""The judgement without reasons or doubts."""
NONE_KNOWN = "no known effect explains it"
of_model = partial(rule, when=When.AFTER)
of_measurement = partial(rule, when=When.MEASURED)


@of_model(
    id="search-not-ended",
    outcome=Outcome.DISTRUSTED,
    sentence="the search for the best fit is stuck: one more step promises to lower the sum of squares by {left:.3g}, where 1 is "
    "a standard uncertainty, and does not; the numbers are not those of the best fit; hold one of the coefficients at a limit "
    "under [coefficients]{held}, and build again",
)
def not_ended(fit: FinishedFit) -> Iterator[Facts]:
    """Fall of the sum of squares that an undamped step from the end of the search promises; 0 at a minimum."""
    if fit.left > constants.DOUBTFUL_SIGMA**2:
        names = ", ".join(held.name for held in fit.held)
        yield {"left": fit.left, "held": f" ({names})" if names else ""}


@of_model(
    id="misfit-above-noise",
    outcome=Outcome.GRADED,
    sentence="the model misses {channel} by {ratio:.3g} times {noise}, most in {carriers}; {cause}; check these sweeps and the "
    "uncertainty, or run mffit diagnose",
)
def above_noise(fit: FinishedFit) -> Iterator[Facts]:
    """Scatter over the uncertainty, channel by channel, or a misfit that an effect explains better than model error.

    It contradicts an uncertainty that was stated. That of means of a recording is the scatter within each rest, and nobody said
    that rests differ by no more.
    """
    noise = "the scatter within its rests" if fit.averaged else "its stated uncertainty"
    for name in fit.used:
        rough = fit.rough(name, constants.DISTRUSTED_MISFIT, CERTAIN_SIGMA)
        certain = rough or (fit.wrong(name) and fit.cause_is_certain and not fit.against)
        if certain or fit.doubtful(name):
            facts = {"channel": name, "ratio": fit.misfit(name).ratio, "carriers": _carriers(fit, name)}
            yield {**facts, "noise": noise, "cause": _cause(fit), "asked": fit.averaged or not certain}


@of_model(
    id="sweep-above-noise",
    outcome=Outcome.DISTRUSTED,
    sentence="the model misses {channel} of {sweep} by {ratio:.1f} times {noise}, beyond chance{others}{cause}; "
    "check this sweep or repeat it",
)
def sweep_above_noise(fit: FinishedFit) -> Iterator[Facts]:
    """Misfit of a sweep that contradicts all others over its stated noise, or over its scatter and the median sweep's misfit."""
    said = not all(map(above_noise.only_asks, above_noise.find(fit)))  # with the cause
    for name in fit.used:
        seen = _by_sweep(fit, name)
        off = {
            k: one.ratio
            for k, one in {**_odd(fit, name), **seen}.items()
            if far(one, constants.DISTRUSTED_MISFIT, CERTAIN_SIGMA) and fit.contradicts(name, k)
        }
        if off:
            first = {int(fit.points.sweep[one.index[0]]): -i for i, one in enumerate(fit.against)}
            worst = max(off, key=lambda k: (first.get(k, -len(first)), off[k]))
            others = [fit.points.sweep_names[k] for k in sorted(off, key=lambda k: -off[k]) if k != worst]
            yield {
                "channel": name,
                "sweep": fit.points.sweep_names[worst],
                "ratio": off[worst],
                "noise": "its stated uncertainty" if worst in seen else SCATTER,
                "others": f" (also {', '.join(others[:NAMED_IN_SENTENCE])})" if others else "",
                "cause": "" if said else f"; {_cause(fit)}",
            }


SCATTER = (
    "the scatter of neighbouring readings (none states its uncertainty) and far more than the usual sweep"
)


def _odd(fit: FinishedFit, channel: str) -> dict[int, OverNoise]:
    """Misfit over the scatter of neighbouring readings, of sweeps without stated noise and with far more than median misfit."""
    missed = np.where(fit.used[channel], fit.model[channel] - fit.points.channel(channel), np.nan)
    own = {k: rms(missed[rows]) for k, rows in fit.points.rows_of_sweeps.items()}
    odd = ODD_SWEEP_RATIO * finite_median(np.array(list(own.values())))
    return {k: fit.over_scatter(channel, fit.points.sweep == k) for k, size in own.items() if size > odd}


@of_model(
    id="unexplained-variance",
    outcome=Outcome.DISTRUSTED,
    sentence="the model explains {percent:.0f} % of the variance of {channel}{where}; are these readings of free rolling at "
    "steady state, of one tyre and one rig, and their units and axes right?",
)
def unexplained(fit: FinishedFit) -> Iterator[Facts]:
    """Share of a channel's variance that the model explains, unless it is noise; without a stated one also of left-out sweeps."""
    for name, seen in fit.r2.items():
        share, where, out = seen, "", fit.left_out.get(name)
        if out is not None and out.sweeps >= FEWEST and not fit.misfit(name).n:
            predicted = 1.0 - (out.typical / float(np.nanstd(fit.points.channel(name)))) ** 2
            if predicted < share:
                share, where = predicted, " in a sweep to which it is not fitted (median)"
        if share < 1.0 - share and not fit.at_the_noise(name):  # more is left than explained
            yield {"channel": name, "percent": 100.0 * max(share, 0.0), "where": where}


@of_model(
    id="held-against-the-data",
    outcome=Outcome.GRADED,
    sentence="{what} ({sigma:.2g} standard deviations, {percent:.0f} % of the misfit): {cure}",
)
def held_against_data(fit: FinishedFit) -> Iterator[Facts]:
    """Misfit that is due to a value or bound set by hand or, where the noise is stated, to a bound of published tyres or a limit
    of the curves, such as E <= 1; distrusted for such a limit, and for what is set by hand if most of the misfit is due to it.
    """
    stated = _noise_is_stated(fit)
    for held in fit.held:
        name, asked = held.name, not held.physical
        certain = stated and held.sigma > CERTAIN_SIGMA and held.share > constants.LEAST_SHARE_OF_A_LIMIT
        if held.by_hand:
            certain = held.sigma > constants.DOUBTFUL_SIGMA
            asked = held.sigma <= CERTAIN_SIGMA or held.share <= MOST
            what = f"the readings contradict what [coefficients] sets for {name}"
            cure = f"the other coefficients take up the difference; check {name}, or free it"
        elif held.physical:
            what = f"a limit of the curves holds {name} against the readings"
            cure = f"no curve of the formula fits these sweeps; check what determines {name}"
        else:
            what = (
                f"the readings ask for more of {name} than any published tyre has, at whose bound it is held"
            )
            bounds = f"{name} = {{ min = ..., max = ... }}"
            cure = f"check what determines {name}, or widen its bounds with {bounds} under [coefficients]"
        if certain:
            facts = {"what": what, "sigma": held.sigma, "percent": 100.0 * held.share, "cure": cure}
            yield facts | {"asked": asked}


@of_model(
    id="physical-limit-broken",
    outcome=Outcome.DISTRUSTED,
    sentence="the file breaks a physical limit: {problem}",
)
def limit_broken(fit: FinishedFit) -> Iterator[Facts]:
    """Errors that `mffit check` finds in the written files."""
    yield from ({"problem": problem} for problem in fit.broken)


@of_measurement(
    id="contradictory-sideslip-zeros",
    outcome=Outcome.GRADED,
    sentence="the sideslip zeros of {setup} contradict each other: alpha_M = {one} and {other}, as one axis and the ply-steer of "
    "one tyre cannot be; if the rig was set up anew in between, give these sweeps setups of different names; if not, the axis "
    "moved, or a direction, path_centre or zero is wrong: check the zeros there",
)
def zeros_contradict(measured: JudgedMeasurement) -> Iterator[Facts]:
    """Sideslip zeros of one set-up, from forward and backward runs at all its loads and paths: they are one angle."""
    for z in measured.sideslip_zeros:
        if z.chance < ndtr(-constants.DOUBTFUL_SIGMA):
            yield {**_apart(z), "asked": z.chance >= ndtr(-CERTAIN_SIGMA)}


def _apart(found: SideslipZeros) -> Facts:
    one, other = (
        f"{math.degrees(x.alpha_M.value):.3f} +- {math.degrees(x.alpha_M.u):.3f} deg at {x.load:.0f} N "
        f"(path centre {path_in_words(x.phi_t)})"
        for x in (found.one, found.other)
    )
    return {"setup": f"set-up {found.setup}" if found.setup else "one set-up", "one": one, "other": other}


@of_measurement(
    id="drift-between-sweeps",
    outcome=Outcome.WARNED,
    sentence="conditions that several sweeps repeat show a drift: forces of {most} are {percent:.1f} % larger than those of "
    "{least}, though no temperature was recorded that would explain it; eps_gamma is corrected for it as far as zeros and camber "
    "sweeps were repeated; record T_degC, or warm the tyre up and mix the order of the runs",
)
def drift_between_sweeps(measured: JudgedMeasurement) -> Iterator[Facts]:
    """Forces of conditions without sideslip that several sweeps repeat, where temperatures are not known."""
    if measured.drift is not None and measured.drift.counts:
        yield measured.drift._asdict() | {"percent": 100.0 * measured.drift.apart}


@of_measurement(
    id="sweeps-of-one-way",
    outcome=Outcome.WARNED,
    sentence="all moving sweeps of sideslip go one way, so that no reading shows by how much the force lags behind the angle: a "
    "usual tyre, with a relaxation length of {length:.2f} m, shifts them by {angle:.2f} deg{force}; the uncertainty includes it; "
    "sweep the other way, too, or slower over the road",
)
def sweeps_of_one_way(measured: JudgedMeasurement) -> Iterator[Facts]:
    """Lag of a usual tyre where no sweep goes the other way, if it exceeds the usual ply-steer, which looks like it."""
    lag = measured.lag
    if lag is not None and abs(lag.angle) > usual_ply_steer():
        row, force = measured.nominal, ""
        if row is not None and row.C_alpha is not None:
            force = f", {abs(row.C_alpha.value * lag.angle):.0f} N at {row.load:.0f} N"
        yield {"length": lag.length, "angle": abs(math.degrees(lag.angle)), "force": force}


@of_measurement(
    id="unpublished-camber-reduction",
    outcome=Outcome.WARNED,
    sentence="eps_gamma = {value:.3f} +- {u:.3f} is outside everything published ({published}); likeliest causes: {causes}",
)
def unpublished(measured: JudgedMeasurement) -> Iterator[Facts]:
    """Measured camber reduction factor against those of published tyres, of motorcycles alone if the tyre was leaned like one."""
    row, margin = measured.nominal, CERTAIN_SIGMA * OF_MOTORCYCLES.stdev
    if row is None or row.epsilon_gamma is None:
        return
    value, u = row.epsilon_gamma[:2]
    leaned = bool(np.any(np.abs(measured.points.gamma) > CAMBER_OF_SLOPES.rad))
    most = OF_MOTORCYCLES.mean + margin if leaned else constants.LARGEST_PUBLISHED_EPSILON
    if not OF_MOTORCYCLES.mean - margin <= value <= most:
        known = sorted(tyre.epsilon_gamma for tyre in TYRES)
        published = f"motorcycle tyres lie between {known[0]:.2f} and {known[-1]:.2f}"
        published += "" if leaned else ", car tyres between 0.43 and 0.7, truck tyres about 1"
        found = causes(row, radius_counts=measured.radius_counts)
        yield {"value": value, "u": u, "published": published, "causes": found}


@of_model(
    id="many-at-limits",
    outcome=Outcome.WARNED,
    sentence="{count} of {free} fitted coefficients are at a limit or outside the range of usual tyres ({names}): these "
    "limits decide what the sweeps do not show of this tyre; give a base of a similar tyre ([tyre] base), or more conditions",
)
def many_at_limits(fit: FinishedFit) -> Iterator[Facts]:
    """Share of the fitted coefficients that bounds, physical limits or no published tyre would have."""
    if len(fit.at_limits) > constants.LIMITS_IN_DOUBT * fit.free:
        yield {"count": len(fit.at_limits), "free": fit.free, "names": ", ".join(fit.at_limits)}


@of_model(
    id="sign-of-no-other-tyre",
    outcome=Outcome.WARNED,
    sentence="{what} is {value} +- {u} {unit}, and has the other sign in all published tyres and rigs: it takes up something "
    "else; repeat a condition to see whether it is there",
)
def sign_of_no_other(fit: FinishedFit) -> Iterator[Facts]:
    """Sign of a stiffness over temperature or of a hysteresis, beyond what chance explains."""
    for name, (number, spread) in fit.rig.items():
        error = error_of(name)
        if error is not None and clearly_below_zero(error.known_sign * number, spread):
            *found, unit = shown(name, number, spread)
            value, u = rounded(*found)
            yield {"what": words_of(name), "value": value, "u": u, "unit": unit}


@of_model(
    id="misfit-far-below-noise",
    outcome=Outcome.WARNED,
    sentence="the model misses {channel} by {ratio:.2g} times its stated uncertainty only, so that the readings and their "
    "uncertainty cannot be in the same unit: check the units of {column} and u_{column}",
)
def far_below_noise(fit: FinishedFit) -> Iterator[Facts]:
    """Misfit of the model over the stated uncertainty, where it is smaller than chance and the numbers of the fit explain."""
    numbers = 0 if fit.linear is None else len(fit.linear.numbers)
    for name in fit.used:
        ratio, n, _ = fit.misfit(name)
        few = n <= numbers or chdtr(n - numbers, n * ratio**2) > FALSE_ALARM
        if not few and ratio < constants.MISFIT_OF_ANOTHER_UNIT:
            yield {"channel": name, "ratio": ratio, "column": column(name)}


@of_model(
    id="effect-in-the-residuals",
    outcome=Outcome.GRADED,
    sentence="the readings {what}: {cause}; {cure}",
)
def effect_left(fit: FinishedFit) -> Iterator[Facts]:
    """Score test of every effect beside the fitted numbers, where noise is stated or one effect explains most of the misfit;
    distrusted for a rig error that [rig] declares as exactly known.
    """
    states = any(fit.misfit(name).n for name in fit.used)
    reported = any(any(rule.find(fit)) for rule in (above_noise, sweep_above_noise))
    if reported or not (fit.cause_is_certain and (states or fit.cause_is_most)):
        return
    what, cure = "show more than was declared and fitted", "run mffit diagnose"
    declared = bool(fit.undeclared and states)
    if declared:
        what = "contradict [rig], which declares as absent what the coefficients have taken up"
        cure = f"state {fit.undeclared} as large as that, and the fit finds it"
    yield {"what": what, "cause": fit.cause, "cure": cure, "asked": not declared}


@of_model(
    id="structure-in-the-residuals",
    outcome=Outcome.WARNED,
    sentence="the residuals of {channel} are more than noise: they change smoothly with {over}, by {size:.3g} {unit} rms",
)
def structure_left(fit: FinishedFit) -> Iterator[Facts]:
    """Evidence of model error, where the noise is stated and the model error does not exceed it."""
    from mffit.linearised.inputs import word_of

    for name, channel in fit.linear.channels.items() if fit.linear and _noise_is_stated(fit) else ():
        over = [word_of(one) for one in channel.proven_over] if channel.is_proven else []
        if over:
            facts = {"channel": name, "over": listed(over), "size": channel.size}
            yield {**facts, "unit": CHANNELS[name].unit}


@of_model(
    id="misfit-of-whole-sweeps",
    outcome=Outcome.WARNED,
    sentence="the model misses whole sweeps of {channel}, by {ratio:.3g} times the stated uncertainty, most {carriers}: they "
    "differ in a condition that is not stated, such as pressure (p_kPa) or temperature (T_degC), or the formula misses them, "
    "and these sweeps do not tell which; state the condition, or repeat them",
)
def whole_sweeps(fit: FinishedFit) -> Iterator[Facts]:
    """Misfit over the stated noise that is neither noise within the sweeps nor proven to be common to all of them."""
    for name, channel in fit.linear.channels.items() if fit.linear else ():
        beyond = fit.misfit(name).ratio > MISFIT_AT_NOISE and fit.beyond_scatter(name)
        if beyond and not channel.is_proven:
            yield {"channel": name, "ratio": fit.misfit(name).ratio, "carriers": _carriers(fit, name)}


def judge(found: JudgedMeasurement) -> Trust:
    """The judgement by all rules of trust, or without a fit by those that need none."""

    def said(*rules: Rule, doubtful: bool) -> tuple[str, ...]:
        return tuple(
            rule.said(facts)
            for rule in rules
            for facts in rule.find(found)
            if rule.only_asks(facts) == doubtful
        )

    if not isinstance(found, FinishedFit):
        rules = [rule for rule in OF_TRUST if rule.when is When.MEASURED]
        return Trust(said(*rules, doubtful=False), said(*rules, doubtful=True))
    reasons = said(*OF_TRUST, doubtful=False)
    doubts = said(*OF_TRUST, doubtful=True)
    # A misfit that one effect explains is not due to the formula.
    limited = tuple(name for name in found.used if found.beyond_scatter(name) and not found.cause_is_most)
    return Trust(reasons, doubts, over_noise=found.over_noise, limited=limited)


OF_TRUST = (
    not_ended,
    above_noise,
    sweep_above_noise,
    unexplained,
    limit_broken,
    zeros_contradict,
    drift_between_sweeps,
    sweeps_of_one_way,
    unpublished,
    held_against_data,
    many_at_limits,
    sign_of_no_other,
    far_below_noise,
    effect_left,
    structure_left,
    whole_sweeps,
)
"""All rules of trust, the most serious first."""


def _noise_is_stated(fit: FinishedFit) -> bool:
    """Whether residuals can be judged by stated noise: a channel states it, and no such channel is missed beyond its scatter."""
    stated = [name for name in fit.used if fit.misfit(name).n]
    return bool(stated) and not any(fit.beyond_scatter(name) for name in stated)


def _cause(fit: FinishedFit) -> str:
    """The certain cause of a misfit in words, or words for an unknown cause."""
    return fit.cause if fit.cause_is_certain else NONE_KNOWN


def _by_sweep(fit: FinishedFit, channel: str) -> dict[int, OverNoise]:
    """By sweep, misfit over the stated noise; without sweeps that state none."""
    found = {k: fit.misfit(channel, fit.points.sweep == k) for k in fit.points.rows_of_sweeps}
    return {k: seen for k, seen in found.items() if seen.n}


def _carriers(fit: FinishedFit, channel: str) -> str:
    """The sweeps with the largest misfits, in words; at least the worst one."""
    own = {k: seen.ratio for k, seen in _by_sweep(fit, channel).items()}
    worst = sorted(own, key=lambda k: -own[k])
    limit = constants.DISTRUSTED_MISFIT * fit.misfit(channel).ratio
    named = [k for k in worst if own[k] > limit][:NAMED_IN_SENTENCE] or worst[:1]
    return ", ".join(f"{fit.points.sweep_names[k]} ({own[k]:.1f} times)" for k in named)

"""Checks of all files together: copied sweeps, reversed signs, moment point, nominal load, and the points that a disc needs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from mffit.config import Config
from mffit.constants import CAMBER_OF_SLOPES, EXPLAINED_SHARE, FEWEST, HOTTEST_TREAD, STRAIGHT, UPRIGHT
from mffit.points import Points, levels
from mffit.quantities import CHANNELS
from mffit.suspicion import constants
from mffit.suspicion.groups import readings_of
from mffit.suspicion.rereadings import REVERSALS
from mffit.suspicion.rule import Facts, Outcome, When, rule
from mffit.suspicion.slopes import (
    SIGNS,
    Signatures,
    at_zero,
    contradictions,
    line,
    overturning_slope,
    pooled,
    signatures,
    slope,
)
from tir.constants import NEGLIGIBLE_SHARE


@rule(
    id="copied-sweep",
    sentence="holds exactly the readings of {first}; remove one of the two, or correct the one that was copied by mistake",
)
def copied_sweep(points: Points, config: Config) -> Iterator[Facts]:
    """Readings of a sweep that are all in another sweep; its points would count twice."""
    readings = readings_of(points)
    seen: dict[bytes, int] = {}
    for k, rows in points.rows_of_sweeps.items():
        if len(rows) < FEWEST or np.ptp(points.Fy[rows]) == 0.0:
            continue
        own = readings[rows]
        key = own[np.lexsort(own.T)].tobytes()
        if key in seen:
            first = points.sweep_names[seen[key]]
            yield {"file": points.files[points.file[rows[0]]], "first": first}
        seen[key] = k


@rule(
    id="reversed-file",
    sentence="{what} {where}, against all the others: {cause}",
)
def reversed_file(points: Points, config: Config) -> Iterator[Facts]:
    """Signs of the slopes, file by file, with the scatter of all files."""
    files = np.unique(points.file)
    if len(files) < 2:
        return
    each = [signatures(points.select(points.file == index, with_table=False)) for index in files]
    broken = []
    for k, own in enumerate(_with_common_scatter(each)):
        found = next(((sign, facts["column"]) for sign in SIGNS for facts in sign.find(own)), None)
        if found is not None:
            broken.append((k, *found))
    if not broken:
        return
    k, sign, column = broken[0]
    alike = [points.files[files[other]] for other, *rest in broken[1:] if rest == [sign, column]]
    where = f"in this file and in {', '.join(alike)}" if alike else "in this file alone"
    causes = []
    for mistake in REVERSALS:
        undone = signatures(mistake.undone(points.select(points.file == files[k]), {}))
        if mistake.column == "direction":  # a wheel that leans reads the same side force both ways
            undone = undone._replace(camber=each[k].camber)
        if not contradictions(_with_common_scatter([*each[:k], undone, *each[k + 1 :]])[k]):
            causes.append(mistake)
    said = " Or ".join(f"it looks like {mistake.looks}: {mistake.remedy}." for mistake in causes)
    cause = said.removesuffix(".") or "a sign looks reversed; correct the file"
    if len({mistake.column for mistake in causes}) == 1:
        column = causes[0].column
    facts = {"what": sign.sentence, "where": where, "cause": cause}
    yield {"file": points.files[files[k]], "column": column, **facts}


def _with_common_scatter(each: list[Signatures]) -> list[Signatures]:
    """The signatures of several files, with standard errors from the pooled scatter of all files."""
    names = ("cornering", "camber", "aligning", "backward")
    slopes = (pooled([getattr(own, name) for own in each]) for name in names)
    return [
        own._replace(cornering=cornering, camber=camber, aligning=aligning, backward=backward)
        for own, cornering, camber, aligning, backward in zip(each, *slopes, strict=True)
    ]


@rule(
    id="overturning-moment-reversed",
    outcome=Outcome.WARNED,
    sentence="Mx_Nm has the wrong sign: it rises with gamma_deg in ISO axes, and falls with it on every tyre, whose load moves "
    "to the side to which it leans; write scale = -1 for Mx_Nm under [columns], if its axis points the other way",
)
def moment_reversed(points: Points, config: Config) -> Iterator[Facts]:
    """Slope of Mx over camber."""
    if overturning_slope(points).sign > 0:
        yield {}


@rule(
    id="angles-exchanged",
    outcome=Outcome.WARNED,
    sentence="Fy_N changes {ratio:.0f} times as fast with gamma_deg as with alpha_deg, and on every known tyre slower: are both "
    "exchanged?",
)
def angles_exchanged(points: Points, config: Config) -> Iterator[Facts]:
    """Slope of Fy over camber, over that over sideslip; rolling forwards, both within the same range."""
    within = (
        np.maximum(np.abs(points.alpha), np.abs(points.gamma)) <= CAMBER_OF_SLOPES.rad
    ) & points.free_rolling
    used = within & (points.direction > 0) & (points.mount > 0)
    sideslip, camber = (slope(points, points.Fy, angle, used) for angle in ("alpha", "gamma"))
    if abs(camber.value) - camber.clear > abs(sideslip.value) + sideslip.clear:
        yield {"ratio": camber.value / sideslip.value}


@rule(
    id="angles-fit-exchanged",
    when=When.AFTER,
    sentence="alpha_deg and gamma_deg are exchanged: read the other way, the misfit of {channel} falls from {before:.3g} to "
    "{after:.3g} {unit}; exchange them under [columns], or their headings",
)
def angles_fit_exchanged(before: Mapping[str, float], after: Mapping[str, float]) -> Iterator[Facts]:
    """Misfit over that with both exchanged, where angles-exchanged asks."""
    if all(after[name] <= EXPLAINED_SHARE * before[name] for name in before):
        name = min(before, key=lambda name: after[name] / before[name])
        yield {
            "channel": name,
            "before": before[name],
            "after": after[name],
            "unit": CHANNELS[name].unit,
            "column": "alpha_deg",
        }


@rule(
    id="weak-turn-slip-force",
    outcome=Outcome.WARNED,
    sentence="the force at alpha = gamma = 0 is {percent:.1f} % of the load along the turn slip, too little to measure turn "
    "slip; check the alignment of the sideslip axis",
)
def weak_turn_slip(points: Points, config: Config) -> Iterator[Facts]:
    """Fy per load at alpha = gamma = 0, outwards, mean of both directions."""
    outward = signatures(points).outward
    if outward < NEGLIGIBLE_SHARE:
        yield {"percent": 100 * outward}


@rule(
    id="moments-about-another-point",
    sentence='with moments = "{declared}", Mx_Nm changes by {lever:.2f} m times Fy_N, which is about the wheel\'s radius; about '
    'the contact point it hardly changes; the data agree with moments = "{other}"',
)
def other_moment_point(points: Points, config: Config) -> Iterator[Facts]:
    """Lever arm of Mx over Fy of the upright wheel, per unloaded radius."""
    used = np.isfinite(points.Fy) & (np.abs(points.gamma) <= UPRIGHT.rad)
    found = line(points.Fy, points.Mx, used)
    least = abs(found.value) - found.clear
    if not least > config.tyre.unloaded_radius - least:  # nearer to the radius than to zero
        return
    key, declared = "rig.moments", config.rig.moments
    other = {"contact": "wheel-centre", "wheel-centre": "contact"}[declared]
    facts = {"declared": declared, "lever": found.value, "other": other}
    yield {"file": config.path, "line": config.line_of(key), "key": key, **facts}


@rule(
    id="one-sided-on-a-disc",
    sentence="runs only from {smallest:.3g} to {largest:.3g} deg in ISO signs, and on a disc both signs are needed to separate "
    "turn slip; add the mirrored points",
)
def one_sided_on_disc(points: Points, config: Config) -> Iterator[Facts]:
    """Signs of the angles on a disc, where turn slip is separated by mirror symmetry."""
    if not config.rig.on_disc:
        return
    for column, values, zero in (("alpha_deg", points.alpha, STRAIGHT), ("gamma_deg", points.gamma, UPRIGHT)):
        degrees = np.degrees(values)
        if (degrees.max() > zero) != (degrees.min() < -zero):
            facts = {"smallest": degrees.min(), "largest": degrees.max()}
            yield {"file": config.path, "column": column, **facts}


@rule(
    id="no-zero-on-a-disc",
    sentence="no forward point has alpha_deg = 0 and gamma_deg = 0, where the turn-slip force is measured; add one per load",
)
def no_zero_on_disc(points: Points, config: Config) -> Iterator[Facts]:
    """Forward points at alpha = gamma = 0 on a disc, where the turn-slip force is measured."""
    if config.rig.on_disc and not np.any(at_zero(points) & (points.direction > 0)):
        yield {"file": config.path, "column": "alpha_deg"}


class LevelsOfLoad(NamedTuple):
    """The lowest and the highest level of load [N]; NaN without loads."""

    lowest: float
    highest: float

    @classmethod
    def of(cls, points: Points) -> LevelsOfLoad:
        """The lowest and the highest level of load of some points."""
        loads = points.Fz[np.isfinite(points.Fz)]
        found = levels.level_values(loads, levels.LOAD) if len(loads) else np.array([np.nan])
        return cls(float(found.min()), float(found.max()))

    def below(self, nominal: float) -> bool:
        """Whether a nominal load [N] is clearly above the highest level."""
        return nominal > (1.0 + levels.LOAD.tolerance) * self.highest


@rule(
    id="nominal-load-of-other-loads",
    outcome=Outcome.WARNED,
    sentence="the nominal load of {nominal:g} N is {where} the measured loads of {lowest:.0f} to {highest:.0f} N, so that "
    "nothing was measured where the file is centred: check nominal_load (is a digit missing or too many?) and the unit of Fz_N",
)
def nominal_load_of_others(points: Points, config: Config) -> Iterator[Facts]:
    """Nominal load over the highest level of load, and the lowest level over the nominal load."""
    found, nominal = LevelsOfLoad.of(points), config.tyre.nominal_load
    if found.below(nominal):
        yield {"nominal": nominal, "where": "above", **found._asdict()}
    elif found.lowest / nominal > constants.BEYOND_NOMINAL:
        yield {"nominal": nominal, "where": "far below", **found._asdict()}


@rule(
    id="hot-tread",
    outcome=Outcome.WARNED,
    sentence="T_degC is {degrees:.0f} degC in the middle{where}, and no tread stays as hot: if the readings are in degF, write "
    'T_degC = {{ column = "...", unit = "degF" }} under [columns]',
)
def hot_tread(points: Points, config: Config) -> Iterator[Facts]:
    """Median of the temperatures of a file."""
    found = []
    for k in np.unique(points.file):
        T = points.T[points.file == k]
        middle = float(np.median(T[np.isfinite(T)])) if np.any(np.isfinite(T)) else 0.0
        if middle >= HOTTEST_TREAD:
            found.append((points.files[k], middle))
    if found:
        first, others = found[0][0], len(found) - 1
        where = f" in {first}" + f" and {others} more" * bool(others)
        yield {"degrees": found[0][1], "where": where}

"""Checks of all files together: copies, a file or sweep of another sign than all others, and the needs of a disc."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mffit.config import Config
from mffit.constants import ZERO_CAMBER, ZERO_SIDESLIP
from mffit.points import Points
from mffit.suspicion import constants
from mffit.suspicion.rule import Finding, Rule
from mffit.suspicion.slopes import Signatures, at_zero, pooled, signatures


def copied_sweep(points: Points, config: Config) -> Iterator[Finding]:
    """A sweep whose readings are all in another one too: its points would count twice."""
    readings = np.column_stack(
        [points.alpha, points.gamma, points.Fz, points.Fy, np.nan_to_num(points.Mz), points.direction]
    )
    seen: dict[bytes, int] = {}
    for k in np.unique(points.sweep):
        rows = np.flatnonzero(points.sweep == k)
        if len(rows) < constants.FEWEST_ROWS_OF_A_COPY or np.ptp(points.Fy[rows]) == 0.0:
            continue
        own = readings[rows]
        key = own[np.lexsort(own.T)].tobytes()
        if key in seen:
            facts = {"first": points.sweep_names[seen[key]]}
            yield Finding(facts, file=points.files[points.file[rows[0]]])
        seen[key] = int(k)


def reversed_file(points: Points, config: Config, signs: tuple[Rule, ...]) -> Iterator[Finding]:
    """A file with a slope of another sign than all tyres have; ``signs`` are the rules about signs."""
    files = np.unique(points.file)
    if len(files) < 2:
        return
    each = [signatures(points.select(points.file == index)) for index in files]
    broken = []
    for index, own in zip(files, _with_common_scatter(each), strict=True):
        found = next(((rule, finding.column) for rule in signs for finding in rule.find(own)), None)
        if found is not None:
            broken.append((points.files[index], *found))
    if not broken:
        return
    name, rule, column = broken[0]
    alike = [other for other, *rest in broken[1:] if rest == [rule, column]]
    where = f"in this file and in {', '.join(alike)}" if alike else "in this file alone"
    yield Finding({"what": rule.sentence, "where": where, "column": column}, file=name, column=column)


def _with_common_scatter(each: list[Signatures]) -> list[Signatures]:
    """The signatures of several files, every slope with the scatter of all files."""
    names = ("cornering", "camber", "aligning", "backward")
    slopes = (pooled([getattr(own, name) for own in each]) for name in names)
    return [
        own._replace(cornering=cornering, camber=camber, aligning=aligning, backward=backward)
        for own, cornering, camber, aligning, backward in zip(each, *slopes, strict=True)
    ]


def lone_lean(points: Points, config: Config) -> Iterator[Finding]:
    """The one sweep that leans the other way, unless a sweep holds both signs, as sweeps on a disc do."""
    sides: dict[int, float] = {}
    for k in np.unique(points.sweep).tolist():
        gamma = points.gamma[points.sweep == k]
        found = np.unique(np.sign(gamma[np.abs(gamma) > constants.LEANING.rad]))
        if len(found) > 1:
            return
        if len(found):
            sides[k] = float(found[0])
    usual = np.sign(sum(sides.values()))
    odd = [k for k, side in sides.items() if side != usual]
    if len(sides) >= constants.FEWEST_LEANING_SWEEPS and len(odd) == 1:
        degrees = abs(np.degrees(np.median(points.gamma[points.sweep == odd[0]])))
        yield Finding({"sweep": points.sweep_names[odd[0]], "degrees": degrees, "others": len(sides) - 1})


def weak_turn_slip(points: Points, config: Config) -> Iterator[Finding]:
    """A turn-slip force that is too small to be measured."""
    outward = signatures(points).outward
    if outward < constants.WEAK_TURN_SLIP_FORCE:
        yield Finding({"percent": 100 * outward})


def other_moment_point(points: Points, config: Config) -> Iterator[Finding]:
    """Moments about another point than declared: about the contact point Mx hardly follows the side force."""
    upright = np.abs(points.gamma) < constants.UPRIGHT_FOR_MOMENT_POINT.rad
    used = np.isfinite(points.Mx) & np.isfinite(points.Fy) & upright
    if np.sum(used) < constants.FEWEST_POINTS_OF_MOMENT_POINT:
        return
    if np.ptp(points.Fy[used]) < constants.FORCE_RANGE_OF_MOMENT_POINT * np.median(points.Fz[used]):
        return
    lever = float(np.polyfit(points.Fy[used], points.Mx[used], 1)[0])
    if abs(lever) < constants.LEVER_OF_OTHER_MOMENT_POINT * config.tyre.unloaded_radius:
        return
    declared = config.rig.moments
    other = {"contact": "wheel-centre", "wheel-centre": "contact"}[declared]
    yield Finding(
        {"declared": declared, "lever": lever, "other": other},
        file=config.path,
        line=config.line_of("rig.moments"),
        key="rig.moments",
    )


def one_sided_on_disc(points: Points, config: Config) -> Iterator[Finding]:
    """Angles of one sign on a disc, where turn slip is separated by mirror symmetry."""
    if not config.rig.on_disc:
        return
    for column, values, zero in (
        ("alpha_deg", points.alpha, ZERO_SIDESLIP),
        ("gamma_deg", points.gamma, ZERO_CAMBER),
    ):
        degrees = np.degrees(values)
        if (degrees.max() > zero) != (degrees.min() < -zero):
            facts = {"smallest": degrees.min(), "largest": degrees.max()}
            yield Finding(facts, file=config.path, column=column)


def no_zero_on_disc(points: Points, config: Config) -> Iterator[Finding]:
    """No forward point at zero sideslip and camber on a disc, where the turn-slip force is measured."""
    if config.rig.on_disc and not np.any(at_zero(points) & (points.direction > 0)):
        yield Finding({}, file=config.path, column="alpha_deg")

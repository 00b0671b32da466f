"""The declared axes, frame, path centre and units against what every tyre does.

A declaration that the data contradict is refused together with the declarations that they would agree with:
every alternative is tried on the data. A sideslip axis a degree out does not look like wrong axes, as it
shifts the curves without turning a slope round.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from mffit.config import Config
from mffit.errors import InputError
from mffit.points.lone_lean import lone_lean
from mffit.points.magnitudes import check_magnitudes, check_pressures
from mffit.points.points import Points
from mffit.points.signatures import WEAK_FORCE, Signatures, pooled, signatures
from mffit.points.twins import check_twins
from tir.conventions import FLIPPED

STEEPEST_CAMBER = -1.9
"""Camber stiffness per load [1/rad] that no tyre reaches; frame C taken for W adds or removes 1."""
WEAKEST_CAMBER = -0.2
"""Camber stiffness per load [1/rad] that a declaration must leave to be proposed."""
THRUST = (0.1, 1.5)
"""Camber thrust per load over tan(gamma) at large camber; frame C taken for W adds or removes about 1."""
UPRIGHT, FEWEST_UPRIGHT = np.radians(2.0), 10
"""Camber [rad] and points by which the point of the moments is judged."""
SHOWN = 2  # contradictions named in the sentence


class Alternative(NamedTuple):
    """Another declaration: what to write, its key, and the points as they would be then."""

    remedy: str
    key: str
    points: Callable[[], Points]


def check_physics(points: Points, config: Config) -> list[str]:
    """Refuse data that contradict the declaration; return warnings.

    Parameters
    ----------
    points : steady points (n,)
    config : the declaration

    Raises
    ------
    InputError
        With the channel and the likely cause.
    """
    check_twins(points)
    check_magnitudes(points)
    check_pressures(points, 1e3 * config.tyre.nominal_pressure)
    found = signatures(points)
    wrong = contradictions(found)
    if wrong:
        raise _refusal(wrong, found, points, config)
    _check_every_file(points)
    _check_moment_point(points, config)
    warnings = lone_lean(points)
    if np.isfinite(found.outward) and found.outward < WEAK_FORCE:
        warnings.append(
            f"the force at alpha = gamma = 0 is {100 * found.outward:.1f} % of the load along the "
            "turn slip, too little to "
            "measure turn slip; check the alignment of the sideslip axis"
        )
    return warnings


def _check_moment_point(points: Points, config: Config) -> None:
    """Refuse moments about another point than declared: about the contact point Mx hardly follows the side force."""
    used = np.isfinite(points.Mx) & np.isfinite(points.Fy) & (np.abs(points.gamma) < UPRIGHT)
    if np.sum(used) < FEWEST_UPRIGHT or np.ptp(points.Fy[used]) < 0.5 * np.median(points.Fz[used]):
        return
    lever = float(np.polyfit(points.Fy[used], points.Mx[used], 1)[0])
    if abs(lever) < 0.5 * config.tyre.unloaded_radius:
        return
    other = {"contact": "wheel-centre", "wheel-centre": "contact"}[config.rig.moments]
    raise InputError(
        f'with moments = "{config.rig.moments}", Mx_Nm changes by {lever:.2f} m times Fy_N, about the wheel\'s radius, as it '
        f'does about no contact point; the data agree with moments = "{other}"',
        file=config.path,
        line=config.line_of("rig.moments"),
        key="rig.moments",
    )


def _check_every_file(points: Points) -> None:
    """Refuse a file that has another sign than the others: it was recorded or written down the other way round."""
    if len(np.unique(points.file)) < 2:
        return
    files = np.unique(points.file)
    each = [signatures(points.select(points.file == index)) for index in files]
    sure = [
        own._replace(cornering=cornering, backward=backward, camber=camber, aligning=aligning)
        for own, cornering, backward, camber, aligning in zip(
            each,
            pooled([own.cornering for own in each]),
            pooled([own.backward for own in each]),
            pooled([own.camber for own in each]),
            pooled([own.aligning for own in each]),
            strict=True,
        )
    ]
    broken = [
        (points.files[index], *said)
        for index, own in zip(files, sure, strict=True)
        if (said := _reversed(own)) is not None
    ]
    if not broken:
        return
    name, column, sentence = broken[0]
    alike = [other for other, *said in broken[1:] if tuple(said) == (column, sentence)]
    where = f"in this file and in {', '.join(alike)}" if alike else "in this file alone"
    raise InputError(
        f"{sentence} {where}, against all the others: its sign or its direction of rolling looks reversed; correct the file, "
        f'write direction = "backward" in its [[sweep]], or map {column} with scale = -1 under [sweep.columns]',
        file=name,
        column=column,
    )


def _reversed(own: Signatures) -> tuple[str, str] | None:
    """Column and beginning of the sentence where one file has a sign that no tyre has."""
    for broken, column, sentence in (
        (own.cornering.sign > 0, "alpha_deg", "Fy_N rises with alpha_deg"),
        (own.backward.sign < 0, "alpha_deg", "Fy_N falls with alpha_deg, rolling backwards"),
        (own.camber.sign > 0, "gamma_deg", "Fy_N rises with gamma_deg"),
        (own.aligning.sign < 0, "Mz_Nm", "Mz_Nm falls with alpha_deg"),
    ):
        if broken:
            return column, sentence
    return None


def contradictions(found: Signatures) -> list[str]:
    """What no tyre does, as sentences' beginnings; empty if all is well."""
    out = []
    if found.cornering.sign > 0:
        out.append("Fy_N rises with alpha_deg")
    if found.camber.sign > 0:
        out.append("Fy_N rises with gamma_deg")
    if found.camber.value + 2.0 * found.camber.error < STEEPEST_CAMBER:
        out.append(f"Fy_N falls by {-found.camber.value:.1f} times the load per radian of gamma_deg")
    if found.thrust < THRUST[0] or found.thrust > THRUST[1]:
        out.append(f"Fy_N at large gamma_deg is {-found.thrust:.2f} Fz tan(gamma)")
    if found.aligning.sign < 0:
        out.append("Mz_Nm falls with alpha_deg")
    if found.backward.sign < 0:
        out.append("Fy_N falls with alpha_deg in backward runs")
    if found.outward < -WEAK_FORCE:
        out.append("Fy_N at alpha = gamma = 0 points towards the declared centre of the path")
    return out


def _refusal(wrong: list[str], found: Signatures, points: Points, config: Config) -> InputError:
    single = [other for other in _alternatives(points, config) if _fits(other)]
    fitting = single or [other for other in _pairs(points, config) if _fits(other)]
    misaligned = found.outward < -WEAK_FORCE and len(wrong) == 1 and not np.any(points.direction < 0)
    if fitting:
        remedy = f"the data agree with {' or with '.join(dict.fromkeys(other.remedy for other in fitting))}"
        key = fitting[0].key
    else:
        remedy = (
            "no other axes, frame or path centre fits: check the signs of alpha_deg, gamma_deg, Fy_N, Mz_Nm"
        )
        key = "rig.axes"
    if misaligned and np.isfinite(found.cornering.value):
        degrees = abs(np.degrees(found.outward / found.cornering.value))
        remedy += (
            f", or the sideslip axis is out by more than {degrees:.1f} deg, which backward runs would show"
        )
    shown = " and ".join(wrong[:SHOWN]) + (", among others," if len(wrong) > SHOWN else "")
    sentence = f"with {_declared(config)}, {shown} in ISO signs, as no tyre does; {remedy}"
    return InputError(sentence, file=config.path, line=config.line_of(key), key=key)


def _fits(other: Alternative) -> bool:
    """Whether the data agree with another declaration, and not only for want of a camber response."""
    found = signatures(other.points())
    return not contradictions(found) and not found.camber.value > WEAKEST_CAMBER


def _declared(config: Config) -> str:
    rig = config.rig
    said = f'axes = "{rig.axes}", force_frame = "{rig.force_frame}"'
    return said if rig.type == "flat-track" else f'{said}, path_centre = "{rig.path_centre}"'


def _alternatives(points: Points, config: Config) -> list[Alternative]:
    """Every declaration that differs in one thing."""
    rig = config.rig
    others = [
        Alternative(f'axes = "{axes}"', "rig.axes", partial(under_axes, points, rig.axes, axes))
        for axes in FLIPPED
        if axes != rig.axes
    ]
    if rig.on_disc:
        others.append(_other_centre(points, config))
    frame = "C" if rig.force_frame == "W" else "W"
    for vertical in (False, True):
        others.append(
            Alternative(
                f'force_frame = "{frame}"',
                "rig.force_frame",
                partial(_other_frame, points, frame, vertical),
            )
        )
    others.append(
        Alternative(
            'the other sign of Mz: Mz_Nm = { column = "Mz_Nm", scale = -1 } under [sweep.columns]',
            "sweep",
            lambda: points.replace(Mz=-points.Mz),
        )
    )
    others.append(
        Alternative(
            "backward runs reported in the rig's axes: their alpha_deg has the other sign, or "
            "direction is wrong",
            "sweep",
            lambda: points.replace(alpha=np.where(points.direction < 0, -points.alpha, points.alpha)),
        )
    )
    return others


def _pairs(points: Points, config: Config) -> list[Alternative]:
    """Other axes together with the other path centre or frame."""
    rig = config.rig
    pairs = []
    for axes in FLIPPED:
        if axes == rig.axes:
            continue
        turned = under_axes(points, rig.axes, axes)
        for other in _alternatives(turned, config):
            if other.key in ("rig.path_centre", "rig.force_frame"):
                pairs.append(Alternative(f'axes = "{axes}" and {other.remedy}', "rig.axes", other.points))
    return pairs


def _other_centre(points: Points, config: Config) -> Alternative:
    side = "right" if config.rig.path_centre == "left" else "left"
    return Alternative(
        f'path_centre = "{side}"', "rig.path_centre", lambda: points.replace(phi_t=-points.phi_t)
    )


def under_axes(points: Points, declared: str, other: str) -> Points:
    """The points, had ``other`` axes been declared."""
    changed = FLIPPED[declared] ^ FLIPPED[other]
    signs = {name: -1.0 if name in changed else 1.0 for name in ("alpha", "Fy", "Mz")}
    return points.replace(
        alpha=signs["alpha"] * points.alpha, Fy=signs["Fy"] * points.Fy, Mz=signs["Mz"] * points.Mz
    )


def _other_frame(points: Points, frame: str, vertical: bool) -> Points:
    """The points, had the other ``frame`` been declared; ``vertical``: the load is vertical in either."""
    c, s = np.cos(points.gamma), np.sin(points.gamma)
    # From C to W where C is the alternative, and back to what the rig gave where C was declared.
    s = s if frame == "C" else -s
    if not vertical:
        return points.replace(Fy=c * points.Fy - s * points.Fz, Fz=c * points.Fz + s * points.Fy)
    return points.replace(
        Fy=(points.Fy - s * points.Fz) / c if frame == "C" else c * points.Fy - s * points.Fz
    )

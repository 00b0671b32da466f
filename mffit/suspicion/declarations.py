"""Search for other axes, frames and path centres if the data contradict the declared ones.

Every alternative is tried on the data. A misaligned sideslip axis is not mistaken for wrong axes, because it shifts the curves
without reversing a slope.
"""

from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

from mffit.config import Config
from mffit.constants import NAMED_IN_SENTENCE
from mffit.points import Points
from mffit.suspicion import constants
from mffit.suspicion.rereadings import turned
from mffit.suspicion.rule import Facts, Outcome, rule
from mffit.suspicion.slopes import Signatures, contradictions, signatures
from tir.constants import NEGLIGIBLE_SHARE
from tir.conventions import FLIPPED


class Alternative(NamedTuple):
    """An alternative declaration."""

    remedy: str  #: what to write in tyre.toml
    key: str
    points: Callable[[], Points]  #: the points under this declaration


@rule(
    id="declaration-contradicted",
    sentence="with {declared}, {wrong} in ISO signs, which no tyre does; {remedy}",
)
def contradicted(points: Points, config: Config) -> Iterator[Facts]:
    """What no tyre does, under the declared and under all other axes, frames and path centres."""
    found = signatures(points)
    wrong = contradictions(found)
    if not wrong:
        return

    def fits(other: Alternative) -> bool:
        """Whether the data agree with another declaration and show a clear camber response under it."""
        seen = signatures(other.points())
        return not contradictions(seen) and not seen.camber.value > -constants.USUAL_CAMBER_THRUST[0]

    fitting = [other for other in _alternatives(points, config) if fits(other)]
    fitting = fitting or [other for other in _pairs(points, config) if fits(other)]
    fitting = [one for one in fitting if not _unusual_thrust(signatures(one.points()))] or fitting
    if fitting:
        remedy = f"the data agree with {' or with '.join(dict.fromkeys(other.remedy for other in fitting))}"
        key = fitting[0].key
    else:
        remedy = (
            "no other axes, frame or path centre fits: check the signs of alpha_deg, gamma_deg, Fy_N, Mz_Nm"
        )
        key = "rig.axes"
    shown = NAMED_IN_SENTENCE
    facts = {
        "declared": _declared(config),
        "wrong": " and ".join(wrong[:shown]) + (", among others," if len(wrong) > shown else ""),
        "remedy": remedy + _or_misaligned(points, found, len(wrong)),
    }
    yield {"file": config.path, "line": config.line_of(key), "key": key, **facts}


def _unusual_thrust(found: Signatures) -> bool:
    """Whether the camber thrust lies outside what is usual; False where large camber was not run on both sides."""
    least, most = constants.USUAL_CAMBER_THRUST
    return found.thrust < least or found.thrust > most


@rule(
    id="unusual-camber-thrust",
    outcome=Outcome.WARNED,
    sentence="Fy_N at large gamma_deg is {thrust:.2f} Fz tan(gamma), which is rare ({least} to {most} is usual){instead}; check "
    "force_frame and the unit of gamma_deg",
)
def other_frame(points: Points, config: Config) -> Iterator[Facts]:
    """-Fy over Fz tan(gamma) at large camber of both signs, also as it would be in the other frame."""
    found = signatures(points)
    if not _unusual_thrust(found):
        return
    instead = ""
    for other in _alternatives(points, config):
        seen = signatures(other.points())
        if other.key == "rig.force_frame" and not contradictions(seen) and not _unusual_thrust(seen):
            instead = f", and {seen.thrust:.2f} with {other.remedy}"
            break
    least, most = constants.USUAL_CAMBER_THRUST
    yield {"thrust": found.thrust, "least": least, "most": most, "instead": instead}


def _or_misaligned(points: Points, found: Signatures, contradictions: int) -> str:
    """Words on a misaligned sideslip axis as another cause of a turn-slip force towards the centre; empty if it is excluded.

    It is excluded by a second contradiction or by backward runs.
    """
    inward = found.outward < -NEGLIGIBLE_SHARE
    if (
        not inward
        or contradictions > 1
        or np.any(points.direction < 0)
        or not np.isfinite(found.cornering.value)
    ):
        return ""
    degrees = abs(np.degrees(found.outward / found.cornering.value))
    return f", or the sideslip axis is out by more than {degrees:.1f} deg, which backward runs would show"


def _declared(config: Config) -> str:
    rig = config.rig
    said = f'axes = "{rig.axes}", force_frame = "{rig.force_frame}"'
    return said if rig.type == "flat-track" else f'{said}, path_centre = "{rig.path_centre}"'


def _alternatives(points: Points, config: Config) -> list[Alternative]:
    """Every declaration that differs in one respect."""
    rig = config.rig
    frame = "C" if rig.force_frame == "W" else "W"
    side = "right" if rig.path_centre == "left" else "left"
    others = [
        Alternative(f'axes = "{axes}"', "rig.axes", partial(under_axes, points, rig.axes, axes))
        for axes in FLIPPED
        if axes != rig.axes
    ]
    if rig.on_disc:
        others.append(
            Alternative(
                f'path_centre = "{side}"', "rig.path_centre", lambda: points.replace(phi_t=-points.phi_t)
            )
        )
    others += [
        Alternative(
            f'force_frame = "{frame}"', "rig.force_frame", partial(_other_frame, points, frame, vertical)
        )
        for vertical in (False, True)
    ]
    return [
        *others,
        Alternative(
            f"the other sign of Mz: {turned('Mz_Nm')}", "sweep", lambda: points.replace(Mz=-points.Mz)
        ),
        Alternative(
            "backward runs reported in the rig's axes: their alpha_deg has the other sign, or direction is wrong",
            "sweep",
            lambda: points.replace(alpha=np.where(points.direction < 0, -points.alpha, points.alpha)),
        ),
    ]


def _pairs(points: Points, config: Config) -> list[Alternative]:
    """Every declaration with other axes and also the other path centre or frame."""
    pairs = []
    for axes in FLIPPED:
        if axes == config.rig.axes:
            continue
        turned = under_axes(points, config.rig.axes, axes)
        for other in _alternatives(turned, config):
            if other.key in ("rig.path_centre", "rig.force_frame"):
                pairs.append(Alternative(f'axes = "{axes}" and {other.remedy}', "rig.axes", other.points))
    return pairs


def under_axes(points: Points, declared: str, other: str) -> Points:
    """The points as read if ``other`` axes had been declared."""
    changed = FLIPPED[declared] ^ FLIPPED[other]
    turned = [name for name in ("alpha", "Fy", "Mz") if name in changed]
    return points.replace(**{name: -getattr(points, name) for name in turned})


def _other_frame(points: Points, frame: str, vertical: bool) -> Points:
    """The points as read if the other ``frame`` had been declared; ``vertical``: the load is vertical in both frames."""
    c, s = np.cos(points.gamma), np.sin(points.gamma)
    # If C is the alternative, rotate from C to W; if C was declared, undo that rotation.
    s = s if frame == "C" else -s
    if not vertical:
        return points.replace(Fy=c * points.Fy - s * points.Fz, Fz=c * points.Fz + s * points.Fy)
    return points.replace(
        Fy=(points.Fy - s * points.Fz) / c if frame == "C" else c * points.Fy - s * points.Fz
    )

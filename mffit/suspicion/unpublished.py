"""What each likely cause of an implausible camber reduction factor would have to be, in numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass

from mffit.suspicion import constants


@dataclass(frozen=True, slots=True)
class CamberReduction:
    """A measured camber reduction factor and what it was made from; NaN where not measured."""

    value: float
    u: float
    R: float = math.nan  #: path radius [m], positive
    radius_counts: bool = True  #: False if r_e was measured along the path, so that an error of R cancels
    C_gamma: float = math.nan  #: camber stiffness [N/rad], negative
    C_alpha: float = math.nan  #: cornering stiffness [N/rad], negative


def causes(found: CamberReduction) -> str:
    """The likely causes, each with the value that it would have to have or that eps_gamma would have without it.

    With 1 - eps_gamma = -C_gamma r_e / C_phit and C_phit = |F_phit| R, an error of R scales 1 - eps_gamma, a wrong sign of the
    camber or of the path's centre reverses it, and a skew adds C_alpha times its angle to C_gamma.
    """
    usual = 1.0 - constants.USUAL_PUBLISHED_EPSILON
    rest = 1.0 - found.value
    said = []
    if math.isfinite(found.R):
        said.append(_radius(found, rest, usual))
    sign = f"a reversed sign of camber or path_centre (with the other sign it would be {1.0 + rest:.2f})"
    if rest < 0.0:
        said.insert(0, sign)
    else:
        said.append(sign)
    if math.isfinite(found.C_gamma) and math.isfinite(found.C_alpha) and rest > 0.0:
        skew = math.degrees(found.C_gamma * (1.0 - usual / rest) / found.C_alpha)
        said.append(
            f"a camber axis that is not square to the steering axis (camber_skew_deg would have to be {skew:+.1f} for a usual "
            f"{constants.USUAL_PUBLISHED_EPSILON:.2f}; a backward camber sweep measures it)"
        )
    return "; ".join(said)


def _radius(found: CamberReduction, rest: float, usual: float) -> str:
    if not found.radius_counts:
        return "a path radius that is off does not change it, because the rolling radius was measured along the path"
    half, double = 0.5 * found.R, 2.0 * found.R
    entered, other, would = (
        ("a diameter entered as the path radius", half, 1.0 - 2.0 * rest)
        if abs(rest) < usual
        else ("a path radius that was halved by mistake", double, 1.0 - 0.5 * rest)
    )
    return (
        f"{entered} (with a path radius of {other:.3g} m instead of {found.R:.3g} m it would be {would:.2f})"
    )

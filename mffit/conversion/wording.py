"""Sentences of a conversion."""

from __future__ import annotations

import math
from collections.abc import Iterable

from mffit.conversion import constants
from mffit.conversion.refit import COMBINED_CURVATURE, PURE_CURVATURE
from mffit.conversion.result import Conversion, RegionMisfit
from mffit.quantities import MODEL


def headline(found: Conversion) -> str:
    """What was made of what, and over which ranges."""
    reach = found.reach
    curvature = ", of the curvature that the old formula limits" if limited(found) else ""
    return (
        f"{found.old.path.name} ({found.old.kind}) as MF 6.2, over {reach.Fz[0]:.0f} to {reach.Fz[1]:.0f} N, sideslip to "
        f"{math.degrees(reach.alpha):.3g} deg, camber to {math.degrees(reach.gamma):.3g} deg, longitudinal slip to "
        f"{reach.kappa:g}. "
        f"{len(found.fitted)} coefficients were fitted to the old forces, those of camber{curvature} and of the residual torque; "
        "all others mean the same in both formulae."
    )


def limited(found: Conversion) -> bool:
    """Whether a curvature factor of the old file exceeds 1, to which MF 5.2 holds it."""
    return not {*PURE_CURVATURE, *COMBINED_CURVATURE}.isdisjoint(found.fitted)


def region(row: RegionMisfit) -> str:
    """A region of the misfit."""
    side = "to" if row.small_camber else "beyond"
    return f"camber {side} {constants.SMALL_CAMBER:g} deg{', slipping' if row.slipping else ''}"


def worst(misfit: Iterable[RegionMisfit]) -> str:
    """The misfit of the channel that differs most, as a share of its largest value."""
    row = max(misfit, key=lambda row: row.largest / row.greatest_force)
    quantity = MODEL[row.channel]
    return (
        f"{quantity.symbol} differs most from the old file, by up to {row.largest:.3g} {quantity.unit} "
        f"({row.largest / row.greatest_force:.1%} of its largest value), at {region(row)}"
    )


def reasons(found: Conversion) -> list[str]:
    """Why the converted file is not to be trusted; empty if its misfit is small."""
    out = []
    for row in found.poor:
        quantity = MODEL[row.channel]
        out.append(
            f"{quantity.symbol} at {region(row)} is off by up to {row.largest:.0f} {quantity.unit}, "
            f"{row.largest / row.greatest_force:.1%} of its largest value; {row.within:.0%} of the conditions are within "
            f"{constants.GOOD_SHARE:.0%}"
        )
    return out

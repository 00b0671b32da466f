"""Sentences of a conversion."""

from __future__ import annotations

import math
from collections.abc import Iterable

from mffit.conversion import constants
from mffit.conversion.curvature_limits import FACTORS
from mffit.conversion.result import Conversion, RegionMisfit
from mffit.quantities import MODEL


def headline(found: Conversion) -> str:
    """What was made of what, and over which ranges."""
    reach = found.reach
    return (
        f"{found.old.path.name} ({found.old.kind}) as MF 6.2, over {reach.Fz[0]:.0f} to {reach.Fz[1]:.0f} N, sideslip to "
        f"{math.degrees(reach.alpha):.3g} deg, camber to {math.degrees(reach.gamma):.3g} deg, longitudinal slip to "
        f"{reach.kappa:g}. "
        f"{len(found.fitted)} coefficients were fitted to the old forces, those of {refitted(found.fitted)}; all others mean the "
        "same in both formulae."
    )


def refitted(names: Iterable[str]) -> str:
    """What the fitted coefficients describe."""
    curved = [factor.names[0][:-1] for factor in FACTORS if factor.names[0] in set(names)]
    if not curved:
        return "camber and of the residual torque"
    return f"camber, of the residual torque and of curvature above 1 ({', '.join(curved)}), which the old formula holds to 1"


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

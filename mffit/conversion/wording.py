"""Sentences of a conversion."""

import math
from collections.abc import Iterable

from mffit.conversion import constants
from mffit.conversion.refit import FACTORS
from mffit.conversion.result import Conversion, RegionMisfit
from mffit.quantities import MODEL
from tir.errors import listed

REVERSED = (
    *("PKY1", "PVY1", "PVY2", "PVY3", "PVY4", "RVY1", "RVY2", "RVY3"),
    *("QBZ10", "QDZ6", "QDZ7", "QDZ8", "QDZ9", "SSZ1", "SSZ3", "SSZ4", "QSX3", "QSX9"),
)
"""Coefficients of MF 5.2 whose signs together reverse Fy and Mz and nothing else."""


def headline(found: Conversion) -> str:
    """The old and the new formula, and the ranges of the fit."""
    reach = found.reach
    over = (
        f"over {reach.Fz[0]:.0f} to {reach.Fz[1]:.0f} N, sideslip to {math.degrees(reach.alpha):.3g} deg, camber to "
        f"{math.degrees(reach.gamma):.3g} deg, longitudinal slip to {reach.kappa:g}"
    )
    if found.old is None:
        kept = f"those of {', '.join(found.fitted)}; " if found.fitted else ""
        pressure = float(found.tyre["INFLPRES"]) / 1000.0
        return (
            f"{found.path.name} (MF 6.2) as {found.kind} at {pressure:g} kPa, {over}. {len(found.fitted)} coefficients "
            f"were fitted to its forces, {kept}all others mean the same in "
            "both formulae. The older formula knows neither pressure nor turn slip."
        )
    return (
        f"{found.path.name} ({found.kind}) as MF 6.2, {over}. {len(found.fitted)} coefficients were fitted to "
        f"the old forces, those of {refitted(found.fitted)}; all others mean "
        f"the same in both formulae.{curvature(found)}"
    )


def curvature(found: Conversion) -> str:
    """What the old formula does where a curvature factor exceeds 1; empty if none does."""
    if not found.held:
        return ""
    most = " and ".join(f"{E:.3g} ({key})" for key, E in found.held.items())
    return (
        f" The equations of {found.kind} hold curvature factors to 1, and the old forces are taken so; by the file's "
        f"coefficients they would reach {most} in these ranges."
    )


def refitted(names: Iterable[str]) -> str:
    """What the fitted coefficients describe."""
    curved = [factor.names[0][:-1] for factor in FACTORS if factor.names[0] in set(names)]
    return f"camber and of curvature above 1 ({', '.join(curved)})" if curved else "camber"


def region(row: RegionMisfit) -> str:
    """A region of the misfit."""
    side = "to" if row.small_camber else "beyond"
    return f"camber {side} {constants.SMALL_CAMBER:g} deg{', slipping' if row.slipping else ''}"


def worst(misfit: Iterable[RegionMisfit]) -> str:
    """The misfit of the channel that differs most, as a share of its largest value at the same load."""
    row = max(misfit, key=lambda row: row.share, default=None)
    if row is None:
        return "the original gives no force that could differ"
    return (
        f"{MODEL[row.channel].symbol} differs most from the original, by up to {size(row)}, at {region(row)}"
    )


def size(row: RegionMisfit) -> str:
    """The largest misfit of a region, and the largest value at its load."""
    unit = MODEL[row.channel].unit
    return f"{row.largest:.3g} of {row.greatest_force:.3g} {unit} ({row.share:.1%}) at {row.load:.0f} N"


def trusted(found: Conversion) -> bool:
    """Whether a conversion is usable: no reason speaks against it."""
    return not reasons(found)


def reasons(found: Conversion) -> list[str]:
    """Why the converted file is not to be trusted; empty if it has no error and its misfit is small."""
    out = against_sideslip(found) + [one.sentence for one in found.problems if one.level == "error"]
    for row in found.poor:
        out.append(
            f"{MODEL[row.channel].symbol} at {region(row)} is off by up to {size(row)}, in rms by {row.rms_share:.1%} of the "
            f"largest of the same load; {row.within:.0%} of the conditions are within {constants.GOOD_SHARE:.0%}"
        )
    return out


def against_sideslip(found: Conversion) -> list[str]:
    """A sentence if the side force of the upright wheel grows with sideslip, which no tyre does in ISO-W."""
    nominal = float(found.tyre["FNOMIN"])
    if found.old is None or float(found.tyre.state(nominal).K_ya) <= 0.0:
        return []
    return [
        f"the side force grows with sideslip at {nominal:.0f} N (PKY1 and PKY2 have one sign), but in ISO-W, the axes of "
        "property files, every tyre pushes against it: the file is in other axes, and so is the converted one. If they are those "
        f"of adapted SAE, with the side force and the aligning moment reversed, reverse the signs of {listed(REVERSED)} in it"
    ]

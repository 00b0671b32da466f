"""Known mistakes in recording a sweep, one record each, and the one that explains the errors of a sweep."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

from mffit.constants import EXPLAINED_SHARE
from mffit.points import Points
from mffit.sweeps.units import factor


@dataclass(frozen=True, slots=True, kw_only=True)
class Mistake:
    """A way in which one sweep contradicts all the others."""

    looks: str  #: what the sweep looks like
    column: str  #: heading at fault
    remedy: str  #: what to do about it
    undone: Callable[[Points, Mapping[str, float]], Points]
    """The points without it; takes the signs from ISO-W to the rig's axes, by channel."""
    beyond_doubt: bool = True  #: False if a sound tyre or rig can look almost like it


def _negated(points: Points, _: Mapping[str, float], *, fields: tuple[str, ...]) -> Points:
    return points.replace(**{name: -getattr(points, name) for name in fields})


def _swapped(points: Points, signs: Mapping[str, float]) -> Points:
    sign = signs["alpha"] * signs["gamma"]
    return points.replace(alpha=sign * points.gamma, gamma=sign * points.alpha)


def _exchanged(points: Points, signs: Mapping[str, float]) -> Points:
    sign = signs["Fy"] * signs["Mz"]
    return points.replace(Fy=sign * points.Mz, Mz=sign * points.Fy)


def _converted(points: Points, _: Mapping[str, float], *, field: str, unit: str, expected: str) -> Points:
    return points.replace(**{field: factor(unit, expected) * getattr(points, field)})


def _reversed(field: str, column: str, what: str) -> Mistake:
    return Mistake(
        looks=f"{what} reversed",
        column=column,
        remedy=f"correct its sign, or map {column} with scale = -1 under [sweep.columns]",
        undone=partial(_negated, fields=(field,)),
    )


def _in_unit(field: str, column: str, what: str, *, unit: str, expected: str) -> Mistake:
    return Mistake(
        looks=f"{what} in {unit}",
        column=column,
        remedy=f'write {expected}, or {column} = {{ column = "{column}", unit = "{unit}" }} under [sweep.columns]',
        undone=partial(_converted, field=field, unit=unit, expected=expected),
    )


FORCE = ("Fy", "Fy_N", "its side force")
DRIVE = ("Fx", "Fx_N", "its longitudinal force")
OVERTURNING = ("Mx", "Mx_Nm", "its overturning moment")
ROLLING = ("My", "My_Nm", "its rolling resistance moment")
LOAD = ("Fz", "Fz_N", "its load")
MOMENT = ("Mz", "Mz_Nm", "its moment")
SIDESLIP = ("alpha", "alpha_deg", "its sideslip")
CAMBER = ("gamma", "gamma_deg", "its camber")
PRESSURE = ("p", "p_kPa", "its pressure")

MISTAKES: tuple[Mistake, ...] = (
    *(_reversed(*channel) for channel in (SIDESLIP, CAMBER, FORCE, MOMENT, DRIVE, OVERTURNING, ROLLING)),
    Mistake(
        looks="sideslip and camber exchanged",
        column="alpha_deg",
        remedy="correct the headings alpha_deg and gamma_deg",
        undone=_swapped,
    ),
    Mistake(
        looks="side force and moment exchanged",
        column="Fy_N",
        remedy="correct the headings Fy_N and Mz_Nm",
        undone=_exchanged,
    ),
    Mistake(
        looks="the direction of rolling undeclared or wrong",
        column="direction",
        remedy='write direction = "backward" (or "forward") in its [[sweep]]',
        undone=partial(_negated, fields=("direction",)),
    ),
    Mistake(
        looks="side force and moment in other axes",
        column="Fy_N",
        remedy="correct the signs of Fy_N and Mz_Nm",
        undone=partial(_negated, fields=("Fy", "Mz")),
    ),
    Mistake(
        looks="sideslip, side force and moment in other axes",
        column="alpha_deg",
        remedy="correct the signs of alpha_deg, Fy_N and Mz_Nm",
        undone=partial(_negated, fields=("alpha", "Fy", "Mz")),
    ),
    Mistake(
        looks="the tyre turned on its rim",
        column="mount",
        remedy='write mount = "flipped" (or "normal") in its [[sweep]]',
        undone=partial(_negated, fields=("mount",)),
        beyond_doubt=False,
    ),
    *(_in_unit(*LOAD, unit=unit, expected="N") for unit in ("kgf", "lbf")),
    *(_in_unit(*force, unit=unit, expected="N") for force in (FORCE, DRIVE) for unit in ("kN", "kgf", "lbf")),
    *(
        _in_unit(*moment, unit=unit, expected="N m")
        for moment in (MOMENT, OVERTURNING, ROLLING)
        for unit in ("N mm", "kN m", "lbf ft")
    ),
    *(_in_unit(*angle, unit="rad", expected="deg") for angle in (SIDESLIP, CAMBER)),
    _in_unit(*PRESSURE, unit="psi", expected="kPa"),
)


class Away(NamedTuple):
    """How far one channel of a sweep is from what is expected."""

    error: float  #: in any unit that is the same before and after
    share: float  #: of the channel's usual size
    matched: bool = True  #: False if the error is not small beside what was measured and expected


class ExplainingMistake(NamedTuple):
    """A mistake that explains a sweep."""

    mistake: Mistake
    left: float  #: largest share of the usual size by which a channel is still away


def explaining(
    candidates: Iterable[tuple[Mistake, Points]],
    gross: Mapping[str, float],
    away: Callable[[Points], Mapping[str, Away]],
    tolerated: Mapping[str, float],
) -> ExplainingMistake | None:
    """The mistake that leaves least when it is undone; None if no mistake explains the errors.

    ``candidates`` come with the points of the sweep as they are without the mistake. ``tolerated`` limits the share by which a
    channel may be away in the end, so that no new error is made elsewhere.
    """
    best = None
    for mistake, points in candidates:
        after = away(points)
        little = all(
            name in after and after[name].error <= EXPLAINED_SHARE * error and after[name].matched
            for name, error in gross.items()
        )
        if not little or any(one.share > tolerated[name] for name, one in after.items()):
            continue
        left = max(one.share for one in after.values())
        if best is None or left < best.left:
            best = ExplainingMistake(mistake=mistake, left=left)
    return best

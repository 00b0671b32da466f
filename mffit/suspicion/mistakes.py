"""The mistakes that are made in writing a sweep down: one record each, with the points as they would be without it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

from mffit.points import Points
from mffit.sweeps.units import factor


@dataclass(frozen=True, slots=True)
class Mistake:
    """A way in which one sweep contradicts all the others."""

    looks: str  #: what the sweep looks like
    column: str  #: heading at fault
    remedy: str  #: what to do about it
    undone: Callable[[Points, Mapping[str, float]], Points]
    """The points without it; takes the signs that turn ISO-W into the rig's axes, by channel."""
    beyond_doubt: bool = True  #: False where a sound tyre or rig can look almost like it


def _turned(points: Points, signs: Mapping[str, float], channels: tuple[str, ...]) -> Points:
    return points.replace(**{name: -getattr(points, name) for name in channels})


def _swapped(points: Points, signs: Mapping[str, float]) -> Points:
    sign = signs["alpha"] * signs["gamma"]
    return points.replace(alpha=sign * points.gamma, gamma=sign * points.alpha)


def _in_unit(points: Points, signs: Mapping[str, float], channel: str, unit: str, house: str) -> Points:
    return points.replace(**{channel: factor(unit, house) * getattr(points, channel)})


def _reversed(channel: str, column: str, what: str) -> Mistake:
    return Mistake(
        f"{what} reversed",
        column,
        f"correct its sign, or map {column} with scale = -1 under [sweep.columns]",
        partial(_turned, channels=(channel,)),
    )


def _unit(channel: str, column: str, what: str, unit: str, house: str) -> Mistake:
    return Mistake(
        f"{what} in {unit}",
        column,
        f'write {house}, or {column} = {{ column = "{column}", unit = "{unit}" }} under [sweep.columns]',
        partial(_in_unit, channel=channel, unit=unit, house=house),
    )


FORCE, LOAD, MOMENT = (
    ("Fy", "Fy_N", "its side force"),
    ("Fz", "Fz_N", "its load"),
    ("Mz", "Mz_Nm", "its moment"),
)
SIDESLIP, CAMBER = ("alpha", "alpha_deg", "its sideslip"), ("gamma", "gamma_deg", "its camber")

MISTAKES: tuple[Mistake, ...] = (
    _reversed(*SIDESLIP),
    _reversed(*CAMBER),
    _reversed(*FORCE),
    _reversed(*MOMENT),
    Mistake(
        "sideslip and camber exchanged",
        "alpha_deg",
        "correct the headings alpha_deg and gamma_deg",
        _swapped,
    ),
    Mistake(
        "the direction of rolling undeclared or wrong",
        "direction",
        'write direction = "backward" (or "forward") in its [[sweep]]',
        lambda points, signs: points.replace(direction=-points.direction),
    ),
    Mistake(
        "side force and moment in other axes",
        "Fy_N",
        "correct the signs of Fy_N and Mz_Nm",
        partial(_turned, channels=("Fy", "Mz")),
    ),
    Mistake(
        "sideslip, side force and moment in other axes",
        "alpha_deg",
        "correct the signs of alpha_deg, Fy_N and Mz_Nm",
        partial(_turned, channels=("alpha", "Fy", "Mz")),
    ),
    Mistake(
        "the tyre turned on its rim",
        "mount",
        'write mount = "flipped" (or "normal") in its [[sweep]]',
        lambda points, signs: points.replace(mount=-points.mount),
        beyond_doubt=False,
    ),
    *(_unit(*LOAD, unit, "N") for unit in ("kgf", "lbf")),
    *(_unit(*FORCE, unit, "N") for unit in ("kN", "kgf", "lbf")),
    *(_unit(*MOMENT, unit, "N m") for unit in ("N mm", "kN m", "lbf ft")),
    *(_unit(*angle, "rad", "deg") for angle in (SIDESLIP, CAMBER)),
    _unit("p", "p_kPa", "its pressure", "psi", "kPa"),
)

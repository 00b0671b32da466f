"""Physical conditions over the whole range of a tyre: each is searched for its worst point, inside and just outside."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from tir import constants
from tir.equations import aligning, lateral, longitudinal, normalise, stiffness
from tir.errors import Problem
from tir.record import TyreRecord

SEARCHED: Mapping[str, tuple[str, str]] = {
    "Fz": ("FZMIN", "FZMAX"),
    "gamma": ("CAMMIN", "CAMMAX"),
    "pressure": ("PRESMIN", "PRESMAX"),
    "alpha": ("ALPMIN", "ALPMAX"),
    "kappa": ("KPUMIN", "KPUMAX"),
}
"""The inputs searched with the keys of their ranges, in the order of :data:`tir.constants.VALUES_PER_SEARCHED_RANGE`."""
RANGES = (*SEARCHED.values(),)
SLIGHT, FRICTION = constants.NEGLIGIBLE_SHARE, constants.CREDIBLE_FRICTION

Measure = Callable[[Any, normalise.Inputs], Any]


@dataclass(frozen=True, slots=True)
class Condition:
    """A quantity that must stay above zero."""

    name: str  #: the key to check first
    level: str  #: "error" or "warning"
    measure: Measure
    sentence: str  #: with {where} and {worst}
    value: Callable[[float], float] = lambda margin: margin  #: the number to print, from the margin
    outside: str = ""  #: sentence if the condition holds inside the ranges only; "" if that does not matter
    slips: bool = False  #: whether it depends on sideslip and longitudinal slip
    camber: bool = True  #: whether it depends on camber


def _sign(peak: float) -> float:
    """The sign of a peak factor: a negative one also reverses the slope factor, so the curve stays."""
    return -1.0 if peak < 0.0 else 1.0


CONDITIONS = (
    Condition(
        "PDY1",
        "error",
        lambda p, q: _sign(p.PDY1) * stiffness.lateral_friction(p, q, q.gamma),
        "the lateral friction coefficient is not positive: {worst:.2f} at {where}; narrow the ranges or refit",
        outside="the lateral friction coefficient turns negative just outside the ranges, at {where}",
    ),
    Condition(
        "PDY1",
        "warning",
        lambda p, q: FRICTION - _sign(p.PDY1) * stiffness.lateral_friction(p, q, q.gamma),
        "the lateral friction coefficient is {worst:.1f} at {where}",
        lambda margin: FRICTION - margin,
    ),
    Condition(
        "PDX1",
        "warning",
        lambda p, q: np.where(p.PDX1 == 0.0, 1.0, _sign(p.PDX1) * stiffness.longitudinal_friction(p, q)),
        "the longitudinal friction coefficient is not positive: {worst:.2f} at {where}; narrow the ranges or refit",
    ),
    Condition(
        "PKY1",
        "error",
        lambda p, q: -stiffness.cornering_stiffness(p, q, 0.0),
        "the cornering stiffness is not negative at zero camber (ISO-W), at {where}: the file is in other axes, or wrong",
        camber=False,
    ),
    Condition(
        "PKY3",
        "warning",
        lambda p, q: -stiffness.cornering_stiffness(p, q, q.gamma),
        "the cornering stiffness changes sign at {where}: narrow CAMMIN and CAMMAX",
        outside="the cornering stiffness changes sign just outside the ranges, at {where}",
    ),
    Condition(
        "PKX1",
        "warning",
        lambda p, q: np.where(p.PKX1 == 0.0, 1.0, stiffness.longitudinal_slip_stiffness(p, q)),
        "the longitudinal slip stiffness is not positive at {where}",
        camber=False,
    ),
    Condition(
        "PKY6",
        "warning",
        lambda p, q: 1e-9 - stiffness.camber_stiffness(p, q),
        "the camber force has the wrong sign at {where}: a normal tyre has PKY6 < 0 in ISO-W",
        camber=False,
    ),
    Condition(
        "PEY1",
        "warning",
        lambda p, q: 1.0 - np.maximum(*(lateral.curvature(p, q, q.gamma, side) for side in (-1.0, 1.0))),
        "the curvature E_y reaches {worst:.2f} > 1 at {where}: simulations may limit it to 1",
        lambda margin: 1.0 - margin,
    ),
    Condition(
        "QEZ1",
        "warning",
        lambda p, q: 1.0 - aligning.curvature(p, q, aligning.slope_factor(p, q), q.alpha),
        "the curvature E_t of the trail reaches {worst:.2f} > 1 at {where}: simulations may limit it to 1",
        lambda margin: 1.0 - margin,
        slips=True,
    ),
    Condition(
        "RBY1",
        "warning",
        lambda p, q: SLIGHT + lateral.combined_weight(p, q),
        "longitudinal slip reverses the side force: G_yk is {worst:.2f} at {where}",
        lambda margin: margin - SLIGHT,
        slips=True,
    ),
    Condition(
        "RBX1",
        "warning",
        lambda p, q: SLIGHT + longitudinal.combined_weight(p, q),
        "sideslip reverses the longitudinal force: G_xa is {worst:.2f} at {where}",
        lambda margin: margin - SLIGHT,
        slips=True,
    ),
)


OF_THE_SIDE_FORCE = ("PDY1", "PKY1", "PKY3")
"""Conditions that a tyre without a side force need not fulfil."""


def over_the_range(tyre: TyreRecord) -> Iterator[Problem]:
    """Problems for the conditions that the tyre violates within its ranges or just outside.

    Within the default of a range that the file does not state, an error counts as a warning.
    """
    inside, stated = box(tyre), _stated(tyre)
    reach = constants.JUST_OUTSIDE * (inside[1] - inside[0])
    around = np.array([inside[0] - reach, inside[1] + reach])
    around[0, 0] = max(around[0, 0], constants.LOWEST_SEARCHED_LOAD * tyre["FNOMIN"])
    around[0, 2] = max(around[0, 2], constants.IN_USE[0] * tyre["NOMPRES"])
    skipped = OF_THE_SIDE_FORCE if _along_only(tyre) else ()
    for condition in (one for one in CONDITIONS if one.name not in skipped):
        margin, point = worst(tyre, condition.measure, inside)
        if np.isnan(margin):
            yield Problem(
                _level("error", condition, tyre, stated),
                f"{condition.name} and related coefficients give no number at {_place(point, condition)}",
                condition.name,
            )
            return
        sentence = condition.sentence if margin <= 0.0 else ""
        level = _level(condition.level, condition, tyre, stated) if sentence else ""
        if not sentence and condition.outside:
            margin, point = worst(tyre, condition.measure, around)
            sentence, level = condition.outside if margin <= 0.0 else "", "warning"
        if sentence:
            text = sentence.format(where=_place(point, condition), worst=condition.value(margin))
            yield Problem(level, text, condition.name)


def _along_only(tyre: TyreRecord) -> bool:
    """Whether the file states a longitudinal force and no side force."""
    along = all(name in tyre.present and tyre[name] != 0.0 for name in ("PDX1", "PKX1"))
    return along and tyre["PDY1"] == tyre["PKY1"] == 0.0


def _level(level: str, condition: Condition, tyre: TyreRecord, stated: np.ndarray) -> str:
    """The level of a violation: "warning" if the condition holds over the stated ranges, at the nominal values of the others."""
    if level == "error" and worst(tyre, condition.measure, stated)[0] > 0.0:
        return "warning"
    return level


def _stated(tyre: TyreRecord) -> np.ndarray:
    """:func:`box` with each range of which the file states no end reduced to its nominal value."""
    nominal = (tyre["FNOMIN"], 0.0, tyre["NOMPRES"], 0.0, 0.0)
    missing = [not tyre.present.intersection(names) for names in RANGES]
    return np.where(missing, nominal, box(tyre))


def worst(tyre: TyreRecord, measure: Measure, box: np.ndarray) -> tuple[float, np.ndarray]:
    """The smallest value over a box (2, 5) of Fz [N], gamma [rad], pressure [Pa], alpha [rad], kappa, and where.

    NaN, and the place, if the measure is NaN anywhere.
    """
    low, high = box
    counts = [int(n) for n in constants.VALUES_PER_SEARCHED_RANGE]
    best, place = np.inf, low
    for _ in range(constants.ROUNDS_OF_THE_SEARCH):
        axes = [np.linspace(a, b, n) for a, b, n in zip(low, high, counts, strict=True)]
        points = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")])
        found = np.broadcast_to(_measured(tyre, measure, points), points.shape[1:])
        i = int(np.argmax(np.isnan(found))) if np.any(np.isnan(found)) else int(np.argmin(found))
        if np.isnan(found[i]):
            return float("nan"), points[:, i]
        if found[i] < best:
            best, place = float(found[i]), points[:, i]
        step = (high - low) / [n - 1 for n in counts]
        low, high = np.maximum(box[0], place - step), np.minimum(box[1], place + step)
    return best, place


def _measured(tyre: TyreRecord, measure: Measure, points: np.ndarray) -> Any:
    at = normalise.OperatingCondition(**dict(zip(SEARCHED, points, strict=True)))
    with np.errstate(all="ignore"):
        return measure(tyre.p, normalise.inputs(tyre.p, at))


def box(tyre: TyreRecord) -> np.ndarray:
    """The file's :data:`RANGES` (2, 5), reduced to what tyres are used for."""
    camber, sideslip = constants.LARGEST_CAMBER.rad, 2.0 * constants.USUAL_SIDESLIP.rad
    ends = np.array([[float(tyre[name]) for name in names] for names in RANGES]).T
    ends[0, 0] = max(ends[0, 0], constants.LOWEST_SEARCHED_LOAD * tyre["FNOMIN"])
    ends[:, 1] = np.clip(ends[:, 1], -camber, camber)
    least, most = (share * tyre["NOMPRES"] for share in constants.IN_USE)
    pressure = np.clip(ends[:, 2], least, most)
    ends[:, 2] = pressure if pressure[0] < pressure[1] else tyre["NOMPRES"]
    ends[:, 3] = np.clip(ends[:, 3], -sideslip, sideslip)
    return ends


def _place(point: np.ndarray, condition: Condition) -> str:
    Fz, gamma, pressure, alpha, kappa = point
    parts = [f"{Fz:.0f} N"]
    if condition.camber:
        parts.append(f"{np.degrees(gamma):.0f} deg camber")
    parts.append(f"{pressure / 1e3:.0f} kPa")
    if condition.slips:
        parts += [f"{np.degrees(alpha):.0f} deg sideslip", f"kappa {kappa:.2g}"]
    return ", ".join(parts)

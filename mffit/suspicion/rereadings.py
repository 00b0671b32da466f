"""Alternative readings of a sweep, one record each, and the search for the one that makes it agree with its prediction.

A recording mistake is undone; an offset or gain of the rig is fitted to the errors.
"""

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np

from mffit.constants import EXPLAINED_SHARE
from mffit.points import Points, levels
from mffit.quantities import CHANNELS, COLUMNS
from mffit.quantities import column as heading
from mffit.rig import Simulation
from mffit.rig_errors import BY_NAME
from mffit.rounding import to_uncertainty
from mffit.suspicion import constants
from mffit.suspicion.groups import confirmed_by_others
from mffit.sweeps.units import factor

if TYPE_CHECKING:
    from mffit.linearised.mixed import LeftOutReadings

Signs = Mapping[str, float]
"""+1 or -1 by channel: from ISO-W to the rig's axes."""
Errors: TypeAlias = "Mapping[str, LeftOutReadings]"
"""By channel, prediction errors of the measured readings."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mistake:
    """A mistake in a recording, such as a reversed sign or a wrong unit."""

    looks: str  #: appearance of the sweep, in words
    column: str  #: heading at fault
    remedy: str  #: how to correct it
    undone: Callable[[Points, Signs], Points]  #: the points corrected for the mistake
    beyond_doubt: bool = True  #: False if a sound tyre or rig can look almost the same
    units: tuple[str, str] | None = None  #: the wrong unit and the expected one, of a mistaken unit

    @property
    def factor(self) -> float:
        """Of a wrong unit, at least 1; 1 for other mistakes."""
        size = 1.0 if self.units is None else factor(*self.units)
        return max(size, 1.0 / size)

    def certain(self, undone: Points, others: Points, *, by_formula: bool) -> bool:
        """Whether no formula of a sound tyre is as wrong as this mistake.

        At a load, camber or pressure that ``others`` do not cover, a tyre may differ by a small factor from what they show, and
        by any but a large factor from a prediction ``by_formula``. A wrong setting is certain if others confirm the true one.
        """
        if self.factor > 1.0 and any(self.column == COLUMNS[name] for name in levels.SETTINGS):
            return confirmed_by_others(undone, others, {self.column})
        if self.factor > constants.LARGEST_ERROR_OF_FORMULA or (self.factor == 1.0 and not by_formula):
            return True
        return confirmed_by_others(undone, others)


def _negated(points: Points, _: Signs, *, fields: tuple[str, ...]) -> Points:
    return points.replace(**{name: -getattr(points, name) for name in fields})


def _swapped(points: Points, signs: Signs, *, fields: tuple[str, str]) -> Points:
    one, other = fields
    sign = signs[one] * signs[other]
    return points.replace(**{one: sign * getattr(points, other), other: sign * getattr(points, one)})


def _converted(points: Points, _: Signs, *, field: str, unit: str, expected: str) -> Points:
    return points.replace(**{field: factor(unit, expected) * getattr(points, field)})


def _reversed(looks: str, column: str, remedy: str, *fields: str, beyond_doubt: bool = True) -> Mistake:
    undone = partial(_negated, fields=fields)
    return Mistake(looks=looks, column=column, remedy=remedy, undone=undone, beyond_doubt=beyond_doubt)


def turned(column: str) -> str:
    """How the sign of a column is turned in ``tyre.toml``, whatever its heading."""
    return f"map {column} with scale = -1 under [sweep.columns]"


def _of_sign(field: str, column: str, what: str) -> Mistake:
    remedy = f"correct its sign, or {turned(column)}"
    return _reversed(f"{what} reversed", column, remedy, field)


def _in_unit(field: str, column: str, what: str, *, unit: str, expected: str) -> Mistake:
    return Mistake(
        looks=f"{what} in {unit}",
        column=column,
        remedy=f'write {expected}, or {column} = {{ column = "{column}", unit = "{unit}" }} under [sweep.columns]',
        undone=partial(_converted, field=field, unit=unit, expected=expected),
        units=(unit, expected),
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

REVERSALS: tuple[Mistake, ...] = (
    *(_of_sign(*channel) for channel in (SIDESLIP, CAMBER, FORCE, MOMENT, DRIVE, OVERTURNING, ROLLING)),
    _reversed(
        "the direction of rolling undeclared or wrong",
        "direction",
        'write direction = "backward" (or "forward") in its [[sweep]]',
        "direction",
    ),
    _reversed(
        "side force and moment in other axes", "Fy_N", "correct the signs of Fy_N and Mz_Nm", "Fy", "Mz"
    ),
    _reversed(
        "sideslip, side force and moment in other axes",
        "alpha_deg",
        "correct the signs of alpha_deg, Fy_N and Mz_Nm",
        *("alpha", "Fy", "Mz"),
    ),
)
"""Signs of channels, alone or together, and the direction of rolling."""
ANGLES_EXCHANGED = Mistake(
    looks="sideslip and camber exchanged",
    column="alpha_deg",
    remedy="correct the headings alpha_deg and gamma_deg",
    undone=partial(_swapped, fields=("alpha", "gamma")),
)
MISTAKES: tuple[Mistake, ...] = (
    *(_in_unit(*angle, unit="rad", expected="deg") for angle in (SIDESLIP, CAMBER)),
    _in_unit(*PRESSURE, unit="psi", expected="kPa"),
    *(_in_unit(*force, unit="kN", expected="N") for force in (FORCE, DRIVE)),
    Mistake(
        looks="side force and moment exchanged",
        column="Fy_N",
        remedy="correct the headings Fy_N and Mz_Nm",
        undone=partial(_swapped, fields=("Fy", "Mz")),
    ),
    ANGLES_EXCHANGED,
    *(_in_unit(*force, unit=unit, expected="N") for force in (LOAD, FORCE, DRIVE) for unit in ("kgf", "lbf")),
    *(
        _in_unit(*moment, unit=unit, expected="N m")
        for moment in (MOMENT, OVERTURNING, ROLLING)
        for unit in ("N mm", "kN m", "lbf ft")
    ),
    *REVERSALS,
    _reversed(
        "the tyre turned on its rim",
        "mount",
        'write mount = "flipped" (or "normal") in its [[sweep]]',
        "mount",
        beyond_doubt=False,
    ),
)
"""In order of preference, if several explain the errors equally well."""


def certain_mistakes(
    part: Points, signs: Signs, others: Points, *, by_formula: bool
) -> Iterator[tuple[Mistake, Points]]:
    """The mistakes that no sound tyre or rig looks like, each with the points of a sweep corrected for it.

    ``others`` and ``by_formula`` are as in :meth:`Mistake.certain`.
    """
    for mistake in MISTAKES:
        undone = mistake.undone(part, signs)
        if mistake.beyond_doubt and mistake.certain(undone, others, by_formula=by_formula):
            yield mistake, undone


def moved(points: Points, errors: Errors, simulation: Simulation, changed: Points) -> dict[str, np.ndarray]:
    """By channel, the errors of the points if they are read as ``changed``, to first order.

    Channels without readings in ``changed`` are left out.
    """
    here, there = simulation.readings(points, errors), simulation.readings(changed, errors)
    out = {}
    for name, one in errors.items():
        change = changed.channel(name) - points.channel(name) - (there[name] - here[name])
        after = one.error + change[np.isfinite(points.channel(name))]
        if np.all(np.isfinite(after)):
            out[name] = after
    return out


class Away(NamedTuple):
    """Error of one channel of a sweep."""

    error: float  #: in any unit that is the same before and after
    share: float  #: error as a share of the channel's usual size
    matched: bool = True  #: False if the error is not small compared with measured and expected values


class ExplainingMistake(NamedTuple):
    """A mistake that explains a sweep."""

    mistake: Mistake
    left: float  #: largest remaining error of a channel, as a share of its usual size


def explaining(
    candidates: Iterable[tuple[Mistake, Points]],
    gross: Mapping[str, float],
    away: Callable[[Points], Mapping[str, Away]],
    tolerated: Mapping[str, float],
) -> ExplainingMistake | None:
    """The mistake with the smallest remaining error once it is undone; None if no mistake explains the gross errors.

    ``candidates`` are mistakes with the corrected points of the sweep. ``tolerated`` limits the remaining error of every channel,
    so that a correction makes no new error elsewhere.
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


DEGREES = float(np.degrees(1.0))
STEP = 1e-4
"""Step of the finite difference over a set-point [rad], relative for load and pressure."""
Shape = Callable[[Points, Simulation, Collection[str]], Mapping[str, np.ndarray]]
"""Returns, by channel, the change of the errors per unit of an offset or gain."""


@dataclass(frozen=True, slots=True)
class Shift:
    """An offset, gain or wrong set-point of a sweep, with a size to be fitted."""

    looks: str  #: words with {} for the size
    shape: Shape
    possible: tuple[float, float] = (-math.inf, math.inf)  #: smallest and largest possible size
    unit: float = 1.0  #: factor on the size in the sentence
    start: float = 0.0  #: added to the size in the sentence
    sign: str = ""  #: channel from whose sign in the rig's axes the size takes its sign


def _constant(channel: str) -> Shape:
    return lambda points, simulation, among: {channel: np.ones(len(points))}


def _gain(channel: str) -> Shape:
    return lambda points, simulation, among: (
        {channel: simulation.readings(points, (channel,))[channel]} if channel in among else {}
    )


def _set_point(name: str, relative: bool = False) -> Shape:
    def shape(points: Points, simulation: Simulation, among: Collection[str]) -> Mapping[str, np.ndarray]:
        value = getattr(points, name)
        there = points.replace(**{name: value * (1.0 + STEP) if relative else value + STEP})
        before, after = simulation.readings(points, among), simulation.readings(there, among)
        return {channel: (after[channel] - before[channel]) / STEP for channel in before}

    return shape


POSITIVE = (-1.0, math.inf)
"""Possible relative changes of a quantity that must stay positive."""
SHIFTS = (
    *(
        Shift(f"a zero offset of {{}} {known.unit} in {heading(name)}", _constant(name), sign=name)
        for name, known in CHANNELS.items()
    ),
    *(Shift(f"a gain of {{}} in {heading(name)}", _gain(name), POSITIVE, start=1.0) for name in CHANNELS),
    *(
        Shift(
            f"a {word} axis that is {{}} deg out",
            _set_point(name),
            (BY_NAME[zero].lower / DEGREES, BY_NAME[zero].upper / DEGREES),
            unit=DEGREES,
            sign=name,
        )
        for name, word, zero in (("alpha", "sideslip", "alpha_0_deg"), ("gamma", "camber", "gamma_0_deg"))
    ),
    Shift("a load that was {} % off", _set_point("Fz", relative=True), POSITIVE, unit=100.0),
    Shift("a pressure that was {} % off", _set_point("p", relative=True), POSITIVE, unit=100.0),
)


def explanation(points: Points, errors: Errors, simulation: Simulation, signs: Signs) -> str:
    """The cause that explains most of the errors of a sweep, in words; empty if no known cause does."""
    before = _chi2(errors, {name: one.error for name, one in errors.items()})
    best, said = (1.0 - EXPLAINED_SHARE) * before, ""
    for mistake in MISTAKES:
        undone = mistake.undone(points, signs)
        left = moved(points, errors, simulation, undone)
        gained = before - _chi2(errors, left)
        if gained > best and (mistake.units is None or _agrees_in_size(points, undone, left)):
            best, said = gained, mistake.looks
    for shift in SHIFTS:
        gained, size, u = _fitted(points, errors, shift.shape(points, simulation, errors))
        if gained > best and shift.possible[0] < size < shift.possible[1]:
            best = gained
            value = shift.start + shift.unit * signs.get(shift.sign, 1.0) * size
            said = shift.looks.format(to_uncertainty(value, shift.unit * u, "" if shift.start else "+"))
    return said


def _agrees_in_size(points: Points, undone: Points, left: Mapping[str, np.ndarray]) -> bool:
    """Whether what is left is small against the readings in the other unit: any are near a model near zero once they are divided
    by 1000.
    """
    there = {name: undone.channel(name) for name in left}
    changed = [name for name in left if not np.array_equal(there[name], points.channel(name), equal_nan=True)]
    return all(
        np.linalg.norm(left[name]) <= EXPLAINED_SHARE * np.linalg.norm(there[name][np.isfinite(there[name])])
        for name in changed
    )


def _fitted(points: Points, errors: Errors, shapes: Mapping[str, np.ndarray]) -> tuple[float, float, float]:
    """Decrease of chi-square by the best multiple of the shapes, this multiple, and its standard uncertainty."""
    curvature = gradient = 0.0
    for name in (name for name in errors if name in shapes):
        shape = shapes[name][np.isfinite(points.channel(name))]
        solved = np.linalg.solve(errors[name].covariance, shape)
        curvature += float(shape @ solved)
        gradient += float(errors[name].error @ solved)
    if curvature <= 0.0:
        return 0.0, 0.0, 0.0
    return gradient**2 / curvature, gradient / curvature, curvature**-0.5


def _chi2(errors: Errors, left: Mapping[str, np.ndarray]) -> float:
    """Chi-square of the remaining errors ``left``; infinite if a channel lacks readings."""
    if left.keys() != errors.keys():
        return math.inf
    return sum(one.chi2(left[n]) for n, one in errors.items())

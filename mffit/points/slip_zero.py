"""Slip at zero longitudinal force over load, and conversion of slip against another radius to slip against free rolling.

A wheel without longitudinal force rolls freely. Slip against the loaded radius ``l`` is ``omega l / V - 1``; slip of the
Magic Formula is ``omega Re / V - 1`` with the radius ``Re`` of free rolling. With the slip ``s0 = l / Re - 1`` at which the
force is zero, ``kappa = (1 + s) / (1 + s0) - 1``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from mffit.config import Config
from mffit.constants import STRAIGHT, WEAKEST_DIRECTION
from mffit.errors import InputError
from mffit.points import constants
from mffit.points.levels import CAMBER, LOAD, PRESSURE, SIDESLIP, SPEED, LevelKind
from mffit.points.slip_form import ROAD, Over, SlipForm, over_road, slip_form
from mffit.scatter import ALARM, finite_median, robust
from mffit.sweeps import Sweep
from mffit.sweeps.columns import standing
from mffit.sweeps.sweep import MeasuredRows
from tir.constants import EFFECTIVE_RADIUS_RANGE
from tir.errors import listed, some
from tir.frozen import ReadOnlyArrays
from tir.parameters import BY_NAME

FREE, LOADED, UNLOADED = "free-rolling", "loaded-radius", "unloaded-radius"
"""Possible references of a slip column."""
WEAKEST = constants.SOFTEST_SLIP_STIFFNESS * constants.SMALLEST_SWEEP_OF_SLIP
"""|Fx| over load that every driven tyre exceeds."""
STIFFEST = BY_NAME["PKX1"].bounds[1]
"""Slope of Fx over load and slip beyond which a channel moves too little to be the slip."""
ROUNDING = 1e-12
"""Change of slip over Fx and load that the estimate makes of readings at one slip."""
FROM_SPEEDS = "slip from wheel and road speed"
"""Replaces the heading if a rig records no slip."""


class SlipRemarks(NamedTuple):
    """Remarks on the definition of slip, and undeclared shifts."""

    notes: tuple[str, ...]  #: the assumed definition, if nothing contradicts it
    warnings: tuple[str, ...]  #: contradictions and undeclared shifts
    taken_off: Mapping[str, tuple[SlipZero, str]]  #: by file, an undeclared shift, and the sentence about it


class Driven(NamedTuple):
    """Readings (n,) in any axes; only the magnitudes of load and angles are used."""

    kappa: np.ndarray
    Fx: np.ndarray  #: [N]
    Fz: np.ndarray  #: [N]
    alpha: np.ndarray  #: [rad]
    gamma: np.ndarray  #: [rad]
    p: np.ndarray  #: [Pa]
    RL: np.ndarray  #: loaded radius [m]; NaN where it was not measured
    V: np.ndarray  #: speed [m/s]; NaN where it was not measured


class ZeroAtLoad(NamedTuple):
    """Slip at which the longitudinal force is zero at one load, at the smallest camber and sideslip that were run."""

    load: float  #: [N]
    slip: float


@dataclass(frozen=True, slots=True)
class SlipZero(ReadOnlyArrays):
    """The slip at which the longitudinal force is zero, over load, pressure, camber and sideslip."""

    slope: float  #: slope of force per load over slip, at zero force
    levels: tuple[ZeroAtLoad, ...]
    middle: Driven  #: usual size of each reading, (1,)
    coefficients: np.ndarray  #: factors of :func:`_conditions`, for the slip or for ``(1 + slip) / RL`` [1/m]
    per_radius: bool = False  #: whether the measured loaded radius explains the slip better

    def at(self, of: Driven) -> np.ndarray:
        """The slip (n,) of zero force at the conditions of some readings, and at their loaded radius with ``per_radius``."""
        found = _conditions(of, self.middle) @ self.coefficients
        return np.asarray(of.RL * found - 1.0 if self.per_radius else found)

    @property
    def reversed(self) -> SlipZero:
        """The record for slip with the opposite sign."""
        assert not self.per_radius
        turned = tuple(ZeroAtLoad(level.load, -level.slip) for level in self.levels)
        return replace(self, slope=-self.slope, levels=turned, coefficients=-self.coefficients)

    @property
    def largest(self) -> float:
        """Largest absolute slip of zero force over the loads."""
        return max(abs(level.slip) for level in self.levels)

    @property
    def is_free_rolling(self) -> bool:
        """Whether the slip is against free rolling, that is zero where the force is zero."""
        return self.largest <= constants.SLIP_OF_ZERO_FORCE

    @property
    def falls(self) -> bool:
        """Whether the slip of zero force changes with load, as it does for slip against the loaded radius."""
        slips = [level.slip for level in self.levels]
        return max(slips) - min(slips) > constants.SLIP_OF_ZERO_FORCE

    @property
    def against(self) -> str | None:
        """The reference of the slip; None if it is another one. The loaded radius is smaller than that of free rolling."""
        if self.is_free_rolling:
            return FREE
        if not self.falls:
            return None
        return LOADED if max(self.levels, key=lambda level: abs(level.slip)).slip < 0.0 else UNLOADED

    @property
    def within(self) -> str:
        """A clause that the zeros are small."""
        return f"Fx = 0 lies at slip 0 within {max(self.largest, 1e-4):.4f} at {self._loads}"

    @property
    def _loads(self) -> str:
        return f"{listed([f'{level.load:.0f}' for level in self.levels])} N"

    @property
    def said(self) -> str:
        """The zeros with their loads, in words."""
        slips = listed([f"{level.slip:+.4f}" for level in self.levels])
        return f"{slips} at {self._loads}"


def slip_zero(of: Driven) -> SlipZero | None:
    """The slip of zero longitudinal force; None if slip hardly varies or too few readings lie near zero force.

    Readings are needed on both sides of zero force or, if slip was run in steps, at it.
    """
    if (
        not np.nanmax(of.kappa, initial=-np.inf) - np.nanmin(of.kappa, initial=np.inf)
        >= constants.SMALLEST_SWEEP_OF_SLIP
    ):
        return None  # a freely rolling wheel: the slope of Fx over slip is only noise
    load = np.abs(of.Fz)
    with np.errstate(invalid="ignore", divide="ignore"):
        force = of.Fx / load
    near = np.all(np.isfinite([*of[:-2], force]), axis=0) & (load > constants.UNLOADED * finite_median(load))
    near &= np.abs(force) < constants.NEAR_ZERO
    in_steps = min(np.sum(force[near] > WEAKEST), np.sum(force[near] < -WEAKEST)) < constants.FEWEST_POINTS
    if in_steps and np.sum(np.abs(force[near]) <= WEAKEST) < constants.FEWEST_POINTS:
        return None
    used = Driven(*(np.asarray(x, dtype=float)[near] for x in of))
    x = force[near]
    middle = Driven(*(np.median(np.abs(values), keepdims=True) for values in used))
    conditions, compliance = _conditions(used, middle) * _varied(used), _compliance(used, middle)
    design = np.column_stack([conditions, x[:, None] * compliance, x**3])
    solution, scatter = _robust_lines(design, used.kappa)
    k = conditions.shape[1]
    found = solution[:k]
    inverse = float(compliance.mean(axis=0) @ solution[k:-1])
    every = np.isfinite(of.kappa) & np.isfinite(force)
    if in_steps:  # too few readings for the slope at zero: take sign and size from the whole curve
        driven = every & (np.abs(force) > WEAKEST)
        if not np.any(driven):
            return None
        inverse = float(np.median((of.kappa - _conditions(of, middle) @ found)[driven] / force[driven]))
    elif abs(inverse) < ROUNDING:
        return None  # the force passes zero at one slip
    if inverse * float(np.mean(of.kappa[every] * force[every])) < 0.0:
        return None  # the line through few points near zero contradicts the whole curve
    zero = SlipZero(1.0 / inverse if inverse else np.nan, _at_loads(used, middle, found), middle, found)
    if np.all(np.isfinite(of.RL)):
        by_radius, left = _robust_lines(design, (1.0 + used.kappa) / used.RL)
        if left * middle.RL < scatter:
            return replace(zero, coefficients=by_radius[:k], per_radius=True)
    return zero


def unexplained_drive(of: Driven) -> float:
    """Range of Fx over the load, straight ahead; 0 if the slip moves enough to explain it by the stiffest tyre."""
    load = np.abs(of.Fz)
    straight = np.all(np.isfinite([of.kappa, of.Fx, load]), axis=0) & (np.abs(of.alpha) < STRAIGHT.rad)
    straight &= load > constants.UNLOADED * finite_median(load)
    if np.sum(straight) < constants.FEWEST_POINTS:
        return 0.0
    driven = (of.Fx[straight] / load[straight], of.kappa[straight])
    drive, slip = (float(np.ptp(np.percentile(x, constants.CORE))) for x in driven)
    return drive if drive > max(WEAKEST, STIFFEST * slip) else 0.0


def against_free_rolling(
    sweeps: Sequence[Sweep], config: Config, *, with_errors: bool = False
) -> tuple[tuple[Sweep, ...], SlipRemarks]:
    """The sweeps with slip against free rolling, and remarks on its definition and shift.

    Files whose slip has the same heading share the definition and the zero: a file in which the wheel rolls freely shows the zero
    at its conditions, and one that is driven shows what the slip is against. ``with_errors``: an undeclared zero that is the same
    at every load stays in the slip as a rig error.
    """
    stated = _stated(config)
    sweeps, derived = _with_slip(sweeps, config.tyre.unloaded_radius)
    # Slip that was not recorded but computed from speeds.
    from_speeds = _Stated(FROM_SPEEDS, None, ROAD)
    stated |= {s.file: from_speeds for s in sweeps if "kappa" not in s.table and np.any(s.kappa)}
    out = list(sweeps)
    notes: list[str] = []
    warnings: list[str] = [*derived]
    taken_off: dict[str, tuple[SlipZero, str]] = {}
    for of in dict.fromkeys(stated.values()):
        rows = [k for k, sweep in enumerate(sweeps) if stated[sweep.file] == of]
        own, form, zero = _of_column(of, [sweeps[k] for k in rows], config)
        if form is not None:
            warnings.append(_of_form(of.heading, form))
        # A mean radius is the reference of slip from speeds: nothing but Fx = 0 corrects it, and it needs no remark.
        shifted = zero is not None and of.heading == FROM_SPEEDS
        left = with_errors and of.against is None and zero is not None and not zero.falls
        if zero is not None and not shifted and not left:
            is_free, said = zero.is_free_rolling, sentence(of.heading, of.against, zero)
            if not (of.against == FREE and is_free):  # no remark if the declaration is right
                expected = of.against is None if is_free else of.against not in (None, FREE)
                (notes if expected else warnings).append(said)
            shifted = not is_free if of.against is None else of.against != FREE
            if shifted and of.against is None:
                taken_off |= {one.file: (zero, said) for one in own}
        for k, one in zip(rows, own, strict=True):
            out[k] = _less(one, zero) if zero is not None and shifted else one
    return tuple(out), SlipRemarks(tuple(notes), tuple(warnings), taken_off)


def _of_column(
    of: _Stated, own: Sequence[Sweep], config: Config
) -> tuple[Sequence[Sweep], SlipForm | None, SlipZero | None]:
    """The sweeps of a slip column over the road's speed, an undeclared form of it, and the slip of zero force; None if unknown.

    Raises InputError if the forces or the speeds contradict the column.
    """
    wrong = partial(InputError, file=config.path or config.sweep[0].file)
    if of.over is not None:
        own = _over_road(own, of.over)
    readings = Driven(*map(np.concatenate, zip(*map(readings_of, own), strict=True)))
    if _too_weak(readings):
        raise wrong(_weak(readings, config), key="columns.Fx_N")
    if drive := unexplained_drive(readings):
        recorded = any("kappa" in one.table for one in own)
        raise wrong(_not_driven_by(of.heading, drive, recorded), key="columns.kappa")
    zero = slip_zero(readings)
    if zero is None:
        return own, None, None
    zero = slip_zero(_with_free_wheels(readings, zero)) or zero
    from_speeds = of.heading == FROM_SPEEDS
    form = None if from_speeds else form_of(readings, _wheel_speed(own))
    said, key = _contradiction(of.heading, zero, from_speeds or (form is not None and form.over is not None))
    if said:
        raise wrong(said, key=f"columns.{key}")
    if form is None or form.over == ROAD:
        return own, None, zero
    if of.over is not None:
        said = f'{of.heading} is declared over = "{of.over}", which contradicts the recorded speeds: '
        said += form.said(of.heading if of.over == ROAD else "what follows from it")
        raise wrong(said, key="columns.kappa.over")
    if form.over is not None:
        own = _over_road(own, form.over)
        readings = readings._replace(kappa=over_road(readings.kappa, form.over))
        zero = slip_zero(_with_free_wheels(readings, zero)) or zero
    return own, form, zero


class _Stated(NamedTuple):
    """What ``tyre.toml`` says about the slip of a file."""

    heading: str
    against: str | None
    over: Over | None


def _stated(config: Config) -> dict[str, _Stated]:
    """By file, what is declared about its slip, by the file itself or by the only other declaration for the same heading."""
    columns = {
        entry.file: entry.columns.get("kappa") or config.columns.get("kappa") for entry in config.sweep
    }
    said = {
        file: _Stated("kappa", None, None) if c is None else _Stated(c.column or "kappa", c.against, c.over)
        for file, c in columns.items()
    }
    alike: dict[str, list[_Stated]] = {}
    for one in said.values():
        alike.setdefault(one.heading, []).append(one)

    def completed(one: _Stated) -> _Stated:
        against = {of.against for of in alike[one.heading] if of.against is not None}
        over = {of.over for of in alike[one.heading] if of.over is not None}
        return _Stated(
            one.heading,
            one.against or (against.pop() if len(against) == 1 else None),
            one.over or (over.pop() if len(over) == 1 else None),
        )

    return {file: completed(one) for file, one in said.items()}


def _with(sweep: Sweep, kappa: np.ndarray) -> Sweep:
    """The sweep with another slip, which its table shows next to the one as read."""
    return replace(sweep, kappa=kappa, table=sweep.table.assign(kappa_free_rolling=kappa))


def _over_road(sweeps: Sequence[Sweep], over: Over) -> Sequence[Sweep]:
    """The sweeps with slip over the road's speed, from slip in another form."""
    return sweeps if over == ROAD else [_with(one, over_road(one.kappa, over)) for one in sweeps]


def _less(sweep: Sweep, zero: SlipZero) -> Sweep:
    """The sweep with slip against the radius at which the zero finds no force."""
    return _with(sweep, (1.0 + sweep.kappa) / (1.0 + zero.at(readings_of(sweep))) - 1.0)


def _wheel_speed(sweeps: Sequence[Sweep]) -> np.ndarray:
    """Speed of the wheel (n,) of all sweeps [rad/s]; NaN where it or the road's speed was not recorded."""
    return np.concatenate([s.omega if "V_mps" in s.table else np.full(len(s), np.nan) for s in sweeps])


def form_of(of: Driven, omega: np.ndarray) -> SlipForm | None:
    """The form of the slip that the speed of the wheel (n,) [rad/s] shows, NaN where it or the road's was not recorded.

    None if the speeds do not show it.
    """
    along = of.V * np.cos(of.alpha)
    rolling = along > constants.UNLOADED * finite_median(along)
    turns = np.where(rolling, np.abs(omega) / np.where(rolling, along, 1.0), np.nan)
    middle = Driven(*(np.full(1, finite_median(np.abs(x))) for x in of))
    return slip_form(of.kappa, turns, _conditions(of, middle) * _varied(of))


def _of_form(heading: str, form: SlipForm) -> str:
    """A sentence on a slip that is not over the road's speed, as nothing declares."""
    if form.over is None:
        return form.said(heading)
    return f'{form.said(heading)}; converted (over = "{form.over}" for kappa under [columns] says the same)'


def sentence(heading: str, against: str | None, zero: SlipZero) -> str:
    """A sentence on the reference of a slip column, and on the subtracted shift."""
    found = f"Fx = 0 lies at slip {zero.said}"
    if zero.is_free_rolling:
        if against in (LOADED, UNLOADED):
            return f"{heading} is declared against the {_word(against)}, but {found}, as against free rolling; taken off"
        return f"{heading} is against free rolling: {zero.within}"
    if against == FREE:
        return (
            f"{heading} is declared against free rolling, but {found}; if it is against the {_word(zero.against or LOADED)}, "
            f'write against = "{zero.against or LOADED}" for kappa under [columns]'
        )
    if zero.against is not None:
        return f"{heading} is against the {_word(zero.against)}: {found}; taken off, so that slip is against free rolling"
    return f"the zero of {heading} is not free rolling: {found}; taken off"


def _word(against: str) -> str:
    return against.replace("-", " ")


def _with_free_wheels(of: Driven, zero: SlipZero) -> Driven:
    """The readings, with zero force where it was not measured and all slips are those of a wheel that rolls freely."""
    unknown = ~np.isfinite(of.Fx)
    kappa = (1.0 + of.kappa[unknown]) / (1.0 + zero.at(of)[unknown]) - 1.0
    kappa = kappa[np.isfinite(kappa)]
    if not len(kappa) or np.max(np.abs(np.percentile(kappa, constants.CORE))) > constants.SLIP:
        return of
    return of._replace(Fx=np.where(unknown, 0.0, of.Fx))


def _too_weak(of: Driven) -> bool:
    """Whether Fx over load is smaller than for any tyre although slip is large enough."""
    shown = (np.abs(of.kappa) > constants.SMALLEST_SWEEP_OF_SLIP) & np.isfinite(of.Fx) & (np.abs(of.Fz) > 0.0)
    if np.sum(shown) < constants.FEWEST_POINTS or np.ptp(of.kappa[shown]) < constants.SMALLEST_SWEEP_OF_SLIP:
        return False  # a wheel without drive
    return bool(np.max(np.abs(of.Fx[shown] / of.Fz[shown])) < WEAKEST)


def _not_driven_by(heading: str, drive: float, recorded: bool) -> str:
    """The error sentence for a longitudinal force without slip, with the remedy."""
    force = f"Fx changes by {drive:.2g} times the load straight ahead"
    if recorded:
        return (
            f"{heading} hardly moves while {force}, so it is not the slip: map the column that is, or remove kappa to take slip "
            "from the speeds of wheel and road"
        )
    return (
        f"{force}, so the wheel is driven or braked, but no slip is known, nor speeds of wheel and road that give it: name its "
        "column, kappa = \"HEADING\" under [columns] or --column 'kappa=HEADING', or leave these readings out"
    )


def _weak(of: Driven, config: Config) -> str:
    """The error sentence for a longitudinal force that is too small, with the remedy."""
    column = config.columns.get("Fx_N")
    heading = (column.column if column is not None else None) or "Fx_N"
    return (
        f"Fx is at most {np.nanmax(np.abs(of.Fx)):.3g} N at loads of {np.nanmedian(np.abs(of.Fz)):.0f} N and slips of up to "
        f"{np.nanmax(np.abs(of.kappa)):.2f}, which looks like kN; write newtons, or "
        f'Fx_N = {{ column = "{heading}", unit = "kN" }} under [columns]'
    )


def _contradiction(heading: str, zero: SlipZero, by_speeds: bool) -> tuple[str, str]:
    """Why a column cannot be slip as a ratio that is positive when driven, empty if it can, and the channel to correct.

    ``by_speeds``: the recorded speeds give this slip or agree with it, so that a wrong sign is that of the force.
    """
    if abs(zero.slope) < constants.SOFTEST_SLIP_STIFFNESS:
        said = (
            f"Fx rises by {zero.slope:.2g} times the load per unit of {heading}, tyres by "
            f'{constants.SOFTEST_SLIP_STIFFNESS:g} or more: it looks like per cent; write unit = "%" for kappa under [columns]'
        )
    elif zero.slope < 0.0 and by_speeds:
        said = f"Fx falls with {heading}, which the recorded speeds confirm; write scale = -1 for Fx_N under [columns]"
        return said, "Fx_N"
    elif zero.slope < 0.0:
        said = f"Fx falls with {heading}, so braking is positive there; write scale = -1 for kappa under [columns]"
    elif zero.largest > 1.0 - EFFECTIVE_RADIUS_RANGE[0]:
        said = f"Fx = 0 lies at {heading} {zero.said}, which no radius explains; check this column"
    else:
        said = ""
    return said, "kappa"


def readings_of(rows: MeasuredRows) -> Driven:
    """The readings of a sweep or of points."""
    return Driven(*(getattr(rows, name) for name in Driven._fields))


def _conditions(of: Driven, middle: Driven) -> np.ndarray:
    """Columns (n, k) of a linear model of the zero: load, pressure, camber and sideslip to second order, squared speed.

    The speed term is the growth of the free radius with the square of the speed.
    """
    load, camber = np.abs(of.Fz) / middle.Fz - 1.0, np.abs(of.gamma)
    nothing = np.zeros(len(load))
    pressure = of.p / middle.p - 1.0 if middle.p else nothing
    columns = (
        np.ones(len(load)),
        load,
        load**2,
        pressure,
        pressure * load,
        pressure**2,
        camber,
        camber**2,
        camber * load,
        np.abs(of.alpha),
        of.alpha**2,
        np.nan_to_num((of.V / middle.V) ** 2 - 1.0) if middle.V > 0.0 else nothing,
    )
    return np.column_stack(columns)


def _varied(of: Driven) -> np.ndarray:
    """1 for the columns (k,) of :func:`_conditions` whose settings were run at several levels; 0 for those that only scatter."""

    def several(x: np.ndarray, kind: LevelKind) -> bool:
        low, high = np.nanpercentile(np.abs(x), constants.CORE)
        return bool(high - low > kind.tolerance * (high if kind.relative else 1.0))

    load, pressure, camber = several(of.Fz, LOAD), several(of.p, PRESSURE), several(of.gamma, CAMBER)
    sideslip = several(of.alpha, SIDESLIP)
    speed = bool(np.any(np.isfinite(of.V))) and several(of.V, SPEED)
    second = (pressure, pressure and load, pressure)
    return np.array(
        (True, load, load, *second, camber, camber, camber and load, sideslip, sideslip, speed), dtype=float
    )


def _compliance(of: Driven, middle: Driven) -> np.ndarray:
    """Columns (n, k) of slip per force over load: constant, load, squared sideslip."""
    load = np.abs(of.Fz) / middle.Fz - 1.0
    return np.column_stack([np.ones(len(load)), load, of.alpha**2])


def _robust_lines(design: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, float]:
    """Least-squares solution after rejection of outliers, and the robust scatter; empty columns get zero."""
    size = np.linalg.norm(design, axis=0)
    scaled = design / np.where(size > 0.0, size, 1.0)
    solution, *_ = np.linalg.lstsq(scaled, y, rcond=WEAKEST_DIRECTION)
    residual = y - scaled @ solution
    kept = np.abs(residual) <= ALARM * robust(residual)
    if np.sum(kept) > design.shape[1]:
        solution, *_ = np.linalg.lstsq(scaled[kept], y[kept], rcond=WEAKEST_DIRECTION)
    scatter = robust(y - scaled @ solution)
    return np.asarray(solution / np.where(size > 0.0, size, 1.0)), scatter


def _at_loads(of: Driven, middle: Driven, coefficients: np.ndarray) -> tuple[ZeroAtLoad, ...]:
    """The zero at a low, the median and a high load, at the smallest camber and sideslip that were run."""
    low, high = constants.CORE
    loads = np.unique(np.percentile(np.abs(of.Fz), [low, 50.0, high]).round())
    usual = Driven(*(np.broadcast_to(value, len(loads)) for value in middle))
    straight, upright = (np.full(len(loads), np.min(np.abs(angle))) for angle in (of.alpha, of.gamma))
    zeros = _conditions(usual._replace(Fz=loads, alpha=straight, gamma=upright), middle) @ coefficients
    return tuple(map(ZeroAtLoad, loads.tolist(), zeros.tolist()))


def _with_slip(sweeps: Sequence[Sweep], unloaded_radius: float) -> tuple[tuple[Sweep, ...], tuple[str, ...]]:
    """The sweeps, with slip computed from speeds if it was not recorded but the wheel was driven; and a sentence about it.

    Slip is ``omega R / (V cos alpha) - 1`` with the mean radius at the load. Its zero is free rolling only if driving and braking
    balance; if Fx was measured, the zero is later set to Fx = 0.
    """
    out, files = [], []
    for sweep in sweeps:
        unknown = "kappa" not in sweep.table and "V_mps" in sweep.table
        slip = slip_from_speeds(readings_of(sweep), sweep.omega, unloaded_radius) if unknown else None
        files += [] if slip is None else [sweep.file]
        out.append(sweep if slip is None else replace(sweep, kappa=slip))
    said = (
        f"{some(list(dict.fromkeys(files)))}: no slip was recorded, but wheel and road speed show that the wheel was driven or "
        "braked; slip follows from both, with its zero at Fx = 0 where Fx was measured"
    )
    return tuple(out), (said,) if files else ()


def slip_from_speeds(of: Driven, omega: np.ndarray, radius: float) -> np.ndarray | None:
    """Slip (n,) of a driven or braked wheel from its speed (n,) [rad/s] and the road's; None if it rolled freely.

    ``radius`` [m] is that of the unloaded wheel; how much smaller the rolling one is at each load is taken off. NaN at
    standstill.
    """
    along = of.V * np.cos(of.alpha)
    turning = np.isfinite(omega) & (along > 0.0) & ~standing(along)
    if not np.any(turning):
        return None
    slip = np.full(len(along), np.nan)
    slip[turning] = np.abs(omega[turning]) * radius / along[turning] - 1.0
    rolling = _over_load(slip[turning], np.abs(of.Fz[turning]))
    slip[turning] = (1.0 + slip[turning]) / (1.0 + rolling) - 1.0
    low, high = np.nanpercentile(slip, constants.CORE)
    return slip if high - low >= constants.SMALLEST_SWEEP_OF_SLIP else None


def _over_load(slip: np.ndarray, Fz: np.ndarray) -> np.ndarray:
    """Parabola of the slip over load, at each load (n,): the slip of free rolling against the unloaded radius."""
    if np.ptp(Fz) < constants.CONDITION * np.median(Fz):
        return np.full(len(slip), np.median(slip))
    powers = np.vander((Fz - np.mean(Fz)) / np.ptp(Fz), 3)
    solution, *_ = np.linalg.lstsq(powers, slip, rcond=1e-6)  # two loads leave the shortest parabola
    return np.asarray(powers @ solution)

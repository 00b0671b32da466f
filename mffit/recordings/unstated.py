"""Units that a file does not state: columns of one kind are decided together, and each choice comes with its reason."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from mffit.constants import HOTTEST_TREAD
from mffit.points.clock import spread
from mffit.recordings import constants
from mffit.sweeps.channels import BY_NAME, Channel
from mffit.sweeps.columns import implausible
from mffit.sweeps.units import converted, factor, spelt


class FoundChannel(NamedTuple):
    """A column of numbers that is a channel."""

    channel: Channel
    heading: str
    unit: str  #: as stated, or the contract's unit under the contract's heading; "" if neither gives it
    values: np.ndarray  #: (n,), NaN where there is no reading

    @property
    def size(self) -> float:
        """The largest reading except for spikes; 0 without readings."""
        seen = np.abs(self.values[np.isfinite(self.values)])
        return float(np.percentile(seen, constants.PERCENTILE_OF_SIZE)) if len(seen) else 0.0

    @property
    def range(self) -> str:
        """Lowest and highest reading, for a sentence."""
        return f"{np.nanmin(self.values):.3g} to {np.nanmax(self.values):.3g}"


class Choice(NamedTuple):
    """A unit that no file states."""

    unit: str
    why: str  #: follows "the file states no unit: "


class Choices(NamedTuple):
    """What is decided about the columns of a file, by channel."""

    chosen: dict[str, Choice]
    left_out: dict[str, str]  #: why a column is left out


KINDS_OF_ONE_UNIT = ("deg", "N", "N m")
"""Channels with these contract units usually share a unit in a file."""
PRESSURE_UNITS = ("bar", "psi", "kPa", "MPa", "Pa")
"""Sorted by priority."""
TIME_UNITS = ("s", "ms", "us")
"""Sorted by priority."""
ROTATION_UNITS = ("rad/s", "rpm")
SPEED_UNITS = ("m/s", "km/h", "mph")
CUSTOMARY = {"N": "lbf", "N m": "in-lb", "kPa": "psi", "m/s": "mph", "degC": "degF", "m": "in"}
"""American units by the contract's."""
FOOT_POUNDS = "ft-lb"
AMERICAN = frozenset(spelt(unit) for unit in (*CUSTOMARY.values(), FOOT_POUNDS))
LENGTH_UNITS = ("m", "mm", "cm", "in")


def choices(found: Mapping[str, FoundChannel], radius: float | None) -> Choices:
    """Units of the columns for which nothing states one, and optional columns that are implausible in any unit.

    Parameters
    ----------
    found : columns of numbers by channel
    radius : unloaded [m]; None if it is not known
    """
    chosen: dict[str, Choice] = {}
    american = _american_sign(found, radius)
    for kind in KINDS_OF_ONE_UNIT:
        for group in _groups(kind, found):
            chosen |= _shared_unit(kind, group, _load(found, chosen))
    for name, column in found.items():
        if not column.unit and column.channel.unit and name not in chosen and name != "omega_radps":
            chosen[name] = _own_unit(name, found, chosen, radius)
    if american is not None and not _has_other_units(found, chosen):
        chosen |= _american(found, chosen, american)
    if (speed := _speed_of_wheel(found, chosen, radius)) is not None:
        chosen["V_mps"] = speed
    rotation = _rotation(found, chosen, radius)
    left_out = {"omega_radps": rotation} if isinstance(rotation, str) else {}
    if isinstance(rotation, Choice):
        chosen["omega_radps"] = rotation
    for name in found:
        if name not in left_out and (reason := _implausible(name, found, chosen)):
            left_out[name] = reason
    return Choices({name: chosen[name] for name in chosen if name not in left_out}, left_out)


def _groups(kind: str, found: Mapping[str, FoundChannel]) -> list[dict[str, FoundChannel]]:
    """Columns of one kind that share a unit: all, unless forces exceed the load more than the grip of any tyre allows."""
    group = {name: column for name, column in found.items() if column.channel.unit == kind}
    load = {name: column for name, column in group.items() if name == "Fz_N"}
    rest = {name: column for name, column in group.items() if name not in load}
    largest = max((column.size for column in rest.values()), default=0.0)
    if load and largest > constants.GRIP_THAT_MEANS_ANOTHER_UNIT * load["Fz_N"].size:
        return [load, rest]
    return [group] if group else []


def _shared_unit(kind: str, group: Mapping[str, FoundChannel], load: float) -> dict[str, Choice]:
    """One unit for all columns of a group that state none: that of another column, else the one that fits."""
    stated = next((column for column in group.values() if column.unit), None)
    unit = stated.unit if stated else _fitting_unit(kind, group, load)
    headings = ", ".join(column.heading for column in group.values())
    shared = f"; {headings} share a unit" if len(group) > 1 else ""

    def reason(column: FoundChannel) -> str:
        if stated:
            return f"{column.range} assumed to be in {unit}, like {stated.heading}"
        return _look_like(column, unit) + shared

    return {name: Choice(unit, reason(column)) for name, column in group.items() if not column.unit}


def _fitting_unit(kind: str, group: Mapping[str, FoundChannel], load: float) -> str:
    size = max(column.size for column in group.values())
    if kind == "deg":
        return "rad" if size < constants.LARGEST_ANGLE_IN_RADIANS else "deg"
    if kind == "N":
        return "kN" if size < constants.LARGEST_FORCE_IN_KILONEWTONS else "N"
    return "kN m" if 0.0 < size < constants.SHORTEST_LEVER_ARM_IN_RECORDING * load else "N m"


def _american_sign(found: Mapping[str, FoundChannel], radius: float | None) -> FoundChannel | None:
    """A column that can only be in an American unit, so that the file has American units; None without one.

    A pressure in psi is no such sign: rigs in Europe have gauges in psi, too.
    """

    def is_sign(name: str, column: FoundChannel) -> bool:
        if column.unit:
            return spelt(column.unit) in AMERICAN - {spelt("psi")}
        return (name == "T_degC" and _too_hot(column)) or (
            name == "RL_m" and _lengths(column, radius) == ["in"]
        )

    return next((column for name, column in found.items() if is_sign(name, column)), None)


def _has_other_units(found: Mapping[str, FoundChannel], chosen: Mapping[str, Choice]) -> bool:
    """Whether a pressure or a column with a stated unit is in a unit that is not American."""
    pressure = _unit_of("p_kPa", found, chosen) if "p_kPa" in found else "psi"
    stated = [column for column in found.values() if column.unit and column.channel.unit in CUSTOMARY]
    return spelt(pressure) != spelt("psi") or any(spelt(column.unit) not in AMERICAN for column in stated)


def _american(
    found: Mapping[str, FoundChannel], chosen: Mapping[str, Choice], sign: FoundChannel
) -> dict[str, Choice]:
    """American units of the columns whose kind has no stated unit in any column."""
    settled = {column.channel.unit for column in found.values() if column.unit}
    moments = max((found[name].size for name in chosen if found[name].channel.unit == "N m"), default=0.0)
    arm = moments / found["Fz_N"].size if "Fz_N" in found and found["Fz_N"].size else 0.0
    units = CUSTOMARY | ({"N m": FOOT_POUNDS} if arm < constants.LARGEST_LEVER_ARM_IN_FEET else {})
    given = {}
    for name in chosen:
        column = found[name]
        unit = units.get(column.channel.unit)
        if unit is None or column.channel.unit in settled:
            continue
        if name == "p_kPa" and chosen[name].unit != "psi":
            continue  # readings decide between units that differ by a factor of seven
        if name == "RL_m" and "in" not in _lengths(column, None):
            continue
        why = f"{column.range} assumed to be in {unit}, as {sign.heading} ({sign.range}) is in American units"
        given[name] = chosen[name] if chosen[name].unit == unit else Choice(unit, why)
    return given


def _too_hot(column: FoundChannel) -> bool:
    """Whether temperatures without a unit, or stated in degC, are those of no tyre in degC."""
    return _within(float(np.nanmedian(column.values)), (HOTTEST_TREAD, constants.HOTTEST_TREAD_IN_FAHRENHEIT))


def _lengths(column: FoundChannel, radius: float | None) -> list[str]:
    """Units in which a column is the loaded radius of a tyre."""
    limits: tuple[float, ...] = constants.ANY_LOADED_RADII
    if radius is not None:
        limits = tuple(share * radius for share in constants.ROLLING_RADIUS_RANGE)
    middle = float(np.nanmedian(column.values))
    return [unit for unit in LENGTH_UNITS if _within(factor(unit, "m") * middle, limits)]


def _own_unit(
    name: str, found: Mapping[str, FoundChannel], chosen: Mapping[str, Choice], radius: float | None
) -> Choice:
    """The unit of a column that shares it with no other."""
    column = found[name]
    unit = column.channel.unit
    if unit == "kPa":
        return _pressure(column, _load(found, chosen))
    if name == "RL_m":
        # Between centimetres and inches only the size of the tyre decides; in metres the column is left out.
        possible = _lengths(column, radius)
        return (
            Choice(possible[0], _look_like(column, possible[0])) if len(possible) == 1 else Choice(unit, "")
        )
    if name == "T_degC" and _too_hot(column):
        return Choice("degF", f"{_look_like(column, 'degF')}: no tread stays as hot in degC")
    if name == "time_s":
        return _time(column, _sideslip_deg(found, chosen))
    if name == "V_mps" and column.size >= constants.FASTEST_SPEED_IN_METRES:
        return Choice("km/h", f"{_look_like(column, 'km/h')}, less likely mph")
    return Choice(unit, _look_like(column, unit))


def _unit_of(name: str, found: Mapping[str, FoundChannel], chosen: Mapping[str, Choice]) -> str:
    """Unit of a column, stated or chosen; "" while it is open."""
    return found[name].unit or (chosen[name].unit if name in chosen else "")


def _load(found: Mapping[str, FoundChannel], chosen: Mapping[str, Choice]) -> float:
    """The largest load [N]; 0 while its unit is open."""
    unit = _unit_of("Fz_N", found, chosen) if "Fz_N" in found else ""
    return factor(unit, "N") * found["Fz_N"].size if unit else 0.0


def _sideslip_deg(found: Mapping[str, FoundChannel], chosen: Mapping[str, Choice]) -> np.ndarray | None:
    if "alpha_deg" not in found:
        return None
    return converted(found["alpha_deg"].values, _unit_of("alpha_deg", found, chosen), "deg")


def _look_like(column: FoundChannel, unit: str) -> str:
    return f"{column.range} look like {unit}"


def _pressure(column: FoundChannel, load: float) -> Choice:
    """The unit that gives the pressure of a tyre, with the other units that are possible."""
    middle = float(np.nanmedian(np.abs(column.values)))
    in_kPa = {unit: factor(unit, "kPa") * middle for unit in PRESSURE_UNITS}
    is_lorry = load > constants.LORRY_LOAD
    possible = [unit for unit in PRESSURE_UNITS if _within(in_kPa[unit], constants.ANY_TYRE_PRESSURES)]
    likely = constants.LORRY_TYRE_PRESSURES if is_lorry else constants.CAR_TYRE_PRESSURES
    usual = [unit for unit in possible if _within(in_kPa[unit], likely)]
    unit = next(iter(usual or possible), column.channel.unit)
    others = [f"{other} ({in_kPa[other]:.0f} kPa)" for other in possible if other != unit]
    own = "" if unit == column.channel.unit else f" ({in_kPa[unit]:.0f} kPa)"
    also = f", less likely {' or '.join(others)}" if others else ""
    return Choice(unit, _look_like(column, unit) + own + also)


def _within(value: float, limits: tuple[float, ...]) -> bool:
    least, most = limits
    return least <= value <= most


def _time(column: FoundChannel, alpha_deg: np.ndarray | None) -> Choice:
    """The unit in which the sideslip angle moves as fast as rigs steer."""
    motion = None if alpha_deg is None else _motion(column.values, alpha_deg)
    if motion is None:
        return Choice("s", f"{column.range} assumed to be in s; without a moving angle the unit is not known")
    step, rate = motion
    for unit in TIME_UNITS:
        seconds = factor(unit, "s")
        if unit != "s" and seconds * float(np.ptp(column.values[np.isfinite(column.values)])) < (
            constants.SHORTEST_RECORDING
        ):
            continue  # a table of finished points, not a recording
        if _within(step * seconds, constants.RECORDED_TIME_STEPS) and _within(
            rate / seconds, constants.STEERING_RATES
        ):
            why = f"steps of {step:.3g} look like {unit}, in which the angle moves at {rate / seconds:.2g} deg/s"
            return Choice(unit, why)
    return Choice(
        "s",
        f"steps of {step:.3g} assumed to be in s, but the angle would move at {rate:.2g} deg/s: unit not known",
    )


def _motion(time: np.ndarray, alpha_deg: np.ndarray) -> tuple[float, float] | None:
    """Usual step of time and rate of steering [deg], per unit of time; None if the angle does not move."""
    seen = np.isfinite(time) & np.isfinite(alpha_deg)
    time, alpha_deg = spread(time[seen]), alpha_deg[seen]
    if len(time) < 5 or np.ptp(alpha_deg) < constants.STEERING_TRAVEL:
        return None
    long_enough = len(time) > 4 * constants.SAMPLES_PER_RATE
    width = constants.SAMPLES_PER_RATE if long_enough else 1
    step = float(np.median(np.diff(time)))
    elapsed = time[width:] - time[:-width]
    forwards = elapsed > 0.0
    rates = np.abs(alpha_deg[width:] - alpha_deg[:-width])[forwards] / elapsed[forwards]
    if not (step > 0.0 and len(rates)):
        return None
    return step, float(np.percentile(rates, constants.STEERING_PERCENTILE))


def _speed_of_wheel(
    found: Mapping[str, FoundChannel], chosen: Mapping[str, Choice], radius: float | None
) -> Choice | None:
    """The unit of a speed that nothing states, in which the wheel turns at its rate.

    None if no rate or size of the wheel is known, or no unit fits.
    """
    column, speed = found.get("omega_radps"), found.get("V_mps")
    size = radius or _measured_radius(found, chosen)
    if column is None or speed is None or speed.unit or size is None:
        return None
    fits = [
        (abs(float(np.log(ratio / size))), unit)
        for unit in SPEED_UNITS
        for rotation in ([column.unit] if column.unit else ROTATION_UNITS)
        if 0.0 < (ratio := _rolling_radius(speed, unit, column, rotation)) < np.inf
    ]
    away, unit = min(fits, default=(np.inf, ""))
    if away > np.log(constants.ROLLING_RADIUS_RANGE[1]):
        return None
    return Choice(unit, f"in {unit} they agree with {column.heading} at a radius of {size:.3g} m")


def _measured_radius(found: Mapping[str, FoundChannel], chosen: Mapping[str, Choice]) -> float | None:
    """The loaded radius [m], if it was recorded in a known unit."""
    unit = _unit_of("RL_m", found, chosen) if "RL_m" in found else ""
    if not unit:
        return None
    middle = factor(unit, "m") * float(np.nanmedian(found["RL_m"].values))
    return middle if _within(middle, constants.ANY_LOADED_RADII) else None


def _rolling_radius(speed: FoundChannel, unit: str, rotation: FoundChannel, unit_of_rotation: str) -> float:
    """Median of speed over rotation [m] in these units; infinite or 0 if the wheel or the road rests."""
    V = np.abs(converted(speed.values, unit, "m/s"))
    omega = np.abs(converted(rotation.values, unit_of_rotation, "rad/s"))
    seen = np.isfinite(omega) & np.isfinite(V) & (V > 0.0)
    with np.errstate(divide="ignore"):
        return float(np.median(V[seen] / omega[seen])) if np.any(seen) else np.inf


def _rotation(
    found: Mapping[str, FoundChannel], chosen: Mapping[str, Choice], radius: float | None
) -> Choice | str | None:
    """The unit in which a speed of rotation is that of the wheel, or why it is left out; None if there is nothing to choose."""
    column, speed = found.get("omega_radps"), found.get("V_mps")
    if column is None or column.heading == "omega_radps":
        return None
    if speed is None:
        return f"{column.heading} is left out: without a speed it cannot be checked that it is the wheel's"
    lengths = BY_NAME["RL_m"]
    limits: tuple[float, ...] = (lengths.lower, lengths.upper)
    if radius is not None:
        limits = tuple(share * radius for share in constants.ROLLING_RADIUS_RANGE)
    fits: dict[str, float] = {}
    for unit in (column.unit,) if column.unit else ROTATION_UNITS:
        ratio = _rolling_radius(speed, _unit_of("V_mps", found, chosen), column, unit)
        if _within(ratio, limits):
            fits[unit] = abs(np.log(ratio / np.sqrt(np.prod(limits))))
    if not fits:
        tried = "" if speed.unit else f" in {', '.join(SPEED_UNITS[:-1])} or {SPEED_UNITS[-1]},"
        return (
            f"{column.heading} ({column.range}) is left out: at the speed in {speed.heading},{tried} no wheel of this size turns "
            "at this rate"
        )
    unit = min(fits, key=lambda unit: fits[unit])
    return None if column.unit else Choice(unit, f"in {unit} they agree with {speed.heading}")


def _implausible(name: str, found: Mapping[str, FoundChannel], chosen: Mapping[str, Choice]) -> str:
    """Why an optional column is left out: its readings are outside the plausible range; "" if they are not."""
    column, channel = found[name], found[name].channel
    if channel.required or name == "time_s":
        return ""
    unit = _unit_of(name, found, chosen)
    values = converted(column.values, unit, channel.unit)
    if not implausible(values, channel, may_have_gaps="time_s" in found):
        return ""
    limits = f"{channel.lower:g} to {channel.upper:g} {channel.unit}".rstrip()
    possible = _lengths(column, None) if name == "RL_m" and not column.unit else []
    if len(possible) > 1:
        return (
            f"{column.heading} ({column.range}) is left out: it may be in {' or '.join(possible)}; if it is {channel.name}, "
            "write it with its true unit under [columns]"
        )
    return (
        f"{column.heading} ({column.range}) is left out: in {unit or 'plain numbers'} it is not within {limits}; if it is "
        f"{channel.name}, write it with its true unit under [columns]"
    )


def hot(found: Mapping[str, FoundChannel]) -> str:
    """A remark if a temperature that is stated in degC is that of no tyre; "" otherwise."""
    column = found.get("T_degC")
    if column is None or not column.unit or spelt(column.unit) != "degC" or not _too_hot(column):
        return ""
    return (
        f"{column.heading} ({column.range}) is stated in {column.unit}, but no tread stays as hot: if it is in degF, write "
        f'T_degC = {{ column = "{column.heading}", unit = "degF" }} under [columns]'
    )


def customary(found: Mapping[str, FoundChannel], chosen: Mapping[str, Choice]) -> str:
    """A remark if one column is in an American unit and others state none; "" otherwise."""
    units = {name: _unit_of(name, found, chosen) for name in found}
    settled = {column.channel.unit for column in found.values() if column.unit}
    sign = next((name for name in found if spelt(units[name]) in AMERICAN), None)
    doubtful = [
        name
        for name in chosen
        if found[name].channel.unit in CUSTOMARY.keys() - settled and spelt(units[name]) not in AMERICAN
    ]
    if sign is None or not doubtful:
        return ""
    pairs = [
        f"{found[name].heading} ({units[name]} or {CUSTOMARY[found[name].channel.unit]})" for name in doubtful
    ]
    first = found[doubtful[0]]
    return (
        f"{found[sign].heading} is in {units[sign]}, so columns without a stated unit may be in American units, too: "
        f"{', '.join(pairs)}; if they are, write the unit under [columns], for example {first.channel.name} = "
        f'{{ column = "{first.heading}", unit = "{CUSTOMARY[first.channel.unit]}" }}'
    )

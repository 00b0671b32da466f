"""Units that a file does not state: columns of one kind are decided together, and each choice says what it rests on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from mffit.sweeps.channels import BY_NAME, Channel
from mffit.sweeps.units import converted, factor, spelt


class Found(NamedTuple):
    """A column of numbers that is a channel."""

    channel: Channel
    heading: str
    unit: str  #: as stated, or the contract's under the contract's heading; "" where nothing says it
    values: np.ndarray  #: (n,), NaN where there is no reading

    @property
    def size(self) -> float:
        """The largest reading; one spike does not make another unit."""
        seen = np.abs(self.values[np.isfinite(self.values)])
        return float(np.percentile(seen, 99.5)) if len(seen) else 0.0


class Choice(NamedTuple):
    """A unit that no file states."""

    unit: str
    why: str  #: after "the file states no unit: "


LARGEST_RADIANS = 1.6
LARGEST_KILONEWTONS = 100.0
MOST_GRIP = 5.0
LEAST_ARM = 1e-3  # m, of the largest moment over the largest load
FASTEST_MPS = 25.0
PRESSURES = ("bar", "psi", "kPa", "MPa", "Pa")
"""In the order in which they are believed."""
USUAL, POSSIBLE, OF_A_LORRY = (50.0, 400.0), (40.0, 1200.0), (400.0, 1200.0)  # kPa
LORRY = 10_000.0  # N
TIMES = ("s", "ms", "us")
STEPS = (1e-5, 5.0)  # s, between samples of a moving angle
RATES = (0.02, 100.0)  # deg/s, of steering
TRAVEL, WINDOW = 1.0, 20  # deg an angle must move to say something, samples over which its rate is taken
CUSTOMARY = {"N": "lbf", "N m": "in-lb", "kPa": "psi", "m/s": "mph", "degC": "degF"}
"""What American laboratories write for the contract's units."""


def choices(found: Mapping[str, Found]) -> dict[str, Choice]:
    """Units of the columns whose unit nothing states, by channel."""
    out: dict[str, Choice] = {}
    known = {name: column.unit for name, column in found.items() if column.unit}

    for kind in ("deg", "N", "N m"):
        group = {name: column for name, column in found.items() if column.channel.unit == kind}
        for alike in _apart(group):
            said = next((column for name, column in alike.items() if name in known), None)
            unit = said.unit if said else _unit_of_group(kind, alike, _load(found, known))
            also = f"; {', '.join(c.heading for c in alike.values())} share a unit" if len(alike) > 1 else ""
            for name, column in alike.items():
                if name not in known:
                    taken = f"{_range(column)} taken for {unit}, as {said.heading} is" if said else ""
                    out[name] = Choice(unit, taken or _look_like(column, unit) + also)
            known |= {name: unit for name in alike if name not in known}
    for name, column in found.items():
        if name in known or not column.channel.unit:
            continue
        if column.channel.unit == "kPa":
            out[name] = _pressure(column, _load(found, known))
        elif name == "time_s":
            out[name] = _time(column, found.get("alpha_deg"), known.get("alpha_deg", "deg"))
        elif name == "V_mps":
            out[name] = _as_it_looks(column, "m/s" if column.size < FASTEST_MPS else "km/h")
        elif name != "omega_radps":
            out[name] = _as_it_looks(column, column.channel.unit)
        if name in out:
            known[name] = out[name].unit
    return out


def _apart(group: Mapping[str, Found]) -> list[dict[str, Found]]:
    """Columns of one kind that share a unit: all, unless forces are larger numbers than any tyre's grip allows."""
    load = {name: column for name, column in group.items() if name == "Fz_N"}
    rest = {name: column for name, column in group.items() if name not in load}
    if load and max((c.size for c in rest.values()), default=0.0) > MOST_GRIP * load["Fz_N"].size:
        return [load, rest]
    return [dict(group)] if group else []


def _range(column: Found) -> str:
    return f"{np.nanmin(column.values):.3g} to {np.nanmax(column.values):.3g}"


def _look_like(column: Found, unit: str) -> str:
    return f"{_range(column)} look like {unit}"


def _as_it_looks(column: Found, unit: str) -> Choice:
    return Choice(unit, _look_like(column, unit))


def _unit_of_group(kind: str, group: Mapping[str, Found], load: float) -> str:
    size = max((column.size for column in group.values()), default=0.0)
    if kind == "deg":
        return "rad" if size < LARGEST_RADIANS else "deg"
    if kind == "N":
        return "kN" if size < LARGEST_KILONEWTONS else "N"
    return "kN m" if 0.0 < size < LEAST_ARM * load else "N m"


def _load(found: Mapping[str, Found], known: Mapping[str, str]) -> float:
    """The largest load [N]; 0 while its unit is open."""
    if "Fz_N" not in found or "Fz_N" not in known:
        return 0.0
    return factor(known["Fz_N"], "N") * found["Fz_N"].size


def _pressure(column: Found, load: float) -> Choice:
    """The unit that gives the pressure of a tyre, with the others that are not out of the question."""
    middle = float(np.nanmedian(np.abs(column.values)))
    in_kPa = {unit: factor(unit, "kPa") * middle for unit in PRESSURES}
    least, most = OF_A_LORRY if load > LORRY else USUAL
    possible = [unit for unit in PRESSURES if POSSIBLE[0] <= in_kPa[unit] <= POSSIBLE[1]]
    usual = [unit for unit in possible if least <= in_kPa[unit] <= most]
    unit = next(iter(usual or possible), column.channel.unit)
    others = [f"{other} ({in_kPa[other]:.0f} kPa)" for other in possible if other != unit]
    own = "" if unit == column.channel.unit else f" ({in_kPa[unit]:.0f} kPa)"
    also = f"{own}, less likely {' or '.join(others)}" if others else own
    return Choice(unit, _look_like(column, unit) + also)


def _time(column: Found, angle: Found | None, unit: str) -> Choice:
    """The unit in which an angle is steered as fast as machines steer."""
    alpha = None if angle is None else converted(angle.values, unit, "deg")
    motion = None if alpha is None else _motion(column.values, alpha)
    if motion is None:
        return Choice("s", f"{_range(column)} taken for s, but without a moving angle the unit is not known")
    step, rate = motion
    for each in TIMES:
        seconds = factor(each, "s")
        if STEPS[0] <= step * seconds <= STEPS[1] and RATES[0] <= rate / seconds <= RATES[1]:
            why = f"steps of {step:.3g} look like {each}, in which the angle moves at {rate / seconds:.2g} deg/s"
            return Choice(each, why)
    return Choice(
        "s", f"steps of {step:.3g} taken for s, but the angle would move at {rate:.2g} deg/s: unit not known"
    )


def _motion(time: np.ndarray, alpha: np.ndarray) -> tuple[float, float] | None:
    """Usual step and rate of the steering [deg], per unit of time; None without both."""
    seen = np.isfinite(time) & np.isfinite(alpha)
    time, alpha = time[seen], alpha[seen]
    width = WINDOW if len(time) > 4 * WINDOW else 1
    if len(time) <= 4 or np.ptp(alpha) < TRAVEL:
        return None
    step = float(np.median(np.diff(time)))
    apart = time[width:] - time[:-width]
    rates = np.abs(alpha[width:] - alpha[:-width])[apart > 0.0] / apart[apart > 0.0]
    return (step, float(np.percentile(rates, 95.0))) if step > 0.0 and len(rates) else None


def rotation(found: Mapping[str, Found], speed_unit: str, radius: float | None) -> tuple[str, str]:
    """The unit of the wheel's speed that fits the speed of the contact point, or why the column is left out.

    Parameters
    ----------
    found : with ``omega_radps``
    speed_unit : of ``V_mps``; "" where there is none
    radius : unloaded [m]; None where it is not known

    Returns
    -------
    unit, why not
        One of them is empty.
    """
    column = found["omega_radps"]
    if not speed_unit:
        return "", f"{column.heading} is left out: without a speed nothing says that it is the wheel's"
    speed = np.abs(converted(found["V_mps"].values, speed_unit, "m/s"))
    lengths = BY_NAME["RL_m"]
    least, most = (lengths.lower, lengths.upper) if radius is None else (0.75 * radius, 1.25 * radius)
    middle = np.sqrt(least * most)
    fits: dict[str, float] = {}
    for unit in (column.unit,) if column.unit else ("rad/s", "rpm"):
        omega = np.abs(converted(column.values, unit, "rad/s"))
        seen = np.isfinite(omega) & np.isfinite(speed) & (speed > 0.0)
        with np.errstate(divide="ignore"):
            ratio = float(np.median(speed[seen] / omega[seen])) if np.any(seen) else np.inf
        if least <= ratio <= most:
            fits[unit] = abs(np.log(ratio / middle))
    if fits:
        return min(fits, key=lambda unit: fits[unit]), ""
    return "", (
        f"{column.heading} ({_range(column)}) is left out: at the speed of {found['V_mps'].heading} no wheel of this size "
        "turns like that"
    )


def customary(found: Mapping[str, Found], units: Mapping[str, str], open_: Sequence[str]) -> str:
    """What to say where one column is in an American unit and others state none; empty if that is not so.

    Parameters
    ----------
    found : the columns
    units : of all of them
    open_ : channels whose unit is a choice
    """
    american = {spelt(unit) for unit in CUSTOMARY.values()}
    settled = {column.channel.unit for column in found.values() if column.unit}
    sign = next((name for name in found if spelt(units.get(name, "")) in american), None)
    doubtful = [
        name
        for name in open_
        if found[name].channel.unit in CUSTOMARY.keys() - settled and spelt(units[name]) not in american
    ]
    if sign is None or not doubtful:
        return ""
    pairs = [
        f"{found[name].heading} ({units[name]} or {CUSTOMARY[found[name].channel.unit]})" for name in doubtful
    ]
    first = found[doubtful[0]]
    return (
        f"{found[sign].heading} is in {units[sign]}, so these may be in American units, too, and nothing states them: "
        f"{', '.join(pairs)}; if so, write unit = under [columns], as in {first.channel.name} = "
        f'{{ column = "{first.heading}", unit = "{CUSTOMARY[first.channel.unit]}" }}'
    )

"""Units that a file does not state: the unit in which the readings are plausible for a tyre, with the reason.

A table lists, for every kind of reading, the units that rigs use and the plausible range. Columns of one kind share a unit.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from mffit.as_json import keys
from mffit.config.models import Column
from mffit.constants import HOTTEST_TREAD
from mffit.points import levels
from mffit.points.clock import spread
from mffit.points.constants import CORE
from mffit.recordings import constants
from mffit.suspicion.constants import LARGEST_MOMENT_ARM
from mffit.sweeps.channels import BY_NAME, Channel
from mffit.sweeps.columns import implausible, numbers
from mffit.sweeps.raw_table import RawTable
from mffit.sweeps.units import converted, is_unit, spelt
from tir.constants import CREDIBLE_FRICTION


class Remark(NamedTuple):
    """What a user should know about columns of a recording."""

    said: str
    remedy: str = ""  #: what to write or which option to give; a page has fields for it instead

    def __str__(self) -> str:
        return self.said + self.remedy


class Choice(NamedTuple):
    """The unit chosen for a column whose file states none."""

    unit: str
    why: str  #: the reason; it follows the words "the file states no unit: "


class Guess(NamedTuple):
    """The column of a file that is a channel."""

    channel: Channel
    heading: str
    stated: str = ""  #: unit as the file states it, "" if it does not
    unit: str = ""  #: unit to write to ``tyre.toml``; "" if the file or the heading states it
    assumed: bool = False  #: neither the file nor the heading states the unit
    lower: float = np.nan  #: range of the readings, in the file's unit
    upper: float = np.nan
    why: str = ""  #: reason for the unit, if neither the file nor the heading states it
    scale: float = 1.0  #: -1 if the file has the opposite sign
    against: str | None = None
    """Reference radius of longitudinal slip; None for other channels, or if unknown."""
    value: float | None = None  #: of all rows, as chosen; None for a column of the file
    over: str | None = None
    """Speed that longitudinal slip is divided by; None for the road's."""

    @property
    def unit_of_readings(self) -> str:
        """The unit in which the file's readings are."""
        return self.unit or self.stated or self.channel.unit

    def because(self, why: str) -> Guess:
        """The same column with a further reason."""
        return self._replace(why="; ".join(filter(None, (self.why, why))))

    def reversed(self, why: str) -> Guess:
        """The same column with the opposite sign in the file, for a reason."""
        return self.because(why)._replace(scale=-1.0)

    @property
    def column(self) -> Column:
        """The guess as an entry of ``[columns]``."""
        if self.value is not None:
            return Column(value=self.value)
        given = {"column": self.heading, "unit": self.unit or None, "scale": self.scale}
        return Column.model_validate({**given, "against": self.against, "over": self.over})


keys(Guess, "* channel=channel.name")


class FoundChannel(NamedTuple):
    """A column of numbers that is a channel."""

    channel: Channel
    heading: str
    stated: str  #: unit as the file states it, "" if it does not
    values: np.ndarray  #: (n,), NaN where there is no reading
    given: bool = False  #: whether a user gave the value, which then says nothing of the file's units
    of_heading: bool = False  #: whether the unit is stated within the heading

    @classmethod
    def of(cls, raw: RawTable, channel: Channel, heading: str, of_heading: str = "") -> FoundChannel | None:
        """The column of a heading, which may state the unit itself, as this channel; None without readings."""
        values = numbers(raw.column(heading))
        stated = of_heading or raw.unit(heading)
        if not np.any(np.isfinite(values)):
            return None
        return cls(channel, heading, stated if is_unit(stated) else "", values, of_heading=of_heading != "")

    @property
    def unit(self) -> str:
        """The stated unit, else the contract's unit if the heading is the contract's; "" otherwise."""
        return self.stated or (self.channel.unit if self.heading == self.channel.name else "")

    def guess(self, choice: Choice | None) -> Guess:
        """The guess for this column, with the chosen unit if the file states none."""
        unit, why = choice or ((self.stated, "as the heading says") if self.of_heading else ("", ""))
        seen = self.values[np.isfinite(self.values)]
        lower, upper = (float(seen.min()), float(seen.max())) if len(seen) else (np.nan, np.nan)
        return Guess(self.channel, self.heading, self.stated, unit, choice is not None, lower, upper, why)

    @property
    def size(self) -> float:
        """The largest reading except for spikes; 0 without readings."""
        seen = np.abs(self.values[np.isfinite(self.values)])
        return float(np.percentile(seen, constants.PERCENTILE_OF_SIZE)) if len(seen) else 0.0

    @property
    def middle(self) -> float:
        """Median of the absolute readings."""
        return float(np.nanmedian(np.abs(self.values)))

    @property
    def range(self) -> str:
        """Lowest and highest reading, for a sentence."""
        return f"{np.nanmin(self.values):.3g} to {np.nanmax(self.values):.3g}"


class Kind(NamedTuple):
    """Units and plausible range of one kind of reading."""

    units: tuple[str, ...]  #: units that rigs use, the likeliest first
    limits: tuple[float, ...]  #: lowest and highest plausible reading, in the contract's unit
    american: str = ""  #: the American unit; "" without one


RADII = BY_NAME["RL_m"].lower, BY_NAME["RL_m"].upper
KINDS: Mapping[str, Kind] = {
    "deg": Kind(("rad", "deg"), (0.0, BY_NAME["alpha_deg"].upper)),
    "N": Kind(("kN", "N"), (0.0, BY_NAME["Fz_N"].upper), "lbf"),
    "N m": Kind(("kN m", "N m"), (0.0, 1.0), "in-lb"),  # over the load
    "kPa": Kind(("bar", "psi", "kPa", "MPa", "Pa"), constants.TYRE_PRESSURES, "psi"),
    "m": Kind(("m", "mm", "cm", "in"), RADII, "in"),
    "m/s": Kind(("m/s", "km/h", "mph"), (0.0, constants.FASTEST_SPEED_IN_METRES), "mph"),
    "degC": Kind(("degC", "degF"), (BY_NAME["T_degC"].lower, HOTTEST_TREAD), "degF"),
    "s": Kind(("s", "ms", "us"), tuple(1.0 / rate for rate in reversed(constants.STEERING_RATES))),  # per deg
}
"""Kinds of readings, by the contract's unit."""
ROTATION_UNITS = ("rad/s", "rpm")
FOOT_POUNDS = "ft-lb"
AMERICAN = frozenset(
    spelt(unit) for unit in (*(k.american for k in KINDS.values() if k.american), FOOT_POUNDS)
)


def choices(
    found: Mapping[str, FoundChannel], radius: float | None
) -> tuple[dict[str, Choice], dict[str, Remark], list[Remark]]:
    """Units of columns without a stated unit, reasons for leaving out optional columns, and remarks on doubtful units."""
    chosen: dict[str, Choice] = {}
    for kind in KINDS:
        for whole in _groups(kind, found):
            group = {name: column for name, column in whole.items() if not column.given}
            chosen |= _shared_unit(kind, group, _Known(found, chosen, radius)) if group else {}
    american, remarks = _american(_Known(found, chosen, radius))
    chosen |= american
    turning = _turning(_Known(found, chosen, radius))
    left_out = {"omega_radps": Remark(turning)} if isinstance(turning, str) else {}
    if not isinstance(turning, str):
        chosen |= turning
    known = _Known(found, chosen, radius)
    for name in found:
        if name not in left_out and (reason := _implausible(name, known)):
            left_out[name] = reason
    chosen = {name: choice for name, choice in chosen.items() if name not in left_out}
    return chosen, left_out, [*remarks, *_hot(found)]


class _Known(NamedTuple):
    """The columns of a file, with the units chosen so far."""

    found: Mapping[str, FoundChannel]
    chosen: Mapping[str, Choice]
    radius: float | None  #: unloaded [m]

    def unit(self, name: str) -> str:
        """Unit of a column, stated or chosen; "" if not yet chosen, or without the column."""
        if name not in self.found:
            return ""
        return self.found[name].unit or (self.chosen[name].unit if name in self.chosen else "")

    @property
    def longest_arm(self) -> float:
        """Longest lever arm [m] of the side force that a contact allows, on a tyre of a middling size if its own is not known."""
        return LARGEST_MOMENT_ARM * (self.radius or math.sqrt(math.prod(RADII)))

    @property
    def load(self) -> float:
        """The largest load [N]; 0 if its unit is not yet chosen."""
        unit = self.unit("Fz_N")
        return _in(self.found["Fz_N"].size, unit, "N") if unit else 0.0

    def possible(self, kind: str, value: float) -> dict[str, float]:
        """Units in which a reading is plausible, the likeliest first, each with the reading in the contract's unit."""
        lower, upper = KINDS[kind].limits
        if kind == "N m":
            upper *= self.load
        if kind == "m" and self.radius is not None:
            lower, upper = (share * self.radius for share in constants.ROLLING_RADIUS_RANGE)
        fits = {unit: x for unit in KINDS[kind].units if lower <= (x := _in(value, unit, kind)) <= upper}
        if kind == "kPa":  # load over pressure is the contact patch
            fits = dict(sorted(fits.items(), key=lambda fit: _from_usual_patch(fit[1], self.load)))
        return fits


def _in(value: float, unit: str, target: str) -> float:
    return float(converted(np.array([value]), unit, target)[0])


def _from_usual_patch(kPa: float, load: float) -> float:
    return abs(math.log(max(load, 1.0) / (1e3 * kPa * constants.USUAL_CONTACT_PATCH)))


def _groups(kind: str, found: Mapping[str, FoundChannel]) -> list[dict[str, FoundChannel]]:
    """Groups of columns of one kind that share a unit: one group, unless forces exceed the load by more than any tyre's grip."""
    group = {name: column for name, column in found.items() if column.channel.unit == kind}
    load = {name: column for name, column in group.items() if name == "Fz_N"}
    rest = {name: column for name, column in group.items() if name not in load}
    largest = max((column.size for column in rest.values()), default=0.0)
    if load and largest > CREDIBLE_FRICTION * load["Fz_N"].size:
        return [load, rest]
    return [group] if group else []


def _shared_unit(kind: str, group: Mapping[str, FoundChannel], known: _Known) -> dict[str, Choice]:
    """The unit of all columns of a group that state none: another column's stated unit, else the likeliest plausible unit."""
    stated = next((column for column in group.values() if column.unit), None)

    def all_in(unit: str, why: str) -> dict[str, Choice]:
        open_ones = ((name, column) for name, column in group.items() if not column.unit)
        return {name: Choice(unit, f"{column.range} {why}") for name, column in open_ones}

    if stated is not None:
        return all_in(stated.unit, f"assumed to be in {stated.unit}, like {stated.heading}")
    value = _decisive(kind, group, known)
    if value is None:
        return all_in(kind, "assumed to be in s; without a moving angle the unit is not known")
    fits = known.possible(kind, value) if value else {}
    if not fits or (kind == "m" and len(fits) > 1):  # in metres an implausible radius is left out
        why = ": in no unit the angle moves as rigs steer, so that the unit is not known" * (kind == "s")
        return all_in(kind, f"taken as {kind}{why}")
    unit, *others = fits
    also = f", less likely {' or '.join(_with_size(kind, other, fits) for other in others)}" if others else ""
    shared = f"; {', '.join(column.heading for column in group.values())} share a unit" * (len(group) > 1)
    return all_in(unit, f"look like {_with_size(kind, unit, fits)}{also}{shared}")


def _with_size(kind: str, unit: str, fits: Mapping[str, float]) -> str:
    """The unit as text, with the reading in the contract's unit if the two units differ."""
    if unit == kind:
        return unit
    if kind == "s":
        return f"{unit}, in which the angle moves at {1.0 / fits[unit]:.2g} deg/s"
    return f"{unit} ({fits[unit]:{'.0f' if fits[unit] >= 10.0 else '.2g'}} {kind})"


def _decisive(kind: str, group: Mapping[str, FoundChannel], known: _Known) -> float | None:
    """The reading, as written in the file, that decides the unit of a group; None if there is none."""
    if kind in ("kPa", "m", "degC"):
        return next(iter(group.values())).middle
    if kind != "s":
        return max(column.size for column in group.values())
    if "alpha_deg" not in known.found or "time_s" not in group:
        return None
    alpha_deg = converted(known.found["alpha_deg"].values, known.unit("alpha_deg"), "deg")
    return _time_per_degree(group["time_s"].values, alpha_deg)


def _time_per_degree(time: np.ndarray, alpha_deg: np.ndarray) -> float | None:
    """Time per degree of sideslip while it is steered, in the unit of ``time``; None if it does not move."""
    seen = np.isfinite(time) & np.isfinite(alpha_deg)
    time, alpha_deg = spread(time[seen]), alpha_deg[seen]
    width = int(constants.SAMPLES_PER_RATE) if len(time) > 4 * constants.SAMPLES_PER_RATE else 1
    elapsed = time[width:] - time[:-width]
    forwards = elapsed > 0.0
    if np.sum(forwards) < 4 or np.radians(np.ptp(alpha_deg)) < levels.SIDESLIP.tolerance:
        return None
    rates = np.abs(alpha_deg[width:] - alpha_deg[:-width])[forwards] / elapsed[forwards]
    rate = float(np.percentile(rates, constants.PERCENTILE_OF_SIZE))
    return 1.0 / rate if rate > 0.0 else None


def _american(known: _Known) -> tuple[dict[str, Choice], list[Remark]]:
    """American units for the columns without a stated unit, and a remark if these units are possible but not certain.

    They are certain if some column can only be in an American unit and no stated unit or pressure is in another one.
    """
    found = known.found
    of_file = [column for column in found.values() if column.unit and not column.given]
    stated = {column.channel.unit: column.unit for column in of_file}
    arm = _lever_arm(known)
    doubtful = {
        name: FOOT_POUNDS if unit == "in-lb" and _in(arm, "ft", "m") < known.longest_arm else unit
        for name in known.chosen
        if (kind := found[name].channel.unit) in KINDS
        and kind not in stated
        and (unit := KINDS[kind].american)
        and spelt(known.unit(name)) not in AMERICAN
    }
    others = [unit for kind, unit in stated.items() if kind in KINDS and KINDS[kind].american]
    if "p_kPa" in found:
        others.append(known.unit("p_kPa"))
    sign = next((column for name, column in found.items() if _only_american(name, known, arm)), None)
    if sign is not None and all(spelt(unit) in AMERICAN for unit in others):
        why = f"as {sign.heading} ({sign.range}) is in American units"
        return {
            name: Choice(unit, f"{found[name].range} assumed to be in {unit}, {why}")
            for name, unit in doubtful.items()
            if found[name].channel.unit != "m" or unit in known.possible("m", found[name].middle)
        }, []
    hint = next((name for name in found if spelt(known.unit(name)) in AMERICAN), None)
    if hint is None or not doubtful:
        return {}, []
    pairs = [f"{found[name].heading} ({known.unit(name)} or {unit})" for name, unit in doubtful.items()]
    name, unit = next(iter(doubtful.items()))
    said = (
        f"{found[hint].heading} is in {known.unit(hint)}, so columns without a stated unit may be in American units, too: "
        f"{', '.join(pairs)}"
    )
    example = f'{name} = {{ column = "{found[name].heading}", unit = "{unit}" }}'
    return {}, [Remark(said, f"; if they are, write the unit under [columns], for example {example}")]


def _lever_arm(known: _Known) -> float:
    """Largest moment without a stated unit over the largest load, as the file writes them; 0 without either."""
    found, load = known.found, known.found["Fz_N"].size if "Fz_N" in known.found else 0.0
    moments = [found[name].size for name in known.chosen if found[name].channel.unit == "N m"]
    return max(moments, default=0.0) / load if load else 0.0


def _only_american(name: str, known: _Known, arm: float) -> bool:
    """Whether a column can only be in an American unit.

    Rigs in Europe have gauges in psi, too, so psi counts only if the lever ``arm`` would be too long in newtons and metres.
    """
    column, kind = known.found[name], known.found[name].channel.unit
    if name == "p_kPa" and spelt(known.unit(name)) == spelt("psi"):
        return known.radius is not None and arm > known.longest_arm and known.unit("Fz_N") == "N"
    if column.unit:
        return spelt(column.unit) in AMERICAN
    return kind in ("degC", "m") and list(known.possible(kind, column.middle)) == [KINDS[kind].american]


def _turning(known: _Known) -> dict[str, Choice] | str:
    """Unstated units of speed and rotation that give a plausible rolling radius, or the reason to leave out rotation."""
    found = known.found
    column, speed = found.get("omega_radps"), found.get("V_mps")
    if column is None:
        return {}
    doubtful = column.heading != "omega_radps"
    if speed is None:
        why = "is left out: without a speed it cannot be checked that it is the wheel's"
        return f"{column.heading} {why}" if doubtful else {}
    size = known.radius or _measured_radius(known)
    limits: tuple[float, ...] = RADII
    if size is not None:
        limits = tuple(share * size for share in constants.ROLLING_RADIUS_RANGE)
    of_speed = KINDS["m/s"].units if size is not None and not speed.unit else (known.unit("V_mps"),)
    of_rotation = (column.unit,) if column.unit else ROTATION_UNITS
    usual = size or math.sqrt(math.prod(limits))
    fits = {
        (unit, rotation): min(of_wheel)
        for unit in of_speed
        for rotation in of_rotation
        if (
            of_wheel := [
                abs(math.log(radius / usual))
                for radius in _rolling_radii(speed, unit, column, rotation)
                if limits[0] <= radius <= limits[1]
            ]
        )
    }
    if not fits:
        units = KINDS["m/s"].units
        tried = "" if speed.unit else f" in {', '.join(units[:-1])} or {units[-1]},"
        why = f"is left out: at the speed in {speed.heading},{tried} no wheel of this size turns at this rate"
        return f"{column.heading} ({column.range}) {why}" if doubtful else {}
    unit, rotation = min(fits, key=lambda pair: fits[pair])
    given = {}
    if size is not None and not speed.unit:
        given["V_mps"] = Choice(
            unit, f"in {unit} they agree with {column.heading} at a radius of {size:.3g} m"
        )
    if not column.unit:
        given["omega_radps"] = Choice(rotation, f"in {rotation} they agree with {speed.heading}")
    return given


def _measured_radius(known: _Known) -> float | None:
    """The loaded radius [m], if it was recorded in a known unit."""
    unit = known.unit("RL_m")
    middle = _in(known.found["RL_m"].middle, unit, "m") if unit else 0.0
    return middle if RADII[0] <= middle <= RADII[1] else None


def _rolling_radii(
    speed: FoundChannel, unit: str, rotation: FoundChannel, unit_of_rotation: str
) -> list[float]:
    """A small, the middle and a large ratio of speed to rotation [m] in these units; none if the wheel or the road rests.

    A wheel that is braked most of the time has the radius of rolling at the small one only, one that is driven at the large one.
    """
    V = np.abs(converted(speed.values, unit, "m/s"))
    omega = np.abs(converted(rotation.values, unit_of_rotation, "rad/s"))
    seen = np.isfinite(omega) & np.isfinite(V) & (V > 0.0) & (omega > 0.0)
    low, high = CORE
    return np.percentile(V[seen] / omega[seen], [low, 50.0, high]).tolist() if np.any(seen) else []


def _implausible(name: str, known: _Known) -> Remark | None:
    """The reason to leave out an optional column: readings outside the plausible range; None if they are inside."""
    column, channel = known.found[name], known.found[name].channel
    if channel.required or name == "time_s":
        return None
    unit = known.unit(name)
    values = converted(column.values, unit, channel.unit)
    if not implausible(values, channel, may_have_gaps="time_s" in known.found):
        return None
    left_out = f"{column.heading} ({column.range}) is left out"
    remedy = f"; if it is {channel.name}, write it with its true unit under [columns]"
    possible = known._replace(radius=None).possible("m", column.middle) if name == "RL_m" else {}
    if len(possible) > 1 and not column.unit:
        return Remark(f"{left_out}: it may be in {' or '.join(possible)}", remedy)
    limits = f"{channel.lower:g} to {channel.upper:g} {channel.unit}".rstrip()
    return Remark(f"{left_out}: in {unit or 'plain numbers'} it is not within {limits}", remedy)


def _hot(found: Mapping[str, FoundChannel]) -> list[Remark]:
    """A remark if a temperature stated in degC is implausible for a tyre but plausible in degF."""
    column = found.get("T_degC")
    if column is None or not column.unit or spelt(column.unit) != "degC":
        return []
    if list(_Known(found, {}, None).possible("degC", column.middle)) != ["degF"]:
        return []
    return [
        Remark(
            f"{column.heading} ({column.range}) is stated in {column.unit}, but no tread stays as hot",
            f': if it is in degF, write T_degC = {{ column = "{column.heading}", unit = "degF" }} under [columns]',
        )
    ]

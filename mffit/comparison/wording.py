"""The sentences about a comparison."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from mffit.comparison.characteristics import Tested
from mffit.comparison.record import ComparedSubject, Comparison, Difference, Shared
from mffit.constants import COVERAGE_FACTOR_95
from mffit.fit.at_nominal import Nominal
from mffit.quantities import CHANNELS, CHARACTERISTICS, CONDITIONS, DIRECT, KEYS, SIDEWAYS, QuantityName
from mffit.rig_errors import words_of
from mffit.rounding import AtLeast, stated
from tir import Quantity
from tir.errors import counted, listed, some
from tir.parameters import BY_NAME

OF_DIRECT = {key: DIRECT[name] for name, key in KEYS.items()}


def quantity(row: Difference) -> QuantityName:
    """Word, symbol and unit of a number."""
    if row.load is None:
        known = BY_NAME[row.key]
        return QuantityName(known.description, row.key, known.unit)
    return CHARACTERISTICS.get(row.key) or OF_DIRECT[row.key]


def headline(found: Comparison) -> str:
    """A sentence on the largest differences, preceded by one on different uses or nominal conditions, if any."""
    return " ".join(filter(None, (found.apart, differences(found))))


def differences(found: Comparison) -> str:
    """The largest differences in a sentence."""
    if found.sweeps:
        parts = []
        for channel, known in CHANNELS.items():
            rows = [gap for gap in found.sweeps if gap.channel == channel]
            if rows:
                n = sum(gap.n for gap in rows)
                total = math.sqrt(sum(gap.n * gap.rms**2 for gap in rows) / n)
                parts.append(f"{total:.3g} {known.unit} rms in {channel}")
        return f"{found.first} misses {found.second} by {listed(parts)}; {_significant(found)}."
    gap = {c: max((g.rms for g in found.curves if g.channel == c), default=0.0) for c in CHANNELS}
    if not any(gap.values()):
        return f"The curves of {found.first} and {found.second} do not differ; {_significant(found)}."
    named = {**SIDEWAYS, **{c: q for c, q in CHANNELS.items() if gap[c]}}
    said = listed([f"{c} by up to {gap[c]:.3g} {q.unit} rms" for c, q in named.items()])
    return f"The curves of {found.first} and {found.second} differ in {said}; {_significant(found)}."


def _significant(found: Comparison) -> str:
    """A clause on the numbers and coefficients that differ significantly, or else on the largest relative difference."""
    beyond = f"by more than {COVERAGE_FACTOR_95:.2g} standard uncertainties"
    names = list(dict.fromkeys(quantity(row).word for row in _beyond(found.numbers)))
    known = [row for row in found.coefficients if row.z is not None]
    keys = [row.key for row in _beyond(known)]
    coefficients = f"; of {counted(len(known), 'coefficient')} these do: {some(keys)}" if keys else ""
    if names:
        return f"numbers that differ {beyond}: {some(names)}{coefficients}"
    if any(row.z is not None for row in found.numbers):
        return f"no stiffness, peak or other number at a load differs {beyond}{coefficients}"
    largest = max(found.numbers, key=lambda row: row.relative, default=None)
    if largest is None or not largest.relative:
        return "all numbers are equal"
    return f"the largest relative difference is that of the {quantity(largest).word}, {100.0 * largest.relative:.3g} %"


def _beyond(rows: Iterable[Difference]) -> list[Difference]:
    """The differences that are significant."""
    return [row for row in rows if row.z is not None and abs(row.z) > COVERAGE_FACTOR_95]


def sides(row: Difference) -> tuple[str, str]:
    """Both values with their uncertainties."""
    first, second = (AtLeast if least else Quantity for least in (row.at_least_first, row.at_least_second))
    u_first, u_second = row.u_first or 0.0, row.u_second or 0.0
    return stated(first(row.first, u_first, "")), stated(second(row.second, u_second, ""))


def place(row: Difference) -> str:
    """Condition at which a number holds; empty for a coefficient."""
    return "" if row.load is None else CONDITIONS["Fz_N"].of(row.load)


def apart(first: ComparedSubject, second: ComparedSubject) -> str:
    """Sentences on different uses, nominal conditions or pressures of two files; empty if they agree."""
    said = []
    if first.turn_slip != second.turn_slip:
        on, off = (first, second) if first.turn_slip else (second, first)
        said.append(
            f"{on.name} is evaluated with turn slip on, {off.name} with turn slip off, each for its own use."
        )
    one, other = Nominal.of(first.tyre.values).beside(Nominal.of(second.tyre.values))
    if one:
        said.append(
            f"Nominal conditions differ, {first.name} {one}, {second.name} {other}: coefficients are relative to them, so that "
            "equal ones give other forces."
        )
    pressures = [float(side.tyre["INFLPRES"]) / 1e3 for side in (first, second)]
    if not math.isclose(*pressures):
        said.append(
            f"Each file is evaluated at its own inflation pressure, {first.name} at {pressures[0]:.5g} kPa, {second.name} at "
            f"{pressures[1]:.5g} kPa."
        )
    return " ".join(said)


def notes_between(first: ComparedSubject, second: ComparedSubject, shared: Shared) -> tuple[str, ...]:
    """Remarks on a comparison of two files: whether their uncertainties are known, and whether they share rig errors."""
    notes = []
    bare = [side.name for side in (first, second) if side.known is None]
    if bare:
        notes.append(
            f"The uncertainty of {' and '.join(bare)} is unknown: no result.json beside it states one for this file."
        )
    elif shared:
        errors = listed(list(dict.fromkeys(words_of(error) for error, _ in shared)))
        notes.append(
            f"One rig measured both sides: what its errors do to both cancels in the differences ({errors}). Zeros count among "
            "these if [rig] has a name and the sweeps of both builds name the same setup."
        )
    else:
        notes.append(
            "Both sides are treated as independent, as they are not two builds with the same [rig]: if one rig measured "
            "both, differences are more significant than stated."
        )
    return tuple(notes)


def notes_on_peaks(numbers: Iterable[Difference], tested: Tested) -> Iterator[str]:
    """A remark on the largest forces that are not peaks, if there are any."""
    ends = {tested.end(row.key) for row in numbers if row.at_least_first or row.at_least_second}
    if ends:
        yield f'"At least": the curve does not fall up to the end of the slip compared, {listed(sorted(ends))}.'


def note_on_temperature(name: str, T_ref: float) -> str:
    """The remark that the readings of a file were simulated at the temperatures of the points."""
    return (
        f"{name} holds at {T_ref:g} degC; its temperature terms take it to the temperature of every point (T_degC), where that "
        "is known."
    )


def note_on_data(file: str) -> str:
    """The remark on a comparison of a file with data."""
    return (
        f"The numbers of {file} are results of the direct method on its simulated readings at the same points, so that the bias "
        "of the method is the same on both sides."
    )

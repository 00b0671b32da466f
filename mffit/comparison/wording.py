"""The sentences about a comparison."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence

from mffit.comparison.characteristics import Tested
from mffit.comparison.of_rig import ExplainedByRig
from mffit.comparison.record import ComparedSubject, Comparison, Difference, Shared
from mffit.constants import COVERAGE_FACTOR_95
from mffit.fit.at_nominal import Nominal
from mffit.quantities import (
    CHANNELS,
    CHARACTERISTICS,
    CONDITIONS,
    DIRECT,
    KEYS,
    OF_ROAD,
    SIDEWAYS,
    QuantityName,
)
from mffit.rig_errors import BY_NAME as ERRORS
from mffit.rig_errors import shown, unit_of, words_of
from mffit.rounding import AtLeast, number, stated
from tir import Quantity
from tir.errors import listed, some
from tir.parameters import BY_NAME

BEYOND_95 = 0.05
"""Share of differences beyond a 95 % interval by chance."""
OF_DIRECT = {key: DIRECT[name] for name, key in KEYS.items()}


def quantity(found: Comparison, row: Difference) -> QuantityName:
    """Word, symbol and unit of a number; against data, those of the direct method."""
    if row.load is None:
        known = BY_NAME[row.key]
        return QuantityName(known.description, row.key, known.unit)
    if found.points is not None:
        return OF_DIRECT[row.key]
    named = CHARACTERISTICS[row.key]
    if row.key in OF_ROAD:  # a build's road states the best estimate under the plain name
        return named._replace(word=f"{named.word} of the file")
    return named


def headline(found: Comparison) -> str:
    """A sentence on the largest differences, preceded by one on different uses or nominal conditions, if any."""
    return " ".join(filter(None, (found.apart, differences(found))))


def differences(found: Comparison) -> str:
    """What differs significantly, and by how much the curves or the readings do, in a few sentences."""
    return " ".join(
        [*_against_data(found), _significant(found)]
        if found.sweeps
        else [_significant(found), _curves(found)]
    )


def _curves(found: Comparison) -> str:
    gap = {c: max((g.rms for g in found.curves if g.channel == c), default=0.0) for c in CHANNELS}
    if not any(gap.values()):
        return "The curves do not differ."
    named = {**SIDEWAYS, **{c: q for c, q in CHANNELS.items() if gap[c]}}
    return f"The curves differ in {listed([f'{c} by up to {number(gap[c], digits=3)} {q.unit} rms' for c, q in named.items()])}."


def _against_data(found: Comparison) -> list[str]:
    """By how much a file misses data, and whether that is the rig or the tyre."""
    parts = []
    for channel, known in CHANNELS.items():
        rows = [gap for gap in found.sweeps if gap.channel == channel]
        if rows:
            total = math.sqrt(sum(gap.n * gap.rms**2 for gap in rows) / sum(gap.n for gap in rows))
            parts.append(f"{number(total, digits=3)} {known.unit} rms in {channel}")
    missed = f"{found.first} misses {found.second} by {listed(parts)}."
    return [missed] if found.by_rig is None else [missed, rig_or_tyre(found.by_rig, fitted=found.fitted)]


def rig_or_tyre(found: ExplainedByRig, *, fitted: bool) -> str:
    """Whether errors of the rig explain what a file misses of readings, in a sentence or two.

    ``fitted``: whether the file was fitted to these readings; then what the rig leaves is the misfit of that fit.
    """
    noise = "noise and what the formula misses by the build of the file" if found.of_formula else "noise"
    if found.is_noise:
        return f"That is {noise}: nothing is left to explain."
    left = listed(
        [f"{number(size, digits=3)} {CHANNELS[name].unit} in {name}" for name, size in found.left.items()]
    )
    errors = _largest_of(found, [*found.errors])
    if found.suffices:
        return (
            f"It can be the rig: errors of the size that is declared{errors} leave {left}, which is {noise}."
        )
    if fitted:
        return (
            f"The file was fitted to these points: errors of the rig{errors} leave {left}, which is the misfit of the fit; the "
            "report of its build judges it."
        )
    rest = "the rest is the tyre, or an error that is not declared: mffit diagnose names it"
    if found.mostly:
        return f"Most of it can be the rig: errors of the size that is declared{errors} leave {left}; {rest}."
    if found.fits and found.beyond:
        worse = _largest_of(found, found.beyond)
        return f"It is the tyre, or the rig is worse than declared{worse}, which leaves {left}; mffit diagnose tries both."
    if not found.is_plausible:
        return "It is not the rig as declared: its errors would have to be far larger; mffit diagnose names what is missing."
    return f"It is not the rig as declared: its errors would leave {left}; {rest}."


def _largest_of(found: ExplainedByRig, names: Sequence[str]) -> str:
    """The first of some errors, and the number of the others, in brackets; empty if there are none."""
    if not names:
        return ""
    more = f" and {len(names) - 1} more" if len(names) > 1 else ""
    return f" ({_shown(names[0], found.errors[names[0]])}{more})"


def notes_on_rig(found: ExplainedByRig | None) -> tuple[str, ...]:
    """A remark with all errors of the rig that would explain a gap; none if the headline names them."""
    if found is None or found.is_noise or len(found.errors) < 2:
        return ()
    errors = listed([_shown(name, one) for name, one in found.errors.items()])
    return (f"The errors of the rig that would explain most of the gap are {errors}.",)


def _shown(name: str, error: Quantity) -> str:
    value, u, unit = shown(name, error.value, error.u)
    return f"{words_of(name)} {stated(Quantity(value, u, unit), unit)}"


def _significant(found: Comparison) -> str:
    """A sentence on what differs significantly, or else on the largest relative difference."""
    rows = found.significant
    if not found.unequal and not found.coefficients:
        return f"All numbers of {found.first} and {found.second} are equal."
    known = sum(row.z is not None for row in (*found.numbers, *found.coefficients))
    if rows and found.sweeps:
        return f"Numbers of the direct method that differ significantly: {some(_named(found, rows))}."
    if rows:
        how_many = f"{len(rows)} of {known} numbers and coefficients"
        return f"{found.first} and {found.second} differ significantly in {how_many}: {some(_named(found, rows))}."
    if known and found.sweeps:
        return "No number of the direct method differs significantly."
    if known:
        beyond = [
            row for row in (*found.numbers, *found.coefficients) if abs(row.z or 0.0) > COVERAGE_FACTOR_95
        ]
        return (
            f"{found.first} and {found.second} do not differ significantly: of {known} numbers and coefficients "
            f"{len(beyond) or 'none'} differ by more than {COVERAGE_FACTOR_95:.2g} standard uncertainties; chance makes "
            f"{BEYOND_95 * known:.0f}."
        )
    largest = max(found.unequal or found.coefficients, key=lambda row: row.relative)
    return (
        f"The largest relative difference of {found.first} and {found.second} is that of {quantity(found, largest).word}, "
        f"{number(100.0 * largest.relative, digits=3)} %."
    )


def _named(found: Comparison, rows: Iterable[Difference]) -> list[str]:
    """Words of numbers and names of coefficients, each once."""
    return list(dict.fromkeys(row.key if row.load is None else quantity(found, row).word for row in rows))


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


def notes_on_estimates(first: str, second: str, rows: Iterable[Difference]) -> Iterator[str]:
    """Remarks on what differs although a side did not measure it."""
    apart = [row for row in rows if row.change]
    for side, of_side in (
        (first, [row for row in apart if row.estimated_first]),
        (second, [row for row in apart if row.estimated_second]),
    ):
        words = [row.key if row.load is None else CHARACTERISTICS[row.key].word for row in of_side]
        if words:
            yield (
                f"{side} did not measure {some(list(dict.fromkeys(words)))}: its value is estimated or given, and the difference "
                "has no significance."
            )


def note_on_own_peaks(numbers: Iterable[Difference]) -> Iterator[str]:
    """A remark on the peaks that a build states on its road under the plain name."""
    named = [CHARACTERISTICS[key].ascii for key in OF_ROAD if any(row.key == key for row in numbers)]
    if named:
        yield (
            f"{listed(named)} are those of each file's own curve at positive sideslip, within what both were tested to. The road "
            "in the report of a build states the best estimate for both sides; its uncertainty includes that of the model error."
        )


def note_on_conditions(name: str, beside: Mapping[str, float]) -> str:
    """The remark that a file was simulated at the conditions of the points, by its terms ``beside`` the formula."""
    held = [
        f"{value:g} {unit_of(term)}" for term, value in sorted(beside.items()) if ERRORS[term].place is None
    ]
    return f"{name} holds at {listed(held)}; its terms take it to the conditions of every point, where they are known."


def note_on_data(file: str) -> str:
    """The remark on a comparison of a file with data."""
    return (
        f"The numbers of {file} are results of the direct method on its simulated readings at the same points, so that the bias "
        "of the method is the same on both sides."
    )

"""``[coefficients]``: values, bounds, starting values and priors that the engineer sets for single coefficients."""

import math
import sys
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Annotated

from pydantic import PlainSerializer, PlainValidator
from pydantic_core import PydanticCustomError

from mffit.config import quantities as q
from mffit.config.problems import NUMBER_IN_QUOTES
from mffit.errors import InputError, meant, shortened
from tir.parameters import BY_NAME, TABLE, Parameter

BASE = "base"
"""Instead of a number: the value of the base file."""
KEYS = ("value", "u", "start", "min", "max")
"""Keys of a coefficient that is not held."""
KEYS_OF_TYRE = {
    "FNOMIN": "nominal_load",
    "NOMPRES": "nominal_pressure",
    "INFLPRES": "nominal_pressure",
    "LONGVL": "nominal_speed",
    "UNLOADED_RADIUS": "unloaded_radius",
    "WIDTH": "width",
    "RIM_RADIUS": "rim_radius",
    "TYRESIDE": "side",
}
"""By name of the property file, the key of [tyre] that states it."""
FREE_WITHOUT_STAGE = ("PECP1", "Q_RE0")
"""Coefficients that the joint polish frees, though no stage of the fit does."""
OF_DIRECT_METHOD = ("PECP1", "PECP2")
"""Coefficients that come from the direct method unless ``[spin] pecp1`` is "model"."""
HOW = f'write a number to hold it, "{BASE}", or a table such as {{ min = 0.0, max = 1.0 }} or {{ value = 0.5, u = 0.1 }}'


@dataclass(frozen=True, slots=True)
class CoefficientByHand:
    """One entry of [coefficients]: a number, "base", or a table of the keys in :data:`KEYS`."""

    held: float | None = None  #: value of a coefficient that is held
    from_base: bool = False  #: held at the base file's value
    value: float | None = None  #: what is known of the coefficient beforehand
    u: float | None = None  #: standard uncertainty of ``value``
    start: float | None = None  #: where the search starts
    min: float | None = None
    max: float | None = None

    @property
    def is_held(self) -> bool:
        """Whether the fit takes the coefficient as exact."""
        return self.from_base or self.held is not None

    @property
    def bounded(self) -> bool:
        """Whether a bound is given."""
        return self.min is not None or self.max is not None

    def bounds(self, name: str) -> tuple[float, float]:
        """The bounds of the coefficient ``name``: those of the parameter table where none is given."""
        lower, upper = BY_NAME[name].bounds
        return lower if self.min is None else self.min, upper if self.max is None else self.max


def as_in_the_file(entry: CoefficientByHand) -> object:
    """The entry as ``tyre.toml`` writes it."""
    if entry.from_base:
        return BASE
    if entry.held is not None:
        return entry.held
    return {key: getattr(entry, key) for key in KEYS if getattr(entry, key) is not None}


def named(given: object) -> object:
    """The content of ``[coefficients]`` with the name next to every entry, as :func:`read_entry` needs it."""
    if not isinstance(given, Mapping):
        return given
    return {name: (name, content) for name, content in given.items()}


def read_entry(given: tuple[str, object]) -> CoefficientByHand:
    """The entry of a name and what the file gives for it; refused with a sentence if it is not possible."""
    name, content = given
    if isinstance(content, CoefficientByHand):
        return content
    if mistake := unsettable(name):
        raise q.wrong(mistake)
    row = BY_NAME[name]
    if content == BASE:
        return CoefficientByHand(from_base=True)
    if not isinstance(content, Mapping):
        return CoefficientByHand(held=_number(content, row))
    if not content:
        raise q.wrong(f"is empty; {HOW}")
    for key in content:
        if key not in KEYS:
            near = meant(key, KEYS)
            hint = f'did you mean "{near}"?' if near else f"known are {', '.join(KEYS)}"
            raise q.wrong(f'has the unknown key "{key}"; {hint}')
    numbers = {key: _number(given, row, key) for key, given in content.items()}
    value, u, start, least, most = (numbers.get(key) for key in KEYS)
    entry = CoefficientByHand(value=value, u=u, start=start, min=least, max=most)
    _check_freed(row, entry)
    return entry


Entries = dict[str, Annotated[CoefficientByHand, PlainValidator(read_entry), PlainSerializer(as_in_the_file)]]


def may_be_free(row: Parameter) -> bool:
    """Whether a fit may determine the coefficient, so that bounds, a start and a prior are possible."""
    return bool(row.stage and row.stage != "held") or row.name in FREE_WITHOUT_STAGE


def _check_freed(row: Parameter, entry: CoefficientByHand) -> None:
    """Refuse contradictions within the table of a coefficient."""
    value, u, start, least, most = (getattr(entry, key) for key in KEYS)
    if not may_be_free(row):
        raise q.wrong(f'has bounds or a prior, but no fit frees {row.name}; write a number or "{BASE}"')
    if value is None and u is not None:
        raise q.wrong("is missing, but u needs it; add what is known of the coefficient", "value")
    if value is not None and u is None:
        raise q.wrong(
            f"is missing; add one standard deviation of the value, or write {row.name} = {value:g} to hold it",
            "u",
        )
    if u is not None and not u > 0.0:
        raise q.wrong(f"{u:g} is not above 0; write {row.name} = {value:g} to hold the value exactly", "u")
    if least is not None and most is not None and least >= most:
        remedy = f"write {row.name} = {least:g} to hold it" if least == most else "exchange the two"
        raise q.wrong(f"{least:g} is not below max, {most:g}; {remedy}", "min")
    lower, upper = entry.bounds(row.name)
    if lower >= upper:
        key, other = ("min", "max") if most is None else ("max", "min")
        raise q.wrong(
            f"lies beyond the bounds {row.bounds[0]:g} to {row.bounds[1]:g}; give {other}, too", key
        )
    for key, given in (("value", value), ("start", start)):
        if given is not None and not lower <= given <= upper:
            raise q.wrong(
                f"{given:g} is outside the bounds {lower:g} to {upper:g}; correct it, or give min and max",
                key,
            )


def unsettable(name: str) -> str:
    """Why no coefficient of this name can be set by hand; empty if one can."""
    row = BY_NAME.get(name)
    if row is None:
        known = [row.name for row in TABLE if row.kind == "number" and row.name not in KEYS_OF_TYRE]
        near = meant(name.upper(), known)
        hint = f"did you mean {near}?" if near else "write it as the property file does, such as PCY1"
        return f"is not a coefficient of MF 6.2; {hint}"
    if name in KEYS_OF_TYRE:
        return f"is set by {KEYS_OF_TYRE[name]} under [tyre]; write it there"
    if row.kind != "number" or name in ("FITTYP", "USE_MODE"):
        return "is decided by the build; remove it"
    if row.section.endswith("_RANGE"):
        return "is a range of the file, which follows from the points; remove it"
    return ""


def _number(given: object, row: Parameter, key: str = "") -> float:
    """The number under a key of the coefficient's table; without a key, the value at which it is held.

    Refuses values that are not finite, that the equations cannot take, or whose sign they exclude. A value beyond those of
    published tyres is a declaration.
    """
    if isinstance(given, str):
        quoted = NUMBER_IN_QUOTES.fullmatch(given)
        remedy = "remove the quotes" if quoted else HOW
        raise q.wrong(f'"{shortened(given)}" is a text, not a number; {remedy}', key)
    if isinstance(given, bool) or not isinstance(given, int | float):
        raise q.wrong(f"is not a number; {HOW}", key)
    if isinstance(given, int) and abs(given) > sys.float_info.max:
        raise q.wrong(q.TOO_MANY_DIGITS, key)
    if not math.isfinite(given):
        raise q.wrong(f"{given:g} is not a finite number; write one", key)
    if row.divisor and given == 0.0 and not key:
        raise q.wrong(f"0 is not possible, because the equations divide by {row.name}; correct it", key)
    lower, upper = row.bounds
    if given < 0.0 < lower or upper < 0.0 < given:
        has, needs = ("negative", "positive") if given < 0.0 else ("positive", "negative")
        raise q.wrong(
            f"{given:g} is {has}, but the {row.description} is {needs} (ISO-W axes); correct the sign", key
        )
    return float(given)


def check_coefficients(
    entries: Mapping[str, CoefficientByHand], *, symmetric: bool, has_base: bool, direct: bool
) -> None:
    """Refuse entries of [coefficients] that another key of the file forbids; ``direct``: PECP1 and PECP2 come from the direct
    method.
    """
    for name, entry in entries.items():
        key = f"coefficients.{name}"
        if entry.from_base and not has_base:
            raise q.wrong('is "base", but [tyre] names no base file; add base there, or write a number', key)
        if symmetric and BY_NAME[name].odd and entry.held != 0.0:
            raise q.wrong(
                f'is set, but side = "symmetric" under [tyre] holds {name} at 0; remove it, or declare another side',
                key,
            )
        if direct and name in OF_DIRECT_METHOD:
            raise q.wrong(
                f'is set, but {name} comes from the direct measurement; write pecp1 = "model" under [spin], or remove it',
                key,
            )


def of_command_line(words: Iterable[str]) -> dict[str, object]:
    """The entries that ``--set NAME=VALUE`` gives, as ``[coefficients]`` has them.

    Raises InputError if a word is not ``NAME=VALUE`` or the entry is not possible.
    """
    out: dict[str, object] = {}
    for word in words:
        name, equals, text = (part.strip() for part in word.partition("="))
        key = f"--set {name}"
        if not equals or not name or not text:
            raise InputError(f'"{word}" is not NAME=VALUE; write for example --set PCY1=1.3', key="--set")
        if name in out:
            raise InputError("is given twice; keep one", key=key)
        out[name] = _parsed(text, key)
        try:
            read_entry((name, out[name]))
        except PydanticCustomError as error:
            found = error.context or {}
            raise InputError(found["sentence"], key=f"{key} {found['key']}".strip()) from None
    return out


def _parsed(text: str, key: str) -> object:
    """A value as TOML reads it; ``base`` needs no quotes."""
    if text == BASE:
        return BASE
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (ValueError, KeyError):
        raise InputError(f'"{shortened(text)}" is not a value; {HOW}', key=key) from None

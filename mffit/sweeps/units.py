"""Conversion from the unit that a file or a user names to the contract's unit.

pint is imported only when a unit is named. ``unit_spellings.csv`` translates laboratories' spellings that pint does not know.
"""

import csv
import re
from functools import cache
from importlib import resources
from typing import Any

import numpy as np

MOMENT = re.compile(r"^((?:da|k|M|m)?N)[-.·* ]?(mm|cm|m)$")
"""Usual spellings of moments, N-m and N.m and Nm; pint needs a space between force and length."""


class UnknownUnitError(ValueError):
    """The unit is unknown or has another dimension."""


def converted(values: np.ndarray, unit: str, target: str) -> np.ndarray:
    """Values in ``target``, from ``unit``.

    Parameters
    ----------
    values : (n,) in ``unit``
    unit, target : names of units, e.g. ``"kN"``, ``"lbf ft"``, ``"degF"``, ``"km/h"``; "" is dimensionless

    Raises
    ------
    UnknownUnitError
        ``unit`` is not a unit, or has another dimension than ``target``.

    Examples
    --------
    >>> converted(np.array([1.5]), "kN", "N")
    array([1500.])
    >>> converted(np.array([10.0]), "in-lb", "N m").round(4)
    array([1.1298])
    """
    import pint

    values = np.asarray(values, dtype=float)
    known, wanted = spelt(unit), spelt(target)
    if known == wanted:
        return values
    if not is_unit(unit):
        raise UnknownUnitError(f'"{unit}" is not a unit')
    registry = _registry()
    try:
        return np.asarray(registry.Quantity(values, known).to(wanted).magnitude)
    except pint.DimensionalityError:
        raise UnknownUnitError(f'"{unit}" cannot be converted to {target or "a plain number"}') from None
    except (pint.PintError, *PARSER_FAILURES):
        raise UnknownUnitError(f'"{unit}" is not a unit') from None


@cache
def factor(unit: str, house: str) -> float:
    """The factor from ``unit`` to ``house``."""
    return float(converted(np.ones(1), unit, house)[0])


def has_dimension(unit: str, target: str) -> bool:
    """Whether values in ``unit`` can be converted to ``target``."""
    try:
        factor(unit, target)
    except UnknownUnitError:
        return False
    return True


def is_unit(text: str) -> bool:
    """Whether a text names a unit, in pint's spelling or a laboratory's; words for "dimensionless" count."""
    import pint

    known = spelt(text)
    if known == "":
        return True
    if len(known) > 24 or not EXPRESSION.fullmatch(known):
        return False
    try:
        _registry().parse_units(known)
    except (pint.PintError, *PARSER_FAILURES):
        return False
    return True


PARSER_FAILURES = (AttributeError, AssertionError, TypeError, ValueError, RecursionError)
"""Errors, other than pint's own, that pint's parser raises on a text that is not an expression of units."""
TERM = r"(?:[^\W\d_]+|%|°[CF]?)(?:_[^\W\d_]+)*(?:(?:\*\*|\^)?-?\d(?!\d)|[²³])?"
EXPRESSION = re.compile(rf"(?:1/)?{TERM}(?: ?[ */·] ?{TERM})*")
"""Form of an expression of units; no other text goes to pint's parser, because it also evaluates arithmetic."""


@cache
def spelt(unit: str) -> str:
    """The unit in pint's spelling; "" for a word that means dimensionless."""
    unit = unit.strip()
    plain = spellings().get(unit.lower())
    return MOMENT.sub(r"\1 \2", unit) if plain is None else plain


@cache
def spellings() -> dict[str, str]:
    """Pint's spelling of each unit, by laboratories' spelling in lower case."""
    text = resources.files(__package__).joinpath("unit_spellings.csv").read_text(encoding="utf-8")
    return {row["written"]: row["unit"] for row in csv.DictReader(text.splitlines())}


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True, cache_folder=None)

"""From the unit a file or a user names to the contract's unit; pint is imported only when a unit is named.

Laboratories spell units in ways that no units library knows; ``unit_spellings.csv`` turns them into pint's.
"""

from __future__ import annotations

import csv
import re
from functools import cache
from importlib import resources
from typing import Any

import numpy as np

MOMENT = re.compile(r"^((?:da|k|M|m)?N)[-.·* ]?(mm|cm|m)$")
"""Moments as people write them, N-m and N.m and Nm; pint wants a space between force and length."""


class UnknownUnitError(ValueError):
    """The unit is unknown or measures something else."""


def converted(values: np.ndarray, unit: str, target: str) -> np.ndarray:
    """Values in ``target``, from ``unit``.

    Parameters
    ----------
    values : (n,) in ``unit``
    unit, target : names of units, e.g. ``"kN"``, ``"lbf ft"``, ``"degF"``, ``"km/h"``; "" has no dimension

    Raises
    ------
    UnknownUnitError
        ``unit`` is no unit, or none of the kind of ``target``.

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
        raise UnknownUnitError(f'"{unit}" is no unit')
    registry = _registry()
    try:
        return np.asarray(registry.Quantity(values, known).to(wanted).magnitude)
    except pint.DimensionalityError:
        raise UnknownUnitError(f'"{unit}" cannot be turned into {target or "a plain number"}') from None
    except (pint.PintError, AttributeError, AssertionError, TypeError, ValueError, RecursionError):
        # pint's parser lets these through when the text is no expression of units at all.
        raise UnknownUnitError(f'"{unit}" is no unit') from None


@cache
def factor(unit: str, house: str) -> float:
    """How many of the ``house`` unit one ``unit`` is."""
    return float(converted(np.ones(1), unit, house)[0])


def is_unit(text: str) -> bool:
    """Whether a text names a unit, also the spellings of laboratories and words for no unit."""
    import pint

    known = spelt(text)
    if known == "":
        return True
    if len(known) > LONGEST or not EXPRESSION.fullmatch(known):
        return False
    try:
        _registry().parse_units(known)
    except (pint.PintError, AttributeError, AssertionError, TypeError, ValueError, RecursionError):
        return False
    return True


LONGEST = 24
TERM = r"(?:[^\W\d_]+|%|°[CF]?)(?:_[^\W\d_]+)*(?:(?:\*\*|\^)?-?\d(?!\d)|[²³])?"
EXPRESSION = re.compile(rf"(?:1/)?{TERM}(?: ?[ */·] ?{TERM})*")
"""What an expression of units looks like, so that pint's parser, which also calculates, sees nothing else."""


@cache
def spelt(unit: str) -> str:
    """The unit as pint spells it; "" for a word that means none."""
    unit = unit.strip()
    plain = spellings().get(unit.lower())
    return MOMENT.sub(r"\1 \2", unit) if plain is None else plain


@cache
def spellings() -> dict[str, str]:
    """What laboratories write, in lower case, and the unit as pint spells it."""
    text = resources.files(__package__).joinpath("unit_spellings.csv").read_text(encoding="utf-8")
    return {row["written"]: row["unit"] for row in csv.DictReader(text.splitlines())}


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True, cache_folder=None)

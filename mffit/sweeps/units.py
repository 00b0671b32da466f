"""From the unit a user names to the contract's unit; pint is imported only when a unit is named."""

from __future__ import annotations

import re
from functools import cache
from typing import Any

import numpy as np

MOMENT = re.compile(r"^((?:da|k|M|m)?N)(mm|cm|m)$")
"""Moments as people write them; pint wants a space or a dot between force and length."""


class UnknownUnitError(ValueError):
    """The unit is unknown or measures something else."""


def converted(values: np.ndarray, unit: str, target: str) -> np.ndarray:
    """Values in ``target``, from ``unit``.

    Parameters
    ----------
    values : (n,) in ``unit``
    unit, target : names of units, e.g. ``"kN"``, ``"lbf ft"``, ``"degF"``, ``"km/h"``

    Raises
    ------
    UnknownUnitError
        ``unit`` is no unit, or none of the kind of ``target``.

    Examples
    --------
    >>> converted(np.array([1.5]), "kN", "N")
    array([1500.])
    """
    import pint

    registry = _registry()
    try:
        quantity = registry.Quantity(np.asarray(values, dtype=float), MOMENT.sub(r"\1 \2", unit.strip()))
        return np.asarray(quantity.to(target).magnitude)
    except pint.DimensionalityError:
        raise UnknownUnitError(f'"{unit}" cannot be turned into {target}') from None
    except (pint.PintError, AttributeError, AssertionError, TypeError, ValueError):
        # pint's parser lets these through when the text is no expression of units at all.
        raise UnknownUnitError(f'"{unit}" is no unit') from None


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True, cache_folder=None)

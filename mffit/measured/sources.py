"""Sources of uncertainty: numbers with an uncertainty that know where it comes from, as a budget must show it."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from uncertainties import UFloat, ufloat


class Source(NamedTuple):
    """The origin of a standard uncertainty, in the terms of JCGM 100."""

    name: str
    unit: str  #: of the input quantity
    kind: str = "B"  #: "A": evaluated from the scatter of readings; "B": by other means
    distribution: str = "normal"
    dof: float = math.inf  #: degrees of freedom


def named(value: float, u: float, source: str, unit: str, **more: Any) -> UFloat:
    """An input quantity with its standard uncertainty; ``more`` are further fields of its :class:`Source`."""
    return ufloat(value, max(u, 1e-12), Source(source, unit, **more))  # the propagation does not accept u = 0


def source_of(variable: Any) -> Source:
    """The source of an independent variable."""
    tag = variable.tag
    return tag if isinstance(tag, Source) else Source(str(tag or "other"), "-")

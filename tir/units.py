"""The [UNITS] of a file, and their factors to the units of the table."""

from __future__ import annotations

import math
from collections.abc import Mapping

KINDS: dict[str, dict[str, float]] = {
    "LENGTH": {
        "meter": 1.0, "metre": 1.0, "m": 1.0, "mm": 1e-3, "millimeter": 1e-3, "cm": 1e-2, "centimeter": 1e-2, "km": 1e3,
        "um": 1e-6, "inch": 0.0254, "in": 0.0254, "foot": 0.3048, "feet": 0.3048, "ft": 0.3048,
    },
    "FORCE": {
        "newton": 1.0, "n": 1.0, "kn": 1e3, "knewton": 1e3, "kilonewton": 1e3, "mn": 1e-3, "kg_force": 9.80665,
        "kgf": 9.80665, "pound_force": 4.4482216152605, "lbf": 4.4482216152605, "dyne": 1e-5,
    },
    "ANGLE": {"radians": 1.0, "radian": 1.0, "rad": 1.0, **dict.fromkeys(("degrees", "degree", "deg"), math.pi / 180)},
    "MASS": {
        "kg": 1.0, "kilogram": 1.0, "g": 1e-3, "gram": 1e-3, "mg": 1e-6, "ton": 1e3, "tonne": 1e3, "slug": 14.593902937,
        "pound_mass": 0.45359237, "lbm": 0.45359237,
    },
    "TIME": {
        "second": 1.0, "seconds": 1.0, "sec": 1.0, "s": 1.0, "millisecond": 1e-3, "ms": 1e-3, "minute": 60.0, "hour": 3600.0,
    },
    "PRESSURE": {
        "pascal": 1.0, "pa": 1.0, "kpascal": 1e3, "kpa": 1e3, "kilopascal": 1e3, "mpascal": 1e6, "mpa": 1e6, "megapascal": 1e6,
        "bar": 1e5, "psi": 6894.757293168361,
    },
}  # fmt: skip
"""By kind of quantity, the SI value of each word that a file may have for its unit."""
SI = {"LENGTH": "meter", "FORCE": "newton", "ANGLE": "radians", "MASS": "kg", "TIME": "second"}

PRODUCTS: dict[str, tuple[tuple[str, int], ...]] = {
    "m": (("LENGTH", 1),),
    "s": (("TIME", 1),),
    "m/s": (("LENGTH", 1), ("TIME", -1)),
    "m/s2": (("LENGTH", 1), ("TIME", -2)),
    "N": (("FORCE", 1),),
    "N/m": (("FORCE", 1), ("LENGTH", -1)),
    "N s/m": (("FORCE", 1), ("TIME", 1), ("LENGTH", -1)),
    "N m/rad": (("FORCE", 1), ("LENGTH", 1), ("ANGLE", -1)),
    "Pa": (("FORCE", 1), ("LENGTH", -2)),
    "kg": (("MASS", 1),),
    "kg m2": (("MASS", 1), ("LENGTH", 2)),
    "rad": (("ANGLE", 1),),
    "Hz": (("TIME", -1),),
}
"""Each unit of the table as a product of powers of the file's base units."""


def known_word(kind: str, word: str) -> str:
    """The word of the table for a file's word, which may be in the plural; the word in lower case if it is unknown."""
    word = word.strip("'\" ").lower()
    one = word.removesuffix("s")
    return one if word not in KINDS[kind] and one in KINDS[kind] else word


def factor(unit: str, words: Mapping[str, str]) -> float:
    """The factor from a number in the file's units to a unit of the table, e.g. "N/m".

    ``words`` has the file's word per kind, e.g. {"LENGTH": "mm"}; a missing kind is SI, and a pressure without its own word is
    the file's force per area.
    """
    if unit == "Pa" and "PRESSURE" in words:
        return KINDS["PRESSURE"][words["PRESSURE"].lower()]
    result = 1.0
    for kind, power in PRODUCTS.get(unit, ()):
        result *= KINDS[kind][words.get(kind, SI[kind]).lower()] ** power
    return result

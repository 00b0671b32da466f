"""The [UNITS] of a file, and their factors to the units of the table."""

import math
from collections.abc import Mapping

WORDS: dict[str, dict[float, str]] = {
    "LENGTH": {
        1.0: "meter metre m", 1e-2: "cm centimeter", 1e-3: "mm millimeter", 1e-6: "um", 1e3: "km",
        0.0254: "inch in", 0.3048: "foot feet ft",
    },
    "FORCE": {
        1.0: "newton n", 1e3: "kn knewton kilonewton", 1e-3: "mn", 9.80665: "kg_force kgf", 4.4482216152605: "pound_force lbf",
        1e-5: "dyne",
    },
    "ANGLE": {1.0: "radians radian rad", math.radians(1.0): "degrees degree deg"},
    "MASS": {
        1.0: "kg kilogram", 1e-3: "g gram", 1e-6: "mg", 1e3: "ton tonne", 14.593902937: "slug", 0.45359237: "pound_mass lbm",
    },
    "TIME": {1.0: "second seconds sec s", 1e-3: "millisecond ms", 60.0: "minute", 3600.0: "hour"},
    "PRESSURE": {
        1.0: "pascal pa", 1e3: "kpascal kpa kilopascal", 1e6: "mpascal mpa megapascal", 1e5: "bar", 6894.757293168361: "psi",
    },
}  # fmt: skip
"""By kind of quantity and SI value, the words that a file may have for its unit."""
KINDS = {
    kind: {word: value for value, words in values.items() for word in words.split()}
    for kind, values in WORDS.items()
}
"""By kind of quantity, the SI value of each word."""
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

"""Columns of numbers in a page: typed arrays, compressed, as text within its JSON."""

import base64
import zlib
from collections.abc import Mapping

import numpy as np

from mffit.as_json import Json

SIZES = ("u1", "i1", "u2", "i2", "i4")
"""Types of whole numbers, the smallest first."""
SIX_DIGITS = 20
"""Bits of a number with six digits, as files of rigs have; further ones would only be harder to compress."""


def rounded(values: np.ndarray, bits: int) -> np.ndarray:
    """Numbers with so many bits, the others zero."""
    mantissa, exponent = np.frexp(values)
    return np.asarray(np.ldexp(np.round(np.ldexp(mantissa, bits)), exponent - bits))


def packed(columns: Mapping[str, np.ndarray]) -> dict[str, Json]:
    """Columns, each of its own length, as one text; floats become single with six digits, whole numbers the smallest type.

    ``layout`` has name, type and length of each column in their order, ``bytes`` their bytes, deflated, in base 64: of each
    column the lowest bytes of all numbers, then the next ones, because bytes that are alike compress better side by side.
    """
    layout: list[Json] = []
    content = b""
    for name, column in columns.items():
        kind = "f4" if column.dtype.kind == "f" else _smallest(column)
        kept = rounded(column, SIX_DIGITS) if kind == "f4" else column
        values = np.ascontiguousarray(kept, dtype=f"<{kind}")
        layout.append([name, kind, len(values)])
        content += values.view(np.uint8).reshape(len(values), values.itemsize).T.tobytes()
    return {"layout": layout, "bytes": base64.b64encode(zlib.compress(content)).decode()}


def _smallest(column: np.ndarray) -> str:
    low, high = (int(x) for x in (column.min(initial=0), column.max(initial=0)))
    fitting = (kind for kind in SIZES if np.iinfo(kind).min <= low and high <= np.iinfo(kind).max)
    return next(fitting, SIZES[-1])

"""Elementary functions without branches, so that a compiler can use vector instructions.

Each polynomial interpolates its function at the Chebyshev nodes of a reduced range; relative errors are below 4e-16
(``arctan``: 7e-16, ``power``: 2e-15), angles of ``sin``, ``cos`` and ``tan`` up to 1e6 rad. NaN gives NaN.

The numbers are those of :mod:`tir.codegen.instructions`.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from tir.codegen.instructions import VectorValue, bits, number, select

ROUND = 6755399441055744.0
"""1.5 2^52: adding and subtracting it rounds to an integer, which is in the lowest bits in between."""
PI_1, PI_2 = 3.1415926534682512, 1.2154201013012384e-10
LN2_1, LN2_2 = 0.6931471804855391, 7.440617110012397e-11
"""pi and ln 2 as sums of two numbers, the first with few digits, so that small multiples of it are exact."""
PER_PI, PER_LN2 = 1.0 / math.pi, 1.0 / math.log(2.0)
HALF_PI, PI_6 = math.pi / 2.0, math.pi / 6.0
TAN_PI_12, TAN_PI_6, TAN_5PI_12 = 2.0 - math.sqrt(3.0), 1.0 / math.sqrt(3.0), 2.0 + math.sqrt(3.0)
SIGN_BIT = -(2**63)
SIN = (
    -0.16666666666666666, 0.008333333333333316, -0.00019841269841254974, 2.7557319219163234e-06,
    -2.5052107616996182e-08, 1.6058977312464087e-10, -7.643970296798572e-13, 2.7314447669863995e-15,
)  # fmt: skip
ARCTAN = (
    -0.3333333333333324, 0.19999999999842993, -0.1428571423967277, 0.11111105955136967,
    -0.09090624586290096, 0.07683735512306385, -0.06522051309586488, 0.04578559472830506,
)  # fmt: skip
EXPONENT_OF_ONE = 4607182418800017408
MANTISSA = 4503599627370495
INTEGER_IN_BITS = 4841369599423283200
"""Bits of 1.0, the bits behind the exponent, and the bits of 2^52, to which an integer can be added."""
EXP = (
    0.5000000000000001, 0.16666666666666669, 0.041666666666624164, 0.008333333333330065, 0.0013888888917196719,
    0.00019841269863040545, 2.4801521322368692e-05, 2.7557268480310024e-06, 2.7620075879983367e-07,
    2.5100375832561234e-08,
)  # fmt: skip
LOG = (
    0.6666666666666666, 0.4000000000000088, 0.28571428570803614, 0.22222222391713917, 0.18181795640132906,
    0.15386239702814658, 0.13268773138656886, 0.13086626147840102,
)  # fmt: skip


def polynomial(x: VectorValue, coefficients: Sequence[float]) -> VectorValue:
    """c0 + c1 x + c2 x^2 ...; neighbours are added first, because sums that do not wait for each other run side by side."""
    terms: list[VectorValue] = list(coefficients)  # type: ignore[arg-type]  # numbers until the first sums
    while len(terms) > 1:
        terms = [
            terms[i] + x * terms[i + 1] if i + 1 < len(terms) else terms[i] for i in range(0, len(terms), 2)
        ]
        x = x * x
    return terms[0]


def sin(x: VectorValue) -> VectorValue:
    turns = x * PER_PI + ROUND
    return _with_sign_of(turns, _sin_in_half_turn(_reduced(x, turns - ROUND)))


def cos(x: VectorValue) -> VectorValue:
    turns = (x * PER_PI + 0.5) + ROUND
    return _with_sign_of(turns, _sin_in_half_turn(_reduced(x, (turns - ROUND) - 0.5)))


def tan(x: VectorValue) -> Any:
    half_turns = (x * PER_PI + ROUND) - ROUND
    r = _reduced(x, half_turns)
    from_pole = _reduced(x, half_turns + select(r < 0.0, -0.5, 0.5))
    return _sin_in_half_turn(r) / _sin_in_half_turn(abs(from_pole))


def _reduced(x: VectorValue, half_turns: VectorValue) -> Any:
    return (x - half_turns * PI_1) - half_turns * PI_2


def _with_sign_of(turns: VectorValue, value: VectorValue) -> VectorValue:
    """The value, negative where the number of half turns is odd."""
    return number(bits(value) ^ (bits(turns) << 63))


def _sin_in_half_turn(r: VectorValue) -> Any:
    """sin(r) for abs(r) <= pi/2."""
    s = r * r
    return r + (r * s) * polynomial(s, SIN)


def arctan(x: VectorValue) -> VectorValue:
    t = abs(x)
    steep, middle = t > 1.0, (t > TAN_PI_12) & (t < TAN_5PI_12)
    top, bottom = select(steep, 1.0, t), select(steep, t, 1.0)
    z = select(middle, top - TAN_PI_6 * bottom, top) / select(middle, bottom + TAN_PI_6 * top, bottom)
    s = z * z
    value = z + (z * s) * polynomial(s, ARCTAN)
    value = select(middle, value + PI_6, value)
    value = select(steep, HALF_PI - value, value)
    return number(bits(value) | (bits(x) & SIGN_BIT))


def arccos(x: VectorValue) -> Any:
    """For -1 < x <= 1."""
    return 2.0 * arctan(np.sqrt((1.0 - x) / (1.0 + x)))


def exp(x: VectorValue) -> Any:
    x = select(x > 709.0, 709.0, select(x < -708.0, -708.0, x))
    turns = x * PER_LN2 + ROUND
    n = turns - ROUND
    r = (x - n * LN2_1) - n * LN2_2
    return (1.0 + (r + (r * r) * polynomial(r, EXP))) * number((bits(turns) << 52) + EXPONENT_OF_ONE)


def log(x: VectorValue) -> Any:
    """Of abs(x)."""
    whole = bits(abs(x))
    exponent = number((whole >> 52) + INTEGER_IN_BITS) - (4503599627370496.0 + 1023.0)
    m = number((whole & MANTISSA) + EXPONENT_OF_ONE)
    high = m > 1.4142135623730951
    m, exponent = select(high, 0.5 * m, m), select(high, exponent + 1.0, exponent)
    f = (m - 1.0) / (m + 1.0)
    s = f * f
    tail = (f * s) * polynomial(s, LOG)
    value = exponent * LN2_1 + (2.0 * f + (tail + exponent * LN2_2))
    return select(x == 0.0, -math.inf, select(abs(x) < math.inf, value, abs(x)))


def power(x: VectorValue, y: VectorValue | float) -> Any:
    """As numpy's: 1 for y = 0, NaN for a negative x unless y is an integer."""
    exponent = y * log(x)
    size = select(exponent < -708.0, 0.0, select(exponent > 709.78, math.inf, exp(exponent)))
    half = 0.5 * y
    integer, even = (y + ROUND) - ROUND == y, (half + ROUND) - ROUND == half
    negative = select(integer, select(even, size, -size), math.nan)
    return select(y == 0.0, 1.0, select(x < 0.0, negative, size))

"""Elementary functions without branches, so that a compiler can use vector instructions.

Each polynomial interpolates its function at the Chebyshev nodes of a reduced range; relative errors are below 4e-16
(``power``: 2e-15), angles of ``sin``, ``cos`` and ``tan`` up to 1e6 rad. NaN gives NaN.

The numbers are those of :mod:`tir.codegen.instructions`.
"""

from __future__ import annotations

import math

from tir.codegen.instructions import bits, number, select, sqrt

ROUND = 6755399441055744.0
"""1.5 2^52: adding and subtracting it rounds to an integer, which is in the lowest bits in between."""
PI_1, PI_2, PI_3 = 3.1415926534682512, 1.2154201012607932e-10, 4.044532497591901e-21
LN2_1, LN2_2 = 0.6931471804855391, 7.440617110012397e-11
"""pi and ln 2 as sums of numbers with few digits, so that small multiples of each are exact."""
PER_PI, PER_LN2 = 1.0 / math.pi, 1.0 / math.log(2.0)
HALF_PI, HALF_PI_REST = math.pi / 2.0, 6.123233995736766e-17
TAN_PI_8, TAN_3PI_8 = math.sqrt(2.0) - 1.0, math.sqrt(2.0) + 1.0
EXPONENT_OF_ONE = 4607182418800017408
MANTISSA = 4503599627370495
INTEGER_IN_BITS = 4841369599423283200
"""Bits of 1.0, the bits behind the exponent, and the bits of 2^52, to which an integer can be added."""


def sin(x):
    turns = x * PER_PI + ROUND
    n = turns - ROUND
    r = ((x - n * PI_1) - n * PI_2) - n * PI_3
    return _sin_in_half_turn(r, bits(turns))


def cos(x):
    turns = (x * PER_PI - 0.5) + ROUND
    n = (turns - ROUND) + 0.5
    r = ((x - n * PI_1) - n * PI_2) - n * PI_3
    return -_sin_in_half_turn(r, bits(turns))


def _sin_in_half_turn(r, half_turns):
    """sin(r) for abs(r) <= pi/2, negative where the number of half turns is odd."""
    s = r * r
    tail = 1.605904347941901e-10 + s * (
        -7.647139121983424e-13 + s * (2.8104687777073216e-15 - s * 8.006069886350886e-18)
    )
    tail = -0.00019841269841269806 + s * (2.7557319223971264e-06 + s * (-2.5052108382391406e-08 + s * tail))
    value = r + r * (s * (-0.16666666666666666 + s * (0.008333333333333333 + s * tail)))
    return number(bits(value) ^ (half_turns << 63))


def tan(x):
    return sin(x) / cos(x)


def arctan(x):
    t = abs(x)
    steep, middle = t > TAN_3PI_8, t > TAN_PI_8
    top = select(steep, -1.0, select(middle, t - 1.0, t))
    bottom = select(steep, t, select(middle, t + 1.0, 1.0))
    share = select(steep, 1.0, select(middle, 0.5, 0.0))
    z = top / bottom
    s = z * z
    tail = -0.06664511447381948 + s * (
        0.0585814891280221 + s * (-0.0508544973794026 + s * (0.03923165829558719 - s * 0.01917688711906226))
    )
    tail = 0.11111111015256361 + s * (-0.09090904578123903 + s * (0.07692183190826087 + s * tail))
    tail = -0.3333333333333333 + s * (0.1999999999999552 + s * (-0.14285714284666542 + s * tail))
    value = share * HALF_PI + (z + (z * (s * tail) + share * HALF_PI_REST))
    return select(x < 0.0, -value, value)


def arccos(x):
    """For -1 < x <= 1."""
    return 2.0 * arctan(sqrt((1.0 - x) / (1.0 + x)))


def exp(x):
    x = select(x > 709.0, 709.0, select(x < -708.0, -708.0, x))
    turns = x * PER_LN2 + ROUND
    n = turns - ROUND
    r = (x - n * LN2_1) - n * LN2_2
    tail = 2.4801521322368692e-05 + r * (
        2.7557268480310024e-06 + r * (2.7620075879983367e-07 + r * 2.5100375832561234e-08)
    )
    tail = 0.008333333333330065 + r * (0.0013888888917196719 + r * (0.00019841269863040545 + r * tail))
    tail = 0.5000000000000001 + r * (0.16666666666666669 + r * (0.041666666666624164 + r * tail))
    return (1.0 + (r + (r * r) * tail)) * number((bits(turns) << 52) + EXPONENT_OF_ONE)


def log(x):
    """Of abs(x)."""
    whole = bits(abs(x))
    exponent = number((whole >> 52) + INTEGER_IN_BITS) - (4503599627370496.0 + 1023.0)
    m = number((whole & MANTISSA) + EXPONENT_OF_ONE)
    high = m > 1.4142135623730951
    m, exponent = select(high, 0.5 * m, m), select(high, exponent + 1.0, exponent)
    f = (m - 1.0) / (m + 1.0)
    s = f * f
    tail = 0.18181795640132906 + s * (
        0.15386239702814658 + s * (0.13268773138656886 + s * 0.13086626147840102)
    )
    tail = 0.4000000000000088 + s * (0.28571428570803614 + s * (0.22222222391713917 + s * tail))
    tail = f * (s * (0.6666666666666666 + s * tail))
    value = exponent * LN2_1 + (2.0 * f + (tail + exponent * LN2_2))
    return select(x == 0.0, -math.inf, select(abs(x) < math.inf, value, abs(x)))


def power(x, y):
    """As numpy's: 1 for y = 0, NaN for a negative x unless y is an integer."""
    exponent = y * log(x)
    size = select(exponent < -708.0, 0.0, select(exponent > 709.78, math.inf, exp(exponent)))
    half = 0.5 * y
    integer, even = (y + ROUND) - ROUND == y, (half + ROUND) - ROUND == half
    negative = select(integer, select(even, size, -size), math.nan)
    return select(y == 0.0, 1.0, select(x < 0.0, negative, size))

"""The only functions the equations call: numpy's, except where numpy's own would break a complex step."""

import numpy as np

arccos = np.arccos
arctan = np.arctan
cos = np.cos
exp = np.exp
pi = np.pi
real = np.real
select = np.where
sin = np.sin
sqrt = np.sqrt
tan = np.tan

TINY = 1e-12


def sign(x):
    """Sign of the real part; +1 at zero, so that no term of the Magic Formula vanishes at exactly zero slip."""
    return select(np.real(x) < 0.0, -1.0, 1.0)


def absolute(x):
    """|x| that stays analytic on either side of zero."""
    return x * sign(x)


def cos_arctan(x):
    """cos(atan x), the weighting that most turn-slip factors share."""
    return 1.0 / sqrt(1.0 + x * x)


def away_from_zero(x):
    """x, moved off zero by a rounding error, for use as a divisor."""
    return x + TINY * sign(x)


def finite(x):
    """x, or a value that is nearly infinite in place of an infinite one."""
    largest = 1.0 / TINY
    x = select(real(x) > largest, largest, x)
    return select(real(x) < -largest, -largest, x)


def at_most_one(E, limits):
    """Curvature factor held at <= 1 when limits are asked for; left alone otherwise."""
    return select(limits & (np.real(E) > 1.0), 1.0, E)


def magic_angle(B, C, E, x):
    """The argument ``C atan(Bx - E (Bx - atan Bx))`` of every Magic Formula sine or cosine."""
    Bx = B * x
    return C * arctan(Bx - E * (Bx - arctan(Bx)))

"""Rolling resistance moment My."""

from tir.equations.elementary import TINY, absolute, pi, real, select, sin
from tir.equations.normalise import Inputs


def moment(p, q: Inputs, Fz, Fx, kappa, Vx):
    """My [Nm], negative for a wheel that rolls forwards; A48. ``Vx`` [m/s] > 0.

    Below VXLOW it fades to zero with the wheel's speed of rotation, so that a wheel at rest is not driven.
    """
    speed = Vx / p.LONGVL
    load = Fz / p.FNOMIN
    terms = p.QSY1 + p.QSY2 * Fx / p.FNOMIN + p.QSY3 * absolute(speed) + p.QSY4 * speed**4
    terms = terms + (p.QSY5 + p.QSY6 * load) * q.gamma**2
    My = (
        -p.UNLOADED_RADIUS * p.FNOMIN * p.LMY * terms * load**p.QSY7 * (q.pressure / p.NOMPRES) ** p.QSY8
    )  # A48
    rotation = (1.0 + kappa) * Vx / select(p.VXLOW > 0.0, p.VXLOW, TINY)
    rotation = select(real(rotation) > 1.0, 1.0, select(real(rotation) < -1.0, -1.0, rotation))
    return My * sin(0.5 * pi * rotation)

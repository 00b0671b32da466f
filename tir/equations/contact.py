"""The lag of the contact: its deflections against the wheel, and the slips that correspond to them; see :mod:`tir.transient`.

u is forwards and v to the right [m]; slip speeds Vsx, Vsy [m/s]; sigma_x, sigma_y [m].
"""

from typing import Any, NamedTuple

from tir.equations.elementary import absolute, arctan, cos, exp, pi, select, sign

FULL_SLIDING = 3.0
"""Slip at which the whole contact slides, in units of friction times load over slip stiffness: a brush of parabolic pressure
(Pacejka, section 3.2.1)."""
NEARLY_AT_REST = 1e-3
"""Way over relaxation length below which a series replaces 1 - exp(-z), which would lose its digits."""


class Deflection(NamedTuple):
    """Deflection of the contact point [m]."""

    u: Any
    v: Any


class Motion(NamedTuple):
    """Load [N] and speeds [m/s] of a wheel."""

    Fz: Any
    Vx: Any  #: along the wheel
    Vsx: Any  #: longitudinal slip speed
    Vsy: Any  #: lateral slip speed


def after(p, state, before: Deflection, dt, motion: Motion) -> Deflection:
    """The deflection after ``dt`` [s], for speeds that are constant within it; ``state`` is that at no slip."""
    Fz, Vx, Vsx, Vsy = motion
    rolling, slow = absolute(Vx), absolute(Vx) < p.VXLOW
    u = dragged(before.u, -Vsx, rolling, state.sigma_x, dt)
    v = dragged(before.v, Vsy, rolling, state.sigma_y, dt)
    u = select(slow, no_growth(u, before.u, sliding(state.sigma_x, state.mu_x, Fz, state.K_xk)), u)
    v = select(slow, no_growth(v, before.v, sliding(state.sigma_y, state.mu_y, Fz, state.K_ya)), v)
    return Deflection(select(Fz <= 0.0, 0.0, u), select(Fz <= 0.0, 0.0, v))


def slips(p, state, of: Deflection, motion: Motion, damping) -> tuple[Any, Any]:
    """kappa' [-] and alpha' [rad] of a deflected contact, with ``damping`` [Ns/m] that fades out towards VXLOW."""
    _, Vx, Vsx, Vsy = motion
    way = sign(Vx)  # rolling backwards, slips are relative to the backward speed
    share = way * damping * fading(Vx, p.VXLOW)
    kappa = way * ratio(of.u, state.sigma_x) - ratio(share * Vsx, state.K_xk)
    tan_alpha = way * ratio(of.v, state.sigma_y) + ratio(share * Vsy, absolute(state.K_ya))
    return kappa, arctan(tan_alpha)


def dragged(x, speed, rolling, sigma, dt):
    """Exact solution of dx/dt + rolling/sigma x = speed after dt; x + speed dt where nothing rolls.

    A contact without slip stiffness has no grip on the road, so no deflection.
    """
    length, rate = select(sigma <= 0.0, 1.0, sigma), select(rolling > 0.0, rolling, 1.0)
    z = select(rolling > 0.0, rolling * dt / length, 0.0)
    left = exp(-z)
    series = 1.0 - z / 2.0 * (1.0 - z / 3.0 * (1.0 - z / 4.0 * (1.0 - z / 5.0)))
    time = select(
        z > NEARLY_AT_REST, (1.0 - left) * length / rate, dt * series
    )  # for which the slip speed acts
    gone = select(absolute(speed) <= 0.0, 0.0, speed * time)
    return select(sigma <= 0.0, 0.0, x * left + gone)


def sliding(sigma, mu, Fz, stiffness):
    """Deflection [m] at which the whole contact slides."""
    size = absolute(stiffness)
    return select(size <= 0.0, 0.0, absolute(FULL_SLIDING * mu * Fz * sigma / select(size <= 0.0, 1.0, size)))


def no_growth(x, before, limit):
    """x, held to the limit or, if larger, to its size before."""
    most = select(absolute(before) > limit, absolute(before), limit)
    return select(x > most, most, select(x < -most, -most, x))


def fading(Vx, low):
    """1 at standstill, 0 from ``low`` on, smooth between (Pacejka, chapter 7)."""
    share = Vx / select(low > 0.0, low, 1.0)
    return select(absolute(Vx) < low, 0.5 * (1.0 + cos(pi * share)), 0.0)


def ratio(x, sigma):
    """x over sigma; 0 where sigma is not positive."""
    return select(sigma <= 0.0, 0.0, x / select(sigma <= 0.0, 1.0, sigma))

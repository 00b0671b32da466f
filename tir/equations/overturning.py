"""Overturning moment Mx."""

from tir.equations.elementary import absolute, arctan, cos, sin
from tir.equations.normalise import Inputs


def moment(p, q: Inputs, Fz, Fy):
    """Mx [Nm] about the x axis of the contact frame; 4.E69 extended by QSX12-14."""
    load, side = Fz / p.FNOMIN, Fy / p.FNOMIN
    direct = (
        p.QSX1 * p.LVMX - p.QSX2 * q.gamma * (1.0 + p.PPMX1 * q.dpi) - p.QSX12 * q.gamma * absolute(q.gamma)
    )
    mixed = p.QSX4 * cos(p.QSX5 * arctan((p.QSX6 * load) ** 2))
    mixed = mixed * sin(p.QSX7 * q.gamma + p.QSX8 * arctan(p.QSX9 * side))
    camber = p.QSX10 * arctan(p.QSX11 * load) * q.gamma
    Mx = p.UNLOADED_RADIUS * Fz * p.LMX * (direct + p.QSX3 * side + mixed + camber)  # 4.E69
    return Mx + p.UNLOADED_RADIUS * Fy * p.LMX * (p.QSX13 + p.QSX14 * absolute(q.gamma))

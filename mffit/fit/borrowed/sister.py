"""Longitudinal and combined slip of a tyre measured only sideways, scaled from a sister tyre by the measured side force.

With the ratios of friction and of cornering stiffness of the two tyres, r_mu and r_K at the measured loads::

    mu_x = r_mu mu_x,sister        K_xk = r_K K_xk,sister

so that mu_x over mu_y, the friction ellipse, and K_xk over K_ya stay those of the sister. The weights of combined slip are
functions of slip over the slip at which the tyre slides, which is in the ratio r_mu / r_K (the similarity of H. B. Pacejka, Tire
and Vehicle Dynamics, 3rd ed., section 4.2): their factors of slip are multiplied by r_K / r_mu, and their shifts divided by it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from mffit.config import Config
from mffit.errors import InputError
from mffit.fit import constants
from mffit.fit.beside import BesideNumbers
from mffit.fit.constraints import Envelope
from mffit.fit.known import DETERMINED, Known
from mffit.fit.posterior import Posterior
from mffit.fit.priors import NOT_MEASURED, scatter
from mffit.fit.ranges import covered_ranges, envelope
from mffit.fit.upright import sideways
from mffit.points import Points, levels, main_pressure
from tir import Quantity, Tyre
from tir.derivatives import gradient, plain, traced
from tir.parameters import BY_NAME, TABLE

NEEDED = ("PCX1", "PDX1", "PKX1", "PDY1", "PKY1")
"""Coefficients that a sister's file must state."""
BY_FRICTION = (("PDX1", "PDX2"), ("PVX1", "PVX2"))
"""Coefficients of a + b dfz that friction scales."""
BY_STIFFNESS = (("PKX1", "PKX2"),)
"""Coefficients of a + b dfz that slip stiffness scales."""
OVER_SLIP = {
    **dict.fromkeys(("RBX1", "RBX3", "RBY2", "RVY4"), (1, False)),
    **dict.fromkeys(("RHX1", "RBY3"), (-1, False)),
    **dict.fromkeys(("RBX2", "RBY1", "RBY4", "RVY6"), (1, True)),
    **dict.fromkeys(("PHX1", "PHX2", "RHY1", "RHY2"), (-1, True)),
}
"""By coefficient, whether it multiplies (1) or shifts (-1) a slip, and whether this is the longitudinal slip."""
LENT = tuple(
    row.name
    for row in TABLE
    if row.section == "LONGITUDINAL_COEFFICIENTS"
    or any(need.word in ("combined", "side_force") for need in row.needs)
    or row.name.startswith(("RVY", "SSZ"))
)
"""Every coefficient of longitudinal and combined slip."""


class Sister(NamedTuple):
    """The sister tyre, and the expected similarity of the two tyres."""

    file: str  #: as tyre.toml names it
    tyre: Tyre  #: at the nominal conditions of the fitted one
    u_friction: float  #: relative standard uncertainty of the assumption that mu_x / mu_y is equal
    u_stiffness: float  #: relative standard uncertainty of the assumption that K_xk / K_ya is equal
    loads: np.ndarray  #: (n,) at which the two tyres are compared [N]
    pressure: float  #: at which the two tyres are compared [Pa]
    envelope: Envelope  #: ranges over which a drawn tyre keeps the physical limits


@dataclass(frozen=True, slots=True)
class Lent:
    """Coefficients that a fitted tyre takes from a sister tyre."""

    sister: Sister
    friction: Quantity  #: longitudinal friction over the sister's, at nominal load
    stiffness: Quantity  #: slip stiffness over the sister's, at nominal load
    beside: BesideNumbers  #: the borrowed coefficients, with derivatives by the fitted ones
    found: Mapping[str, Quantity]  #: the borrowed coefficients with their standard uncertainties


def sister_of(config: Config, base: Tyre | None, points: Points) -> Sister | None:
    """The sister tyre that ``[sister]`` declares; None without that table.

    Raises InputError if the base file has no measured longitudinal force, or longitudinal force was measured on this tyre too.
    """
    if config.sister is None or base is None or config.tyre.base is None:
        return None

    def refused(sentence: str) -> InputError:
        return InputError(sentence, file=config.path, line=config.line_of("sister.Fx"), key="sister.Fx")

    driven = np.flatnonzero(~points.free_rolling & np.isfinite(points.Fx))
    if len(driven):
        raise refused(
            f"Fx is to come from a sister tyre, but {points.files[points.file[driven[0]]]} measures it on this one: remove "
            "[sister], or the sweeps of longitudinal slip"
        )
    for name in NEEDED:
        said = base.status.get(name, "")
        lacks = "" if name in base.present else f"does not state {name}"
        if not lacks and said.startswith(NOT_MEASURED):
            lacks = f'marks {name} as "{said}"'
        if lacks:
            raise refused(
                f"the base file {config.tyre.base} {lacks}, so that it has no measured force to scale: name another base, or "
                "remove [sister]"
            )
    ranges = covered_ranges(points)
    low, high = ranges["FZMIN"], ranges["FZMAX"]
    if levels.count(points.Fz, levels.LOAD) < 2:
        share = float(constants.AROUND_A_SINGLE_VALUE)
        low, high = (1.0 - share) * low, (1.0 + share) * high
    return Sister(
        file=config.tyre.base,
        tyre=base,
        u_friction=config.sister.u_friction,
        u_stiffness=config.sister.u_stiffness,
        loads=np.linspace(low, high, constants.STEPS_OF_A_GRID),
        pressure=float(points.p[main_pressure(points)].mean()),
        envelope=envelope(ranges)._replace(kappa=float(constants.SISTER_SLIP)),
    )


def lend(sister: Sister, known: Known, posterior: Posterior) -> Lent:
    """The borrowed coefficients of a fitted tyre; those determined by points or set by hand keep their values."""
    theirs = {name: float(sister.tyre[name]) for name in LENT}
    kept = {*known.hand.names, *(name for name in LENT if known.origin[name] in DETERMINED)}
    wanted = [name for name in LENT if name in sister.tyre.present and name not in kept]
    fitted = posterior.without(LENT)
    scaled = _scaled(known.values, theirs, sister, by=fitted.names)
    slope = np.array([scaled.slopes[name] for name in LENT])
    own = [
        0.0 if name in ("PDX1", "PKX1") else scatter(name, x, from_base=True, curved=False)
        for name, x in scaled.values.items()
    ]
    errors = slope[:, -2:] * [sister.u_friction, sister.u_stiffness]
    every = BesideNumbers(
        values=scaled.values,
        covariance=errors @ errors.T + np.diag(np.square(own)),
        leans_on=fitted.names,
        slope=slope[:, :-2],
    )
    u = fitted.with_numbers(every).stderr
    return Lent(
        sister=sister,
        friction=_ratio("PDX1", scaled.values, theirs, u),
        stiffness=_ratio("PKX1", scaled.values, theirs, u),
        beside=every.only(wanted),
        found={name: Quantity(scaled.values[name], u[name], BY_NAME[name].unit) for name in wanted},
    )


def _ratio(
    name: str, own: Mapping[str, float], theirs: Mapping[str, float], u: Mapping[str, float]
) -> Quantity:
    return Quantity(own[name] / theirs[name], u[name] / abs(theirs[name]), "-")


class _Scaled(NamedTuple):
    """The scaled coefficients and their derivatives (k + 2,) by the k named numbers and the logarithms of the two errors."""

    values: dict[str, float]
    slopes: dict[str, np.ndarray]


def _scaled(
    values: Mapping[str, Any], theirs: Mapping[str, float], sister: Sister, by: Sequence[str] = ()
) -> _Scaled:
    """The sister's coefficients ``theirs``, scaled to the tyre with these ``values``.

    ``by`` names the numbers to differentiate by.
    """
    own = [name for name in by if name in values and name in BY_NAME]
    free = traced({**{name: float(values[name]) for name in own}, "friction": 0.0, "stiffness": 0.0})
    of_friction, of_stiffness = np.exp(free["friction"]), np.exp(free["stiffness"])
    here = sideways({**values, **free}, sister.loads, sister.pressure)
    there = sideways(sister.tyre.values, sister.loads, sister.pressure)
    mu, K = here[0] / there[0], here[1] / there[1]
    # The scale of sideslip follows from the measured side force alone, so the two similarity errors do not enter it.
    growth = {False: K / mu, True: K / mu * (of_stiffness / of_friction)}
    dfz = sister.loads / (float(values["FNOMIN"]) * float(values["LFZO"])) - 1.0
    lines = np.stack([np.ones_like(dfz), dfz], axis=1)
    nearest, mean = np.linalg.pinv(lines), np.full((1, len(dfz)), 1.0 / len(dfz))
    columns = [*(by.index(name) for name in own), len(by), len(by) + 1]
    found, slopes = dict(theirs), {name: np.zeros(len(by) + 2) for name in theirs}

    def take(names: Sequence[str], weights: np.ndarray, over_load: Any) -> None:
        """Set the coefficients to weighted sums over the loads."""
        by_free = weights @ gradient(over_load, list(free.values()))
        for name, x, slope in zip(names, weights @ plain(over_load), by_free, strict=True):
            found[name], slopes[name][columns] = float(x), slope

    for scale, pairs in ((mu * of_friction, BY_FRICTION), (K * of_stiffness, BY_STIFFNESS)):
        for pair in pairs:
            take(pair, nearest, scale * (lines @ [theirs[name] for name in pair]))
    for name, (power, of_kappa) in OVER_SLIP.items():
        take((name,), mean, theirs[name] * growth[of_kappa] ** float(power))
    return _Scaled(found, slopes)

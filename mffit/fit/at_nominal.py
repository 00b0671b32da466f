"""Coefficients converted to other nominal conditions: load, pressure, speed and free radius.

Nearly all forms of the equations are closed under such a change, so the conversion is exact. :func:`misfit` returns the largest
remaining difference.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from mffit.fit import constants
from mffit.fit.priors import CONVERTED
from mffit.tested import NOT_MEASURED
from tir import Tyre
from tir.equations.forces import Forces
from tir.mode import BLOCK, asks_for_turn_slip

OVER_LOAD: tuple[tuple[str, ...], ...] = (
    ("PDX1", "PDX2"),
    ("PEX1", "PEX2", "PEX3"),
    ("PHX1", "PHX2"),
    ("PVX1", "PVX2"),
    ("REX1", "REX2"),
    ("PDY1", "PDY2"),
    ("PEY1", "PEY2"),
    ("PKY6", "PKY7"),
    ("PHY1", "PHY2"),
    ("PVY1", "PVY2"),
    ("PVY3", "PVY4"),
    ("REY1", "REY2"),
    ("RHY1", "RHY2"),
    ("RVY1", "RVY2"),
    ("QBZ1", "QBZ2", "QBZ3"),
    ("QDZ1", "QDZ2"),
    ("QEZ1", "QEZ2", "QEZ3"),
    ("QHZ1", "QHZ2"),
    ("QHZ3", "QHZ4"),
    ("QDZ6", "QDZ7"),
    ("QDZ8", "QDZ9"),
    ("QDZ10", "QDZ11"),
    ("SSZ3", "SSZ4"),
    ("PHYP2", "PHYP3"),
)
"""Coefficients of a + b dfz + c dfz^2."""
FACTOR_OVER_LOAD: Mapping[tuple[str, ...], tuple[str, ...]] = {
    ("PDXP2",): ("PDXP1",),
    ("PDYP2",): ("PDYP1",),
    ("PECP2",): ("PECP1",),
    ("PCFX1", "PCFX2"): ("LONGITUDINAL_STIFFNESS",),
    ("PCFY1", "PCFY2"): ("LATERAL_STIFFNESS",),
}
"""Coefficients of a factor 1 + a dfz + b dfz^2, and the coefficients that it multiplies."""
FACTOR_OVER_PRESSURE: Mapping[tuple[str, ...], tuple[str, ...]] = {
    ("PPX1", "PPX2"): ("PKX1", "PKX2"),
    ("PPX3", "PPX4"): ("PDX1", "PDX2"),
    ("PPY1",): ("PKY1",),
    ("PPY2",): ("PKY2", "PKY5"),
    ("PPY3", "PPY4"): ("PDY1", "PDY2"),
    ("PPY5",): ("PKY6", "PKY7"),
    ("PPMX1",): ("QSX2",),
    ("PCFX3",): ("LONGITUDINAL_STIFFNESS",),
    ("PCFY3",): ("LATERAL_STIFFNESS",),
    ("PCMZ1",): ("YAW_STIFFNESS",),
}
"""Coefficients of a factor 1 + a dpi + b dpi^2, and the coefficients that it multiplies."""


class Powers(NamedTuple):
    """Powers of the nominal conditions by which a coefficient changes if its force stays constant."""

    load: float = 0.0
    radius: float = 0.0
    speed: float = 0.0


OVER_RADIUS = Powers(radius=-1.0)
POWERS: Mapping[str, Powers] = {
    **dict.fromkeys(("PKY1", "PKY2", "PKY5"), Powers(load=-1.0)),
    **dict.fromkeys(("QSX6", "QSX9", "QSX11", "BREFF", "Q_FCX", "Q_FCY"), Powers(load=1.0)),
    **dict.fromkeys(("QDZ1", "QDZ2", "SSZ2", "QSX3"), Powers(load=1.0, radius=-1.0)),
    **dict.fromkeys(("QDZ6", "QDZ7", "QDZ8", "QDZ9", "QDZ10", "QDZ11", "SSZ1", "SSZ3", "SSZ4"), OVER_RADIUS),
    **dict.fromkeys(("QSX1", "QSX2", "QSX4", "QSX10", "QSX12", "QSX13", "QSX14"), OVER_RADIUS),
    **dict.fromkeys(("PDXP1", "PDYP1", "QDTP1", "QBRP1", "QCRP2"), OVER_RADIUS),
    "PDYP4": Powers(radius=0.5),
    "PKYP1": Powers(radius=-2.0),
    "QCRP1": Powers(load=0.5, radius=-1.0),
    "Q_V1": Powers(radius=-3.0, speed=2.0),
    "Q_V2": Powers(radius=-1.0, speed=1.0),
}
"""Coefficients outside the factors of dfz and dpi; for those of My see OF_ROLLING."""
OF_ROLLING = {
    "QSY1": Powers(),
    "QSY2": Powers(load=1.0),
    "QSY3": Powers(speed=1.0),
    "QSY4": Powers(speed=4.0),
    "QSY5": Powers(),
    "QSY6": Powers(load=1.0),
}
"""Powers of the terms of My, in addition to a common factor of nominal load, nominal pressure and radius."""


KEYS = ("FNOMIN", "NOMPRES", "LONGVL", "UNLOADED_RADIUS")
"""The keys of a file that hold its nominal conditions."""


UNITS = ((1.0, "N"), (1e-3, "kPa"), (1.0, "m/s"), (1.0, "m radius"))
"""Factor and unit of each nominal condition in sentences."""


class Nominal(NamedTuple):
    """The conditions to which coefficients are relative."""

    load: float  #: FNOMIN [N]
    pressure: float  #: NOMPRES [Pa]
    speed: float  #: LONGVL [m/s]
    radius: float  #: UNLOADED_RADIUS [m]

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> Nominal:
        return cls(*(float(values[name]) for name in KEYS))

    def beside(self, other: Nominal) -> tuple[str, str]:
        """The conditions in which two records differ, in words for each of the two; empty if they agree."""
        rows = [
            (f"{scale * a:.5g} {unit}", f"{scale * b:.5g} {unit}")
            for a, b, (scale, unit) in zip(self, other, UNITS, strict=True)
            if not math.isclose(a, b)
        ]
        return ", ".join(row[0] for row in rows), ", ".join(row[1] for row in rows)


def at_nominal(values: Mapping[str, Any], wanted: Nominal) -> dict[str, Any]:
    """The values with other nominal conditions, and coefficients that give the same forces in N and moments in Nm.

    The deflection of the wheel under a load also stays; its free radius becomes the wanted one. Turn-slip coefficients at the
    common defaults are not converted, because these values mark them as a guess.
    """
    before = Nominal.of(values)
    v = dict(values)
    load, pressure = wanted.load / before.load, wanted.pressure / before.pressure
    radius, speed = wanted.radius / before.radius, wanted.speed / before.speed
    for names in OVER_LOAD:
        _polynomial(v, names, load)
    for names, multiplied in FACTOR_OVER_LOAD.items():
        _factor(v, names, multiplied, load)
    growth = math.exp(v["PKX3"] * (load - 1.0))
    _polynomial(v, ("PKX1", "PKX2"), load)
    v |= {"PKX1": growth * v["PKX1"], "PKX2": growth * v["PKX2"], "PKX3": load * v["PKX3"]}
    for names, multiplied in FACTOR_OVER_PRESSURE.items():
        _factor(v, names, multiplied, pressure)
    if not asks_for_turn_slip(values):
        _factor(v, ("PPZ2",), ("QDZ8", "QDZ9"), pressure)  # with turn slip, PPZ2 does not act on these two
    v["PPZ1"] *= -1.0  # the one factor with a minus sign, 1 - PPZ1 dpi
    _factor(v, ("PPZ1",), ("QDZ1", "QDZ2"), pressure)
    v["PPZ1"] *= -1.0
    _vertical(v, load, pressure, radius)
    _camber_reduction(v, radius)
    rolling = load ** (v["QSY7"] - 1.0) * pressure ** v["QSY8"] / radius
    for factor, table in ((1.0, POWERS), (rolling, OF_ROLLING)):
        for name, power in table.items():
            v[name] *= factor * load**power.load * radius**power.radius * speed**power.speed
    if _guessed(values):
        v |= {row.name: values[row.name] for row in BLOCK}
    return {**v, **dict(zip(KEYS, wanted, strict=True))}


def _guessed(values: Mapping[str, Any]) -> bool:
    """Whether the turn-slip coefficients are the common defaults, which are not measured."""
    return all(values[row.name] == row.default for row in BLOCK)


def _polynomial(v: dict[str, Any], names: tuple[str, ...], scale: float) -> None:
    """Rewrite a + b x + c x^2 in the new x', where x = scale x' + scale - 1."""
    shift = scale - 1.0
    a, b, c = (*(float(v[name]) for name in names), 0.0, 0.0)[:3]
    new = (a + b * shift + c * shift**2, (b + 2.0 * c * shift) * scale, c * scale**2)
    v.update(zip(names, new, strict=False))


def _factor(v: dict[str, Any], names: tuple[str, ...], multiplied: tuple[str, ...], scale: float) -> None:
    """Rewrite the factor 1 + a x + b x^2 in the new x'; its value at x' = 0 goes into the multiplied coefficients."""
    v["1"] = 1.0
    _polynomial(v, ("1", *names), scale)
    here = v.pop("1")
    v.update({name: v[name] / here if here else math.inf for name in names})
    v.update({name: v[name] * here for name in multiplied})


def _vertical(v: dict[str, Any], load: float, pressure: float, radius: float) -> None:
    """Convert load over deflection, rolling radius over load, and contact patch.

    VERTICAL_STIFFNESS is the slope at the nominal load; the other coefficients are relative to it.
    """
    here = 1.0 + float(v["PFZ1"]) * (pressure - 1.0)
    if not here > 0.0:
        v["PFZ1"] = math.inf
        return
    stiffness, quadratic = float(v["VERTICAL_STIFFNESS"]), float(v["Q_FZ2"])
    slope = (stiffness * float(v["UNLOADED_RADIUS"]) / float(v["FNOMIN"])) ** 2
    new = (here / load) ** 2 * (slope - 4.0 * quadratic) + 4.0 * quadratic * here / load
    change = load / here * math.sqrt(new / slope) if quadratic and new > 0.0 < slope else 1.0
    powers = {"Q_RA1": 0.5, "Q_RA2": 1.0, "Q_RB1": 1.0 / 3.0, "Q_RB2": 1.0}
    across = {"Q_RA1": -0.5, "Q_RA2": 0.0, "Q_RB1": 1.0 / 3.0, "Q_RB2": 1.0}
    v |= {name: v[name] * change**power * radius ** across[name] for name, power in powers.items()}
    v |= {
        "PFZ1": v["PFZ1"] * pressure / here,
        "VERTICAL_STIFFNESS": stiffness * here * change,
        "Q_FZ2": quadratic * radius**2 * here / load,
        "DREFF": v["DREFF"] * change / load,
        "FREFF": v["FREFF"] * change,
    }


def _camber_reduction(v: dict[str, Any], radius: float) -> None:
    """Convert the force of path curvature, which is proportional to radius / (1 - eps_gamma)."""
    first = 1.0 - radius * (1.0 - v["PECP1"])
    if radius != 1.0:
        slope = radius * v["PECP1"] * v["PECP2"]
        v |= {"PECP1": first, "PECP2": slope / first if first else math.inf * slope if slope else 0.0}


class ForceMisfit(NamedTuple):
    """Largest difference between the forces of two tyres in a channel, over the largest force."""

    channel: str
    turn_slip: bool
    share: float


def misfit(before: Tyre, after: Tyre) -> ForceMisfit:
    """The channel in which two tyres differ most, at random conditions in the ranges of ``before``, straight and on curves."""
    p, random = before.p, np.random.default_rng(0)
    ends = (
        (p.FZMIN, p.FZMAX), (p.ALPMIN, p.ALPMAX), (p.CAMMIN, p.CAMMAX), (p.KPUMIN, p.KPUMAX),
        np.sin([p.CAMMIN, p.CAMMAX]) / p.UNLOADED_RADIUS, (p.LONGVL, p.LONGVL), (p.PRESMIN, p.PRESMAX),
    )  # fmt: skip
    drawn = [random.uniform(min(end), max(end), int(constants.CONDITIONS_OF_A_MISFIT)) for end in ends]
    found = []
    for turn_slip in (False,) if _guessed(before.values) else (False, True):
        one, other = (np.array(tyre(*drawn, turn_slip=turn_slip)) for tyre in (before, after))
        for channel, a, b in zip(Forces._fields, one, other, strict=True):
            rows = np.isfinite(a)
            most = float(np.max(np.abs(a[rows]), initial=0.0))
            off = float(np.max(np.abs(b - a)[rows], initial=0.0))
            found.append(ForceMisfit(channel, turn_slip, off / most if most else 0.0))
    return max(found, key=lambda row: row.share)


CONDITIONS = "nominal conditions"
"""Entry of the provenance of a converted tyre."""


def tyre_at_nominal(tyre: Tyre, wanted: Nominal) -> Tyre:
    """The tyre with other nominal conditions and, as far as the equations allow, the same forces; its provenance records this.

    Raises ArithmeticError if coefficients would be infinite, because a factor of load or pressure is 0; the message names the
    coefficients.
    """
    old, new = Nominal.of(tyre.values).beside(wanted)
    rest = {key: text for key, text in tyre.provenance.items() if key != CONDITIONS}
    if not new:
        return replace(tyre, provenance=MappingProxyType(rest))
    values = at_nominal(tyre.values, wanted)
    lost = [name for name, x in values.items() if isinstance(x, float) and not math.isfinite(x)]
    if lost:
        raise ArithmeticError(", ".join(lost))
    changed = [name for name in tyre.present if values[name] != tyre.values[name] and name not in KEYS]
    known = [name for name in changed if not tyre.status.get(name, "").startswith(NOT_MEASURED)]
    status = {**tyre.status, **dict.fromkeys(known, f"{CONVERTED} to other nominal conditions")}
    found = replace(tyre, values=MappingProxyType(values), status=MappingProxyType(status))
    said = f"its coefficients hold for {old} and are converted to {new}, {_agreement(misfit(tyre, found))}"
    return replace(found, provenance=MappingProxyType({**rest, CONDITIONS: said}))


def _agreement(worst: ForceMisfit) -> str:
    differs = f"{worst.share:.1%}"
    if differs == "0.0%":
        return "with the same forces"
    mode = "with" if worst.turn_slip else "without"
    return f"but {worst.channel} {mode} turn slip differs by up to {differs} of its largest value"

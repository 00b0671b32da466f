"""Every value of the property file with its origin, before and after the fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

from mffit.config import Config
from mffit.config.by_hand import KEYS_OF_TYRE
from mffit.config.models import given_values
from mffit.fit import constants
from mffit.fit.by_hand import NO_HAND, Hand
from mffit.fit.priors import CONVERTED, Prior
from mffit.fit.ranges import covered_ranges
from mffit.fit.stages import ODD_TERMS
from mffit.measured import Measured
from mffit.points import Points
from tir import Tyre
from tir.equations import normalise, stiffness
from tir.parameters import TABLE

DECIDED = ("TYRESIDE", "USE_MODE", "FITTYP")
"""Keys whose values the build sets itself."""
DETERMINED = ("measured", "fitted", "regularised")
"""Origins of values that points determine; estimates never replace them."""


@dataclass(frozen=True, slots=True)
class Known:
    """Values by name, and the origin of each: measured, fitted, regularised, base, converted, default, estimate, fleet, range,
    given."""

    values: Mapping[str, Any]
    origin: Mapping[str, str]
    hand: Hand = NO_HAND
    u: Mapping[str, float | None] = field(default_factory=dict)
    """Standard uncertainties of values known before the fit, where they are stated."""

    def having(self, found: Mapping[str, Any], origin: str = "") -> Known:
        """The record with some values and their ``origin`` replaced; held values stay, and "" keeps the old origin."""
        replaced = {name: value for name, value in found.items() if name not in self.hand.held}
        words = dict.fromkeys(replaced, origin) if origin else {}
        return replace(self, values={**self.values, **replaced}, origin={**self.origin, **words})


def known_before_fit(
    config: Config,
    points: Points,
    measured: Measured,
    base: Tyre | None,
    fleet: Mapping[str, Prior],
    hand: Hand = NO_HAND,
) -> Known:
    """Every value before the fit, with its origin; values held by hand never change afterwards."""
    template = Tyre.from_values({}) if base is None else base
    known = Known(
        values={**template.values, **hand.held},
        origin={
            row.name: "given"
            if row.name in hand.held and row.name not in hand.from_base
            else _of_base(base, row.name)
            if base is not None and row.name in base.present
            else "default"
            for row in TABLE
        },
        hand=hand,
    )
    known = known.having({name: known.values[name] for name in DECIDED}, "given")
    given = given_values(config.tyre)
    assumed = {name: x for name, x in given.items() if not _is_stated(config.tyre, name)}
    known = known.having(given, "given").having(assumed, "default")
    if base is None:
        known = known.having(estimates(known.values), "estimate")
    known = known.having({name: prior.expected for name, prior in fleet.items()}, "fleet")
    known = known.having(covered_ranges(points), "range")
    if measured.carried is not None:
        known = known.having({"PECP1": measured.pecp1}, "measured")
        known = known.having({"PECP2": measured.pecp2}, "measured" if measured.pecp2 else "default")
        known = replace(
            known, u={"PECP1": measured.carried.pecp1.u, "PECP2": measured.carried.over_load.u_pecp2}
        )
    if config.tyre.side == "symmetric":
        known = known.having(dict.fromkeys(ODD_TERMS, 0.0), "given")
    return _as_set(known)


def _of_base(base: Tyre, name: str) -> str:
    """The origin of a value that the base file states."""
    return CONVERTED if base.status.get(name, "").startswith(CONVERTED) else "base"


def _as_set(known: Known) -> Known:
    """The values with the centres of priors set by hand, within the bounds set by hand."""
    hand = known.hand
    found = {name: float(known.values[name]) for name in hand.bounded} | {
        name: prior.expected for name, prior in hand.priors.items()
    }
    changed = {name: x for name, x in hand.within(found).items() if x != known.values[name]}
    measured = {name: x for name, x in changed.items() if known.origin[name] == "measured"}
    return known.having(changed, "given").having(measured, "measured")


def known_after_fit(
    known: Known,
    fitted: Mapping[str, float],
    regularised: frozenset[str],
    held: Mapping[str, float],
    base: Tyre | None,
) -> Known:
    """The values after the fit, with the estimates that follow from the fitted ones.

    ``regularised`` coefficients depend on their priors as much
    as on the points. ``held`` has the coefficients that the fit took as exact, some at starting values read off the points.
    """
    known = known.having({name: x for name, x in held.items() if x != known.values[name]}, "estimate")
    for name, value in fitted.items():
        known = known.having({name: value}, "regularised" if name in regularised else "fitted")
    if base is None:  # again, because some estimates scale with the fitted friction and stiffness
        found = estimates(known.values)
        known = known.having(
            {name: v for name, v in found.items() if known.origin[name] not in DETERMINED}, "estimate"
        )
    return known


def _is_stated(tyre: Any, name: str) -> bool:
    """Whether ``[tyre]`` states a value, rather than its key's default."""
    return name not in KEYS_OF_TYRE or KEYS_OF_TYRE[name] in tyre.model_fields_set


ESTIMATED_SHAPES = {
    "BREFF": 8.0,
    "DREFF": 0.25,
    "FREFF": 0.05,
    "PCX1": 1.6,
    "PEX1": 0.1,
    "PKX3": -0.2,
    "RBX1": 12.0,
    "RBX2": 10.0,
    "RCX1": 1.0,
    "RBY1": 11.0,
    "RBY2": 8.0,
    "RCY1": 1.0,
    "QSX3": 0.03,
    "QSY1": 0.01,
}
"""Shape coefficients usual for road tyres, which complete the file so that a simulation can run."""


def estimates(values: Mapping[str, Any]) -> dict[str, float]:
    """Vertical, longitudinal, combined-slip, rolling and structural coefficients, scaled from known values.

    The static deflection at nominal load is 5 % of the unloaded radius; the longitudinal peak equals the lateral one; the
    longitudinal slip stiffness follows from the cornering stiffness at nominal load; the arm of the load is half the width per
    radian of camber.
    """
    v = {name: float(value) for name, value in values.items() if isinstance(value, (int, float))}
    R0 = v["UNLOADED_RADIUS"]
    vertical = v["FNOMIN"] / (0.05 * R0)
    return {
        "VERTICAL_STIFFNESS": vertical,
        "VERTICAL_DAMPING": 0.0005 * vertical,
        "LONGITUDINAL_STIFFNESS": 1.5 * vertical,
        "LATERAL_STIFFNESS": 0.7 * vertical,
        "PDX1": v["PDY1"],
        "PDX2": v["PDY2"],
        "PKX1": _slip_stiffness(v),
        "QSX2": 0.5 * v["WIDTH"] / R0,
        **ESTIMATED_SHAPES,
    }


def _slip_stiffness(v: Mapping[str, float]) -> float:
    """PKX1 with the usual ratio of the stiffnesses at nominal load and pressure; PKY1 alone is the largest over all loads."""
    p = SimpleNamespace(**{**v, "PKX1": 1.0})
    q = normalise.inputs(p, normalise.OperatingCondition(p.FNOMIN, pressure=p.NOMPRES))
    K_ya, of_one = stiffness.cornering_stiffness(p, q, 0.0), stiffness.longitudinal_slip_stiffness(p, q)
    return float(constants.SLIP_OVER_CORNERING_STIFFNESS * abs(K_ya) / of_one)

"""The tyre at another temperature: the terms that the comments of a file state, applied to its scaling factors."""

import math
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any, TypeVar

from tir.equations.elementary import select
from tir.errors import Problem, TirError
from tir.record import Quantity, TyreRecord

Kind = TypeVar("Kind", bound=TyreRecord)

SCALED_BY = MappingProxyType(
    {
        "k_T_grip_per_K": "LMUY",
        "k_T_stiffness_per_K": "LKY",
        "k_T_camber_per_K": "LKYC",
        "k_T_drive_grip_per_K": "LMUX",
        "k_T_slip_stiffness_per_K": "LKX",
        "k_T_grip_per_K2": "LMUY",
    }
)
"""By term, the scaling factor that it multiplies with 1 + k (T - T_ref), or with 1 + k (T - T_ref) + k2 (T - T_ref)^2."""
CURVED_BY = MappingProxyType({"k_T_grip_per_K": "k_T_grip_per_K2"})
"""By linear term k, the quadratic term k2 of the same scaling factor."""
RIG = "rig."
"""Prefix of the terms and of their reference temperature among the measured quantities of a file."""
REFERENCE = f"{RIG}T_ref_degC"
LOWEST, HIGHEST = "T_min_degC", "T_max_degC"
"""Measured quantities with the range of temperature in which the terms were found."""


def terms_of(tyre: TyreRecord) -> dict[str, Quantity]:
    """The temperature terms of a file, by name; empty for a file without."""
    if REFERENCE not in tyre.measured:
        return {}
    return {name: tyre.measured[RIG + name] for name in SCALED_BY if RIG + name in tyre.measured}


def factors_at(terms: Mapping[str, Quantity], warmer: Any) -> dict[str, Any]:
    """By scaling factor, the number that multiplies it ``warmer`` kelvin above the reference temperature."""
    found: dict[str, Any] = {}
    for name, term in terms.items():
        rise = warmer**2 if name in CURVED_BY.values() else warmer
        found[SCALED_BY[name]] = found.get(SCALED_BY[name], 1.0) + term.value * rise
    return found


def at_temperature(tyre: Kind, T_degC: float) -> Kind:
    """The tyre at a temperature [degC]; see :meth:`tir.Tyre.at_temperature`."""
    terms = terms_of(tyre)
    if not terms:
        raise TirError(
            "the file has no temperature terms (comments with rig.k_T_grip_per_K and rig.T_ref_degC): use the file "
            "NAME-at-temperature.tir that mffit build writes where it models the temperature",
            path=None if tyre.document is None else tyre.document.path,
        )
    beyond = _beyond(tyre, float(T_degC))
    T_degC = float(held(tyre, float(T_degC)))
    warmer = T_degC - tyre.measured[REFERENCE].value
    factors, stated = factors_at(terms, warmer), {}
    for name in SCALED_BY.keys() - CURVED_BY.values():
        linear, curved = terms.get(name), terms.get(CURVED_BY.get(name, ""))
        if linear is None and curved is None:
            continue
        (k, u_k), (k2, u_k2) = (
            (0.0, 0.0) if term is None else (term.value, term.u) for term in (linear, curved)
        )
        factor = factors[SCALED_BY[name]]
        if not factor > 0.0:
            raise TirError(
                f"at {T_degC:g} degC the temperature terms leave no friction or stiffness; use them near their range"
            )
        # The terms of the new file are relative to its own factors, so that a second change of temperature counts from there.
        slope, bend = (k + 2.0 * k2 * warmer) / factor, k2 / factor
        if linear is not None:
            u = math.hypot(u_k * (1.0 - slope * warmer), u_k2 * warmer * (2.0 - slope * warmer)) / factor
            stated[RIG + name] = linear._replace(value=slope, u=u)
        if curved is not None:
            u = math.hypot(u_k2 * (1.0 - bend * warmer**2), u_k * bend * warmer) / factor
            stated[RIG + CURVED_BY[name]] = curved._replace(value=bend, u=u)
    stated[REFERENCE] = tyre.measured[REFERENCE]._replace(value=T_degC)
    scaled = {name: float(tyre[name]) * factor for name, factor in factors.items()}
    moved = tyre.replace(**scaled).annotate(
        measured=stated, status=dict.fromkeys(scaled, f"at {T_degC:g} degC, by the temperature terms")
    )
    return replace(moved, on_reading=(*tyre.on_reading, beyond)) if beyond else moved


def held(tyre: TyreRecord, T_degC: Any) -> Any:
    """The temperature [degC], held to the range in which the terms were measured; a file that states none has no limits."""
    low, high = _tested(tyre)
    if low > -math.inf:
        T_degC = select(T_degC < low, low, T_degC)
    return select(T_degC > high, high, T_degC) if high < math.inf else T_degC


def _tested(tyre: TyreRecord) -> tuple[float, float]:
    """The range of temperature [degC] in which the terms were measured, unlimited if the file states none."""
    known = {name: q.value for name, q in tyre.measured.items() if name in (LOWEST, HIGHEST)}
    return known.get(LOWEST, -math.inf), known.get(HIGHEST, math.inf)


def _beyond(tyre: TyreRecord, T_degC: float) -> Problem | None:
    """A warning for a temperature outside the range of the terms."""
    low, high = _tested(tyre)
    said = (
        f"{T_degC:g} degC is outside {low:g} to {high:g} degC, where the temperature terms were measured; the tyre is that at "
        f"{held(tyre, T_degC):g} degC"
    )
    return None if low <= T_degC <= high else Problem("warning", said)

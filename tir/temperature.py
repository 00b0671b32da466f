"""The tyre at another temperature: the terms that the comments of a file state, applied to its scaling factors."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING

from tir.errors import Problem, TirError

if TYPE_CHECKING:
    from tir.tyre import Quantity, Tyre

SCALED_BY = MappingProxyType(
    {
        "k_T_grip_per_K": "LMUY",
        "k_T_stiffness_per_K": "LKY",
        "k_T_camber_per_K": "LKYC",
        "k_T_drive_grip_per_K": "LMUX",
        "k_T_slip_stiffness_per_K": "LKX",
    }
)
"""By term, the scaling factor that it multiplies with 1 + k (T - T_ref)."""
RIG = "rig."
"""Prefix of the terms and of their reference temperature among the measured quantities of a file."""
REFERENCE = f"{RIG}T_ref_degC"
LOWEST, HIGHEST = "T_min_degC", "T_max_degC"
"""Measured quantities with the range of temperature in which the terms were found."""


def terms_of(tyre: Tyre) -> dict[str, Quantity]:
    """The temperature terms of a file, by name; empty for a file without."""
    if REFERENCE not in tyre.measured:
        return {}
    return {name: tyre.measured[RIG + name] for name in SCALED_BY if RIG + name in tyre.measured}


def at_temperature(tyre: Tyre, T_degC: float) -> Tyre:
    """The tyre at a temperature [degC]; see :meth:`tir.Tyre.at_temperature`."""
    terms = terms_of(tyre)
    if not terms:
        raise TirError(
            "the file has no temperature terms (comments with rig.k_T_grip_per_K and rig.T_ref_degC): use the file "
            "NAME-at-temperature.tir that mffit build writes where it models the temperature",
            path=None if tyre.document is None else tyre.document.path,
        )
    T_degC = float(T_degC)
    warmer = T_degC - tyre.measured[REFERENCE].value
    factors = {name: 1.0 + term.value * warmer for name, term in terms.items()}
    if not all(factor > 0.0 for factor in factors.values()):
        raise TirError(
            f"at {T_degC:g} degC the temperature terms leave no friction or stiffness; use them near their range"
        )
    # The terms of the new file are relative to its own factors, so that a second change of temperature counts from there.
    stated = {
        RIG + name: term._replace(value=term.value / factors[name], u=term.u / factors[name] ** 2)
        for name, term in terms.items()
    }
    stated[REFERENCE] = tyre.measured[REFERENCE]._replace(value=T_degC)
    scaled = {SCALED_BY[name]: float(tyre[SCALED_BY[name]]) * factor for name, factor in factors.items()}
    moved = tyre.replace(**scaled).annotate(
        measured=stated, status=dict.fromkeys(scaled, f"at {T_degC:g} degC, by the temperature terms")
    )
    beyond = _beyond(tyre, T_degC)
    return replace(moved, problems=(*tyre.problems, beyond)) if beyond else moved


def _beyond(tyre: Tyre, T_degC: float) -> Problem | None:
    """A warning for a temperature outside the range of the terms."""
    if LOWEST not in tyre.measured or HIGHEST not in tyre.measured:
        return None
    low, high = tyre.measured[LOWEST].value, tyre.measured[HIGHEST].value
    if low <= T_degC <= high:
        return None
    return Problem(
        "warning",
        f"{T_degC:g} degC is outside {low:g} to {high:g} degC, where the temperature terms were measured",
    )

"""Coefficients that can change together without changing any force, and the form that mffit writes."""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from mffit.fit.priors import CONVERTED
from tir import Tyre
from tir.parameters import BY_NAME

SAME_CURVE = (
    ("PCX1",),
    ("PDX1", "PDX2"),
    ("RBX1", "RBX3"),
    ("RBX2",),
    ("RCX1",),
    ("QSX5",),
    ("QSX6",),
    ("QSX8", "QSX9"),
    ("QSX10", "QSX11"),
    ("PCY1",),
    ("PDY1", "PDY2", "RVY1", "RVY2", "RVY3", "QBZ10"),
    ("PKY1", "PKY4"),
    ("PKY2", "PKY4", "PKY5"),
    ("RBY1", "RBY4"),
    ("RBY2",),
    ("RCY1",),
    ("RVY4",),
    ("RVY6", "RVY5"),
    ("RVY5", "RVY1", "RVY2", "RVY3"),
    ("QBZ1", "QBZ2", "QBZ3", "QEZ4", "QEZ5"),
    ("QBZ9", "QBZ10"),
    ("QCZ1", "QEZ4", "QEZ5"),
    ("PDXP1",),
    ("PDXP3",),
    ("PKYP1",),
    ("PDYP1",),
    ("PDYP3",),
    ("PHYP1",),
    ("PHYP2", "PHYP3"),
    ("QDTP1",),
    ("QCRP1",),
    ("QCRP2",),
    ("QBRP1",),
)
"""Groups of coefficients whose common change of sign changes no force: factors inside an even function, or pairs that cancel."""


def in_one_form(values: Mapping[str, Any]) -> dict[str, float]:
    """Coefficients to replace by their negatives: groups of which more members are then inside the bounds of the table."""
    found: dict[str, float] = {}
    for group in SAME_CURVE:
        here = {name: found.get(name, float(values[name])) for name in group}
        other = {name: -x for name, x in here.items()}
        if _outside(other) < _outside(here):
            found |= other
    return {name: x for name, x in found.items() if x != values[name]}


def _outside(values: Mapping[str, float]) -> int:
    return sum(not BY_NAME[name].bounds[0] <= x <= BY_NAME[name].bounds[1] for name, x in values.items())


def tyre_in_one_form(tyre: Tyre) -> Tyre:
    """The tyre with the signs that the table's bounds allow, and the same forces."""
    changed = in_one_form(tyre.values)
    status = {**tyre.status, **dict.fromkeys(changed, f"{CONVERTED} to the usual signs")}
    values = {**tyre.values, **changed}
    return (
        replace(tyre, values=MappingProxyType(values), status=MappingProxyType(status)) if changed else tyre
    )


def with_expected_signs(values: Mapping[str, Any], expected: Mapping[str, float]) -> dict[str, float]:
    """Coefficients to replace, at the same forces, so that the first of each group has its expected sign.

    The slip stiffness (PKX1 + PKX2 dfz) exp(PKX3 dfz) is the same to second order with -PKX2 and PKX3 + 2 PKX2 / PKX1: of the
    two, the one whose exponent is nearer to the expected one.
    """
    found: dict[str, float] = {}
    if {"PKX2", "PKX3"} <= expected.keys():
        PKX1, PKX2, PKX3 = (float(values[name]) for name in ("PKX1", "PKX2", "PKX3"))
        away = PKX1 * (PKX3 - expected["PKX3"])
        if abs(away + 2.0 * PKX2) < abs(away):
            found = {"PKX2": -PKX2, "PKX3": PKX3 + 2.0 * PKX2 / PKX1}
    for group in SAME_CURVE:
        here = {name: found.get(name, float(values[name])) for name in group}
        if expected.get(group[0], 0.0) * here[group[0]] < 0.0:
            found |= {name: -x for name, x in here.items()}
    return {name: x for name, x in found.items() if x != values[name]}

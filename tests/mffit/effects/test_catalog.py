"""The library is complete, consistent with the property file's table, and its pages are current."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import pytest

from mffit.effects import CATALOG, NEEDS
from mffit.effects.effect import Effect, Free
from mffit.effects.pages import NEITHER, page, pages
from mffit.rig import MEANINGS, UNITS, RigFaults
from tir.parameters import BY_NAME

DOCS = Path(__file__).parents[3] / "docs" / "effects"
FREES = {
    "turn-slip": "turn_slip",
    "camber-reduction": "PECP1",
    "camber-reduction-load": "PECP2",
    "ply-steer": "PHY1",
    "conicity": "PVY1",
    "camber-stiffness": "PKY6",
    "camber-thrust-curvature": "PVY3",
    "camber-grip": "PDY3",
    "camber-cornering-stiffness": "PKY3",
    "load-grip": "PDY2",
    "load-cornering-stiffness": "PKY2",
    "pressure": "PPY1 PPY2 PPY3 PPY5 PPZ1",
    "curvature-asymmetry": "PEY3",
    "trail-load": "QDZ2",
    "trail-camber": "QDZ3 QDZ4",
    "residual-torque": "QDZ6",
    "residual-torque-camber": "QDZ8",
    "spin-grip-loss": "PDYP1",
    "spin-stiffness-loss": "PKYP1",
    "spin-trail-loss": "QDTP1",
    "spin-torque": "QCRP1",
    "relaxation": "",
    "sideslip-misalignment": "alpha_0_deg",
    "camber-misalignment": "gamma_0_deg",
    "loadcell-offset-fy": "F0_N",
    "loadcell-offset-mz": "M0_Nm",
    "loadcell-gain": "gain",
    "crosstalk-fz-fy": "crosstalk",
    "backlash": "backlash_deg",
    "path-radius": "path_radius_m",
    "temperature": "k_T_per_K",
    "speed": "k_V_per_mps",
    "drift": "k_t_per_s",
    "steering-compliance": "compliance_deg_per_Nm",
    "loadcell-nonlinearity": "nonlinearity_per_kN",
    "hysteresis": "hysteresis_deg",
    "temperature-grip": "k_T_grip_per_K",
    "temperature-stiffness": "k_T_stiffness_per_K",
    "wear": "wear_per_km",
    "warm-up": "warm_up",
    "run-offsets-fy": "F0_N",
    "run-offsets-mz": "M0_Nm",
    "run-offsets-alpha": "alpha_0_deg",
}
"""The ids that files and scripts rely on, and what each at least sets free."""


def ids(effects=CATALOG):
    return [effect.id for effect in effects]


def test_every_promised_effect_is_there_once():
    assert sorted(ids()) == sorted(FREES)


@pytest.mark.parametrize("effect", CATALOG, ids=ids())
def test_an_effect_frees_what_is_promised(effect):
    assert set(FREES[effect.id].split()) <= set(effect.parameters)


@pytest.mark.parametrize("effect", CATALOG, ids=ids())
def test_a_record_says_what_a_reader_needs(effect):
    assert effect.name
    assert effect.physics.endswith(".")
    assert effect.kind in {"tyre", "rig", "environment"}
    assert effect.parity, f"{effect.id} does not say how it behaves under reversed angles"
    assert set(effect.needs) <= set(NEEDS)
    assert set(effect.confusable_with) <= set(ids()) - {effect.id}


@pytest.mark.parametrize("effect", CATALOG, ids=ids())
def test_freed_numbers_exist_and_can_be_started_from(effect):
    rig = {field.name for field in fields(RigFaults)}
    for free in effect.free:
        assert free.name in (BY_NAME if effect.kind == "tyre" else rig) or free.name in NEITHER
        assert free.spread > 0.0
        assert free.lower < free.upper
        if free.name in BY_NAME:
            assert free.lower <= BY_NAME[free.name].default <= free.upper or free.relative


@pytest.mark.parametrize("fault", [field.name for field in fields(RigFaults)])
def test_numbers_of_the_rig_are_all_described(fault):
    free = Free(fault, 1.0)
    row = page(Effect("mine", "mine", "rig", "What a rig does.", (free,)), CATALOG)
    assert f"| `{fault}` | {UNITS[fault]} | {MEANINGS[fault]} |" in row


def test_the_pages_are_current():
    written = {path.name: path.read_text(encoding="utf-8") for path in DOCS.glob("*.md")}
    assert written == pages(), "run: python -m mffit.effects.pages docs/effects"

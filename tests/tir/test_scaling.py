"""Scale factors, by Pacejka's definition: each stands for the same change of the coefficients of one quantity."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tir
from tir.parameters import TABLE

FACTOR = 1.3
SAME = {
    "LCX": "PCX1",
    "LMUX": "PDX1 PDX2 PVX1 PVX2",
    "LEX": "PEX1 PEX2 PEX3",
    "LKX": "PKX1 PKX2",
    "LHX": "PHX1 PHX2",
    "LVX": "PVX1 PVX2",
    "LCY": "PCY1",
    "LMUY": "PDY1 PDY2 PVY1 PVY2 PVY3 PVY4 QDZ6 QDZ7 QDZ8 QDZ9 QDZ10 QDZ11 /QBZ1 /QBZ2 /QBZ3 /QBZ9",
    "LEY": "PEY1 PEY2",
    "LKY": "PKY1 QBZ1 QBZ2 QBZ3 QBZ9",
    "LHY": "PHY1 PHY2",
    "LVY": "PVY1 PVY2",
    "LTR": "QDZ1 QDZ2",
    "LRES": "QDZ6 QDZ7",
    "LXAL": "RBX1 RBX3",
    "LYKA": "RBY1 RBY4",
    "LVYKA": "RVY1 RVY2 RVY3",
    "LS": "SSZ1 SSZ2 SSZ3 SSZ4",
    "LKYC": "PKY6 PKY7 PVY3 PVY4",
    "LKZC": "QDZ8 QDZ9 QDZ10 QDZ11",
    "LVMX": "QSX1",
    "LMP": "QCRP1",
}
"""Factor -> coefficients that are multiplied by it, or, with a stroke, divided."""
ONLY_WITHOUT_SPIN = {"LMUY"}  # with spin the residual torque's stiffness takes no part in the friction


@pytest.fixture(scope="module")
def full() -> tir.Tyre:
    """Every coefficient at work."""
    tyre = tir.read(Path(__file__).parent / "vectors" / "moto_front.tir")
    used = [r.name for r in TABLE if r.section.endswith("COEFFICIENTS") and r.kind == "number"]
    return tyre.replace(**{name: tyre[name] or 0.04 for name in used})


def forces(tyre, turn_slip):
    rng = np.random.default_rng(4)
    n = 40
    alpha, gamma, kappa, phi_t = (s * rng.uniform(-1, 1, n) for s in (0.2, 0.5, 0.15, 0.5))
    return tyre(
        rng.uniform(900.0, 2500.0, n),
        alpha,
        gamma,
        kappa,
        phi_t,
        12.0,
        rng.uniform(2e5, 3e5, n),
        turn_slip=turn_slip,
    )


@pytest.mark.parametrize("turn_slip", [False, True])
@pytest.mark.parametrize("factor", SAME)
def test_a_factor_is_a_change_of_its_quantitys_coefficients(full, factor, turn_slip):
    if turn_slip and factor in ONLY_WITHOUT_SPIN:
        return
    changes = {}
    for word in SAME[factor].split():
        name = word.lstrip("/")
        changes[name] = full[name] / FACTOR if word != name else full[name] * FACTOR
    scaled, changed, plain = (
        forces(t, turn_slip) for t in (full.replace(**{factor: FACTOR}), full.replace(**changes), full)
    )
    moved = 0.0
    for a, b, c in zip(scaled, changed, plain, strict=True):
        differs = f"{factor} does not act as a change of {SAME[factor]}; add a new coefficient that it scales to SAME"
        np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-9 * np.max(np.abs(b)), err_msg=differs)
        moved = max(moved, float(np.max(np.abs(a - c)) / np.max(np.abs(c))))
    works = turn_slip or factor != "LMP"
    assert (moved > 1e-4) == works


@pytest.mark.parametrize(("factor", "channel"), [("LMX", "Mx"), ("LMY", "My")])
def test_moments_of_rolling_and_overturning_are_scaled_whole(full, factor, channel):
    scaled, plain = (forces(t, False) for t in (full.replace(**{factor: FACTOR}), full))
    for name in plain._fields:
        expected = getattr(plain, name) * (FACTOR if name == channel else 1.0)
        np.testing.assert_allclose(getattr(scaled, name), expected, rtol=1e-12)


def test_the_load_factor_is_another_nominal_load(full):
    """For forces and trail, which is per nominal load; what FNOMIN itself scales is no matter of it."""
    steady = full.replace(VERTICAL_STIFFNESS=1e30)
    scaled = forces(steady.replace(LFZO=FACTOR), False)
    nominal = forces(
        steady.replace(FNOMIN=FACTOR * full["FNOMIN"], QDZ1=FACTOR * full["QDZ1"], QDZ2=FACTOR * full["QDZ2"],
                       SSZ2=FACTOR * full["SSZ2"]),
        False,
    )  # fmt: skip
    for name in ("Fx", "Fy", "Mz"):
        a, b = getattr(scaled, name), getattr(nominal, name)
        np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-9 * np.max(np.abs(b)))


def test_every_factor_is_tested():
    factors = {row.name for row in TABLE if row.section == "SCALING_COEFFICIENTS"}
    assert factors == {*SAME, "LMX", "LMY", "LFZO"}

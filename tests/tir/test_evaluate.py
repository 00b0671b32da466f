"""The public evaluation: what it does unless told otherwise, and what limits hold."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tir
from tir.evaluate import evaluate

TYRE = tir.read(Path(__file__).parent / "vectors" / "moto_front.tir")
INSIDE = {"kappa": 0.01, "alpha": 0.03, "gamma": 0.1, "pressure": float(TYRE["NOMPRES"])}


def test_limits_and_turn_slip_are_off_by_default():
    """Angles as they are, path curvature ignored, at LONGVL and INFLPRES."""
    beyond = 3.0 * float(TYRE["ALPMAX"])
    plain = evaluate(TYRE.p, 1800.0, beyond, 0.2)[0]
    assert plain.Fy != evaluate(TYRE.p, 1800.0, float(TYRE["ALPMAX"]), 0.2)[0].Fy
    said = dict(Vx=TYRE["LONGVL"], pressure=TYRE["INFLPRES"], turn_slip=False, star=False, limits=False)
    assert plain == evaluate(TYRE.p, 1800.0, beyond, 0.2, 0.0, -0.7, **said)[0]
    for change in (
        {"turn_slip": True},
        {"star": True},
        {"limits": True},
        {"pressure": 1.2 * TYRE["INFLPRES"]},
    ):
        assert plain.Fy != evaluate(TYRE.p, 1800.0, beyond, 0.2, 0.0, -0.7, **{**said, **change})[0].Fy


@pytest.mark.parametrize(
    ("name", "lower", "upper"),
    [("kappa", "KPUMIN", "KPUMAX"), ("alpha", "ALPMIN", "ALPMAX"), ("gamma", "CAMMIN", "CAMMAX"),
     ("pressure", "PRESMIN", "PRESMAX")],
)  # fmt: skip
def test_limits_hold_an_input_at_the_end_of_its_range(name, lower, upper):
    low, high = float(TYRE[lower]), float(TYRE[upper])
    beyond, ends, within = (
        evaluate(TYRE.p, 1800.0, **INSIDE | {name: np.array(values)}, limits=True)[0].Fy
        for values in (
            (low - 0.2 * abs(low), high + 0.2 * abs(high)), (low, high),
            (low + 0.1 * (high - low), high - 0.1 * (high - low)),
        )
    )  # fmt: skip
    assert beyond == pytest.approx(ends, rel=1e-12)
    assert np.all(within != ends)


def test_limits_hold_the_load_from_above_and_let_moments_fade_from_below():
    """Above FZMAX the side force is that of FZMAX; below FZMIN the overturning moment falls with the third power of the load."""
    high, low = float(TYRE["FZMAX"]), max(float(TYRE["FZMIN"]), 200.0)
    tyre = TYRE.replace(FZMIN=low)
    forces = evaluate(tyre.p, np.array([high, 1.3 * high]), 0.03, 0.1, limits=True)[0]
    assert forces.Fy[0] == pytest.approx(forces.Fy[1], rel=1e-12)
    sizes = evaluate(tyre.p, np.array([1.0, 0.5, 0.25]) * low, 0.0, 0.0, limits=True)[0]
    assert sizes.My[1] / sizes.My[0] == pytest.approx(0.25 ** float(tyre["QSY7"]), rel=1e-3)
    assert sizes.My[2] / sizes.My[1] == pytest.approx(0.25 ** float(tyre["QSY7"]), rel=1e-3)
    unlimited = evaluate(tyre.p, np.array([1.0, 0.5]) * low, 0.0, 0.0)[0]
    assert unlimited.My[1] / unlimited.My[0] == pytest.approx(0.5 ** float(tyre["QSY7"]), rel=1e-3)


@pytest.mark.parametrize("phi_t", [0.0, -0.7])
def test_backwards_is_forwards_seen_from_behind(phi_t):
    """A symmetric tyre turned half round about z: sideslip force reversed over the rig, wheel turning the other way."""
    plain = TYRE.replace(**{row.name: 0.0 for row in tir.parameters.TABLE if row.odd})
    out, state = evaluate(plain.p, 1800.0, 0.03, 0.0, 0.0, phi_t, -8.0, turn_slip=True)
    ahead, there = evaluate(plain.p, 1800.0, 0.03, 0.0, 0.0, -phi_t, 8.0, turn_slip=True)
    assert out.Fy == pytest.approx(-ahead.Fy)
    assert out.Mz == pytest.approx(ahead.Mz)
    assert out.My == pytest.approx(-ahead.My)
    assert state.omega == pytest.approx(-there.omega)
    assert state.omega < 0.0

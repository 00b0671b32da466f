"""One rule for turn slip in calls, states, exports and the lag: the units digit of USE_MODE, unless told otherwise."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

import tir
from tir import transient
from tir.derivatives import gradient, traced
from tir.evaluate import evaluate
from tir.outputs import outputs_of

VECTORS = Path(__file__).parent / "vectors"
MEASURED = tir.read(VECTORS / "moto_front.tir").replace(PDYP4=0.3, PECP1=-0.1, QDRP2=-0.2)
"""A block as a fit writes it."""
LEAN = dict(alpha=0.02, gamma=0.4)


def by_equations(tyre: tir.Tyre, on: bool, **given):
    return evaluate(tyre.p, 1400.0, **LEAN, **given, turn_slip=on)


@pytest.mark.parametrize(
    ("mode", "given", "on"),
    [
        (124, {}, False),
        (225, {}, True),
        (5, {}, True),
        (-25, {}, True),
        (225.7, {}, True),
        (150, {}, False),
        (124, {"phi_t": 0.0}, True),
        (225, {"turn_slip": False}, False),
        (124, {"turn_slip": True}, True),
        (225, {"phi_t": -0.1, "turn_slip": False}, False),
    ],
)
def test_a_call_follows_the_units_digit_unless_told(mode, given, on):
    tyre = MEASURED.replace(USE_MODE=mode)
    forces, state = by_equations(tyre, on, phi_t=given.get("phi_t", 0.0))
    assert tyre(1400.0, **LEAN, **given).Fy == pytest.approx(forces.Fy, rel=1e-12)
    assert tyre.state(1400.0, **LEAN, **given).zeta0 == state.zeta0


@pytest.mark.parametrize("mode", [124, 225])
def test_exports_the_lag_and_the_picture_follow_the_same_digit(mode):
    tyre, on = MEASURED.replace(USE_MODE=mode), mode == 225
    words = f"turn slip {'on' if on else 'off'}"
    assert words in tir.export_c(tyre).header
    assert "turn slip off" in tir.export_c(tyre, turn_slip=False).header
    settled = transient.step(tyre, transient.Contact(), np.inf, 1400.0, 20.0, 0.0, 20.0 * np.tan(0.02), 0.4)[
        1
    ]
    assert settled.Fy == pytest.approx(by_equations(tyre, on, Vx=20.0)[0].Fy, rel=1e-9)
    told = transient.step(
        tyre, transient.Contact(), np.inf, 1400.0, 20.0, 0.0, 20.0 * np.tan(0.02), 0.4, turn_slip=not on
    )[1]
    assert told.Fy == pytest.approx(by_equations(tyre, not on, Vx=20.0)[0].Fy, rel=1e-9)


@pytest.mark.parametrize("change", [{}, {"PHYP1": 0.0}, {"PHYP2": 0.0, "PHYP3": 0.0}])
def test_a_guessed_or_empty_block_is_told_once(change):
    tyre = tir.read(VECTORS / "MagicFormula62.tir").replace(USE_MODE=125, **change)
    with pytest.warns(tir.TirWarning, match="no side force" if change else "common defaults") as caught:
        tyre(4000.0, 0.02)
    assert Path(caught[0].filename).name == Path(__file__).name
    with pytest.warns(tir.TirWarning) as caught:
        tir.export_c(tyre)
    assert Path(caught[0].filename).name == Path(__file__).name
    with pytest.warns(tir.TirWarning) as caught:
        transient.step(tyre.replace(), transient.Contact(), 0.1, 4000.0, 10.0)
    assert Path(caught[0].filename).name == Path(__file__).name
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tyre(4000.0, 0.03)
        tyre(4000.0, 0.02, turn_slip=True)
        tir.export_c(tyre, turn_slip=False)
        MEASURED.replace(USE_MODE=225)(1400.0, 0.02)


def test_at_zero_spin_every_derivative_is_a_number_and_that_beside_it():
    """sqrt(|phi|) has no slope at 0; the slopes of the forces are the mean of those on both sides."""
    names = ("Fy", "Fx")
    inputs = {"Fz": 1400.0, "alpha": 0.02, "kappa": 0.01, "gamma": 0.0, "phi_t": 0.0}
    found = _slopes(names, inputs)
    assert np.all(np.isfinite(found))
    beside = [_slopes(names, {**inputs, "phi_t": step}) for step in (-1e-9, 1e-9)]
    np.testing.assert_allclose(found[:, :3], np.mean(beside, axis=0)[:, :3], rtol=1e-4, atol=1e-3)


def _slopes(names, inputs) -> np.ndarray:
    numbers = traced(inputs)
    out = outputs_of(names, MEASURED.p, numbers, turn_slip=True)
    return np.array([gradient(x, [*numbers.values()]) for x in out])


def test_time_does_not_run_backwards():
    for dt in (-1e-3, float("nan")):
        with pytest.raises(tir.TirError, match="time only runs forwards"):
            transient.step(MEASURED, transient.Contact(), dt, 1400.0, 10.0)


def test_a_flat_tyre_has_a_finite_rolling_resistance():
    tyre = MEASURED.replace(QSY1=0.01, QSY8=-0.4)
    flat, low = (tyre(1400.0, p=p) for p in (0.0, 5e3))
    assert flat.My == pytest.approx(low.My, rel=1e-3)
    assert low.My == pytest.approx(tyre(1400.0, p=250e3).My * (5.0 / 250.0) ** -0.4, rel=1e-3)
    assert np.all(np.isfinite(flat))
    np.testing.assert_allclose(tyre(1400.0, p=np.array([0.0, 5e3])).My, [flat.My, low.My], rtol=1e-12)

"""What single programs compute otherwise: their formulae, written out once more, against the numbers that are said."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import tir
from tir.targets import beyond_the_peak_in_chrono, chrono_in_words, spin_without_moment_in_mbsim

FRONT = Path(__file__).parent / "vectors" / "moto_front.tir"
STEEP = {
    "FNOMIN": 4000.0, "UNLOADED_RADIUS": 0.3, "PCX1": 1.65, "PDX1": 1.1, "PEX1": 0.4, "PKX1": 24.0,
    "PCY1": 1.4, "PDY1": 0.9, "PEY1": -0.5, "PKY1": -22.0, "PKY2": 1.5, "PHY1": 0.004, "RBX1": 0.0, "RBY1": 0.0,
}  # fmt: skip


def chrono(C, D, E, K, x):
    """The pure force, the product of slope factor and slip clamped as in Chrono's source, and not."""
    forces = []
    for end in (0.5 * math.pi - 0.01, math.inf):
        Bx = min(max(K / (C * D) * x, -end), end)
        forces.append(D * math.sin(C * math.atan(Bx - E * (Bx - math.atan(Bx)))))
    return forces[0] / forces[1] - 1.0


def test_chrono_holds_the_forces_beyond_the_peak():
    tyre = tir.Tyre.from_values(STEEP)
    found = beyond_the_peak_in_chrono(tyre)
    Fz, K_y = 4000.0, -22.0 * 4000.0 * math.sin(2.0 * math.atan(1.0 / 1.5))
    assert found["Fx"] == pytest.approx(chrono(1.65, 1.1 * Fz, 0.4, 24.0 * Fz, 0.3), rel=1e-6)
    assert found["Fy"] == pytest.approx(
        chrono(1.4, 0.9 * Fz, -0.5, K_y, math.radians(20.0) + 0.004), rel=1e-6
    )
    assert found["Fx"] > 0.1
    assert f"{100.0 * found['Fx']:+.0f} % at slip 0.3" in chrono_in_words(tyre)


def test_a_tyre_that_chrono_does_not_hold_is_not_spoken_of():
    soft = tir.Tyre.from_values(STEEP | {"PKX1": 4.0, "PKY1": -3.0})
    assert beyond_the_peak_in_chrono(soft) == {"Fx": 0.0, "Fy": 0.0}
    assert not chrono_in_words(soft)
    assert beyond_the_peak_in_chrono(tir.Tyre.from_values(STEEP | {"PDX1": 0.0})).keys() == {"Fy"}


def test_the_moment_of_mbsim_is_nan_up_to_the_stated_spin():
    """Its arc cosine by the equations, 4.E92 to 4.E103, for a wheel that leans until its spin cancels that of the path."""
    tyre, phi_t = tir.read(FRONT), 0.02
    p, Fz = tyre.p, float(tyre["FNOMIN"])
    gamma = np.linspace(-0.4, 0.4, 4001)
    state = tyre.state(Fz, 0.0, gamma, 0.0, phi_t, p=p.NOMPRES)
    M_inf = p.QCRP1 * np.abs(state.mu_y) * p.UNLOADED_RADIUS * Fz
    M_90 = M_inf * 2.0 / math.pi * math.atan(p.QCRP2 * p.UNLOADED_RADIUS * phi_t)
    D = M_inf / math.sin(0.5 * math.pi * p.QDRP1)
    K = Fz * p.UNLOADED_RADIUS * (p.QDZ8 + p.QDZ10 * np.abs(gamma))
    spun = D * np.sin(
        p.QDRP1 * np.arctan(K / (p.QDRP1 * D * (1.0 - p.PECP1)) * p.UNLOADED_RADIUS * state.phi)
    )
    nan = np.abs(spun) < M_90
    assert 0 < nan.sum() < nan.size
    assert np.abs(state.phi[nan]).max() / phi_t == pytest.approx(spin_without_moment_in_mbsim(tyre), rel=0.1)

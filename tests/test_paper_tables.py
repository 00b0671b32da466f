"""`samples/paper-tables` through the whole direct method, against the printed tables."""

from __future__ import annotations

from pathlib import Path

import pytest

import mffit

SAMPLES = Path(__file__).parents[1] / "samples" / "paper-tables"
PRINTED = {
    "front-1": (-0.0609, 0.0863, 31.4),
    "front-2": (-0.1245, 0.0951, 31.6),
    "front-3": (-0.1870, 0.1089, 31.2),
    "rear-1": (0.0174, 0.0642, 32.2),
    "rear-2": (-0.0064, 0.0702, 31.7),
    "rear-3": (0.0178, 0.0646, 32.1),
}


@pytest.mark.parametrize("name", PRINTED)
def test_spin_reproduces_the_published_tables(name):
    epsilon, u, u_F = PRINTED[name]
    measured = mffit.spin(SAMPLES / name / "tyre.toml")
    assert measured.epsilon_gamma.value == pytest.approx(epsilon, abs=0.0005)
    assert measured.epsilon_gamma.u == pytest.approx(u, abs=0.0003)
    assert measured.F_phit.u == pytest.approx(u_F, abs=0.1)
    assert measured.published.epsilon_gamma == pytest.approx(measured.epsilon_gamma, abs=1e-6)
    assert measured.published.F_phit.u == pytest.approx(u_F, abs=0.1)

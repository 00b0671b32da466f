"""The page lists the published tyres with their printed numbers."""

from __future__ import annotations

import pytest

from mffit.suspicion.unpublished import TYRES

# Mottola and Massaro, Machines 2022, 10, 921, Table 1: turn-slip force [N] and its uncertainty.
TABLE_1 = ((385.7, 31.4), (373.5, 31.6), (340.6, 31.2), (493.7, 32.2), (454.8, 31.7), (488.5, 32.1))


@pytest.mark.parametrize(("tyre", "force"), list(zip(TYRES, TABLE_1, strict=True)), ids=lambda x: str(x[0]))
def test_uncertainty_follows_from_the_turn_slip_force(tyre, force):
    # u(eps) = (1 - eps) u(F)/F to the rounding of the printed forces: the other sources are negligible.
    assert tyre.u == pytest.approx((1.0 - tyre.epsilon_gamma) * force[1] / force[0], abs=3e-4)

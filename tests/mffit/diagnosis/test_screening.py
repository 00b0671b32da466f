"""Blunders are told from structure, and uncertainties that were stated too small are noticed."""

from __future__ import annotations

import numpy as np
import pytest
from blind_scores import loaded
from blind_set import draw_case

from mffit.diagnosis.screening import outliers, understated
from mffit.rig import RigFaults


def residual_of(case, points):
    simulated = Simulation(dict(case.given.values), RigFaults(), True, False).predict(points)
    return np.concatenate([points.Fy, points.Mz]) - simulated


def test_single_blunders_are_found_and_nothing_else(right_model):
    case, _, points = right_model
    residual = residual_of(case, points)
    assert not outliers(points, residual).any()
    where = np.array([7, 150, 300, 390 + 200])  # inside their sweeps; the last in Mz
    residual[where[:3]] += 120.0
    residual[where[3]] -= 12.0
    assert np.flatnonzero(outliers(points, residual)).tolist() == where.tolist()


@pytest.mark.parametrize("shape", ["sideslip-bump", "one-load-bump", "moment-bump", "camber-bump"])
def test_local_structure_is_no_blunder(shape, tmp_path):
    case = draw_case("bump", (), "large", 17, structure=shape)
    _, points = loaded(case, tmp_path)
    assert outliers(points, residual_of(case, points)).sum() <= 1


def test_a_missing_effect_is_no_blunder(stiffer_camber):
    case, _, points = stiffer_camber
    assert not outliers(points, residual_of(case, points)).any()


@pytest.mark.parametrize("factor", [1.0, 0.5])
def test_scatter_tells_what_the_uncertainty_should_be(right_model, factor):
    case, _, points = right_model
    points = points.replace(u_Fy=points.u_Fy * factor, u_Mz=points.u_Mz * factor)
    ratios = understated(points, residual_of(case, points))
    assert ratios == pytest.approx((1.0 / factor, 1.0 / factor), rel=0.15)

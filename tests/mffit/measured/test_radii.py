"""Path radius (19) and effective radius (18) by hand, with the doubt that each length brings."""

from __future__ import annotations

import math

import numpy as np
import pytest
from plain_tyre import settings

import tir
from mffit import config
from mffit.measured.radii import (
    effective_radius_at,
    measured_effective_radius,
    measured_path_radius,
    radius_readings,
)

PATH = {"shaft_diameter": 0.080, "L_B": 1.140, "L_C": 0.083, "L_D": 0.203}
TURN = {"load_N": 1500.0, "revolutions": 4, "angle_start_deg": 10.0, "angle_end_deg": 100.0}
TURNED = 8.0 * math.pi + math.pi / 2.0


def rig(**changes):
    content = {
        "tyre": {"name": "t", "unloaded_radius": 0.325, "nominal_load": 1500.0, "nominal_pressure": 250.0},
        "rig": {"path": PATH, "u_length": 0.002},
        "rolling_radius": [TURN | {"u_angle_deg": 0.5, "u_arc_m": 0.003}],
        "sweep": [{"file": "a.csv"}],
    }
    return config.load(content | changes)


def test_four_tape_measures():
    """R = 0.04 + 1.14 + 0.143; u_R = u sqrt(1/4 + 1 + 1/4 + 1/4)."""
    R = measured_path_radius(rig())
    assert R.nominal_value == pytest.approx(1.323)
    assert R.std_dev == pytest.approx(0.002 * math.sqrt(1.75))
    stated = measured_path_radius(rig(rig={"path": PATH, "u_path_radius": 0.005}))
    assert stated.std_dev == pytest.approx(0.005)
    assert measured_path_radius(settings(type="flat-track", path_radius=None, u_path_radius=None)) is None


def test_a_declared_radius_is_as_sure_as_the_paper_says():
    assert measured_path_radius(rig(rig={"path_radius": 1.323})).std_dev == pytest.approx(0.0018)


def test_a_revolution_of_the_disc():
    """r_e = 2 pi R / turn; notches and angles are read twice each."""
    settings = rig()
    R = measured_path_radius(settings)
    (r_e,) = measured_effective_radius(settings, R).values()
    assert r_e.nominal_value == pytest.approx(2.0 * math.pi * 1.323 / TURNED)
    parts = (
        2.0 * math.pi * R.std_dev / TURNED,
        math.sqrt(2.0) * 0.003 / TURNED,
        r_e.nominal_value * math.sqrt(2.0) * math.radians(0.5) / TURNED,
    )
    assert r_e.std_dev == pytest.approx(math.hypot(*parts), rel=1e-6)


def test_as_a_reading_it_follows_the_path_and_keeps_its_own_doubt():
    (reading,) = radius_readings(rig())
    r_e = 2.0 * math.pi * 1.323 / TURNED
    assert reading.load == 1500.0
    assert reading.value == pytest.approx(r_e)
    assert reading.follows_path
    own = math.hypot(math.sqrt(2.0) * 0.003 / TURNED, r_e * math.sqrt(2.0) * math.radians(0.5) / TURNED)
    assert reading.u == pytest.approx(own, rel=1e-6)


def test_a_given_radius_does_not_follow_the_path():
    given = [{"effective_radius": 0.31, "u_effective_radius": 0.0007}]
    (reading,) = radius_readings(rig(rolling_radius=given))
    assert reading == (1500.0, 0.31, pytest.approx(0.0007), False)
    (exact,) = radius_readings(rig(rolling_radius=[{"effective_radius": 0.31, "u_effective_radius": 0.0}]))
    assert 0.0 < exact.u <= 1e-4


def test_between_loads_the_nearest_is_moved_along_the_base_files_shape():
    measured = measured_effective_radius(
        rig(rolling_radius=[
            {"load_N": load, "effective_radius": r, "u_effective_radius": 0.0005}
            for load, r in ((1000.0, 0.312), (2000.0, 0.308))
        ]), None,
    )  # fmt: skip
    assert effective_radius_at(1010.0, measured, None) is measured[1000.0]
    assert effective_radius_at(1300.0, measured, None) is measured[1000.0]
    assert effective_radius_at(1500.0, measured, None) is measured[2000.0]  # nearer by ratio
    assert effective_radius_at(1500.0, {}, None) is None
    base = tir.read("samples/front-120-70/true.tir")
    moved = effective_radius_at(1300.0, measured, base)
    shape = base.state(np.array([1000.0, 1300.0])).Re
    assert moved.nominal_value == pytest.approx(0.312 * shape[1] / shape[0])
    assert moved.nominal_value != 0.312
    assert effective_radius_at(1000.0, measured, base).nominal_value == pytest.approx(0.312)

"""The rig's axes and frame."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.virtual_rig.machine import Channels
from mffit.virtual_rig.tables import in_wheel_carrier


def test_the_wheel_carrier_sees_load_as_side_force_at_camber():
    gamma = np.radians([50.0])
    zero = np.zeros(1)
    out = in_wheel_carrier(Channels(zero, np.array([1000.0]), zero, zero, zero), gamma)
    assert out.Fy[0] == pytest.approx(1000.0 * np.sin(gamma[0]))
    assert out.Fz[0] == pytest.approx(1000.0 * np.cos(gamma[0]))


def test_turning_the_frame_keeps_force_and_moment():
    rng = np.random.default_rng(2)
    forces = Channels(*rng.normal(size=(5, 20)))
    out = in_wheel_carrier(forces, rng.uniform(-0.9, 0.9, 20))
    np.testing.assert_allclose(np.hypot(out.Fy, out.Fz), np.hypot(forces.Fy, forces.Fz))
    np.testing.assert_allclose(np.hypot(out.My, out.Mz), np.hypot(forces.My, forces.Mz))


@pytest.mark.parametrize(
    ("axes", "reversed_"),
    [("iso", set()), ("adapted-sae", {"Fy_N", "Mz_Nm"}), ("sae", {"alpha_deg", "Fz_N", "Fy_N", "Mz_Nm"})],
)
def test_axes_reverse_these_columns_and_no_others(run, content, axes, reversed_):
    iso = run().tables["sideslip.csv"]
    other = run(rig=content["rig"] | {"axes": axes}).tables["sideslip.csv"]
    for column in iso:
        sign = -1.0 if column in reversed_ else 1.0
        np.testing.assert_allclose(other[column], sign * iso[column])


def test_a_centre_to_the_right_pushes_to_the_left(run, content):
    Fy = run(rig=content["rig"] | {"path_centre": "right"}).tables["forward.csv"]["Fy_N"]
    assert Fy[1] > 300.0

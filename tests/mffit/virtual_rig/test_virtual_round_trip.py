"""What the virtual rig writes, the readers of `mffit build` give back in ISO-W."""

from __future__ import annotations

import numpy as np
import pytest

from mffit import config, points
from mffit.virtual_rig import load_plan, simulate


@pytest.fixture
def read_back(content, folder, tmp_path):
    def points_of(continuous: bool = False, **changes) -> points.Points:
        simulate(load_plan(content | changes, folder=folder), tmp_path / "out")
        return points.read(config.load(tmp_path / "out" / "tyre.toml"), continuous=continuous).points

    return points_of


@pytest.mark.parametrize("frame", ["W", "C"])
@pytest.mark.parametrize("axes", ["iso", "sae", "adapted-sae"])
def test_axes_and_frame_make_no_difference(read_back, content, axes, frame):
    expected = read_back()
    found = read_back(rig=content["rig"] | {"axes": axes, "force_frame": frame})
    for channel in ("alpha", "gamma", "direction", "phi_t"):
        np.testing.assert_allclose(getattr(found, channel), getattr(expected, channel), atol=1e-12)
    # Forces are written to 0.01 N, moments to 0.001 Nm, loads to 0.1 N.
    np.testing.assert_allclose(found.Fy, expected.Fy, atol=0.1)
    np.testing.assert_allclose(found.Fz, expected.Fz, atol=0.1)
    np.testing.assert_allclose(found.Mz, expected.Mz, atol=0.002)


def test_a_recorded_sweep_is_reduced_to_its_points(read_back, content):
    sweep, *others = content["sweep"]
    expected = read_back()
    recording = {"noise_Fy_N": 25, "noise_Mz_Nm": 2.5, "ripple_Fy_N": 12, "hold_s": 30}
    found = read_back(sweep=[sweep | {"recording": recording}, *others])
    first = expected.sweep == 0
    n = int(first.sum())
    np.testing.assert_allclose(found.alpha[:n], expected.alpha[first], atol=1e-4)
    # A mean over 30 s less the transient, with a memory of 0.8 s, scatters by 6 N and 0.6 Nm; an error
    # estimated from one such stretch by a third of itself.
    assert np.sqrt(np.mean((found.Fy[:n] - expected.Fy[first]) ** 2)) < 10.0
    assert np.sqrt(np.mean((found.Mz[:n] - expected.Mz[first]) ** 2)) < 1.0
    assert 3.0 < np.median(found.u_Fy[:n]) < 9.0
    assert 0.3 < np.median(found.u_Mz[:n]) < 0.9


def test_a_sweep_that_never_rests_is_marked_continuous(read_back, content):
    sweep, *others = content["sweep"]
    moving = sweep | {"recording": {"hold_s": 0, "steering_deg_per_s": 2}}
    found = read_back(continuous=True, sweep=[moving, *others])
    # 12 deg at 2 deg/s, averaged over tenths of a second
    assert found.continuous.sum() == pytest.approx(60, abs=3)
    assert not found.continuous[found.sweep != 0].any()

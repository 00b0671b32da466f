"""Frame C to frame W, against unit vectors of a leaning wheel and the rigid body they belong to."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mffit import config
from mffit.sweeps.assembly import sweeps_of
from mffit.sweeps.columns import Columns
from mffit.sweeps.frames import forces_turned, moments_turned, to_contact_point
from mffit.sweeps.raw_table import RawTable
from mffit.sweeps.sweep import Sweep


def sweep(gamma_deg: float, Fy: float, Fz: float, Mz: float, My: float | None) -> Sweep:
    """One row in ISO signs."""
    values = {"alpha_deg": 0.0, "gamma_deg": gamma_deg, "Fz_N": Fz, "Fy_N": Fy, "Mz_Nm": Mz}
    values |= {} if My is None else {"My_Nm": My}
    table = pd.DataFrame([values])
    cells = tuple((str(value),) for value in table.iloc[0])
    raw = RawTable(tuple(table), ("",) * len(cells), cells, (2,), None, 1)
    tyre = {"name": "a", "unloaded_radius": 0.3, "nominal_load": 1500.0, "nominal_pressure": 250.0}
    settings = config.load({"tyre": tyre, "rig": {"type": "flat-track"}, "sweep": [{"file": "a.csv"}]})
    return sweeps_of(Columns(raw, table, None, ()), settings, settings.sweep[0])[0]


def axes_of_the_wheel(gamma: float) -> tuple[np.ndarray, np.ndarray]:
    """y and z axis of frame C in frame W: with gamma > 0 the top of the wheel goes to -y."""
    turn = np.array([[1, 0, 0], [0, np.cos(gamma), -np.sin(gamma)], [0, np.sin(gamma), np.cos(gamma)]])
    return turn @ [0, 1, 0], turn @ [0, 0, 1]


def test_the_top_of_the_wheel_leans_to_minus_y():
    _, top = axes_of_the_wheel(np.radians(20.0))
    assert top[1] < 0.0 < top[2]


angles = st.floats(-60.0, 60.0)
forces = st.floats(-4000.0, 4000.0)


@given(gamma=angles, Fy=forces, Fz=st.floats(3000.0, 9000.0), Mz=st.floats(-99, 99), My=st.floats(-99, 99))
def test_forces_and_moments_in_c_come_back_in_w(gamma, Fy, Fz, Mz, My):
    y, z = axes_of_the_wheel(np.radians(gamma))
    force, torque = np.array([0.0, Fy, Fz]), np.array([0.0, My, Mz])
    if force @ z < 1.0:  # pulled off the wheel: not a load that a file may hold
        return
    carried = sweep(gamma, force @ y, force @ z, torque @ z, torque @ y)
    found = moments_turned(forces_turned(carried, load_is_vertical=False))
    np.testing.assert_allclose(
        [found.Fy[0], found.Fz[0], found.My[0], found.Mz[0]], [Fy, Fz, My, Mz], atol=1e-8
    )
    vertical = moments_turned(
        forces_turned(sweep(gamma, force @ y, Fz, torque @ z, torque @ y), load_is_vertical=True)
    )
    np.testing.assert_allclose([vertical.Fy[0], vertical.Fz[0]], [Fy, Fz], atol=1e-7)


def test_at_fifty_degrees_the_frames_differ_by_the_load_times_the_sine():
    """A wheel without side force: the carrier's cell reads Fz sin(gamma)."""
    y, z = axes_of_the_wheel(np.radians(50.0))
    load = np.array([0.0, 0.0, 1500.0])
    assert load @ y == pytest.approx(1500.0 * np.sin(np.radians(50.0)))
    found = moments_turned(forces_turned(sweep(50.0, load @ y, load @ z, 0.0, None), load_is_vertical=False))
    assert found.Fy[0] == pytest.approx(0.0, abs=1e-9)
    assert found.Fz[0] == pytest.approx(1500.0)


def test_the_lever_to_the_wheel_centre_leaves_the_aligning_moment_alone():
    """Force at the contact point, moment about the wheel's centre 0.3 m up the leaning wheel."""
    _, z = axes_of_the_wheel(np.radians(40.0))
    force = np.array([50.0, -900.0, 1500.0])
    about_centre = np.cross(-0.3 * z, force)
    assert about_centre @ z == pytest.approx(0.0, abs=1e-9)


@given(
    gamma=angles,
    force=st.tuples(forces, forces, st.floats(100.0, 9000.0)),
    moment=st.tuples(forces, forces, forces),
)
def test_moments_about_the_wheel_centre_are_those_of_a_rigid_body_about_the_contact_point(
    gamma, force, moment
):
    _, top = axes_of_the_wheel(np.radians(gamma))
    radius = 0.31
    at_centre = np.array(moment) - np.cross(radius * top, force)
    reported = sweep(gamma, force[1], force[2], at_centre[2], at_centre[1])
    reported = replace(reported, Mx=at_centre[:1], Fx=np.array(force[:1]), RL=np.array([radius]))
    found = to_contact_point(reported, unloaded_radius=9.9)
    np.testing.assert_allclose([found.Mx[0], found.My[0], found.Mz[0]], moment, atol=1e-8)


def test_without_a_loaded_radius_the_lever_is_the_unloaded_one_and_without_fx_the_wheel_rolls_freely():
    reported = replace(sweep(0.0, 1000.0, 3000.0, 20.0, -4.0), Mx=np.array([310.0]))
    found = to_contact_point(reported, unloaded_radius=0.3)
    assert (found.Mx[0], found.My[0], found.Mz[0]) == pytest.approx((10.0, -4.0, 20.0))

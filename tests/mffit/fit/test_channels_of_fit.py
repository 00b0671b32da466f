"""Which channels a fit uses, their zeros, and what driven points and unfitted channels do to it: nothing."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from small_rigs import truth

from mffit.errors import InputError
from mffit.fit.coverage import coverage
from mffit.fit.plan import channels_of, fitted_channels
from mffit.fit.polish import _require_enough_points
from mffit.fit.problem import FitProblem, fit_problem
from mffit.fit.rig.rig_numbers import rig_numbers
from mffit.points import make_points
from mffit.rig import Simulation

RIG = SimpleNamespace(
    on_disc=False, radius=None, backlash_deg=0.0, u=lambda name: {"Mx0_Nm": 50.0, "F0_N": 10.0}.get(name, 0.0)
)
CONFIG = SimpleNamespace(rig=RIG, tyre=SimpleNamespace(nominal_load=1500.0), rolling_radius=())
MEASURED = SimpleNamespace(misaligned=False, alpha_M=None, per_load=(), C_alpha=None, setup_scatter=None, camber_skew=None,
    misaligned_setups={}, lag=None)  # fmt: skip


@pytest.fixture
def points():
    alpha = np.tile(np.linspace(-0.1, 0.1, 15), 3)
    free = make_points(alpha, 0.0, np.repeat([900.0, 1500.0, 2100.0], 15), p=250e3, V=10.0, phi_t=0.0)
    read = Simulation.of(truth(), turn_slip=False).readings(free, ("Fy", "Mx", "Mz"))
    return free.replace(**read)


def test_a_channel_for_which_nothing_is_free_is_left_alone(points):
    braked = points.replace(My=-3.0, Fx=-20.0)
    assert {"Fx", "My"} <= set(braked.measured)
    assert channels_of(braked) == ("Fy", "Mx", "Mz")


def test_a_stage_of_a_channel_brings_it_into_the_fit_if_it_was_measured(points):
    cover = coverage(points, "left")
    assert fitted_channels(cover, points) == ("Fy", "Mx", "Mz")
    assert fitted_channels(cover, points.replace(Mx=np.nan)) == ("Fy", "Mz")


def test_the_zero_of_a_fitted_channel_is_free_on_a_flat_track_and_for_every_set_up():
    sideways = {n.name for n in rig_numbers(CONFIG, MEASURED)}
    assert {"F0_N", "M0_Nm"} <= sideways
    (number,) = (n for n in rig_numbers(CONFIG, MEASURED, (), ("Fy", "Mx", "Mz")) if n.name not in sideways)
    assert (number.name, number.start, number.spread) == ("Mx0_Nm", 0.0, 50.0)
    several = {n.name for n in rig_numbers(CONFIG, MEASURED, ("A", "B"), ("Fy", "Mx", "Mz"))}
    assert {"Mx0_Nm@A", "Mx0_Nm@B", "F0_N@A"} <= several
    assert not any(name.startswith(("Fx0", "My0")) for name in several)


def test_driven_points_have_no_weight_where_nothing_of_slip_is_fitted(points):
    driven = points.replace(kappa=np.where(np.arange(len(points)) < 5, 0.1, 0.0), Fx=100.0)
    values = dict(truth().values)
    sigma = fit_problem(CONFIG, driven, MEASURED, values).sigma
    assert np.all(np.isinf(sigma["Fy"][:5]))
    assert np.all(np.isfinite(sigma["Fy"][5:]))
    # Readings without weight do not decide what the weight of the others is.
    wild = driven.replace(Fy=np.where(driven.free_rolling, driven.Fy, 1e5))
    assert fit_problem(CONFIG, wild, MEASURED, values).sigma["Fy"][5:] == pytest.approx(sigma["Fy"][5:])
    assert np.all(np.isfinite(fit_problem(CONFIG, driven, MEASURED, values, ("Fx", "Fy", "Mz")).sigma["Fy"]))


def test_an_offset_of_mx_is_found_beside_its_coefficients(points):
    true = Simulation.of(truth().replace(QSX2=0.3, QSX3=0.06), turn_slip=False).with_numbers(
        {"Mx0_Nm": -67.0}
    )
    seen = points.replace(gamma=np.tile([-0.3, 0.0, 0.3], 15))
    seen = seen.replace(Mx=true.readings(seen, ("Mx",)).Mx)
    problem = FitProblem(
        seen, true.with_numbers({"Mx0_Nm": 0.0, "QSX2": 0.0, "QSX3": 0.0}), {"Mx": np.ones(len(seen))}
    )
    names = ["QSX2", "QSX3", "Mx0_Nm"]
    linear = problem.free(names).linear(np.zeros(3))
    step = np.linalg.lstsq(linear.slope, -linear.data, rcond=None)[0]
    assert step == pytest.approx([0.3, 0.06, -67.0], rel=1e-6)


def test_too_few_points_of_a_channel_are_named_with_its_column(points):
    with pytest.raises(InputError, match="45 points of Mx_Nm cannot determine the 46 coefficients"):
        _require_enough_points(points, ["QSX1"] * 46)
    assert _require_enough_points(points, ["QSX1"] * 44) is None

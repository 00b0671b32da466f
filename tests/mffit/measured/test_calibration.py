"""Does the budget state what a wrong calibration does to each result? The readings of a plain tyre are spoilt by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from plain_tyre import Plain, R, settings

from mffit.measured import measure
from mffit.parts import split
from mffit.points import Points

LOADS = (1000.0, 1500.0, 2000.0)
SIZE, GIVE, CROWN, TILT = 0.01, 1e-3, 0.05, 0.2  # relative; deg/Nm; m; deg/kN
RESULTS = ("C_alpha", "C_gamma", "F_phit", "C_phit", "epsilon_gamma", "r_e", "R")


class Bent(Plain):
    """A tyre whose cornering force grows with the root of the load."""

    def readings(self, alpha, gamma, Fz, direction):
        soft = replace(Plain(), cornering=12.0 * np.sqrt(1500.0 / np.asarray(Fz)))
        return soft.readings(alpha, gamma, Fz, direction)


def with_load(points: Points) -> Points:
    Fy, Mz = Bent().readings(points.alpha, points.gamma, (1.0 + SIZE) * points.Fz, points.direction)
    return points.replace(Fy=Fy, Mz=Mz)


def yielding(points: Points) -> Points:
    alpha = points.alpha
    for _ in range(30):
        Fy, Mz = Bent().readings(alpha, points.gamma, points.Fz, points.direction)
        alpha = points.alpha + math.radians(GIVE) * Mz
    return points.replace(Fy=Fy, Mz=Mz)


def crowned(points: Points) -> Points:
    """The force of turn slip is proportional to the curvature of the path, on whose radius the contact moves."""
    plain, away = Plain(), CROWN * np.sin(points.gamma) * Plain().side
    return points.replace(Fy=points.Fy + plain.turn_slip_force(points.Fz) * (R / (R - away) - 1.0))


def tilted(points: Points) -> Points:
    """The wheel leans against the disc by what the load bends it, outwards."""
    lean = points.gamma + np.sign(points.phi_t) * np.radians(TILT * points.Fz / 1000.0)
    Fy, Mz = Bent().readings(points.alpha, lean, points.Fz, points.direction)
    return points.replace(Fy=Fy, Mz=Mz)


SPOILT = {
    "calibration of Fy": ("u_Fy_gain", SIZE, lambda points: points.replace(Fy=(1.0 + SIZE) * points.Fy)),
    "calibration of alpha": (
        "u_alpha_gain", SIZE, lambda points: points.replace(alpha=points.alpha / (1.0 + SIZE)),
    ),
    "calibration of gamma": (
        "u_gamma_gain", SIZE, lambda points: points.replace(gamma=points.gamma / (1.0 + SIZE)),
    ),
    "calibration of Fz": ("u_Fz_gain", SIZE, with_load),
    "steering compliance": ("u_steering_compliance_deg_per_Nm", GIVE, yielding),
    "crosstalk that grows with camber": (
        "u_crosstalk_camber",
        SIZE,
        lambda points: points.replace(Fy=points.Fy + SIZE * np.sin(points.gamma) * points.Fz),
    ),
    "path radius that changes with camber": ("u_crown_m", CROWN, crowned),
    "tilt of the disc": ("u_disc_tilt_deg_per_kN", TILT, tilted),
}  # fmt: skip


def rows_of(measured, name):
    """The budget of a result."""
    return measured.budget if name == "epsilon_gamma" else measured.nominal.budgets[name]


@pytest.mark.parametrize("source", SPOILT)
def test_the_budget_states_what_an_error_of_calibration_does(source):
    key, size, spoil = SPOILT[source]
    points = Bent().campaign(LOADS)
    given = {name: 0.0 for name, _, _ in SPOILT.values()}
    config = settings(**given | {key: size})
    right, wrong = (measure(config, each, split(each)) for each in (points, spoil(points)))
    for name in RESULTS:
        moved = abs(getattr(wrong.nominal, name).value - getattr(right.nominal, name).value)
        said = sum(row.contribution for row in rows_of(right, name) if row.source == source)
        assert said == pytest.approx(moved, rel=0.1, abs=1.5e-3 * abs(getattr(right.nominal, name).value))


def test_the_calibration_of_the_force_cancels_in_the_factor_and_that_of_the_load_does():
    """(17) divides two stiffnesses of one channel at one load."""
    points = Bent().campaign(LOADS)
    result = measure(settings(u_Fy_gain=0.02, u_Fz_gain=0.02), points, split(points))
    sources = {row.source for row in result.budget}
    assert sources.isdisjoint({"calibration of Fy", "calibration of Fz"})
    assert "calibration of gamma" in sources
    assert result.C_gamma.u > 0.02 * abs(result.C_gamma.value)


def test_the_rows_of_every_budget_add_up_to_its_uncertainty():
    points = Bent().campaign(LOADS)
    result = measure(settings(u_steering_compliance_deg_per_Nm=0.004), points, split(points))
    assert result.nominal.budgets.keys() == set(RESULTS) - {"epsilon_gamma"}
    for name in RESULTS:
        rows = rows_of(result, name)
        assert math.hypot(*(row.contribution for row in rows)) == pytest.approx(
            getattr(result.nominal, name).u
        )


def test_a_table_states_distribution_and_degrees_of_freedom_of_a_source():
    """Half a width of 30 N is 17.3 N; alone with 4 degrees of freedom it gives k = 2.78 (JCGM 100, table G.2)."""
    points = Bent().campaign(LOADS)
    zero = {"value": 30.0, "dof": 4, "distribution": "rectangular"}
    result = measure(settings(u_loadcell_offset_N=zero), points, split(points))
    row = result.budget[0]
    assert (row.source, row.distribution, row.dof) == ("load-cell offset", "rectangular", 4.0)
    assert row.u == pytest.approx(30.0 / math.sqrt(3.0))
    assert result.nominal.expanded.k == pytest.approx(2.78, abs=0.3)


def test_what_a_steering_that_yields_would_do_is_said_unless_its_compliance_is_declared():
    points = Bent().campaign(LOADS)
    silent = measure(settings(u_steering_compliance_deg_per_Nm=0.001), points, split(points))
    (said,) = set(measure(settings(), points, split(points)).notes) - set(silent.notes)
    assert "rigid steering" in said

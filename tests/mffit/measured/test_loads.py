"""eps_gamma over load: the slope by hand, when it is worth writing, and the covariance between loads."""

from __future__ import annotations

import math

import numpy as np
import pytest
from uncertainties import UFloat, covariance_matrix, ufloat

from mffit.measured.camber_reduction import camber_reduction
from mffit.measured.epsilon import load_dependence
from mffit.measured.uncertain import covariance

LOADS = (1000.0, 1500.0, 2000.0)


def law(values, us=(0.01, 0.01, 0.01), loads=LOADS, nominal=1, Fz0=1500.0):
    return load_dependence(loads, [ufloat(v, u) for v, u in zip(values, us, strict=True)], nominal, Fz0)


def test_a_slope_beyond_twice_its_uncertainty_is_written():
    """eps = -0.2 (1 + 0.9 dfz), every value known alone: the slope of two points at dfz = -1/3 and +1/3."""
    found = law((-0.14, -0.2, -0.26))
    assert found.pecp2 == pytest.approx(0.9)
    # Both differences share the value at the nominal load: u(slope) = 0.01 sqrt(2) / (2/3).
    assert found.u_pecp2 == pytest.approx(0.01 * np.sqrt(2.0) * 1.5 / 0.2, rel=1e-6)
    assert "PECP2 = 0.900 +- 0.106" in found.note


@pytest.mark.parametrize("slope", [0.9, -0.9])
@pytest.mark.parametrize(("factor", "written"), [(0.95, False), (1.05, True)])
def test_the_border_is_twice_the_uncertainty(slope, factor, written):
    u = 0.5 * abs(-0.2 * slope) / (1.5 * np.sqrt(2.0)) / factor
    found = law(np.array([-0.2, -0.2, -0.2]) * (1.0 + slope * np.array([-1.0, 0.0, 1.0]) / 3.0), (u, u, u))
    assert found.pecp2 == pytest.approx(slope if written else 0.0)
    assert ("is within 2 u" in found.note) is not written
    assert found.u_pecp2 == pytest.approx(0.5 * abs(slope) / factor, rel=1e-6)


def test_an_error_common_to_all_loads_does_not_hide_the_slope():
    common = ufloat(0.0, 0.5)
    epsilon = [ufloat(v, 0.005) + common for v in (-2.5, -3.0, -3.5)]
    found = load_dependence(LOADS, epsilon, 1, 1500.0)
    assert found.pecp2 == pytest.approx(0.5)
    assert found.u_pecp2 == pytest.approx(0.005 * np.sqrt(2.0) * 1.5 / 3.0, rel=1e-3)


def test_a_value_within_twice_its_uncertainty_of_zero_has_no_relative_slope():
    common = ufloat(0.0, 0.5)
    found = load_dependence(LOADS, [ufloat(v, 0.001) + common for v in (-0.7, -0.9, -1.1)], 1, 1500.0)
    assert found.pecp2 == 0.0
    assert "eps_gamma itself is within 2 u of zero" in found.note
    further = load_dependence(LOADS, [ufloat(v, 0.001) + common for v in (-0.9, -1.1, -1.3)], 1, 1500.0)
    assert further.pecp2 == pytest.approx(0.6 / 1.1)


def test_a_factor_that_would_reach_nine_tenths_is_not_extrapolated():
    assert law((0.5, 0.7, 0.91)).pecp2 == 0.0
    assert "would reach 0.9" in law((0.5, 0.7, 0.91)).note
    assert law((0.5, 0.7, 0.87)).pecp2 == pytest.approx(3.0 * 0.185 / 0.7)


def test_loads_count_from_the_measured_one_next_to_the_nominal():
    """The law holds the value at the measured load, which need not be FNOMIN itself."""
    found = law((-0.1, -0.2), (0.001, 0.001), (1000.0, 1400.0), nominal=1, Fz0=1500.0)
    assert found.pecp2 == pytest.approx(-0.1 / (400.0 / 1500.0) / -0.2)


def test_one_load_has_no_slope():
    found = law((-0.1,), (0.01,), (1500.0,), nominal=0)
    assert found[:2] == (0.0, None)
    assert "one load was measured" in found.note


def with_common_sources() -> list[UFloat]:
    """Three numbers that share some of seven sources."""
    sources = [ufloat(1.0 + 0.1 * k, 0.07 / (1 + k)) for k in range(7)]
    return [
        sources[0] * sources[1] / sources[2] + sources[3],
        sources[2] ** 2 * sources[4] - sources[5],
        sources[0] / sources[5] + sources[6] * sources[1],
    ]


def test_it_is_the_covariance_of_common_sources():
    numbers = with_common_sources()
    np.testing.assert_allclose(covariance(numbers), covariance_matrix(numbers), rtol=1e-12)


def test_it_does_not_depend_on_where_the_sources_lie_in_memory():
    kept, found = [], set()
    for k in range(40):
        kept.append([object() for _ in range(17 * k % 23)])
        found.add(covariance(with_common_sources()).tobytes())
    assert len(found) == 1


def test_the_first_order_is_that_of_random_draws():
    """A front tyre of the paper; half the distance of the quantiles at 15.87 and 84.13 %, as a ratio has heavy tails."""
    rng, n = np.random.default_rng(1), 20_000
    F = -390.0 + np.hypot(31.0, 3.0) * rng.standard_normal(n)
    C_gamma, r_e, R = (
        x + u * rng.standard_normal(n) for x, u in ((-1850.0, 40.0), (0.29, 5e-4), (1.32, 2e-3))
    )
    low, high = np.quantile(1.0 + r_e * C_gamma / (-F * R), [0.1587, 0.8413])
    radius = ufloat(1.32, 2e-3)
    force = ufloat(-390.0, math.hypot(31.0, 3.0))
    epsilon = camber_reduction(-force * radius, ufloat(-1850.0, 40.0), ufloat(0.29, 5e-4))
    assert epsilon.std_dev == pytest.approx((high - low) / 2.0, rel=0.05)

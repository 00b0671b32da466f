"""Where bands are narrow and what widens them, against finite differences of the tyre's own call."""

from __future__ import annotations

import numpy as np
import pytest
import small_rigs

from mffit.fit.bands import BandBesideSweeps, Bands, bands
from mffit.fit.wording import bands_sentence, beside_sentence
from mffit.linearised.combined import Combinations
from mffit.linearised.components import Components
from mffit.linearised.smooth import CONSTANT
from mffit.points import make_points
from mffit.prediction.predictor import MissedChannel, Predictor
from mffit.rig import Simulation
from tests.mffit.fit import combined_programme as belt

U = {"PKY1": 0.1, "PPY2": 0.7}


def known(names, root):
    """What is known of a tyre of the formula without noise: the covariance of its coefficients is root times its transpose."""
    root = np.vstack([np.zeros((1, root.shape[1])), root])
    nothing = Components(0.0, (), 0.0, 0.0, 0.0, 0.3, 0.0)
    tested = Combinations((), np.ones(()), np.zeros(()))
    own = MissedChannel(CONSTANT, nothing, np.zeros(1), root, 0.0, 0.0, np.zeros(0), tested, False)
    return Predictor(0.0, names, {"Fx": own, "Fy": own}, {}, {}, (16.0, 16.0))


def found(pressures, known_to=U, **changes):
    """The bands of the front tyre if PKY1 and PPY2 are known to so much and sweeps were run at these pressures [kPa]."""
    tyre = small_rigs.truth().replace(**changes)
    p = 1e3 * np.array([*[250.0] * 20, *np.repeat(pressures, 10)])
    points = make_points(np.linspace(-0.1, 0.1, len(p)), 0.0, 1400.0, p=p, V=10.0, phi_t=0.0)
    return tyre, bands(
        known((*known_to,), np.diag([*known_to.values()])), {"PPY2"}, Simulation.of(tyre), points
    )


def by_differences(tyre, name, p):
    """1.96 U of a coefficient as a side force, rms over the tested sideslip angles [N]."""
    alpha, step = np.linspace(-0.1, 0.1, 9), 1e-4
    up, down = (
        tyre.replace(**{name: tyre[name] + s})(1400.0, alpha, phi_t=0.0, Vx=10.0, p=p).Fy
        for s in (step, -step)
    )
    return 1.96 * U[name] * np.sqrt(np.mean(((up - down) / (2.0 * step)) ** 2))


def test_at_the_pressure_of_the_sweeps_a_pressure_term_does_not_count():
    tyre, wide = found([200.0, 300.0])
    assert wide.main == pytest.approx(250e3)
    assert wide.half == pytest.approx(by_differences(tyre, "PKY1", 250e3), rel=0.01)


def test_elsewhere_it_counts_and_is_named_with_its_share():
    tyre, wide = found([200.0, 300.0])
    whole, own = (
        np.sqrt(np.mean([by_differences(tyre, name, p) ** 2 for p in (200e3, 300e3)]))
        for name in ("PKY1", "PPY2")
    )
    assert wide.others == (200e3, 300e3)
    assert wide.half_of_others == pytest.approx(np.hypot(whole, own), rel=0.01)
    assert wide.unseen == "PPY2"
    assert wide.share == pytest.approx(own**2 / (own**2 + whole**2), rel=0.01)
    said = bands_sentence(wide, U, tyre.values, "one load only")
    assert f"+-{wide.half_of_others:.0f} N at 200, 300 kPa" in said
    assert "PKY1" not in said


def test_the_smaller_part_of_a_band_is_not_blamed_for_it():
    """A tenth of the uncertainty of PPY2 leaves most of the band to PKY1."""
    _, usual = found([200.0, 300.0])
    _, wide = found([200.0, 300.0], known_to={**U, "PPY2": 0.1 * U["PPY2"]})
    parts = 0.01 * usual.share, 1.0 - usual.share
    assert wide.share == pytest.approx(parts[0] / sum(parts))
    assert 0.02 < wide.share < 0.5
    assert wide.unseen == ""


def test_a_nominal_pressure_that_was_not_run_is_one_of_the_others():
    tyre, wide = found([], NOMPRES=290e3)
    assert wide.others == (290e3,)
    wide = Bands(250e3, 20.0, (200e3, 290e3), 50.0, "PPY2", 0.9)
    assert "values at the nominal 290 kPa: PKY1 and PKY2 share" in bands_sentence(wide, U, tyre.values, "")


def test_one_pressure_needs_no_word():
    tyre, wide = found([])
    assert wide.others == ()
    assert not wide.wider
    assert bands_sentence(wide, U, tyre.values, "") == ""


def test_one_sideslip_with_slip_leaves_the_way_there_to_the_formula():
    """RCX1 with RBX1 such that the weight at 5 deg stays: nothing is unknown there, and the shape in between is."""
    tyre = belt.truth()
    reach = np.radians(5.0) * tyre["RBX1"]
    slope = -np.arctan(reach) * (1.0 + reach**2) / reach * tyre["RBX1"] / tyre["RCX1"]
    together = np.array([1.0, slope]) * 0.1
    of_shape = known(("RCX1", "RBX1"), together[:, None])
    simulation = Simulation.of(tyre.replace(REX1=0.0, REX2=0.0, RBX2=0.0), turn_slip=False)

    def combined(**programme):
        return bands(of_shape, (), simulation, belt.programme(**programme)).combined

    one = combined(sideslips=(0.0, 5.0))
    assert one.sideslip == pytest.approx(np.radians(5.0), rel=0.01)
    assert one.beside == pytest.approx(np.radians(2.5), rel=0.01)
    assert one.wider
    assert one.half_at < 0.1 * one.half_beside
    assert combined(sideslips=(-5.0, 0.0, 5.0)) is not None
    assert combined() is None
    assert combined(sideslips=(0.0,)) is None
    assert combined(driven=False) is None


def test_what_one_sideslip_leaves_open_is_said_with_both_bands():
    said = beside_sentence(BandBesideSweeps("Fx", np.radians(4.0), 9.0, np.radians(2.0), 61.0))
    assert "run at 4.0 deg only" in said
    assert "+-61 N at 2.0 deg" in said
    assert "+-9 N at 4.0 deg" in said
    assert beside_sentence(BandBesideSweeps("Fx", np.radians(4.0), 9.0, np.radians(2.0), 10.0)) == ""


def test_the_side_that_was_not_run_shares_what_friction_and_conicity_leave_open():
    """Friction and conicity that make up for each other far out on the tested side add up on the other one."""
    tyre = small_rigs.truth()
    points = make_points(
        np.linspace(0.0, 0.15, 16), 0.0, np.tile([900.0, 1400.0], 8), p=250e3, V=10.0, phi_t=0.0
    )
    far = {
        name: tyre.replace(**{name: tyre[name] + 1e-4})(1400.0, 0.15, phi_t=0.0, Vx=10.0, p=250e3).Fy
        for name in ("PVY1", "PDY1")
    }
    still = tyre(1400.0, 0.15, phi_t=0.0, Vx=10.0, p=250e3).Fy
    u = 0.045
    together = np.array([u, -u * (far["PVY1"] - still) / (far["PDY1"] - still)])
    of_sides = known(("PVY1", "PDY1"), together[:, None])
    simulation = Simulation.of(tyre, turn_slip=False)
    band = bands(of_sides, (), simulation, points).other_side
    assert band.half_at < 0.1 * band.half_beside
    assert band.half_beside == pytest.approx(
        2 * 1.96 * u * np.sqrt((900.0**2 + 1150.0**2 + 1400.0**2) / 3), rel=0.1
    )
    assert f"+-{band.half_beside:.0f} N at -8.6 deg" in beside_sentence(band)
    both = points.replace(alpha=np.linspace(-0.1, 0.1, 16))
    assert bands(of_sides, (), simulation, both).other_side is None

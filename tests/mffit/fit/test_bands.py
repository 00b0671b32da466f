"""Where bands are narrow and what widens them, against finite differences of the tyre's own call."""

from __future__ import annotations

import numpy as np
import pytest
import small_rigs

from mffit.fit.bands import BandsByPressure, bands_by_pressure
from mffit.fit.posterior import Posterior
from mffit.fit.wording import bands_sentence
from mffit.points import make_points
from mffit.rig import Simulation

U = {"PKY1": 0.1, "PPY2": 0.7}


def found(pressures, **changes):
    """The bands of the front tyre if PKY1 and PPY2 are known to ``U`` and sweeps were run at these pressures [kPa]."""
    tyre = small_rigs.truth().replace(**changes)
    p = 1e3 * np.array([*[250.0] * 20, *np.repeat(pressures, 10)])
    points = make_points(np.linspace(-0.1, 0.1, len(p)), 0.0, 1400.0, p=p, V=10.0, phi_t=0.0)
    posterior = Posterior((*U, "F0_N"), np.diag([*np.square(list(U.values())), 25.0]))
    return tyre, bands_by_pressure(posterior, {"PPY2"}, Simulation.of(tyre), points)


def by_differences(tyre, name, p):
    """1.96 U of a coefficient as a side force, rms over the tested sideslip angles [N]."""
    alpha, step = np.linspace(-0.1, 0.1, 9), 1e-4
    up, down = (
        tyre.replace(**{name: tyre[name] + s})(1400.0, alpha, phi_t=0.0, Vx=10.0, p=p).Fy
        for s in (step, -step)
    )
    return 1.96 * U[name] * np.sqrt(np.mean(((up - down) / (2.0 * step)) ** 2))


def test_at_the_pressure_of_the_sweeps_a_pressure_term_does_not_count():
    tyre, bands = found([200.0, 300.0])
    assert bands.main == pytest.approx(250e3)
    assert bands.half == pytest.approx(by_differences(tyre, "PKY1", 250e3), rel=0.01)


def test_elsewhere_it_counts_and_is_named_with_its_share():
    tyre, bands = found([200.0, 300.0])
    whole, own = (
        np.sqrt(np.mean([by_differences(tyre, name, p) ** 2 for p in (200e3, 300e3)]))
        for name in ("PKY1", "PPY2")
    )
    assert bands.others == (200e3, 300e3)
    assert bands.half_of_others == pytest.approx(np.hypot(whole, own), rel=0.01)
    assert bands.unseen == "PPY2"
    assert bands.share == pytest.approx(own**2 / (own**2 + whole**2), rel=0.01)
    said = bands_sentence(bands, U, tyre.values, "one load only")
    assert f"+-{bands.half_of_others:.0f} N at 200, 300 kPa" in said
    assert "PKY1" not in said


def test_a_nominal_pressure_that_was_not_run_is_one_of_the_others():
    tyre, bands = found([], NOMPRES=290e3)
    assert bands.others == (290e3,)
    wide = BandsByPressure(250e3, 20.0, (200e3, 290e3), 50.0, "PPY2", 0.9)
    assert "values at the nominal 290 kPa: PKY1 and PKY2 share" in bands_sentence(wide, U, tyre.values, "")


def test_one_pressure_needs_no_word():
    tyre, bands = found([])
    assert bands.others == ()
    assert not bands.wider
    assert bands_sentence(bands, U, tyre.values, "") == ""

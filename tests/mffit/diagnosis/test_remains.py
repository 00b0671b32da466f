"""What a fit leaves: the effect that explains it is named with its size, and noise alone is neither structure nor effect."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_rigs import LEAN, built, disc

from mffit.diagnosis import wording
from mffit.diagnosis.one_step import best_effect
from mffit.diagnosis.remainder import Remainder, left_out_sweeps, remainder
from mffit.diagnosis.structure import structure
from mffit.effects import CATALOG

DRAWS = 120


@pytest.fixture(scope="module")
def falling(tmp_path_factory):
    """A load that falls by 10 % sin^2 with camber, and a skew of the camber axis that a backward camber sweep shows."""
    content = disc(faults={"load_camber": -0.1})
    content["sweep"].append({"file": "back.csv", "load_N": 1400, "gamma_deg": LEAN, "direction": "backward"})
    return built(content, tmp_path_factory.mktemp("falling"))


@pytest.fixture(scope="module")
def left(falling) -> Remainder:
    return remainder(falling.fit.search)


@pytest.fixture(scope="module")
def drawn(left):
    """Remainders of sound readings: the same fit, residuals drawn from the covariance that it leaves, 1 - A A'."""
    rng = np.random.default_rng(8)
    q, s, _ = np.linalg.svd(left.axes, full_matrices=False)
    shrink = 1.0 - np.sqrt(np.maximum(1.0 - s**2, 0.0))
    used = np.append(left.used, np.ones(len(left.residual) - len(left.sigma), bool))

    def one() -> Remainder:
        y = rng.standard_normal(len(left.residual)) * used
        return replace(left, residual=y - q @ (shrink * (q.T @ y)))

    return [one() for _ in range(DRAWS)]


def test_the_effect_is_named_with_its_size_although_the_misfit_is_at_the_noise(falling):
    assert max(falling.trust.over_noise.values()) < 1.1
    found = falling.remains.effect
    assert found.best.effect.id == "load-camber"
    assert found.significant
    value, u = found.best.numbers["load_camber"]
    assert abs(value + 0.1) < 3.0 * u < 0.07
    assert falling.trusted
    assert any("load that changes with camber" in said for said in falling.warnings)


def test_residuals_of_sound_readings_show_no_effect(drawn):
    """The chance of any effect is uniform: 1 % of sound fits below 0.01, so 120 have 5 or more with a probability of 0.8 %."""
    chances = np.array([best_effect(one).chance for one in drawn])
    assert np.sum(chances < 0.01) <= 4
    assert 0.25 < np.mean(chances < 0.5) < 0.65  # Bonferroni is a little too careful


def test_residuals_of_sound_readings_are_random(drawn):
    chances = np.array([structure(one).chance for one in drawn])
    assert np.sum(chances < 0.01) <= 4
    assert 0.2 < np.mean(chances < 0.5) < 0.65


def with_shape(sound: Remainder, shape: np.ndarray, chi2: float = 200.0) -> Remainder:
    """The remainder with a change of Fy (n,), as large as raises the sum of squares that the fit cannot follow by ``chi2``."""
    rows = np.zeros(len(sound.residual))
    rows[: len(shape)] = shape
    own = sound.outside(rows)
    return replace(sound, residual=sound.residual + np.sqrt(chi2 / (rows @ own)) * own)


@pytest.mark.parametrize(
    ("condition", "over"),
    [("gamma", "gamma_deg"), ("Fz", "Fz_N"), ("direction", "direction of rolling")],
)
def test_structure_is_found_over_the_condition_that_causes_it(left, drawn, condition, over):
    """Beyond what the fitted numbers follow, where a condition is large, or rolling backwards."""
    values = np.asarray(getattr(left.points, condition), float)
    large = np.abs(values) >= np.quantile(np.abs(values), 0.8)
    found = structure(
        with_shape(drawn[0], np.where(values < 0.0 if condition == "direction" else large, 1.0, 0.0))
    )
    assert found.chance < 1e-4
    assert over in {c.over for c in found.found}
    assert "Fy" in wording.structure(found)


def test_an_effect_that_explains_other_residuals_is_no_rival(left):
    """Crosstalk in Fy and a zero of Mz explain as much, each in its channel; the twin of one explains the same as it."""
    by_id = {effect.id: effect for effect in CATALOG}
    both, nothing = replace(left, residual=np.zeros(len(left.residual))), np.zeros(len(left.points))
    for shape in ((left.points.Fz, nothing), (nothing, nothing + 1.0)):
        both = with_shape(both, np.concatenate(shape) / left.sigma)
    of_fy, of_mz = by_id["crosstalk-fz-fy"], by_id["loadcell-offset-mz"]
    for effect in (of_fy, of_mz):
        other = of_mz if effect is of_fy else of_fy
        twin = replace(effect, id="twin")
        found = best_effect(both, (effect, twin))
        assert [one.effect.id for one in found.rivals] == ["twin"]
        assert best_effect(both, (effect, other)).rivals == ()


def test_neighbours_that_agree_are_found_along_the_sweeps(left, drawn):
    """Slow waves along every sweep with a phase of their own."""
    rng = np.random.default_rng(2)
    wave = np.zeros(len(left.points))
    for k in np.unique(left.points.sweep):
        rows = np.flatnonzero(left.points.sweep == k)
        wave[rows] = np.sin(0.7 * np.arange(len(rows)) + rng.uniform(0.0, 6.3))
    found = structure(with_shape(drawn[1], wave))
    assert "the course of the sweeps" in {c.over for c in found.found if c.channel == "Fy"}


def test_a_left_out_sweep_is_predicted_as_a_fit_without_it_would(left):
    """Against solving the linear problem anew without the rows of the sweep; A A' = J (J'J + P)^-1 J'."""
    rng = np.random.default_rng(5)
    n, k = 40, 4
    J, P = rng.standard_normal((n, k)), np.diag([0.5, 1e-6, 2.0, 1e-6])
    y = rng.standard_normal(n)
    rows = np.arange(n) < 9
    axes = J @ np.linalg.inv(np.linalg.cholesky(J.T @ J + P)).T
    whole = replace(left, residual=y - axes @ (axes.T @ y), axes=axes)
    x = np.linalg.solve(J[~rows].T @ J[~rows] + P, J[~rows].T @ y[~rows])
    assert whole.left_out(np.where(rows, 0, -1))[rows] == pytest.approx(y[rows] - J[rows] @ x, rel=1e-6)


def test_left_out_sweeps_are_predicted_worse_than_they_are_fitted(left, falling):
    found = left_out_sweeps(left)
    for k, channel in enumerate(left.channels):
        used = left.used[k * len(left.points) : (k + 1) * len(left.points)]
        misfit = (left.points.channel(channel) - falling.fit.model[channel])[used]
        assert found[channel].sweeps == len(left.points.sweep_names)
        assert found[channel].fitted == pytest.approx(np.sqrt(np.mean(misfit**2)), rel=0.1)
        assert found[channel].predicted > found[channel].typical > found[channel].fitted


@pytest.mark.parametrize("amount", [-2.26, 2.26])
def test_an_effect_of_an_impossible_size_is_not_suggested(left, amount):
    """A load that changes by 226 % with camber: its shape alone, some 60 standard deviations strong."""
    slope = left.simulation.sensitivities(left.points, ["load_camber"], left.channels)[1].stacked[:, :1]
    far = best_effect(
        replace(left, residual=left.residual + amount * left.outside(left.whitened(slope)[:, 0]))
    )
    assert all(step.effect.id != "load-camber" for step in (far.best, *far.rivals))
    assert best_effect(left).best.effect.id == "load-camber"

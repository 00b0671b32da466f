"""What a fit leaves: the effect that explains it is named with its size, and noise alone is no effect."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm
from small_rigs import LEAN, built, disc, simulated, truth

import mffit
from mffit import config as configuration
from mffit.diagnosis.remains import Left, _log_chance, best_effect
from mffit.effects import CATALOG
from mffit.fit.fitted import left_by
from mffit.linearised import LinearisedFit, linearised

DRAWS = 30
CERTAIN = 12.5


@pytest.fixture(scope="module")
def falling(tmp_path_factory):
    """A load that falls by 12 % sin^2 with camber, and a skew of the camber axis that a backward camber sweep shows."""
    content = disc(faults={"load_camber": -0.12})
    content["sweep"].append({"file": "back.csv", "load_N": 1400, "gamma_deg": LEAN, "direction": "backward"})
    return built(content, tmp_path_factory.mktemp("falling"))


@pytest.fixture(scope="module")
def left(falling) -> Left:
    return Left.of(falling.fit.search, left_by(falling.fit.search))


def with_residual(left: Left, residual: np.ndarray) -> Left:
    return left._replace(joint=replace(left.joint, model=replace(left.joint.model, residual=residual)))


def moved(left: Left, change: np.ndarray) -> Left:
    """The same where the readings (c n,) differ by a change."""
    residual = left.joint.model.residual.copy()
    residual[: len(change)] += np.nan_to_num(change) / left.joint.sigma.ravel()
    return with_residual(left, residual)


def test_the_effect_is_named_with_its_size_although_the_misfit_is_at_the_noise(falling):
    assert max(falling.trust.over_noise.values()) < 1.1
    found = falling.remains.effect
    assert found.best.effect.id == "load-camber"
    assert found.significant
    value, u = found.best.numbers["load_camber"]
    assert abs(value + 0.12) < 3.0 * u < 0.07
    assert falling.trusted
    assert any("load that changes with camber" in said for said in falling.warnings)


def test_residuals_of_sound_readings_show_no_effect(left):
    """Numbers drawn from their priors, and noise: 1 % of sound fits have a chance below 0.01.

    30 have 3 or more with a probability of 0.3 %.
    """
    rng, model = np.random.default_rng(8), left.joint.model
    used = np.append(
        np.isfinite(left.joint.sigma.ravel()), np.ones(len(model.residual) - left.joint.sigma.size)
    )
    chances = []
    for _ in range(DRAWS):
        numbers, noise = (rng.standard_normal(n) for n in (model.common.shape[1], len(used)))
        chances.append(best_effect(with_residual(left, model.common @ numbers + used * noise)).chance)
    assert np.sum(np.array(chances) < 0.01) <= 2
    # Bonferroni counts effects that look alike as independent: 0.28 of 240 draws are below 0.5, of 30 with a scatter of 0.08.
    assert 0.1 < np.mean(np.array(chances) < 0.5) < 0.65


def test_an_effect_that_explains_other_residuals_is_no_rival(left):
    """Crosstalk in Fy and a zero of Mz explain as much, each in its channel; the twin of one explains the same as it."""
    by_id = {effect.id: effect for effect in CATALOG}
    u = dict(zip(left.joint.channels, left.joint.sigma, strict=True))
    both = with_residual(left, np.zeros(len(left.joint.model.residual)))
    for channel, shape in (("Fy", left.points.Fz), ("Mz", np.ones(len(left.points)))):
        change = np.concatenate([shape * (name == channel) for name in left.joint.channels])
        own = left.joint.further(np.append(change / np.concatenate([*u.values()]), np.zeros(
            len(left.joint.model.residual) - len(change)))[:, None])  # fmt: skip
        both = moved(both, change * np.sqrt(200.0 / own.information[0, 0]))
    of_fy, of_mz = by_id["crosstalk-fz-fy"], by_id["loadcell-offset-mz"]
    for effect in (of_fy, of_mz):
        other = of_mz if effect is of_fy else of_fy
        twin = replace(effect, id="twin")
        found = best_effect(both, (effect, twin))
        assert [one.effect.id for one in found.rivals] == ["twin"]
        assert best_effect(both, (effect, other)).rivals == ()


@pytest.mark.parametrize("amount", [-2.26, 2.26])
def test_an_effect_of_an_impossible_size_is_not_suggested(left, amount):
    """A load that changes by 226 % with camber: its shape alone, some 60 standard deviations strong."""
    slope = left.fitted.simulation.sensitivities(left.points, ["load_camber"], left.joint.channels)[1].stacked
    far = best_effect(moved(left, amount * slope[:, 0]))
    assert all(step.effect.id != "load-camber" for step in (far.best, *far.rivals))


def missed(falling, rng: np.random.Generator, shape: np.ndarray | float) -> LinearisedFit:
    """What is left of readings of the fitted model with noise and a further force (n,)."""
    fit, points = falling.fit.search, falling.points
    read = fit.simulation.readings(points, fit.problem.sigma)
    noisy = {name: read[name] + u * rng.standard_normal(len(u)) for name, u in fit.problem.sigma.items()}
    return linearised(
        points.replace(**noisy | {"Fy": noisy["Fy"] + shape}), fit.simulation, fit.problem.sigma, ()
    )


def test_a_formula_that_misses_nothing_is_not_said_to(falling):
    rng = np.random.default_rng(5)
    proofs = [one.proof for _ in range(6) for one in missed(falling, rng, 0.0).channels.values()]
    assert max(proofs) < CERTAIN
    assert np.median(proofs) < 2.0


@pytest.mark.parametrize("over", ["gamma", "Fz"])
def test_what_is_missed_is_found_over_the_condition_that_causes_it(falling, over):
    """Where a condition is large; the other channel misses nothing."""
    values = np.asarray(getattr(falling.points, over), float)
    large = np.abs(values) >= np.quantile(np.abs(values), 0.8)
    found = missed(falling, np.random.default_rng(7), np.where(large, 30.0, 0.0)).channels
    assert found["Fy"].proof > CERTAIN
    assert found["Fy"].missed_over[over] > CERTAIN
    assert found["Mz"].proof < CERTAIN


def test_left_out_sweeps_are_predicted_worse_than_they_are_fitted(falling):
    for channel, found in falling.remains.left_out.items():
        used = np.isfinite(falling.fit.search.problem.sigma[channel])
        misfit = np.where(used, falling.points.channel(channel) - falling.fit.model[channel], np.nan)
        assert found.sweeps == len(falling.points.sweep_names)
        assert found.fitted == pytest.approx(np.sqrt(np.nanmean(misfit**2)), rel=0.1)
        assert found.predicted > found.fitted


def test_a_coefficient_that_was_set_wrong_is_named_with_its_true_size(tmp_path):
    """PKY2 is set 30 % too large: the readings tell the tyre's, in units of the coefficient."""
    simulated(disc(), tmp_path)
    true = float(truth()["PKY2"])
    config = configuration.load(tmp_path / "tyre.toml", coefficients=[f"PKY2={1.3 * true!r}"])
    found = mffit.build(config, with_report=False).remains.effect
    assert (found.best.effect.id, found.significant) == ("load-cornering-stiffness", True)
    value, u = found.best.numbers["PKY2"]
    assert abs(value - true) < 3.0 * u < 0.3


@pytest.mark.parametrize("sigma", [3.0, 30.0, 60.0, 300.0])
def test_a_chance_too_small_for_a_number_keeps_its_logarithm(sigma):
    assert _log_chance(sigma**2, 1) == pytest.approx(np.log(2.0) + norm.logsf(sigma), rel=1e-6)
    assert _log_chance(sigma**2, 2) == pytest.approx(-0.5 * sigma**2)

"""A cause that the library lacks takes the confidence from the names that imitate it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from blind_scores import loaded

from mffit.diagnosis import diagnose
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.imitation import imitations, is_no_imitation
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.validation import validate
from mffit.effects import CATALOG
from mffit.rig import Simulation
from mffit.rig_errors import number_of

BY_ID = {effect.id: effect for effect in CATALOG}


def test_an_amplifier_that_compresses_one_sign_of_the_force_is_not_repaired_as_something_else(
    right_model, tmp_path
):
    case, _, _ = right_model
    bent = replace(case, name="bent", Fy=case.Fy - 0.12 * np.maximum(case.Fy - 900.0, 0.0))
    config, points = loaded(bent, tmp_path)
    found = diagnose(points, case.given, config)
    assert found.unexplained
    assert all(one.confidence < 0.5 and not one.repaired for one in found.effects)
    assert dict(found.tyre.values) == dict(case.given.values)


@pytest.fixture
def problem(right_model):
    case, _, points = right_model
    u = np.repeat([6.0, 0.6], len(points))
    noise = Noise(u=u, stated=u, chain=np.arange(len(u)), origin=None)
    return DiagnosisProblem(points, Simulation.of(case.given, turn_slip=True), noise)


def test_effects_taken_out_are_imitated_by_their_likes_alone(problem):
    """Gain and nonlinearity of one load cell are alike; the zero of the other channel is a shape of its own."""
    chosen = [BY_ID[name] for name in ("loadcell-gain", "loadcell-nonlinearity", "loadcell-offset-mz")]
    gain, nonlinearity, zero = imitations(problem, chosen)
    assert 0.7 < gain < 0.99
    assert nonlinearity == pytest.approx(gain, abs=1e-6)  # one direction each
    assert zero < 0.1


def test_the_more_of_the_misfit_a_name_leaves_the_likelier_it_is_an_imitation():
    imitated = np.linspace(0.05, 0.98, 40)
    certain = [is_no_imitation(share, imitated) for share in (0.1, 0.5, 0.9, 0.93, 0.99)]
    assert certain == sorted(certain)
    assert certain[0] < 0.1
    assert certain[3] < 0.5 < certain[4]


def whitened(shape: np.ndarray, size: float, data: np.ndarray) -> Hypothesis:
    residual = data - size * shape
    return Hypothesis((), {}, {"x": 1.0}, float(residual @ residual), 0.0, None, residual, shape[:, None])  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("sigmas", "least", "most"), [(1.0, 0.2, 0.32), (3.0, 0.85, 0.97), (6.0, 0.999, 1.0)]
)
def test_a_rival_is_excluded_as_often_as_the_readings_have_the_power(sigmas, least, most):
    """Two effects that differ by ``sigmas``; the first acts. At 5 % the power is that of a one-sided test of their difference."""
    rng = np.random.default_rng(7)
    shape, other = np.zeros(200), np.zeros(200)
    shape[0], other[0] = 10.0, 10.0
    shape[1], other[1] = 0.0, sigmas
    excluded = 0
    for _ in range(400):
        data = shape + rng.normal(size=200)
        true, rival = (whitened(s, float(s @ data / (s @ s)), data) for s in (shape, other))
        excluded += true.excludes(rival, 0.05)
    assert least <= excluded / 400 <= most


def test_offsets_of_runs_are_checked_within_the_runs(problem):
    """Left-out runs say nothing about their own offsets: half of each run must predict the other."""
    points = problem.points
    files = sorted({points.files[k] for k in np.unique(points.file)})
    offsets = BY_ID["run-offsets-fy"].written_out(files, ())
    drawn = dict(zip(files, np.random.default_rng(2).normal(0.0, 20.0, len(files)).tolist(), strict=True))
    moved = problem.points.replace(Fy=points.Fy + np.array([drawn[points.files[k]] for k in points.file]))
    shifted = DiagnosisProblem(moved, problem.start, problem.noise)
    check = validate(shifted, shifted.fit((offsets,)))
    assert check.within_runs
    assert check.gap_after.rms("Fy") < 0.5 * check.gap_before.rms("Fy")
    assert number_of("F0_N", files[0]) in offsets.parameters

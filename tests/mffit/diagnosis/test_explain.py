"""What is named is of some size once the model's coefficients are estimated beside it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mffit.diagnosis import explain as explaining
from mffit.diagnosis.candidates import Problem
from mffit.diagnosis.inexact import EXACT
from mffit.diagnosis.noise import Origin, noise_model
from mffit.effects import CATALOG
from mffit.rig import Simulation

BY_ID = {effect.id: effect for effect in CATALOG}


def test_an_effect_of_which_nothing_is_left_is_not_named(stiffer_camber):
    """Camber stiffness is missing; the play that stands beside it has come to nothing."""
    case, _, points = stiffer_camber
    start = Simulation.of(case.given)
    problem = Problem(points, start, noise_model(points, start, 0.0, Origin.STATED))
    both = problem.fit((BY_ID["camber-stiffness"], BY_ID["loadcell-offset-mz"]), {"PKY6": 0.8, "M0_Nm": 0.1})
    nothing = replace(both, numbers={**both.numbers, "M0_Nm": 0.0}, stderr={**both.stderr, "M0_Nm": 0.05})
    bumps = explaining.bump_scan(points, problem.noise)
    found = explaining.Explanation(
        problem, both, [], bumps.best(both), explaining.NO_SMOOTH, bumps, np.zeros((2 * len(points), 0)), nothing, {}
    )  # fmt: skip
    left = explaining._of_some_size(found, EXACT)
    assert [e.id for e in left.chosen.effects] == ["camber-stiffness"]
    assert set(left.refined.numbers) == {"PKY6"}
    large = replace(found, refined=replace(nothing, numbers={**nothing.numbers, "M0_Nm": 0.2}))
    assert explaining._of_some_size(large, EXACT).chosen.effects == both.effects

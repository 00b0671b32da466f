"""An effect is named only if it stays significant when the model's coefficients are estimated beside it."""

from __future__ import annotations

from dataclasses import replace

from mffit.diagnosis.bumps import bump_scan
from mffit.diagnosis.explain import significant
from mffit.diagnosis.explanation import Explanation
from mffit.diagnosis.inexact import EXACT
from mffit.diagnosis.noise import Origin
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.stated import stated_noise
from mffit.effects import CATALOG
from mffit.rig import Simulation

BY_ID = {effect.id: effect for effect in CATALOG}


def test_an_effect_that_vanishes_is_not_named(stiffer_camber):
    """Camber stiffness is missing; the load-cell offset beside it has become zero."""
    case, _, points = stiffer_camber
    start = Simulation.of(case.given)
    problem = DiagnosisProblem(points, start, stated_noise(points, Origin.STATED))
    both = problem.fit((BY_ID["camber-stiffness"], BY_ID["loadcell-offset-mz"]), {"PKY6": 0.8, "M0_Nm": 0.1})
    nothing = replace(both, numbers={**both.numbers, "M0_Nm": 0.0}, stderr={**both.stderr, "M0_Nm": 0.05})
    bumps = bump_scan(points, problem.noise)
    found = Explanation(
        problem=problem,
        chosen=both,
        candidates=CATALOG,
        bump=bumps.best(both),
        bumps=bumps,
        refined=nothing,
    )
    left = significant(found, EXACT)
    assert [e.id for e in left.chosen.effects] == ["camber-stiffness"]
    assert set(left.refined.numbers) == {"PKY6"}
    large = replace(found, refined=replace(nothing, numbers={**nothing.numbers, "M0_Nm": 0.2}))
    assert significant(large, EXACT).chosen.effects == both.effects

"""Where the searches of a build end, scipy's ``trf`` finds nothing that is worth more steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import brush
import numpy as np
import pytest
from scipy.optimize import least_squares
from small_rigs import SAMPLE, disc, simulated

import mffit
from mffit.fit import polish
from mffit.least_squares import FreeNumber, LeastSquaresProblem, Linear, broken, solve

WORTH = 1.0
"""Fall of a sum of squares in units of noise: numbers move by less than their standard uncertainty."""


def by_trf(problem: LeastSquaresProblem, numbers: Sequence[FreeNumber], start: np.ndarray) -> float:
    """Sum of squares where ``trf`` ends."""
    bounds = tuple(np.array([getattr(n, end) for n in numbers]) for end in ("lower", "upper"))
    weight = np.array([0.0 if np.isinf(n.spread) else 1.0 / n.spread for n in numbers])
    expected = np.array([n.expected for n in numbers])
    last: list[tuple[np.ndarray, Linear]] = []

    def linear(x: np.ndarray) -> Linear:
        if not last or not np.array_equal(last[0][0], x):
            last[:] = [(x.copy(), problem.linear(x))]
        return last[0][1]

    def residual(x: np.ndarray) -> np.ndarray:
        here = linear(x)
        return np.concatenate([here.data, broken(here.limits), weight * (x - expected)])

    def slope(x: np.ndarray) -> np.ndarray:
        here = linear(x)
        return np.vstack([here.slope, here.limits_slope * (here.limits > 0.0)[:, None], np.diag(weight)])

    start = np.clip(start, *bounds)
    return 2.0 * float(least_squares(residual, start, slope, bounds, x_scale="jac", max_nfev=300).cost)


@pytest.mark.parametrize("campaign", ["disc", "belt"])
def test_the_last_searches_of_a_build_end_at_a_minimum(campaign, tmp_path, monkeypatch):
    found = {}

    def recorded(problem, numbers, **keys):
        end = solve(problem, numbers, **keys)
        if keys.get("max_steps", 1):
            found[len(numbers)] = (problem, numbers, end)
        return end

    monkeypatch.setattr(polish, "solve", recorded)
    project = SAMPLE.parent / "flat-track" / "tyre.toml"
    if campaign == "disc":
        simulated(disc(), tmp_path)
        project = tmp_path / "tyre.toml"
    mffit.build(project, with_report=False)
    assert found
    for problem, numbers, end in found.values():
        here = by_trf(problem, numbers, np.array(list(end.values.values())))
        begun = by_trf(problem, numbers, np.array([n.start for n in numbers]))
        assert end.cost - min(here, begun) < WORTH
        assert end.cost - here < 2.0 * end.left + 0.1  # and it promises no less than there is


def test_no_start_leads_to_a_lower_minimum(tmp_path):
    """The sum of squares of a brush tyre's Mz has a minimum on either side of QEZ1 = 0, a tenth apart."""
    search = mffit.build(brush.written(brush.Brush(), tmp_path, 1), with_report=False).fit.search
    numbers = search.problem.starting_here(search.numbers)
    problem = search.problem.free([n.name for n in numbers])
    ends = {
        x: solve(problem, [replace(n, start=x if n.name == "QEZ1" else n.start) for n in numbers]).cost
        for x in (-8.0, -4.0, -1.0, 0.9, search.values["QEZ1"])
    }
    assert min(ends.values()) > 0.99 * ends[search.values["QEZ1"]], ends

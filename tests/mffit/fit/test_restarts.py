"""Which of several starts of a fit is kept."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from mffit.fit import polish
from mffit.fit.start import ALTERNATIVE_STARTS
from mffit.least_squares import FreeNumber
from mffit.progress import silent


@dataclass(frozen=True)
class End:
    """As much of a fit as the choice needs."""

    cost: float
    problem: None = None
    attempts: tuple[str, ...] = ()


@pytest.mark.parametrize(("fall", "kept"), [(5.0, 1000.0), (15.0, 985.0)])
def test_a_restart_is_kept_only_where_it_is_clearly_better(monkeypatch, fall, kept):
    """A fit is a hundred times likelier if the sum of squares is lower by 2 ln 100 = 9.2."""
    ends = iter([End(1000.0), *(End(1000.0 - fall),) * len(ALTERNATIVE_STARTS)])
    monkeypatch.setattr(polish, "_fit_from", lambda *_: next(ends))
    monkeypatch.setattr(polish, "_cost", lambda fitted, weighted: fitted.cost)
    monkeypatch.setattr(polish, "restart_worthwhile", lambda *_: True)
    monkeypatch.setattr(polish, "_require_enough_points", lambda *_: None)
    found = polish.best_fit(SimpleNamespace(points=None), {}, SimpleNamespace(free=[]), silent)
    assert found == End(kept, None, tuple(ALTERNATIVE_STARTS))


def test_fits_are_compared_by_the_same_weights():
    """A fit that misses readings by 3 of their uncertainty is no better because it gives them a third of the weight."""

    @dataclass(frozen=True)
    class Weighted:
        sigma: float
        simulation: float

        def misfit(self):
            return {"Fy": np.full(10, self.simulation / self.sigma)}

    def fit(sigma, misses):
        return SimpleNamespace(
            problem=Weighted(sigma, misses),
            numbers=[FreeNumber("a", 3.0, expected=1.0, spread=1.0), FreeNumber("b", 9.0)],
        )

    good, bad = fit(1.0, 1.0), fit(3.0, 3.0)
    assert polish._cost(good, good.problem) == pytest.approx(10.0 + 4.0)
    assert polish._cost(bad, good.problem) == pytest.approx(90.0 + 4.0)

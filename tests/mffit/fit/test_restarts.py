"""Which of several starts of a fit is kept."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from mffit.fit import polish
from mffit.fit.start import ALTERNATIVE_STARTS
from mffit.progress import silent


@dataclass(frozen=True)
class End:
    """As much of a fit as the choice needs: the misfit of 100 readings, by which their weights are reduced."""

    misfit: float
    attempts: tuple[str, ...] = ()

    @property
    def cost(self):
        return 100.0

    @property
    def problem(self):
        return SimpleNamespace(sigma={"Fy": np.full(100, self.misfit)})


@pytest.mark.parametrize(("other", "kept"), [(1.97, 2.0), (1.5, 1.5), (3.0, 2.0)])
def test_a_restart_is_kept_only_where_it_is_clearly_better(monkeypatch, other, kept):
    """A fit is a hundred times likelier if -2 log likelihood is lower by 9.2, here with 100 readings at a misfit below 1.91."""
    ends = iter([End(2.0), *(End(other),) * len(ALTERNATIVE_STARTS)])
    monkeypatch.setattr(polish, "_fit_from", lambda *_: next(ends))
    monkeypatch.setattr(polish, "restart_worthwhile", lambda *_: True)
    monkeypatch.setattr(polish, "_require_enough_points", lambda *_: None)
    stated = SimpleNamespace(points=None, sigma={"Fy": np.ones(100)})
    found = polish.best_fit(stated, {}, SimpleNamespace(free=[]), silent)
    assert found == End(kept, tuple(ALTERNATIVE_STARTS))

"""Which of several starts of a fit is kept."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import pytest

from mffit.fit import polish
from mffit.fit.start import ALTERNATIVE_STARTS
from mffit.progress import silent


@dataclass(frozen=True)
class End:
    """As much of a fit as the choice needs."""

    cost: float
    attempts: tuple[str, ...] = ()


@pytest.mark.parametrize(("fall", "kept"), [(5.0, 1000.0), (15.0, 985.0)])
def test_a_restart_is_kept_only_where_it_is_clearly_better(monkeypatch, fall, kept):
    """A fit is a hundred times likelier if the sum of squares is lower by 2 ln 100 = 9.2."""
    costs = iter([1000.0, *(1000.0 - fall,) * len(ALTERNATIVE_STARTS)])
    monkeypatch.setattr(polish, "_fit_from", lambda *_: End(next(costs)))
    monkeypatch.setattr(polish, "restart_worthwhile", lambda *_: True)
    monkeypatch.setattr(polish, "_require_enough_points", lambda *_: None)
    found = polish.best_fit(SimpleNamespace(points=None), {}, SimpleNamespace(free=[]), silent)
    assert found == End(kept, tuple(ALTERNATIVE_STARTS))

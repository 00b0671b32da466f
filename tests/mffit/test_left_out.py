"""What the fit gives no weight, less weight, or doubts, as entries of one list."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from mffit.pipeline.left_out import left_out_by_fit
from mffit.points import make_points
from mffit.suspicion import Doubt, Outlier
from mffit.suspicion.others import Error

N = 12
POINTS = make_points(
    0.0, 0.0, np.full(N, 1500.0), p=2.5e5, V=6.0, phi_t=0.0, Fy=np.linspace(-900.0, 900.0, N), Mz=np.nan,
    u_Fy=np.r_[np.full(6, 5.0), np.full(6, 8.0)], file=np.repeat([0, 1], 6), line=np.tile(np.arange(2, 8), 2),
    files=("a.csv", "b.csv"),
)  # fmt: skip


def fitted(factor, *, outliers=(), doubts=()):
    """A fit that used the stated uncertainties of Fy times ``factor`` (n,)."""
    sigma = {"Fy": POINTS.u_Fy * factor, "Mz": np.full(N, np.inf)}
    search = SimpleNamespace(problem=SimpleNamespace(sigma=sigma))
    return SimpleNamespace(search=search, outliers=outliers, doubts=doubts, at_turns={})


def test_a_common_scale_of_the_uncertainties_discounts_nothing():
    assert left_out_by_fit(POINTS, fitted(np.full(N, 1.7))) == ()


def test_discounted_readings_are_listed_by_file_with_their_smallest_weight():
    """A reading whose uncertainty is doubled beside the others has a quarter of their weight."""
    factor = np.full(N, 1.5)
    factor[[1, 2, 3]] *= [1.5, 2.0, 1.2]
    factor[9] *= 4.0
    factor[11] = np.inf  # an outlier, listed as such
    first, second = left_out_by_fit(POINTS, fitted(factor))
    assert (first.file, first.lines, first.count, first.channel) == ("a.csv", "3-5", 3, "Fy")
    assert first.weight == pytest.approx(0.25)
    assert (second.file, second.lines, second.weight) == ("b.csv", "5", pytest.approx(1.0 / 16.0))
    assert {first.rule, second.rule} == {"huber-weight"}


def test_an_outlier_has_no_weight_and_a_doubtful_sweep_all_of_it():
    outlier = Outlier("b.csv", 7, "b", 11, "Fy", 900.0, 20.0, 110.0)
    error = Error("Fy", 41.0, 5.0, 0.1, 0.0, 0.0)
    doubt = Doubt("a", "a.csv", np.arange(6), (error,), looks="a load in lbf")
    wild, doubted = left_out_by_fit(POINTS, fitted(np.ones(N), outliers=(outlier,), doubts=(doubt,)))
    assert (wild.file, wild.lines, wild.rule, wild.weight) == ("b.csv", "7", "outlying-reading", 0.0)
    assert "900 N where 20 N is expected" in wild.why
    assert (doubted.file, doubted.lines, doubted.count, doubted.weight) == ("a.csv", "2-7", 6, 1.0)
    assert doubted.rule == "doubtful-sweep"
    assert "a load in lbf" in doubted.why

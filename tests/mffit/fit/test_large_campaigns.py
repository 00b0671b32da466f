"""A campaign of many points gives what it gives in one piece: fit, errors, choice of influences, predicted sweeps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import small_rigs

import mffit.constants
import mffit.diagnosis.constants
import tir.constants
from mffit.fit.influences.nuisance_choice import choose
from mffit.least_squares import Linear, condensed


@pytest.fixture(scope="module")
def built():
    return small_rigs.sound(small_rigs.flat)


@pytest.fixture
def in_small_blocks(monkeypatch):
    def change():
        monkeypatch.setattr(tir.constants, "CONDITIONS_PER_BLOCK", 30)
        monkeypatch.setattr(mffit.constants, "ROWS_AT_ONCE", 50)

    return change


def products(linear: Linear) -> np.ndarray:
    rows = np.column_stack([linear.slope, linear.data])
    return rows.T @ rows


def test_condensed_rows_have_the_same_products(built, in_small_blocks):
    search = built.fit.search
    names = [n.name for n in search.numbers]
    at = np.array([search.problem.value(name) * 1.01 for name in names])
    whole = search.problem.free(names).linear(at)
    in_small_blocks()
    few = search.problem.free(names).linear(at)
    assert few.slope.shape == (len(names) + 1, len(names))
    size = np.sqrt(np.diag(products(whole)))
    assert products(few) / np.outer(size, size) == pytest.approx(
        products(whole) / np.outer(size, size), abs=1e-12
    )


def test_a_missing_reading_has_neither_residual_nor_derivatives(built):
    problem = built.fit.search.problem
    gone = np.arange(len(problem.points)) % 7 == 3
    lacking = replace(problem, points=problem.points.replace(Mz=np.where(gone, np.nan, problem.points.Mz)))
    names = [n.name for n in built.fit.search.numbers]
    (_, data, slope), (_, _, complete) = (next(one.blocks(names)) for one in (lacking, problem))
    of_channel = np.concatenate([gone & (name == "Mz") for name in problem.sigma])
    assert not np.any(data[of_channel])
    assert not np.any(slope[of_channel])
    assert slope[~of_channel] == pytest.approx(complete[~of_channel])


def test_a_number_without_effect_stays_without_effect(monkeypatch):
    monkeypatch.setattr(mffit.constants, "ROWS_AT_ONCE", 4)
    rng = np.random.default_rng(1)
    slope = np.column_stack([rng.standard_normal(12), np.zeros(12)])
    data, rows = condensed([(np.ones(6), slope[:6]), (np.ones(6), slope[6:])])
    assert rows.T @ rows == pytest.approx(slope.T @ slope, abs=1e-12)
    assert rows.T @ data == pytest.approx(slope.T @ np.ones(12), abs=1e-12)
    assert data @ data == pytest.approx(12.0)


def test_the_choice_of_influences_is_that_in_one_piece(built, in_small_blocks):
    before = choose(built.config, built.fit.search).verdicts
    in_small_blocks()
    for old, new in zip(before, choose(built.config, built.fit.search).verdicts, strict=True):
        assert (new.modelled, new.reason) == (old.modelled, old.reason)
        assert dict(new.beside) == pytest.approx(dict(old.beside), rel=1e-7)
        assert dict(new.without) == pytest.approx(dict(old.without), rel=1e-7)
    assert any(verdict.without for verdict in before)

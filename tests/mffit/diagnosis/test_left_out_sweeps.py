"""Effects chosen by how well they predict left-out sweeps."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from small_programme import U_FY, U_MZ, problem, programme, read

from mffit.constants import FEWEST_SWEEPS_TO_PREDICT
from mffit.diagnosis.inexact import EXACT
from mffit.diagnosis.prediction import LeftOutPrediction, Predicted, chosen_by_prediction, judged
from mffit.effects import CATALOG, Effect, Free
from mffit.rig_errors import Faults

OFFSET = next(effect for effect in CATALOG if effect.id == "loadcell-offset-fy")
A, B, C = (Effect(name, name, "rig", "", (Free(name, 1.0),)) for name in "abc")


def test_a_left_out_sweep_is_predicted_with_the_offset_of_the_others():
    """An offset of 12 N in all sweeps but one, and of 1.2 Nm in that one, which no number explains."""
    points = read(programme(), faults=Faults(F0_N=12.0))
    odd_one = points.sweep == 4
    points = points.replace(Fy=points.Fy - 12.0 * odd_one, Mz=points.Mz + 1.2 * odd_one)
    model = problem(points)
    found = LeftOutPrediction(model, EXACT).of(model.evaluate((OFFSET,), {"F0_N": 0.0}))
    assert found.chi2.shape == (5, 2)
    offset, spread = np.where(odd_one, 0.0, 12.0), OFFSET.free[0].spread
    for k, (Fy, Mz) in enumerate(found.chi2):
        out = points.sweep == k
        rest = offset[~out]
        predicted = rest.sum() / U_FY**2 / (len(rest) / U_FY**2 + 1.0 / spread**2)
        assert Fy == pytest.approx(np.sum((offset[out] - predicted) ** 2) / U_FY**2, rel=1e-6)
        assert Mz == pytest.approx(np.sum(odd_one[out]) * (1.2 / U_MZ) ** 2, abs=1e-9)


class Tabulated:
    """Predictions whose misfit, the same or one for each channel, is a table by the names of the effects."""

    def __init__(self, sweeps: int, **misfit: float | tuple[float, float]) -> None:
        self.sweeps, self.misfit = sweeps, {frozenset(names.strip("_")): x for names, x in misfit.items()}
        self.problem = SimpleNamespace(null=self.fit(()), columns=self.columns, channels=("Fy", "Mz"))
        self.joint = self

    def fit(self, effects, start=None):
        return SimpleNamespace(effects=tuple(effects), numbers={}, state=None)

    def columns(self, state, candidates):
        return {effect: [effect] for effect in candidates}

    def of(self, hypothesis, *more):
        misfit = self.misfit[frozenset(effect.id for effect in (*hypothesis.effects, *more))]
        unequal = 1.0 + 0.1 * np.arange(self.sweeps)
        return Predicted(np.outer(unequal / unequal.sum(), misfit * np.ones(2)))

    def beyond_noise(self, predicted):
        return predicted.chi2.sum(axis=0)

    def without(self, chosen, effect):
        return self.fit(other for other in chosen.effects if other is not effect)


ALL_THREE = {
    "_": 500.0,
    "a": 250.0,
    "b": 300.0,
    "c": 350.0,
    "ab": 175.0,
    "ac": 200.0,
    "bc": 200.0,
    "abc": 5.0,
}
"""Each effect beside the others predicts better; best first are a, b and c."""
SWEEPS = int(FEWEST_SWEEPS_TO_PREDICT)


def chosen(sweeps: int = SWEEPS, **misfit):
    return chosen_by_prediction(Tabulated(sweeps, **ALL_THREE | misfit), (A, B, C)).effects


def test_effects_are_added_while_they_predict_better():
    assert chosen() == (A, B, C)
    assert chosen(abc=174.9) == (A, B)


def test_the_first_effect_is_dropped_if_later_ones_make_it_needless():
    assert chosen(bc=5.0) == (B, C)


def test_a_later_effect_is_dropped_if_the_last_one_makes_it_needless():
    """Beside a alone, c predicts one channel worse and is passed over for b."""
    assert chosen(ac=(2.0, 300.0), abc=151.0) == (A, C)


@pytest.mark.parametrize(("other", "names"), [(500.1, (A,)), (700.0, (A,)), (760.0, ())])
def test_all_channels_together_decide(other, names):
    """Both channels miss by 500 without the effect; one that gains 250 may lose less than that in the other."""
    found = chosen_by_prediction(Tabulated(SWEEPS, _=500.0, a=(250.0, other)), (A,))
    assert found.effects == names


def test_few_sweeps_choose_nothing():
    assert chosen(SWEEPS - 1) == ()


def test_the_share_is_that_of_the_channel_that_an_effect_explains_most():
    """It removes 300 of 400 there, and 5 of 300 in the other."""
    predictions = Tabulated(SWEEPS, _=(400.0, 300.0), a=(100.0, 295.0))
    found = judged(predictions, predictions.fit((A,)), A, (A,))
    assert found.confidence == pytest.approx(0.75)
    assert found.tied == ()


def test_an_effect_is_tied_with_those_that_explain_the_same_channel():
    """All three lower the sum as much, b in the other channel."""
    predictions = Tabulated(SWEEPS, _=(500.0, 500.0), a=(500.0, 250.0), b=(250.0, 500.0), c=(500.0, 250.0))
    found = judged(predictions, predictions.fit((A,)), A, (A, B, C))
    assert [tied.effects for tied in found.tied] == [(C,)]

"""A model of another tyre ends the search for culprits: one reason, and it names the model, no sweep and no unit.

The readings are those of the virtual rig with the tyre of the front sample; the model is the rear sample's tyre.
"""

from __future__ import annotations

import pytest
from small_rigs import SAMPLE, flat, simulated, truth

import mffit
import tir
from mffit.suspicion import Misread


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    folder = tmp_path_factory.mktemp("front")
    simulated(flat(), folder)
    return folder / "tyre.toml"


def rear() -> tir.Tyre:
    return tir.read(SAMPLE.parent / "rear-190-55" / "true.tir")


def renamed(tyre: tir.Tyre) -> tir.Tyre:
    """The model with the dimensions and nominal conditions of the front tyre, as if they were its own."""
    keys = ("UNLOADED_RADIUS", "WIDTH", "RIM_RADIUS", "FNOMIN", "NOMPRES")
    return tyre.replace(**{key: truth()[key] for key in keys})


def assert_no_culprit(found: mffit.diagnosis.Diagnosis, said: str) -> None:
    assert not found.trusted
    (reason,) = found.reasons
    assert said in reason
    assert not any(name in reason for name in found.points.sweep_names)
    assert not any(word in reason for word in ("units and axes", "check this sweep", "u_Fy_N"))
    assert not any(isinstance(note, Misread) for note in found.notes)
    assert "left out" not in found.headline


def test_a_model_that_states_other_dimensions_is_the_reason(project):
    found = mffit.diagnose(project, rear())
    assert_no_culprit(found, "of another tyre")
    assert "UNLOADED_RADIUS" in found.reasons[0]


def test_a_model_that_misses_most_sweeps_is_the_reason(project):
    """The rear tyre under the front one's name and dimensions: 47 N where the noise is 3 N, in every sweep."""
    assert_no_culprit(mffit.diagnose(project, renamed(rear())), "whether it is another specimen")


def test_the_model_of_this_tyre_is_trusted(project):
    assert mffit.diagnose(project, truth()).trusted

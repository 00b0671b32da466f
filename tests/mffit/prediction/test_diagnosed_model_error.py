"""What a build found that its formula misses is no effect in other readings of the same tyre, and hides none."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from brush import Brush
from conftest import build, disc_of_a_brush

import mffit
from mffit.diagnosis.rest import Answer
from mffit.scatter import rms

TYRE = Brush(mu=1.3, b=0.025, crown=0.5, reduction=0.1)
NOISE = 6.5  # N; another than that of the build, so that the readings are others


class OnSoftSteering(NamedTuple):
    """The tyre on a steering axis that its aligning moment turns."""

    give: float  #: [deg/Nm]
    nominal: float = TYRE.nominal
    r_e: float = TYRE.r_e

    def forces(self, alpha, gamma, Fz, phi_t=0.0, direction=1.0):
        turned = np.zeros_like(alpha)
        for _ in range(40):
            Mz = TYRE.forces(alpha + turned, gamma, Fz, phi_t=phi_t, direction=direction)[1]
            turned = 0.5 * (turned + np.radians(self.give) * Mz)
        return TYRE.forces(alpha + turned, gamma, Fz, phi_t=phi_t, direction=direction)


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    return build(disc_of_a_brush(tmp_path_factory.mktemp("brush") / "tyre", TYRE))


def diagnosed(built, folder, tyre):
    return mffit.diagnose(disc_of_a_brush(folder, tyre, noise=NOISE), built.folder / "brush.tir")


def test_the_model_error_of_a_build_is_no_effect(built, tmp_path):
    found = diagnosed(built, tmp_path / "again", TYRE)
    assert found.answer is Answer.NOTHING
    assert not found.effects
    assert found.gap_examined.rms("Fy") < 0.6 * found.gap_before.rms("Fy")


@pytest.mark.parametrize("give", [0.01, 0.02])
def test_beside_it_an_effect_has_its_size_within_its_uncertainty(built, tmp_path, give):
    found = diagnosed(built, tmp_path / "soft", OnSoftSteering(give))
    assert [one.effect.id for one in found.repaired] == ["steering-compliance"]
    value, u = found.effects[0].parameters["compliance_deg_per_Nm"]
    assert abs(value - give) < 2.0 * u
    assert value == pytest.approx(give, abs=0.002)
    assert found.gap_after.rms("Fy") < 2.0 * NOISE


def test_the_model_error_is_known_rolling_either_way(built, tmp_path):
    found = diagnosed(built, tmp_path / "again", TYRE)
    away = found.noise.of_channel(found.noise.measured(found.points) - found.before, "Fy")
    assert np.any(found.points.direction < 0)
    assert rms(away[found.points.direction < 0]) < 3.0 * NOISE

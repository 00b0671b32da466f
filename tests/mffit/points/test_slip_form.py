"""What a slip column is divided by, from the recorded speeds of wheel and road."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from mffit.errors import InputError
from tests.mffit.points.slip_recording import R0, error, radii, read, recording


def recorded(form: str, radius: str = "loaded", pressures=(83.0,)) -> pd.DataFrame:
    """A drive recording whose slip is computed from its speeds in another form and with another radius."""
    table = recording(pressures, driven=True, seed=4)
    loaded, rolling = radii(table["Fz_N"], table["p_kPa"])
    wheel = table["omega_radps"] * {"loaded": loaded, "rolling": rolling, "unloaded": R0}[radius]
    road = table["V_mps"] * np.cos(np.radians(table["alpha_deg"]))
    below = {"road": road, "wheel": wheel, "larger": np.maximum(road, wheel)}[form]
    random = np.random.default_rng(5)
    return table.assign(kappa=(wheel - road) / below + 3e-4 * random.normal(size=len(table)))


@pytest.mark.parametrize("form", ["wheel", "larger"])
@pytest.mark.parametrize("radius", ["rolling", "loaded", "unloaded"])
@pytest.mark.parametrize("declared", [True, False])
def test_slip_over_another_speed_is_converted(tmp_path, form, radius, declared):
    found = read(
        tmp_path, {"over": form} if declared else {}, drive=recorded(form, radius, (55.0, 83.0, 110.0))
    )
    assert np.max(np.abs(error(found))) < 0.003
    said = [one for one in found.warnings if f'over = "{form}"' in one]
    assert len(said) == (0 if declared else 1)  # a conversion that nobody declared is warned of


def test_without_wheel_speed_a_declaration_converts(tmp_path):
    table = recorded("wheel", "rolling")
    found = read(tmp_path, {"over": "wheel"}, drive=table.drop(columns="omega_radps"))
    exact = read(tmp_path, {}, drive=recorded("road", "rolling").drop(columns="omega_radps"))
    assert found.points.kappa == pytest.approx(exact.points.kappa, abs=0.002)


@pytest.mark.parametrize(("form", "declared"), [("road", "wheel"), ("wheel", "road"), ("larger", "wheel")])
def test_a_declaration_that_the_speeds_contradict_is_refused(tmp_path, form, declared):
    with pytest.raises(InputError, match=f'over = "{declared}", which contradicts the recorded speeds'):
        read(tmp_path, {"over": declared}, drive=recorded(form))


@pytest.mark.parametrize("radius", ["rolling", "loaded", "unloaded"])
def test_slip_over_the_speed_of_the_road_is_left_alone(tmp_path, radius):
    found = read(tmp_path, {}, drive=recorded("road", radius))
    assert np.max(np.abs(error(found))) < 0.003
    assert not any("omega r" in one for one in (*found.warnings, *found.notes))
    said = " ".join((*found.warnings, *found.notes))
    assert f"kappa is against {'free rolling' if radius == 'rolling' else f'the {radius} radius'}" in said


def test_speeds_that_follow_another_slip_are_said(tmp_path):
    """The wheel's speed of a channel that does not follow the wheel: no definition of slip fits."""
    table = recorded("road")
    table["omega_radps"] = 48.0
    (said,) = [
        one for one in read(tmp_path, {}, drive=table).warnings if "contradicts the recorded speeds" in one
    ]
    assert "check V_mps and omega_radps" in said

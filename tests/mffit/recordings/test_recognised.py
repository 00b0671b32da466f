"""A command takes the columns that `sniff` recognises with certainty, and otherwise asks for them in one sentence."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from small_rigs import LOADS

from mffit import config as configuration
from mffit.errors import InputError
from mffit.pipeline.inputs import read_points

ALPHA = np.repeat(np.linspace(-8.0, 8.0, 9), 3)
FZ = np.tile(LOADS[:3], 9).astype(float)
GERMAN = pd.DataFrame(
    {
        "Schräglaufwinkel [Grad]": ALPHA,
        "Sturz [Grad]": 0.0 * ALPHA,
        "Radlast [kN]": FZ / 1e3,
        "Seitenkraft [N]": -FZ * np.tanh(0.3 * ALPHA),
        "Rückstellmoment [Nm]": 0.02 * FZ * np.tanh(0.3 * ALPHA),
        "Luftdruck [bar]": np.full(27, 2.5),
    }
)


def read(folder, table, columns=None):
    text = table.to_csv(index=False, sep=";", decimal=",")
    (folder / "a.csv").write_text(f"Prüfstand 3\n\n{text}", encoding="utf-8")
    content = {
        "tyre": {"name": "a", "unloaded_radius": 0.3, "nominal_load": 1400.0, "nominal_pressure": 250.0},
        "rig": {"type": "flat-track"},
        "sweep": [{"file": str(folder / "a.csv"), "columns": columns or {}}],
    }
    return read_points(configuration.load(content))


def test_german_headings_with_units_are_taken_with_a_remark(tmp_path):
    found = read(tmp_path, GERMAN)
    np.testing.assert_allclose(np.sort(found.points.Fz), np.sort(FZ))
    np.testing.assert_allclose(found.points.p, 250e3)
    (said,) = [warning for warning in found.warnings if "recognised" in warning]
    assert 'Fz_N is "Radlast" in kN' in said
    assert 'Mz_Nm is "Rückstellmoment" in Nm' in said


def test_what_tyre_toml_says_overrides_what_is_recognised(tmp_path):
    plain = read(tmp_path, GERMAN).points.Mz
    given = read(tmp_path, GERMAN, {"Mz_Nm": {"column": "Rückstellmoment", "unit": "ft-lb"}}).points.Mz
    np.testing.assert_allclose(given, 1.3558179 * plain, rtol=1e-6)


DOUBTFUL = {
    "a unit that is not stated": GERMAN.rename(columns={"Radlast [kN]": "Radlast"}),
    "two columns of one name": GERMAN.assign(**{"FZ [N]": FZ}),
    "a time without a unit": GERMAN.assign(Zeit=np.arange(27.0)),
    "a heading that nobody knows": GERMAN.rename(columns={"Seitenkraft [N]": "Kanal 7 [N]"}),
}


@pytest.mark.parametrize("case", DOUBTFUL)
def test_a_doubt_is_left_to_the_user(tmp_path, case):
    with pytest.raises(InputError, match="is missing, and so are gamma_deg, Fz_N, Fy_N"):
        read(tmp_path, DOUBTFUL[case])

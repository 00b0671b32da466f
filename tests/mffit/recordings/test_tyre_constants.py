"""What a recording states of its tyre need not be given."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mffit import config as configuration
from mffit.errors import InputError
from mffit.pipeline import init_from
from mffit.recordings import project_text, sniff
from mffit.report.text.recordings import sniff_summary

CHANNELS = {"SLIPANGL": "deg", "INCLANGL": "deg", "FZW": "N", "FYW": "N", "MZW": "Nm"}


def tydex(folder: Path, constants: str, *, section: str = "CONSTANTS") -> Path:
    """A sideslip sweep as TYDEX writes it, in fixed columns."""
    alpha = np.linspace(-10.0, 10.0, 21)
    force = -1600.0 * np.sin(1.5 * np.arctan(8.0 * np.radians(alpha)))
    rows = [f"{a:.4f} 0 1500 {f:.4f} {-0.02 * f:.4f}" for a, f in zip(alpha, force, strict=True)]
    header = f"**HEADER\n{constants}" if section == "HEADER" else f"**HEADER\n**{section}\n{constants}"
    channels = "\n".join(f"{name:<10}{'':<30}{unit:<10}" for name, unit in CHANNELS.items())
    path = folder / "a.tdx"
    path.write_text(f"{header}\n**MEASURCHANNELS\n{channels}\n**MEASURDATA\n" + "\n".join(rows) + "\n**END\n")
    return path


def constant(name: str, unit: str, value: object) -> str:
    return f"{name:<10}{'as stated':<30}{unit:<10}{value}"


@pytest.mark.parametrize("section", ["CONSTANTS", "HEADER"])
@pytest.mark.parametrize(("unit", "value"), [("mm", 633.0), ("m", 0.633), ("cm", "63,3")])
def test_the_unloaded_radius_is_half_the_overall_diameter(tmp_path, section, unit, value):
    path = tydex(tmp_path, constant("OVALLDIA", unit, value), section=section)
    _, (toml, *_) = init_from([path], tmp_path / "p", nominal_load=1500.0, nominal_pressure=220.0)
    assert configuration.load(toml).tyre.unloaded_radius == pytest.approx(0.3165)
    assert "half of OVALLDIA of a.tdx" in toml.read_text(encoding="utf-8")
    assert "half of OVALLDIA" in project_text(sniff([path]), tmp_path)


def test_what_is_given_or_stated_as_the_radius_itself_is_better(tmp_path):
    lines = [constant("OVALLDIA", "mm", 633), constant("RFREE", "mm", 315)]
    path = tydex(tmp_path, "\n".join(lines))
    given = {"nominal_load": 1500.0, "nominal_pressure": 220.0}
    _, (toml, *_) = init_from([path], tmp_path / "p", **given)
    assert configuration.load(toml).tyre.unloaded_radius == pytest.approx(0.315)
    _, (toml, *_) = init_from([path], tmp_path / "q", unloaded_radius=0.31, **given)
    assert configuration.load(toml).tyre.unloaded_radius == pytest.approx(0.31)
    assert "RFREE" not in toml.read_text(encoding="utf-8")


def test_nothing_need_be_given_where_the_file_states_all(tmp_path):
    stated = [constant("OVALLDIA", "mm", 633), constant("FNOMIN", "kN", 4.1), constant("NOMPRES", "bar", 2.2)]
    sniffed, (toml, *_) = init_from([tydex(tmp_path, "\n".join(stated))], tmp_path / "p")
    tyre = configuration.load(toml).tyre
    assert (tyre.unloaded_radius, tyre.nominal_load, tyre.nominal_pressure) == pytest.approx(
        (0.3165, 4100.0, 220.0)
    )
    assert "p_kPa" not in sniffed.recordings[0].guesses
    assert "the highest load of 1500 N" in toml.read_text(encoding="utf-8")


@pytest.mark.parametrize("line", [("OVALLDIA", "mm", 0), ("OVALLDIA", "-", 633), ("OVALLDIA", "kg", 633)])
def test_a_constant_that_states_no_radius_is_no_radius(tmp_path, line):
    path = tydex(tmp_path, constant(*line))
    with pytest.raises(
        InputError, match="do not state the free radius of the tyre: give --unloaded-radius M"
    ):
        init_from([path], tmp_path / "p", nominal_load=1500.0, nominal_pressure=220.0)


def test_the_columns_of_what_is_used_say_so(tmp_path):
    stated = [constant("OVALLDIA", "mm", 633), constant("RFREE", "mm", 315), constant("NOMPRES", "bar", 2.2)]
    rows = [line.split() for line in sniff_summary(sniff([tydex(tmp_path, "\n".join(stated))])).splitlines()]
    use = {row[0]: " ".join(row[2:4]) for row in rows if row and row[0] in ("OVALLDIA", "RFREE", "NOMPRES")}
    assert use == {"OVALLDIA": "not used", "RFREE": "unloaded_radius", "NOMPRES": "nominal_pressure"}

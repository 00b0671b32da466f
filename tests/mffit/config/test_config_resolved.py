"""``resolved.toml`` has every key and the same meaning."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from test_config_loading import COMPLETE, MINIMAL

from mffit import config
from mffit.config.toml_file import toml_text
from mffit.errors import InputError


def settings(found: config.Config) -> dict:
    """Everything except the names of files, which depend on the folder of the configuration."""
    return found.model_dump(exclude={"sweep": {"__all__": {"file"}}, "tyre": {"base"}})


def written(found: config.Config, folder: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "resolved.toml"
    path.write_bytes(toml_text(config.resolved(found, folder)).encode())
    return path


def test_it_means_the_same_and_names_the_same_files(tmp_path):
    for text in (MINIMAL, COMPLETE):
        (tmp_path / "tyre.toml").write_text(text)
        found = config.load(tmp_path / "tyre.toml")
        for folder in (tmp_path / "out", tmp_path, tmp_path.parent / "elsewhere"):
            again = config.load(path := written(found, folder))
            assert path.read_text(encoding="utf-8").count("[[sweep]]\n") == len(found.sweep)
            assert settings(again) == settings(found)
            for sweep, original in zip(again.sweep, found.sweep, strict=True):
                assert (again.folder / sweep.file).resolve() == (tmp_path / original.file).resolve()


def test_resolving_twice_changes_nothing(tmp_path):
    (tmp_path / "tyre.toml").write_text(COMPLETE)
    found = config.load(tmp_path / "tyre.toml")
    path = written(found, tmp_path / "out")
    again = config.load(path)
    assert config.resolved(again, tmp_path / "out") == config.resolved(found, tmp_path / "out")


def test_folder_and_output_may_be_moved_together(tmp_path):
    here = tmp_path / "here"
    here.mkdir()
    (here / "tyre.toml").write_text(COMPLETE)
    written(config.load(here / "tyre.toml"), here / "out")
    shutil.move(here, tmp_path / "there")
    again = config.load(tmp_path / "there" / "out" / "resolved.toml")
    assert (again.folder / again.sweep[0].file).resolve() == tmp_path / "there" / "sideslip.csv"


def test_every_default_is_filled_in(tmp_path):
    (tmp_path / "tyre.toml").write_text(MINIMAL)
    content = config.resolved(config.load(tmp_path / "tyre.toml"), tmp_path)
    assert content["rig"]["u_slip_alignment_N"] == 25.0
    assert content["normal"] == {"weight": "everything"}
    assert content["model"] == {"turn_slip": True, "star": False, "u_coefficients": 0.0}
    assert content["sweep"][0] == {"file": "a.csv", "mount": "normal"}


def test_the_camber_of_the_normal_file_is_in_degrees(tmp_path):
    (tmp_path / "tyre.toml").write_text(MINIMAL + '\n[normal]\nweight = "road"\ncamber_max_deg = 30\n')
    found = config.load(tmp_path / "tyre.toml").normal
    assert (found.weight, found.camber_max) == ("road", pytest.approx(0.5235987755982988))
    (tmp_path / "tyre.toml").write_text(MINIMAL + "\n[normal]\ncamber_max_deg = 0.5\n")
    with pytest.raises(InputError, match="radians"):
        config.load(tmp_path / "tyre.toml")


@pytest.mark.parametrize(
    ("table", "u"),
    [
        ("{ value = 0.7, dof = 12 }", 0.7),
        ('{ value = 0.7, distribution = "rectangular" }', 0.7 / 3.0**0.5),
        ('{ value = 0.7, dof = 3, distribution = "triangular" }', 0.7 / 6.0**0.5),
    ],
)
def test_an_uncertainty_is_resolved_as_it_was_stated(tmp_path, table, u):
    text = MINIMAL.replace("[rig]", f"[rig]\nu_camber_alignment_deg = {table}")
    (tmp_path / "tyre.toml").write_text(text)
    found = config.load(tmp_path / "tyre.toml")
    assert found.rig.u("gamma_0_deg") == pytest.approx(u)
    again = config.load(written(found, tmp_path / "out"))
    assert vars(again.rig.u("gamma_0_deg")) == vars(found.rig.u("gamma_0_deg"))
    assert again.rig.u("gamma_0_deg") == found.rig.u("gamma_0_deg")


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ("{ dof = 3 }", "has no value"),
        ("{ value = 0.7, dof = 0 }", "dof below 1"),
        ("{ value = 0.7, distribution = 'round' }", "known are normal, rectangular, triangular"),
        ("{ value = 0.7, u = 3 }", 'unknown key "u"'),
        ("{ value = 70 }", "outside 0 to 20 deg"),
        ('{ value = "0.7" }', "number"),
    ],
)
def test_a_wrong_table_of_an_uncertainty_is_refused_with_what_is_allowed(tmp_path, table, said):
    (tmp_path / "tyre.toml").write_text(MINIMAL.replace("[rig]", f"[rig]\nu_camber_alignment_deg = {table}"))
    with pytest.raises(InputError, match=said) as error:
        config.load(tmp_path / "tyre.toml")
    assert error.value.line == 8

"""``mffit init`` writes a project that only lacks data."""

from __future__ import annotations

import re
import tomllib

import pytest

from mffit import config, sweeps
from mffit.config.problems import known_keys
from mffit.errors import InputError
from mffit.init_project import init_project


def test_the_configuration_is_valid_and_its_files_are_there(tmp_path):
    paths = init_project(tmp_path / "new")
    found = config.load(paths[0])
    assert paths[0].name == "tyre.toml"
    assert {sweep.file for sweep in found.sweep} == {path.name for path in paths[1:]}
    with pytest.raises(InputError, match="no data"):
        sweeps.load(found)


def test_its_commented_keys_are_valid_too(tmp_path):
    """Every key of the contract stands in the template, as itself or as a comment."""
    text = init_project(tmp_path / "new")[0].read_text()
    keys = {key for table, names in known_keys(config.Config).items() if table for key in names}
    shown = {key for key in keys if f"{key} =" in text or f"[{key}" in text or f".{key}]" in text}
    assert keys - shown == {"mount"}
    assignment = re.compile(r"# (?=\w+ = )")
    tomllib.loads("\n".join(assignment.sub("", line) for line in text.splitlines()))


def test_nothing_is_overwritten(tmp_path):
    (tmp_path / "camber.csv").write_text("mine")
    with pytest.raises(InputError, match="there already"):
        init_project(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["camber.csv"]


def test_a_file_is_no_folder(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="folder"):
        init_project(tmp_path / "file")

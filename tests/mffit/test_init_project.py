"""``mffit init`` writes a project that only lacks data."""

from __future__ import annotations

import re
import shlex
import tomllib
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from mffit import config, sweeps
from mffit.cli import projects
from mffit.config.problems import known_keys
from mffit.errors import InputError
from mffit.init_project import copy_sample, init_project, sample_names, to_fill_in

SAMPLES = Path(__file__).parents[2] / "samples"


def test_an_empty_project_is_refused_and_the_keys_to_fill_in_are_named(tmp_path):
    """No number of another tyre, and no sign convention, is in use before the user has written his own."""
    file = init_project(tmp_path / "new")[0]
    left = to_fill_in()
    assert "unloaded_radius" in left
    assert {"path_radius", "axes", "force_frame", "path_centre", "side"} < {*left}
    while left:
        with pytest.raises(InputError) as refused:
            config.load(file)
        assert left[0] in str(refused.value)
        filled_in(file, left.pop(0))
    with pytest.raises(InputError, match="no data"):
        sweeps.load(config.load(file))


def filled_in(file: Path, *keys: str) -> None:
    """Write the example of the template, or the first of the choices that its comment names."""
    text = file.read_text()
    for key in keys:
        text = re.sub(rf"^# (?={key} = .*# FILL IN)", "", text, flags=re.MULTILINE)
        text = re.sub(rf'^({key} = )""(.*# FILL IN.*?)("[^"]+")', r"\1\3\2\3", text, flags=re.MULTILINE)
    file.write_text(text)


def test_what_init_says_to_do_next(tmp_path):
    """What to fill in, or a command that a shell takes as it is printed."""
    empty = CliRunner().invoke(projects.init, [str(tmp_path / "new")]).output
    assert all(key in empty for key in to_fill_in())
    sample = CliRunner().invoke(projects.init, ["--sample", "flat-track", str(tmp_path / "a sample")]).output
    (line,) = sample.partition("Next:\n")[2].splitlines()
    program, command, file = shlex.split(line, comments=True)
    assert (program, command) == ("mffit", "build")
    assert config.load(file).tyre.name == "flat-track"


def test_the_configuration_is_valid_and_its_files_are_there(tmp_path):
    paths = init_project(tmp_path / "new")
    filled_in(paths[0], *to_fill_in())
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
    assert keys - shown == {"mount", "setup"}
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


@pytest.mark.parametrize("name", ["flat-track", "front-120-70", "rear-190-55"])
def test_a_sample_is_copied_byte_for_byte_and_loads(tmp_path, name):
    paths = copy_sample(name, tmp_path / "mine")
    assert paths[0] == tmp_path / "mine" / "tyre.toml"
    assert {path.name for path in paths} == {
        path.name for path in (SAMPLES / name).iterdir() if path.is_file()
    }
    assert all(path.read_bytes() == (SAMPLES / name / path.name).read_bytes() for path in paths)
    assert len(config.load(paths[0]).sweep) > 10
    assert sweeps.load(config.load(paths[0])).sweeps


def test_the_help_names_every_sample():
    help_text = "".join(
        projects.init.get_help(click.Context(projects.init)).split()
    )  # a name may be broken at a hyphen
    assert all(name in help_text for name in sample_names())


def test_an_unknown_sample_is_answered_with_those_there_are(tmp_path):
    with pytest.raises(
        InputError,
        match=r"no sample 'front'; choose one of flat-track, flat-track-combined, front-120-70, rear-190-55",
    ):
        copy_sample("front", tmp_path / "new")
    assert not (tmp_path / "new").exists()


def test_a_sample_overwrites_nothing(tmp_path):
    (tmp_path / "base.tir").write_text("mine")
    with pytest.raises(InputError, match="there already"):
        copy_sample("front-120-70", tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["base.tir"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--from", "a.csv", "--sample", "front-120-70", "new"], "exclude each other"),
        (["--sample", "front-120-70", "one", "two"], "one folder only"),
    ],
)
def test_a_sample_goes_into_one_folder_and_with_nothing_else(arguments, message):
    found = CliRunner().invoke(projects.init, arguments)
    assert isinstance(found.exception, InputError)
    assert message in str(found.exception)

"""What `mffit check` calls an error, every command that uses the file says."""

from __future__ import annotations

import pytest
import small_rigs

import tir
from mffit.cli import main
from mffit.conversion import to_old

COMMANDS = (["export", "c"], ["export", "matlab"], ["show"], ["compare"])


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(("change", "said"), [({"FNOMIN": -1400.0}, "FNOMIN is -1400"), ({}, "")])
def test_a_command_that_uses_a_faulty_file_says_its_error(tmp_path, capsys, command, change, said):
    file = tmp_path / "tyre.tir"
    small_rigs.truth().write(file)
    text = file.read_text()
    for key, value in change.items():
        old = next(line for line in text.splitlines() if line.split("=")[0].strip() == key)
        text = text.replace(old, f"{key} = {value}")
    file.write_text(text)
    assert any(p.level == "error" for p in tir.check(tir.read(file))) == bool(said)
    second = [str(file)] if command == ["compare"] else []
    out = tmp_path / ("page.html" if command == ["show"] else "out")
    main([*command, str(file), *second, "--out", str(out)])
    stderr = capsys.readouterr().err
    assert (said in stderr) if said else "warning: " + str(file) not in stderr


@pytest.mark.parametrize("to", [None, "mf52"])
def test_a_conversion_of_a_faulty_file_says_its_error_and_is_not_trusted(tmp_path, capsys, to):
    """The error of the file, that of `mffit check` and that of Python are one sentence."""
    file, out = tmp_path / "tyre.tir", tmp_path / "out.tir"
    small_rigs.truth().write(file)
    if to is None:
        file.write_text(to_old(file, "mf52").text)
    text = file.read_text()
    old = next(line for line in text.splitlines() if line.split("=")[0].strip() == "KPUMIN")
    file.write_text(text.replace(old, "KPUMIN = 2.0"))
    with pytest.raises(SystemExit) as ended:
        main(["convert", str(file), "--out", str(out), *(["--to", to] if to else [])])
    assert ended.value.code == 3
    assert "KPUMIN 2 is not below KPUMAX" in " ".join(capsys.readouterr().out.split())
    if to:
        (error,) = {
            p.sentence for p in tir.read(file).problems if p.level == "error" and "KPUMAX" in p.sentence
        }
        with pytest.raises(SystemExit):
            main(["check", str(file)])
        assert f"error: {error}" in capsys.readouterr().out


def test_problems_of_a_tyre_are_those_of_the_check_and_of_the_reading(tmp_path):
    file = tmp_path / "tyre.tir"
    small_rigs.truth().replace(PCY1=-1.0).write(file)
    lines = [line for line in file.read_text().splitlines() if line.split("=")[0].strip() != "QSY8"]
    file.write_text("\n".join([*lines, ""]))
    tyre = tir.read(file)
    assert tyre.problems == tuple(tir.check(tyre))
    levels = [p.level for p in tyre.problems]
    assert levels == sorted(levels)
    said = " ".join(p.sentence for p in tyre.problems)
    assert "the shape factor must be positive" in said
    assert "QSY8" in said

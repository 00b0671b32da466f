"""What `mffit check` calls an error, every command that uses the file says."""

from __future__ import annotations

import pytest
import small_rigs

import tir
from mffit.cli import main

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

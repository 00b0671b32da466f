"""The number of the method changes whenever a figure of a fixed project changes, and a number keeps its figures."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import method_figures
import pytest
from method_figures import MISSING, PROJECTS, REGISTER, compared, digest, figures, register, store, stored

from mffit import made

STORE = "store the new figures with `python tests/mffit/method_figures.py --raise`"


@pytest.mark.parametrize("project", PROJECTS)
def test_figures_are_those_of_the_method(project):
    """A change below a thousandth of the standard uncertainty is rounding."""
    before = stored()
    found = list(compared(before["figures"].get(project, {}), figures(project)))
    changes = [row for row in found if row.size > 1.0]
    worst = "; ".join(f"{row.key} {row.old} -> {row.new}" for row in changes[:5])
    assert not changes, (
        f"{len(changes)} of {len(found)} figures of {project} differ from those of method {before['method']}: {worst}. "
        f"If the change is meant, {STORE}"
    )
    assert len(found) > 200


def test_the_register_states_the_stored_figures_of_every_method_once():
    lines, before = register(REGISTER.read_text(encoding="utf-8")), stored()
    numbers = [number for number, _ in lines]
    assert numbers == sorted(set(numbers))
    assert lines[-1] == (made.METHOD, digest(before["figures"])), (
        f"the figures are not stored by the script: {STORE}"
    )
    assert before["method"] == made.METHOD


def test_no_line_of_the_register_was_changed_since_it_was_written():
    """By the history of the main line, in which figures of one number were perhaps stored twice."""
    history = ["git", "log", "--first-parent", "-m", "-p", "--format=", "--no-renames", "--", REGISTER.name]
    git = shutil.which("git")
    known = git and subprocess.run(history, cwd=REGISTER.parent, capture_output=True, text=True, check=False)
    if not known or known.returncode:
        pytest.skip("no history here; .ci/run looks at that of its checkout")
    said = set(re.findall(r"^\+(\d+,\w+)$", known.stdout, re.MULTILINE))
    lost = said - set(REGISTER.read_text(encoding="utf-8").split())
    assert not lost, (
        f"figures of a number of the method were stored again: {sorted(lost)}; restore them, and {STORE}"
    )


@pytest.fixture
def elsewhere(tmp_path, monkeypatch):
    """Copies of the stored figures, of the register and of the module with the number."""
    for name in ("STORED", "REGISTER"):
        copy = Path(shutil.copy(getattr(method_figures, name), tmp_path))
        monkeypatch.setattr(method_figures, name, copy)
    return Path(shutil.copy(made.__file__, tmp_path))


def test_moved_figures_are_stored_under_a_new_number_only(elsewhere):
    files = {path: path.read_text() for path in elsewhere.parent.iterdir()}
    found, number = stored()["figures"], made.METHOD
    assert "no figure moved" in store(found, raised=True, program=elsewhere)
    found["front-120-70"]["spin"]["u_C_alpha_N_per_rad"] *= 1.4
    with pytest.raises(SystemExit, match="1 figures moved"):
        store(found, raised=False, program=elsewhere)
    assert files == {path: path.read_text() for path in elsewhere.parent.iterdir()}
    store(found, raised=True, program=elsewhere)
    assert f"\nMETHOD = {number + 1}\n" in elsewhere.read_text()
    assert stored() == {"method": number + 1, "figures": found}
    lines = register(method_figures.REGISTER.read_text())
    assert lines == [*register(files[method_figures.REGISTER]), (number + 1, digest(found))]


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ({"a": 1.0}, {"a": 1.0 + 1e-9, "b": 2.0}, None),
        ({"a": 1.0}, {"a": 1.0 + 3e-5}, "a"),
        ({"dof": 1465.99479}, {"dof": 1465.99295}, None),
        ({"a": 1.0, "u_a": 0.1}, {"a": 1.0 + 1e-5, "u_a": 0.1}, None),
        ({"a": {"value": 1.0, "stderr": 0.1}}, {"a": {"value": 1.00001, "stderr": 0.1}}, None),
        ({"a": {"value": 1.0, "stderr": 0.1}}, {"a": {"value": 1.001, "stderr": 0.1}}, "a.value"),
        ({"a": {"value": 1.0, "stderr": None}}, {"a": {"value": 1.0, "stderr": 0.1}}, "a.stderr"),
        ({"a": [1.0, 2.0]}, {"a": [1.0]}, "a, length"),
        ({"a": [{"b": 2.0}]}, {"a": [{"b": 3.0}]}, "a[0].b"),
        ({"a": 1.0}, {}, "a"),
        ({"a": None}, {"a": 0.0}, "a"),
        ({"a": True}, {"a": False}, "a"),
        ({"a": "x"}, {"a": "y"}, None),
    ],
)  # fmt: skip
def test_a_number_comes_out_again_if_no_stated_digit_changes(old, new, key):
    found = list(compared(old, new))
    assert [row.key for row in found if row.size > 1.0] == ([] if key is None else [key])
    if key == "a" and new == {}:
        assert found[0].new == MISSING

"""The number of the method changes whenever a figure of a fixed project changes."""

from __future__ import annotations

import pytest
from method_figures import PROJECTS, figures, stored
from same_numbers import MISSING, compared

from mffit.made import METHOD

STORE = "store the new figures with `python tests/mffit/method_figures.py`"


@pytest.mark.parametrize("project", PROJECTS)
def test_figures_are_those_of_the_method(project):
    """A change below a thousandth of the standard uncertainty is rounding; see ``same_numbers.py``."""
    before = stored()
    assert before["method"] == METHOD, (
        f"METHOD is {METHOD}, the stored figures are of {before['method']}: {STORE}"
    )
    found = compared(project, before["figures"][project], figures(project))
    changes = [row for row in found if row.size > 1.0]
    worst = "; ".join(f"{row.key} {row.old} -> {row.new}" for row in changes[:5])
    assert not changes, (
        f"{len(changes)} of {len(found)} figures of {project} differ from those of method {METHOD}: {worst}. If the "
        f"change is meant, raise METHOD in mffit/made.py (once per release) and {STORE}"
    )
    assert len(found) > 200


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
        ({"c": [[4.0, 1e-9], [1e-9, 9.0]]}, {"c": [[4.0, 2e-9], [2e-9, 9.0]]}, None),
        ({"c": [[4.0, 0.01], [0.01, 9.0]]}, {"c": [[4.0, 0.02], [0.01, 9.0]]}, "c[0][1]"),
        ({"fit": {"seconds": 1.0}, "made": {"method": 1}}, {"fit": {"seconds": 2.0}, "made": {"method": 2}}, None),
    ],
)  # fmt: skip
def test_a_number_comes_out_again_if_no_stated_digit_changes(old, new, key):
    found = compared("result.json", old, new)
    assert [row.key for row in found if row.size > 1.0] == ([] if key is None else [key])
    if key == "a" and new == {}:
        assert found[0].new == MISSING

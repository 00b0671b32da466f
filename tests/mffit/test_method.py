"""The number of the method changes whenever a figure of a fixed project changes."""

from __future__ import annotations

import pytest
from method_figures import PROJECTS, figures, stored

from mffit.made import METHOD
from mffit.results.verification import compared

STORE = "store the new figures with `python tests/mffit/method_figures.py`"


@pytest.mark.parametrize("project", PROJECTS)
def test_figures_are_those_of_the_method(project):
    """A change below a thousandth of the standard uncertainty is rounding; see ``mffit/results/constants.py``."""
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

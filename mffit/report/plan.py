"""The page of a plan: plots and plan.html."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from mffit.planning import Plan, wording
from mffit.quantities import DIRECT
from mffit.report import page

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHOWN = 15
"""Candidates listed at most."""


def write_plan(plan: Plan, folder: Path) -> None:
    """Write the pictures and ``plan.html`` of a plan.

    Parameters
    ----------
    plan : the record
    folder : existing folder to write to
    """
    from mffit.report.figures import planned

    figures: dict[str, Callable[[], Figure]] = {}
    if plan.steps:
        figures["plan"] = partial(planned.u_against_runs, plan)
    page.render(
        "plan.html.j2",
        folder / "plan.html",
        plan=plan,
        say=wording,
        epsilon=DIRECT["epsilon_gamma"].html,
        trials=plan.trials[:SHOWN],
        pictures=page.draw(folder, figures),
    )

"""The page of a plan: plots/plan.png and plan.html."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from mffit.planning import Plan, wording
from mffit.quantities import DIRECT
from mffit.report import constants, page
from mffit.report.figures import planned


def write_plan(plan: Plan, folder: Path) -> None:
    """Write the picture and ``plan.html`` of a plan to an existing folder."""
    page.write(
        "plan.html.j2",
        folder / "plan.html",
        {"plan": partial(planned.u_against_runs, plan)} if plan.steps else {},
        plan=plan,
        say=wording,
        epsilon=DIRECT["epsilon_gamma"].html,
        trials=plan.trials[: constants.MOST_CANDIDATE_RUNS_IN_PAGE],
    )

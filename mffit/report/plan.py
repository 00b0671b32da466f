"""The page of a plan: plots/plan.png and plan.html."""

from __future__ import annotations

from pathlib import Path

from mffit.planning import Plan, wording
from mffit.quantities import DIRECT
from mffit.report import constants, page
from mffit.report.catalogue import Picture
from mffit.report.figures import planned

PLAN: Picture[Plan] = Picture(
    name="plan",
    title="Uncertainty of the goal now and after every run of the list",
    shows="What the plan makes smaller, now and after each added run; an uncertainty is one standard deviation.",
    draw=planned.u_against_runs,
    when=lambda plan: bool(plan.steps),
)


def write_plan(plan: Plan, folder: Path) -> None:
    """Write the picture and ``plan.html`` of a plan to an existing folder."""
    page.write(
        "plan.html.j2",
        folder / "plan.html",
        PLAN.planned(plan),
        plan=plan,
        say=wording,
        epsilon=DIRECT["epsilon_gamma"].html,
        trials=plan.trials[: constants.MOST_ROWS],
    )

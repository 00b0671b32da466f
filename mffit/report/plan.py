"""The page of a plan: plots/plan.png and plan.html."""

import math
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from mffit.planning import Plan, wording
from mffit.quantities import DIRECT
from mffit.report import page, style
from mffit.report.drawing.records import NOTHING, Axis, Bars, Note, Panel, Sheet, listed


def u_against_runs(plan: Plan) -> Sheet:
    """A bar from zero for the uncertainty now and after every run of the list, with what was added."""
    if not plan.steps:
        return NOTHING
    values = [plan.now, *(step.after for step in plan.steps)]
    names = ["now", *(f"+ {step.run.name}" for step in plan.steps)]
    known = [(k, u) for k, u in enumerate(values) if math.isfinite(u)]
    lengths = np.where(np.isfinite(values), values, np.nan)
    epsilon = DIRECT["epsilon_gamma"]
    unit = "" if plan.goal.unit in ("", "-") else f" [{plan.goal.unit}]"
    panel = Panel(
        title="",
        x=Axis(
            label=f"{plan.goal.label}{unit}".replace(epsilon.ascii, epsilon.mathtext),
            low=0.0,
            high=1.3 * max(u for _, u in known),
        ),
        y=listed(names),
        series=[
            Bars(
                name=plan.goal.label,
                lengths=lengths,
                colours=[style.ACCENT if k else style.FAINT for k in range(len(values))],
            )
        ],
        notes=[Note(x=u, y=k, text=wording.shown(plan, u)) for k, u in known],
    )
    return Sheet(rows=[[panel]], height=0.28 * len(values) + 0.1)


PLAN: Mapping[str, Callable[[Plan], Sheet]] = {"plan": u_against_runs}
"""The picture of the page."""


def write_plan(plan: Plan, folder: Path) -> None:
    """Write the picture and ``plan.html`` of a plan to an existing folder."""
    page.write(
        "plan.html.j2",
        folder / "plan.html",
        PLAN,
        plan,
        say=wording,
    )

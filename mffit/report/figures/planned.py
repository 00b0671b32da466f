"""The uncertainty of a plan's goal against the number of added runs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mffit.planning import Plan, wording
from mffit.quantities import DIRECT
from mffit.report import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def u_against_runs(plan: Plan) -> Figure:
    """u now and after every run of the list, from zero, each point with what was added."""
    values = [plan.now, *(step.after for step in plan.steps)]
    names = ["now", *(f"+ {step.run.name}" for step in plan.steps)]
    height = 0.28 * len(values) + 0.1
    figure, rows = style.panel_grid([1], 1, height=height, legend=False, margins=(2.4, 0.60))
    ax = rows[0][0]
    known = [(k, u) for k, u in enumerate(values) if math.isfinite(u)]
    bars = ax.barh([k for k, _ in known], [u for _, u in known], height=0.6, color=style.ACCENT)
    if known and known[0][0] == 0:
        bars[0].set_color(style.FAINT)
    for k, u in known:
        ax.annotate(wording.shown(plan, u), (u, k), (3, 0), textcoords="offset points", va="center")
    if plan.told_below is not None:
        ax.axvline(plan.told_below, color=style.CONTRAST, lw=1.0, ls="--")
        ax.set_title("dashed: separated below", loc="right", color=style.CONTRAST)
    ax.set_xlim(0.0, 1.08 * max(u for _, u in known))
    ax.set_ylim(len(values) - 0.4, -0.6)
    ax.set_yticks(range(len(values)), names)
    ax.grid(axis="y", visible=False)
    epsilon = DIRECT["epsilon_gamma"]
    unit = "" if plan.goal.unit in ("", "-") else f" [{plan.goal.unit}]"
    ax.set_xlabel(f"{plan.goal.label}{unit}".replace(epsilon.ascii, epsilon.mathtext), labelpad=1.5)
    return figure

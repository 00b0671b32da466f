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
    figure, rows = style.panel_grid([1], 1, height=2.6, legend=False, margins=(0.85, 0.30))
    ax = rows[0][0]
    values = [plan.now, *(step.after for step in plan.steps)]
    names = ["now", *(f"+ {step.run.name}" for step in plan.steps)]
    known = [(k, u) for k, u in enumerate(values) if math.isfinite(u)]
    bars = ax.bar([k for k, _ in known], [u for _, u in known], width=0.5, color=style.ACCENT)
    if known and known[0][0] == 0:
        bars[0].set_color(style.FAINT)
    top = max(u for _, u in known)
    for k, u in known:
        ax.annotate(wording.shown(plan, u), (k, u), (0, 3), textcoords="offset points", ha="center")
    if plan.told_below is not None:
        ax.axhline(plan.told_below, color=style.CONTRAST, lw=1.0, ls="--")
        ax.annotate(
            "told apart below",
            (len(values) - 0.6, plan.told_below),
            (0, 3),
            textcoords="offset points",
            ha="right",
        )
    ax.set_ylim(0.0, 1.18 * top)
    ax.set_xlim(-0.6, len(values) - 0.4)
    ax.set_xticks(range(len(values)), names)
    ax.grid(axis="x", visible=False)
    epsilon = DIRECT["epsilon_gamma"]
    unit = "" if plan.goal.unit in ("", "-") else f" [{plan.goal.unit}]"
    ax.set_ylabel(f"{plan.goal.label}{unit}".replace(epsilon.ascii, epsilon.mathtext))
    return figure

"""The camber reduction factor: among published tyres, its budget, its course over load; alignment."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mffit.measured import Measured
from mffit.points import main_path
from mffit.quantities import CHANNELS
from mffit.report import labels, style
from mffit.report.build_view import BuildView
from mffit.report.curves import Curve
from mffit.report.published import TYRES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_SOURCES = 8


def camber_reduction(view: BuildView) -> Figure:
    """Three panels: eps_gamma among published tyres, budget of its uncertainty, eps_gamma over load."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(style.WIDTH, 3.1))
    axes = [
        figure.add_axes((left, 0.155, wide, 0.735))
        for left, wide in ((0.115, 0.200), (0.490, 0.195), (0.755, 0.235))
    ]
    _among_published(axes[0], view.config.tyre.name, view.measured)
    _budget(axes[1], view.measured)
    _over_load(axes[2], view)
    return figure


def _among_published(ax: Axes, name: str, measured: Measured) -> None:
    rows = [(t.name, t.epsilon_gamma, t.u, style.MUTED) for t in TYRES]
    if measured.epsilon_gamma is not None:
        rows.append((shortened(name), measured.epsilon_gamma.value, measured.epsilon_gamma.u, style.ACCENT))
    ax.axvline(0.0, color=style.FAINT, lw=0.8)
    for i, (_, value, u, colour) in enumerate(reversed(rows)):
        own = colour == style.ACCENT
        ax.errorbar(
            value,
            i,
            xerr=u,
            fmt="o",
            ms=6 if own else 4,
            color=colour,
            elinewidth=2.2 if own else 1.2,
            capsize=3,
        )
    ax.set_yticks(range(len(rows)), [r[0] for r in reversed(rows)])
    ax.get_yticklabels()[0].set(color=style.ACCENT, fontweight="bold")
    ax.set_ylim(-0.6, len(rows) - 0.4)
    ax.grid(axis="y", visible=False)
    ax.set_xlabel(f"{labels.EPSILON.axis}, ± 1 u")
    ax.set_title("This tyre among published ones")


def shortened(name: str, longest: int = 18) -> str:
    """A name that fits beside a panel."""
    return name if len(name) <= longest else f"{name[: longest - 1]}…"


def _budget(ax: Axes, measured: Measured) -> None:
    rows = sorted(measured.budget, key=lambda line: -abs(line.contribution))[:MOST_SOURCES]
    width = [abs(line.contribution) for line in rows][::-1]
    names = [line.source for line in rows][::-1]
    ax.barh(range(len(rows)), width, height=0.62, color=style.ACCENT)
    total = measured.epsilon_gamma.u if measured.epsilon_gamma is not None else 0.0
    ax.axvline(total, color=style.CONTRAST, lw=1.4)
    ax.annotate(
        f" total {total:.3f}", (total, -0.35), color=style.CONTRAST, ha="right", va="center", rotation=90,
        fontsize=7.5, xytext=(-2, 24), textcoords="offset points",
    )  # fmt: skip
    ax.set_yticks(range(len(rows)), names)
    ax.set_xlim(0.0, 1.12 * max([total, *width]))
    ax.grid(axis="y", visible=False)
    ax.set_xlabel(f"contribution to u({labels.EPSILON.mathtext}) [–]")
    ax.set_title("What its uncertainty consists of")


def _over_load(ax: Axes, view: BuildView) -> None:
    measured = view.measured
    found = [(row.load, row.epsilon_gamma) for row in measured.per_load if row.epsilon_gamma is not None]
    load, value, u = np.array([(load, epsilon.value, epsilon.u) for load, epsilon in found]).T
    ax.axhline(0.0, color=style.FAINT, lw=0.8)
    ax.errorbar(load, value, u, fmt="o", ms=4.5, color=style.ACCENT, capsize=3, label="measured")
    nominal = view.config.tyre.nominal_load
    over = np.linspace(min(load.min(), nominal), max(load.max(), nominal), 20)
    if measured.pecp1 is not None:
        line = measured.pecp1 * (1.0 + measured.pecp2 * (over - nominal) / nominal)
        ax.plot(over, line, color=style.INK, lw=1.2, label="PECP1, PECP2 of the file")
    ax.margins(x=0.08)
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + 0.3 * (high - low))  # room for the legend
    ax.legend(loc="upper left", borderaxespad=0.0, handlelength=1.4)
    ax.set_xlabel(labels.LOAD.axis)
    ax.set_ylabel(f"{labels.EPSILON.short_axis}, ± 1 u")
    ax.set_title("Over the load")


def alignment(view: BuildView) -> Figure:
    """Side force rolling both ways around zero; where the lines cross, the slip force vanishes."""
    from matplotlib.lines import Line2D

    both = both_directions(view)
    figure, rows = style.panel_grid([len(both)], len(both), height=1.7)
    for ax, (load, members) in zip(rows[0], both, strict=True):
        for curve in members:
            colour = style.ACCENT if curve.forward else style.CONTRAST
            x = np.degrees(view.points.alpha[curve.index])
            near = np.abs(x) < 1.6
            ax.plot(
                x[near], view.points.Fy[curve.index][near], "-" if curve.forward else "--",
                marker="o" if curve.forward else "v", mfc=colour if curve.forward else "white", color=colour,
            )  # fmt: skip
        ax.axvline(0.0, color=style.FAINT, lw=0.8)
        ax.set_title(labels.LOAD.of(load))
        ax.set_xlabel(labels.ANGLES["alpha"].axis, labelpad=1.5)
        style.few_ticks(ax)
    style.label_left(rows, CHANNELS["Fy"].short_axis)
    handles = [
        Line2D([], [], marker="o", color=style.ACCENT, label="rolling forwards"),
        Line2D([], [], ls="--", marker="v", mfc="white", color=style.CONTRAST, label="rolling backwards"),
    ]
    style.legend_above(figure, handles)
    return figure


def both_directions(view: BuildView) -> list[tuple[float, list[Curve]]]:
    """By load the upright sideslip curves of the usual path that cross zero, where both directions were run."""
    usual = [c for c in view.curves if view.points.phi_t[c.index[0]] == main_path(view.points)]
    upright = [c for c in usual if c.over == "alpha" and abs(c.held) < 0.5 and c.mount > 0]
    backward = {(c.load, c.pressure) for c in upright if not c.forward}
    loads = sorted({load for load, _ in backward})[:4]
    return [
        (load, [c for c in upright if c.load == load and (load, c.pressure) in backward]) for load in loads
    ]

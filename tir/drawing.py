"""Pictures of a tyre; matplotlib is imported on first use."""

from __future__ import annotations

import base64
import html
import io
import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tir import constants
from tir.errors import TirError
from tir.tyre import Tyre

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Figure

WIDEST = {
    "alpha": constants.USUAL_SIDESLIP.rad,
    "kappa": math.tan(constants.USUAL_SIDESLIP.rad),
    "gamma": constants.LARGEST_CAMBER.rad,
}
LOADS = (constants.IN_USE[0], 1.0, constants.IN_USE[1])
"""Loads of the curves over the nominal one."""
KEYS = {"alpha": ("ALPMIN", "ALPMAX"), "kappa": ("KPUMIN", "KPUMAX"), "gamma": ("CAMMIN", "CAMMAX")}
PANELS = (("alpha", "Fy"), ("alpha", "Mz"), ("kappa", "Fx"), ("gamma", "Fy"))
LABELS = {
    "alpha": r"$\alpha$ [deg]", "gamma": r"$\gamma$ [deg]", "kappa": r"$\kappa$ [–]",
    "Fx": "$F_x$ [N]", "Fy": "$F_y$ [N]", "Mz": "$M_z$ [Nm]",
}  # fmt: skip
ANGLES = ("alpha", "gamma")


def plot(
    tyre: Tyre,
    *,
    loads: Iterable[float] | None = None,
    turn_slip: bool | None = None,
    panels: Sequence[tuple[str, str]] = PANELS,
) -> Figure:
    """See :meth:`tir.Tyre.plot`; ``panels`` are pairs of an input and an output."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise TirError("drawing needs matplotlib, which is not installed: pip install matplotlib") from None
    at = [share * float(tyre["FNOMIN"]) for share in LOADS] if loads is None else [float(x) for x in loads]
    rows = math.ceil(len(panels) / 2)
    figure = Figure(figsize=(8.4, 2.7 * rows), layout="constrained")
    for ax, (x, y) in zip(figure.subplots(rows, 2, squeeze=False).flat, panels, strict=True):
        given = np.linspace(*_reach(tyre, x), constants.POINTS_PER_CURVE)
        inputs: dict[str, Any] = {x: given}
        for i, Fz in enumerate(at):
            forces = tyre(Fz, **inputs, turn_slip=turn_slip)
            shown = np.degrees(given) if x in ANGLES else given
            ax.plot(shown, getattr(forces, y), color=_shade(i, len(at)), label=f"{Fz:.0f} N")
        ax.set(xlabel=LABELS[x], ylabel=LABELS[y])
        ax.grid(alpha=0.3)
        ax.spines[["top", "right"]].set_visible(False)
    figure.legend(
        *figure.axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=6, frameon=False
    )
    return figure


def notebook(tyre: Tyre) -> str:
    """HTML for a notebook: the lines of the repr, and a small picture if matplotlib is installed."""
    said = "".join(f"<div>{html.escape(line)}</div>" for line in repr(tyre).strip("<>").splitlines())
    try:
        figure = plot(tyre, panels=PANELS[:2])
    except TirError as error:  # without matplotlib, or for a file that can be read but not evaluated
        return f"{said}<div>{html.escape(str(error))}</div>"
    figure.set_size_inches(7.0, 2.4)
    stream = io.BytesIO()
    figure.savefig(stream, format="png", facecolor="white")
    data = base64.b64encode(stream.getvalue()).decode("ascii")
    return f'{said}<img alt="side force and aligning moment over sideslip at three loads" src="data:image/png;base64,{data}">'


def _reach(tyre: Tyre, name: str) -> tuple[float, float]:
    """First and last drawn value of an input [SI]."""
    widest = WIDEST[name]
    low, high = (min(max(float(tyre[key]), -widest), widest) for key in KEYS[name])
    return (low, high) if low < high else (-widest, widest)


def _shade(i: int, n: int) -> Any:
    """Colour of curve i of n, dark to light."""
    import matplotlib

    return matplotlib.colormaps["viridis"](0.8 * i / max(n - 1, 1))

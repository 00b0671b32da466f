"""Driving, braking and combined slip: the friction ellipse."""

from collections.abc import Sequence

import numpy as np

from mffit.constants import STEPS_OF_LINE, UPRIGHT
from mffit.quantities import CHANNELS
from mffit.report import labels, style
from mffit.report.build_view import BuildView
from mffit.report.curves import Curve
from mffit.report.drawing.records import NOTHING, ZERO, Axis, Guide, Look, Panel, Sheet, Trace, in_rows
from mffit.report.figures.fit import MODEL as LINE
from mffit.report.figures.fit import READINGS, held_key

EDGE = Look(colour=style.INK, line="-", width=1.1)
EDGE_NAME = "limit of the model"
ZEROS = (Guide(axis="x", at=0.0), ZERO)


def friction_ellipse(view: BuildView) -> Sheet:
    """Fx over Fy at each load, sideslip as parameter, at nearly nominal pressure; points less the errors of the rig."""
    upright = [c for c in view.curves if c.over == "kappa" and c.forward and abs(c.camber) < UPRIGHT]
    members = view.nearest(upright, "pressure")
    both = {"Fx", "Fy"} <= {channel.name for channel in view.channels}
    if not both or all(abs(c.held) < UPRIGHT for c in members):
        return NOTHING
    colours = style.ramp({curve.held for curve in members})
    loads = sorted({curve.load for curve in members})
    panels = [_ellipse(view, load, [c for c in members if c.load == load], colours) for load in loads]
    key = {"measured": READINGS, "model": LINE, EDGE_NAME: EDGE, **held_key("alpha", colours)}
    return Sheet(rows=in_rows(panels, columns=3), height=2.6, key=key)


def _ellipse(view: BuildView, load: float, members: Sequence[Curve], colours: dict[float, str]) -> Panel:
    Fx, Fy = (view.felt.channel(name) for name in ("Fx", "Fy"))
    slip = np.linspace(*_ends(view.points.kappa), STEPS_OF_LINE)
    series = []
    for curve in members:
        name, alpha = labels.held(curve), np.full_like(slip, np.median(view.felt.alpha[curve.index]))
        look = Look(colour=colours[curve.held], line="-", width=1.0)
        x, y = _forces(view, curve, slip, alpha)
        series.append(Trace(name=f"model, {name}", x=y, y=x, look=look))
        dots = Look(colour=colours[curve.held], marker=".", size=1.6)
        series.append(Trace(name=f"measured, {name}", x=Fy[curve.index], y=Fx[curve.index], look=dots))
    series.append(friction_limit(view, members[0]))
    end = 1.05 * max(float(np.nanmax(np.abs(part))) for s in series for part in (s.x, s.y))
    return Panel(
        title=labels.LOAD.of(load),
        x=Axis(label=CHANNELS["Fy"].axis, low=-end, high=end),
        y=Axis(label=CHANNELS["Fx"].axis, low=-end, high=end),
        series=series,
        guides=ZEROS,
    )


def friction_limit(view: BuildView, curve: Curve) -> Trace:
    """The largest force of the model in every direction, once around, within the slip and sideslip that were run together."""
    steps = int(STEPS_OF_LINE)
    run = view.felt.alpha[~view.points.free_rolling]
    grids = np.meshgrid(np.linspace(*_ends(view.points.kappa), steps), np.linspace(*_ends(run), steps))
    force = np.column_stack(_forces(view, curve, *(grid.ravel() for grid in grids)))
    turn = np.linspace(0.0, 2.0 * np.pi, 4 * (steps // 2) + 1)
    # Directions are of forces over their peaks, so that the sides of a flat ellipse are seen as well as its ends.
    way = np.column_stack([np.cos(turn), np.sin(turn)]) / np.max(np.abs(force), axis=0)
    Fx, Fy = force[np.argmax(force @ way.T, axis=0)].T
    return Trace(name=EDGE_NAME, x=Fy, y=Fx, look=EDGE)


def _ends(values: np.ndarray) -> tuple[float, float]:
    """Ends of a tested range, which some rigs run to one side of zero only."""
    return min(0.0, float(values.min())), max(0.0, float(values.max()))


def _forces(
    view: BuildView, curve: Curve, kappa: np.ndarray, alpha: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Fx and Fy (m,) of the upright model at the load, pressure and speed of a curve."""
    at, tyre = view.felt.select(curve.index), view.build.fit.tyre
    forces = tyre(
        float(np.median(at.Fz)),
        alpha=alpha,
        kappa=kappa,
        Vx=float(np.median(at.Vx)),
        p=float(np.median(at.p)),
        turn_slip=view.on_disc,
    )
    return forces.Fx, forces.Fy

"""Driving, braking and combined slip: the friction ellipse."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from mffit.constants import STRAIGHT, UPRIGHT
from mffit.points import Points
from mffit.quantities import CHANNELS
from mffit.report import constants, labels, style
from mffit.report.build_view import BuildView
from mffit.report.curves import Curve
from mffit.report.drawing.records import ZERO, Axis, Guide, Look, Panel, Sheet, Trace, in_rows
from mffit.report.figures.fit import MODEL as LINE
from mffit.report.figures.fit import READINGS, SLIP, held_key, varied
from mffit.report.with_band import with_band
from tir.outputs import outputs_of

EDGE = Look(colour=style.INK, line="-", width=1.1)
BEYOND = Look(colour=style.INK, line=":", width=1.1)
EDGE_NAME = "limit of the model"
EDGE_NAME_RUN = "limit as tested"
ZEROS = (Guide(axis="x", at=0.0), ZERO)


def main_slip_curves(view: BuildView) -> dict[float, list[Curve]]:
    """By load, the forward curves over slip of the upright wheel at the pressure nearest to the nominal one."""
    upright = [c for c in varied(view.curves, SLIP) if c.forward and abs(c.camber) < UPRIGHT]
    nominal = view.config.tyre.nominal_pressure
    nearest = min((c.pressure for c in upright), key=lambda p: abs(p - nominal), default=0.0)
    found: dict[float, list[Curve]] = {}
    for curve in upright:
        if curve.pressure == nearest:
            found.setdefault(curve.load, []).append(curve)
    return found


def combined(view: BuildView) -> bool:
    """Whether both forces were measured at slip with sideslip of the upright wheel."""
    members = [c for curves in main_slip_curves(view).values() for c in curves]
    both = {"Fx", "Fy"} <= {channel.name for channel in view.channels}
    return both and any(abs(c.held) >= UPRIGHT for c in members)


def slip_range(view: BuildView) -> tuple[float, float]:
    """Ends of the tested longitudinal slip."""
    kappa = view.points.kappa
    return min(0.0, float(kappa.min())), max(0.0, float(kappa.max()))


def sideslip_range(view: BuildView) -> tuple[float, float]:
    """Ends of the tested sideslip [rad], which was run to one side only on some rigs."""
    alpha = view.felt.alpha
    return min(0.0, float(alpha.min())), max(0.0, float(alpha.max()))


def _beyond_combined(view: BuildView, alpha: np.ndarray) -> np.ndarray:
    """Mask (m,) of the sideslips [rad] that are larger than any at which longitudinal slip was run, to the same side."""
    run = view.felt.alpha[~view.points.free_rolling]
    room = STRAIGHT.rad
    beyond: np.ndarray = (alpha < np.min(run, initial=0.0) - room) | (alpha > np.max(run, initial=0.0) + room)
    return beyond


def friction_ellipse(view: BuildView) -> Sheet:
    """Fx over Fy at each load, sideslip as parameter; points less the errors of the rig, and the tyre with its bands."""
    groups = main_slip_curves(view)
    colours = style.ramp({curve.held for members in groups.values() for curve in members})
    panels = [_ellipse(view, load, members, colours) for load, members in sorted(groups.items())]
    edges = (EDGE_NAME, EDGE_NAME_RUN)
    drawn = {s.name: s.look for p in panels for s in p.series if isinstance(s, Trace) and s.name in edges}
    key = {"measured": READINGS, "model": LINE, **drawn, **held_key("alpha", colours)}
    return Sheet(rows=in_rows(panels, columns=3), height=2.6, key=key)


def _ellipse(view: BuildView, load: float, members: Sequence[Curve], colours: dict[float, str]) -> Panel:
    Fx, Fy = (view.felt.channel(name) for name in ("Fx", "Fy"))
    series = []
    slip = np.linspace(*slip_range(view), constants.STEPS_OF_LINE)
    for curve in members:
        look = Look(colour=colours[curve.held], line="-", width=1.0)
        name = labels.held(curve)
        alpha = float(np.median(view.felt.alpha[curve.index]))
        series.append(_path(view, curve, slip, np.full_like(slip, alpha), f"model, {name}", look))
        dots = Look(colour=colours[curve.held], marker=".", size=1.6)
        series.append(Trace(name=f"measured, {name}", x=Fy[curve.index], y=Fx[curve.index], look=dots))
    series += _limit(view, members[0])
    end = 1.05 * max(float(np.nanmax(np.abs(part))) for s in series for part in s.columns().values())
    return Panel(
        title=labels.LOAD.of(load),
        x=Axis(label=CHANNELS["Fy"].axis, low=-end, high=end),
        y=Axis(label=CHANNELS["Fx"].axis, low=-end, high=end),
        series=series,
        guides=ZEROS,
    )


def friction_limit(view: BuildView, curve: Curve) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Slip, sideslip [rad] (m,) and direction (m, 2) of the largest force of the model in every direction, once around."""
    steps = int(constants.STEPS_OF_LINE)
    kappa, alpha = (
        grid.ravel()
        for grid in np.meshgrid(
            np.linspace(*slip_range(view), steps), np.linspace(*sideslip_range(view), steps)
        )
    )
    force = np.column_stack(_forces(view, _inputs(view, curve, kappa=kappa, alpha=alpha)))
    turn = np.linspace(0.0, 2.0 * np.pi, 4 * (steps // 2) + 1)
    # Directions are of forces over their peaks, so that the sides of a flat ellipse are seen as well as its ends.
    way = np.column_stack([np.cos(turn), np.sin(turn)]) / np.max(np.abs(force), axis=0)
    way /= np.hypot(*way.T)[:, None]
    best = np.argmax(force @ way.T, axis=0)
    return kappa[best], alpha[best], way


def _forces(view: BuildView, where: dict[str, Any]) -> list[Any]:
    tyre = SimpleNamespace(**view.model.values)
    return outputs_of(("Fx", "Fy"), tyre, where, turn_slip=view.on_disc)


def _limit(view: BuildView, curve: Curve) -> list[Trace]:
    """The friction limit with its band, outwards and inwards; dotted where no sweep combined as much sideslip with slip."""
    kappa, alpha, way = friction_limit(view, curve)
    whole = _path(view, curve, kappa, alpha, EDGE_NAME, EDGE, way)
    beyond = _beyond_combined(view, alpha)
    if not np.any(beyond):
        return [whole]
    ends = np.flatnonzero(np.diff(beyond)) + 1
    run = [part for part in np.split(np.arange(len(alpha)), ends) if not beyond[part[0]]]
    inside = [Trace(name=EDGE_NAME_RUN, x=whole.x[part], y=whole.y[part], look=EDGE) for part in run]
    return [replace(whole, look=BEYOND), *inside]


def _path(
    view: BuildView,
    curve: Curve,
    kappa: np.ndarray,
    alpha: np.ndarray,
    name: str,
    look: Look,
    across: np.ndarray | None = None,
) -> Trace:
    """Fx over Fy along slips (m,) with the band across the path, or in the directions (m, 2) ``across`` of Fx and Fy."""
    where = _inputs(view, curve, kappa=kappa, alpha=alpha)

    Fx, Fy = _forces(view, where)
    if across is None:
        along = np.gradient(Fx), np.gradient(Fy)
        across = np.column_stack([-along[1], along[0]]) / np.maximum(np.hypot(*along), 1e-9)[:, None]
    across_x, across_y = across.T

    def moved_across(p: Any) -> Any:
        F = outputs_of(("Fx", "Fy"), p, where, turn_slip=view.on_disc)
        return across_x * F[0] + across_y * F[1]

    _, half = with_band(view.model.values, view.posterior, moved_across)
    return Trace(name=name, x=Fy, y=Fx, half=across_x * half, half_x=across_y * half, look=look)


def _inputs(view: BuildView, curve: Curve, **slips: np.ndarray) -> dict[str, Any]:
    """The operating conditions of a curve with other slips (m,)."""
    at: Points = view.felt.select(curve.index)
    return {
        "Fz": float(np.median(at.Fz)),
        "gamma": 0.0,
        "pressure": float(np.median(at.p)),
        "Vx": float(np.median(at.V)),
        **slips,
    }

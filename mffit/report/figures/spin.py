"""The camber reduction factor: among published tyres, its budget, its course over load; and the alignment."""

import textwrap
from dataclasses import replace

import numpy as np

from mffit.constants import MOST_ROWS, UPRIGHT
from mffit.measured import Measured
from mffit.measured.constants import CUBIC_SIDESLIP
from mffit.points import main_path
from mffit.quantities import CHANNELS
from mffit.report import labels, style
from mffit.report.build_view import BuildView
from mffit.report.curves import Curve
from mffit.report.drawing.records import (
    NOTHING,
    ZERO,
    Axis,
    Bars,
    Guide,
    Look,
    Note,
    Panel,
    Sheet,
    Trace,
    in_rows,
    listed,
)
from mffit.suspicion.unpublished import TYRES

PUBLISHED = Look(colour=style.MUTED, marker="o", size=4.0, width=1.2)
OWN = Look(colour=style.ACCENT, marker="o", size=6.0, width=2.2)
COMBINED = Look(colour=style.CONTRAST, line="-", width=1.4)
OF_THE_FILE = Look(colour=style.INK, line="-", width=1.2)
FORWARDS = Look(colour=style.ACCENT, line="-", marker="o")
BACKWARDS = Look(colour=style.CONTRAST, line="--", marker="v", size=4.2, hollow=True)


def camber_reduction(view: BuildView) -> Sheet:
    """Three panels: eps_gamma among published tyres, the budget of its uncertainty, eps_gamma over load."""
    if not view.on_disc:
        return NOTHING
    panels = [
        _among_published(view.build.config.tyre.name, view.build.measured),
        _budget(view.build.measured),
        _over_load(view),
    ]
    key = {
        "this tyre": replace(OWN, size=4.5),
        "published tyres": PUBLISHED,
        "combined uncertainty": COMBINED,
        "PECP1, PECP2 of the file": OF_THE_FILE,
    }
    return Sheet(rows=[panels], height=2.6, key=key)


def _among_published(name: str, measured: Measured) -> Panel:
    rows = [(tyre.name, tyre.epsilon_gamma, tyre.u) for tyre in TYRES]
    own = measured.epsilon_of_file
    if own is not None:
        rows.append((textwrap.shorten(name, 24, placeholder="…"), own.value, own.u))
    places = np.arange(len(rows))
    values, u = (np.array([row[k] for row in rows]) for k in (1, 2))
    sides = ((places < len(TYRES), "published", PUBLISHED), (places >= len(TYRES), "this tyre", OWN))
    return Panel(
        title="Among published tyres",
        x=Axis(label=f"{labels.EPSILON.short_axis}, ± 1 u"),
        y=listed([row[0] for row in rows]),
        series=[
            Trace(name=said, x=values[which], y=places[which], half_x=u[which], look=look)
            for which, said, look in sides
        ],
        guides=[Guide(axis="x", at=0.0)],
    )


def _budget(measured: Measured) -> Panel:
    lines = sorted(measured.budget, key=lambda line: -abs(line.contribution))[:MOST_ROWS]
    widths = np.array([abs(line.contribution) for line in lines])
    total = measured.epsilon_gamma.u if measured.epsilon_gamma is not None else 0.0
    return Panel(
        title="Its uncertainty budget",
        x=Axis(
            label=f"contribution to u({labels.EPSILON.mathtext}) [–]",
            low=0.0,
            high=1.25 * max([total, *widths]),
        ),
        y=listed([line.source for line in lines]),
        series=[Bars(name="contribution", lengths=widths, colours=[style.ACCENT] * len(lines))],
        guides=[Guide(axis="x", at=total, look=COMBINED)],
        notes=[Note(x=total, y=len(lines) - 1.0, text=f"{total:.3f}", colour=style.CONTRAST)],
    )


def _over_load(view: BuildView) -> Panel:
    measured, nominal = view.build.measured, view.build.config.tyre.nominal_load
    found = [(row.load, row.epsilon_gamma) for row in measured.per_load if row.epsilon_gamma is not None]
    load, value, u = np.array([(load, epsilon.value, epsilon.u) for load, epsilon in found]).T
    series = [Trace(name="this tyre", x=load, y=value, half=u, look=replace(OWN, size=4.5, width=1.4))]
    if measured.pecp1 is not None:
        over = np.linspace(min(load.min(), nominal), max(load.max(), nominal), 20)
        line = measured.pecp1 * (1.0 + measured.pecp2 * (over - nominal) / nominal)
        series.insert(0, Trace(name="PECP1, PECP2 of the file", x=over, y=line, look=OF_THE_FILE))
    return Panel(
        title="Over the load",
        x=Axis(label=labels.LOAD.axis),
        y=Axis(label=f"{labels.EPSILON.short_axis}, ± 1 u"),
        series=series,
        guides=[ZERO],
    )


def alignment(view: BuildView) -> Sheet:
    """Side force around zero sideslip in both directions of rolling; the slip force vanishes where the lines cross."""
    panels = [
        Panel(
            title=labels.LOAD.of(load),
            x=labels.angle_axis("alpha"),
            y=Axis(label=CHANNELS["Fy"].short_axis),
            series=[_near_zero(view, curve) for curve in members],
            guides=[Guide(axis="x", at=0.0)],
        )
        for load, members in (both_directions(view) if view.on_disc else ())
    ]
    key = {"rolling forwards": FORWARDS, "rolling backwards": BACKWARDS}
    return Sheet(rows=in_rows(panels), height=1.7, key=key)


def _near_zero(view: BuildView, curve: Curve) -> Trace:
    x = curve.varied(view.points)
    near = np.abs(x) < CUBIC_SIDESLIP
    return Trace(
        name=f"rolling {'forwards' if curve.forward else 'backwards'}",
        x=x[near],
        y=view.points.Fy[curve.index][near],
        look=FORWARDS if curve.forward else BACKWARDS,
    )


def both_directions(view: BuildView) -> list[tuple[float, list[Curve]]]:
    """By load the upright sideslip curves on the usual path that cross zero, where both directions were run."""
    upright = [
        c
        for c in view.curves
        if view.points.phi_t[c.index[0]] == main_path(view.points)
        and c.over == "alpha"
        and abs(c.held) < UPRIGHT
        and c.mount > 0
    ]
    backward = {(c.load, c.pressure) for c in upright if not c.forward}
    return [
        (load, [c for c in upright if c.load == load and (load, c.pressure) in backward])
        for load in sorted({load for load, _ in backward})
    ]

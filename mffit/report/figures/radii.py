"""Loaded radius and rolling radius of the file over load at each pressure, with the readings that they were fitted to."""

from dataclasses import fields, replace

import numpy as np

from mffit.constants import STEPS_OF_LINE
from mffit.fit.wheel.vertical import RadiusReadings, radius
from mffit.points import levels
from mffit.quantities import CHANNELS, CONDITIONS
from mffit.report import labels, style
from mffit.report.build_view import BuildView
from mffit.report.drawing.records import NOTHING, Axis, Look, Panel, Sheet, Trace
from mffit.scatter import finite_median

MILLIMETRES = 1e3
WORDS = {
    "RL": f"{CHANNELS['RL'].word} {CHANNELS['RL'].mathtext} [mm]",
    "omega": "rolling radius R$_{e}$ [mm]",
}
"""What is drawn for each channel."""
READ = Look(colour=style.MUTED, marker="o", size=3.2)
LINE = Look(colour=style.MUTED, line="-", width=1.0)


def radii(view: BuildView) -> Sheet:
    """A panel per radius that was fitted."""
    rolling = view.build.fit.radii.rolling
    if rolling is None or not view.build.fit.radii.rms:
        return NOTHING
    pressure = np.round(levels.level_values(rolling.p, levels.PRESSURE), -3)
    colours = style.ramp(np.unique(pressure).tolist())
    panels = [_panel(view, rolling, channel, pressure, colours) for channel in view.build.fit.radii.rms]
    key = {"measured": READ, "file": LINE}
    key |= {CONDITIONS["p_kPa"].of(p / 1e3): Look(colour=c, line="-", width=3.0) for p, c in colours.items()}
    return Sheet(rows=[panels], height=2.1, key=key)


def _panel(
    view: BuildView, rolling: RadiusReadings, channel: str, pressure: np.ndarray, colours: dict[float, str]
) -> Panel:
    series = []
    read, steps = rolling.radius(channel), STEPS_OF_LINE
    speed = float(np.median(rolling.V))
    for p, colour in colours.items():
        rows = (pressure == p) & np.isfinite(read)
        if not rows.any():
            continue
        load = np.linspace(rolling.Fz[rows].min(), rolling.Fz[rows].max(), steps)
        usual = dict.fromkeys((field.name for field in fields(RadiusReadings)), 0.0)
        usual |= {"p": p, "V": speed, "omega": finite_median(rolling.omega)}
        at = RadiusReadings(**{name: np.full(steps, x) for name, x in (usual | {"Fz": load}).items()})
        line = np.asarray(radius(view.build.fit.tyre.values, at, channel))
        name, mm = CONDITIONS["p_kPa"].of(p / 1e3), MILLIMETRES
        lined, dotted = replace(LINE, colour=colour), replace(READ, colour=colour)
        series += [
            Trace(name=f"file, {name}", x=load, y=mm * line, look=lined),
            Trace(name=f"measured, {name}", x=rolling.Fz[rows], y=mm * read[rows], look=dotted),
        ]
    return Panel(title=WORDS[channel], x=Axis(label=labels.LOAD.axis), y=Axis(label="mm"), series=series)

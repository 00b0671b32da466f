"""The written files against the fitted model on a straight path."""

from __future__ import annotations

import numpy as np

from mffit.quantities import CHANNELS, SIDEWAYS
from mffit.report import constants, labels, style
from mffit.report.build_view import BuildView
from mffit.report.drawing.records import Look, Panel, Sheet, Trace
from mffit.report.figures.bands import LIMITS, tested_edges
from mffit.rounding import number

LOOKS = {
    "turn-slip": Look(colour=style.ACCENT, line="-", width=1.2),
    "normal": Look(colour=style.CONTRAST, line="--", width=1.2),
    "both": Look(colour=style.MUTED, line=":", width=1.2),
}
MODEL = Look(colour=style.INK, marker=".", size=2.0)


def files_on_a_straight_path(view: BuildView) -> Sheet:
    """Fy and Mz of the files over camber and over sideslip at nominal load, the model as dots, with the ends of the tests."""
    assert view.files is not None
    panels = [_panel(view, channel, over) for channel in SIDEWAYS for over in LIMITS]
    key = {"fitted model": MODEL, **{view.file_names[use]: LOOKS[use] for use in view.files.by_use}}
    return Sheet(rows=[panels], height=2.1, key=key)


def _panel(view: BuildView, channel: str, over: str) -> Panel:
    files = view.files
    assert files is not None
    load = float(files.by_use["normal"].tyre["FNOMIN"])
    end, other = LIMITS[over], labels.OTHER[over]
    x = np.linspace(-files.written[end], files.written[end], constants.STEPS_OF_LINE)
    series = []
    for share in constants.HELD_SHARES[:2] if over == "gamma" else constants.HELD_SHARES:
        held = np.full_like(x, share * files.tested[LIMITS[other]])
        alpha, gamma = (held, x) if over == "gamma" else (x, held)
        at = f"{labels.ANGLES[other].symbol} = {number(np.degrees(held[0]), 1)}°"
        for use, file in files.by_use.items():
            force = getattr(file.tyre(load, alpha, gamma, turn_slip=use == "turn-slip"), channel)
            name = f"{view.file_names[use]}, {at}"
            series.append(Trace(name=name, x=np.degrees(x), y=force, look=LOOKS[use]))
        model = getattr(view.model(load, alpha, gamma, turn_slip=True), channel)
        series.append(Trace(name=f"fitted model, {at}", x=np.degrees(x)[::5], y=model[::5], look=MODEL))
    return Panel(
        title=f"{CHANNELS[channel].short_axis}, {labels.LOAD.of(load)}",
        x=labels.angle_axis(over),
        series=series,
        guides=tested_edges(files.tested[end]),
    )

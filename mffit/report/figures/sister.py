"""Longitudinal force that a sister tyre gives to a tyre measured only sideways, and how certain it is."""

from __future__ import annotations

import numpy as np

from mffit.quantities import CHANNELS, CONDITIONS
from mffit.report import constants, labels
from mffit.report.build_view import BuildView
from mffit.report.drawing.records import Panel, Sheet
from mffit.report.figures.bands import key_of_loads, model_curve, three_loads


def borrowed_force(view: BuildView) -> Sheet:
    """Fx over longitudinal slip with 95 % bands at three loads, with and without sideslip, on a straight path."""
    assert view.files is not None
    colours = three_loads(view)
    kappa = np.linspace(-1.0, 1.0, constants.STEPS_OF_LINE) * constants.LARGEST_SLIP_TO_DRAW
    panels = [
        Panel(
            title=f"{CHANNELS['Fx'].short_axis}, {CONDITIONS['alpha_deg'].symbol} = {sideslip:.0f}°",
            x=labels.angle_axis("kappa"),
            series=[
                model_curve(view, "Fx", kappa, load, colour, alpha=np.radians(sideslip), kappa=kappa)
                for load, colour in colours.items()
            ],
        )
        for sideslip in (
            share * np.degrees(view.files.tested["ALPMAX"]) for share in constants.HELD_SHARES[:2]
        )
    ]
    return Sheet(rows=[panels], height=2.1, key=key_of_loads(colours))

"""The pictures of README and tutorial, from the sample: ``python docs/images/make.py``."""

from __future__ import annotations

from pathlib import Path

import mffit
from mffit.report import labels, style
from mffit.report.build_view import BuildView, view_of
from mffit.report.drawing import pictures
from mffit.report.drawing.records import Axis, Guide, Look, Panel, Sheet, Trace
from mffit.report.figures import fit, residuals, spin

HERE = Path(__file__).parent
SAMPLE = HERE.parents[1] / "samples" / "front-120-70" / "tyre.toml"
LOOKS = {
    "measured on the disc": Look(colour=style.CONTRAST, marker="o", size=4.5),
    "fitted model": Look(colour=style.INK, line="-", width=1.4),
    "odd part: sideslip and camber": Look(colour=style.ACCENT, line="-", width=1.2),
    "even part: turn slip": Look(colour=style.CALM, line="--", width=1.2),
}


def overview(view: BuildView) -> Sheet:
    """Side force over sideslip and over camber at nominal load: readings, odd and even part, fitted model."""
    return Sheet(rows=[[_overview(view, over) for over in labels.ANGLES]], height=3.2, key=LOOKS)


def _overview(view: BuildView, over: str) -> Panel:
    channel, load = view.channels[0], view.build.config.tyre.nominal_load
    (curve,) = (
        c
        for c in view.curves
        if (c.over, c.load, c.held, c.pressure) == (over, load, 0.0, 250.0) and c.forward and len(c.index) > 8
    )
    x, line = curve.varied(view.points), view.lines[curve]
    rows, parts = curve.index, view.build.parts
    data = (
        (x, channel.measured[rows]),
        (line.x, line.raw[channel.name]),
        (x, parts.Fy_odd[rows]),
        (x, parts.Fy_even[rows]),
    )
    return Panel(
        title=curve.condition,
        x=labels.angle_axis(over),
        y=Axis(label=channel.known.short_axis),
        series=[
            Trace(name=name, x=x, y=y, look=look)
            for (name, look), (x, y) in zip(LOOKS.items(), data, strict=True)
        ],
        guides=[Guide(axis="y", at=0.0)],
    )


def sheets(view: BuildView) -> dict[str, Sheet]:
    """The pictures of a build of the sample by name."""
    return {
        "build": overview(view),
        "camber_reduction": spin.camber_reduction(view),
        "alignment": spin.alignment(view),
        "fit": fit.model_against_points(view, view.channels[0]),
        "residuals": residuals.residual_maps(view),
    }


def main() -> None:
    for name, sheet in sheets(view_of(mffit.build(SAMPLE))).items():
        pictures.save(sheet, HERE / f"{name}.png")


if __name__ == "__main__":
    main()

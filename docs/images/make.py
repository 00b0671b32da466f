"""The pictures of README and tutorial, from the sample: ``python docs/images/make.py``."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.lines import Line2D

import mffit
from mffit.report import labels, style
from mffit.report.build_view import view_of
from mffit.report.figures import fit, residuals, spin

HERE = Path(__file__).parent
SAMPLE = HERE.parents[1] / "samples" / "front-120-70" / "tyre.toml"


def overview(view):
    """Side force over sideslip and over camber at nominal load: readings, odd and even part, fitted model."""
    channel, load = view.channels[0], view.config.tyre.nominal_load
    figure, (panels,) = style.panel_grid([2], 2, height=3.2, gap=(0.8, 0.6))
    for ax, over in zip(panels, ("alpha", "gamma"), strict=True):
        (curve,) = (
            c
            for c in view.curves
            if c.over == over and c.load == load and c.held == 0.0 and c.pressure == 250.0 and c.forward
            and len(c.index) > 8
        )  # fmt: skip
        x, line = np.degrees(getattr(view.points, over)[curve.index]), view.lines[curve.key]
        ax.axhline(0.0, color=style.FAINT, lw=0.8)
        ax.plot(line.x, line.raw[channel.name], color=style.INK, lw=1.4)
        ax.plot(
            x, channel.measured[curve.index], ls="none", marker="o", ms=4.5, color=style.CONTRAST, mec="none"
        )
        ax.plot(x, channel.odd[curve.index], "-", color=style.ACCENT, lw=1.2)
        ax.plot(x, channel.even[curve.index], "--", color=style.CALM, lw=1.2)
        ax.set_xlabel(labels.ANGLES[over].axis)
        ax.set_title(labels.condition(load, curve.pressure))
    style.label_left([panels], channel.label)
    said = (
        Line2D([], [], ls="none", marker="o", color=style.CONTRAST, mec="none", label="measured on the disc"),
        Line2D([], [], color=style.INK, label="fitted model"),
        Line2D([], [], color=style.ACCENT, label="odd part: sideslip and camber"),
        Line2D([], [], ls="--", color=style.CALM, label="even part: turn slip"),
    )
    style.legend_above(figure, list(said))
    return figure


def main() -> None:
    view = view_of(mffit.build(SAMPLE))
    with style.applied():
        style.save(overview(view), HERE / "build.png")
        style.save(spin.camber_reduction(view), HERE / "camber_reduction.png")
        style.save(spin.alignment(view), HERE / "alignment.png")
        style.save(fit.model_against_points(view, view.channels[0]), HERE / "fit.png")
        scaled = [(c.symbol, (c.measured - c.model) / c.u) for c in view.channels]
        style.save(
            residuals.residual_maps(view.points, scaled, view.conditions, 4.0, "u"), HERE / "residuals.png"
        )


if __name__ == "__main__":
    main()

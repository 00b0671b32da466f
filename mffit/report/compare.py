"""The page of a comparison: plots and compare.html, and THE table of its pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mffit.comparison import Comparison, wording
from mffit.fit.plan import channels_of
from mffit.points import Points
from mffit.quantities import CHANNELS
from mffit.report import constants, page
from mffit.report.build_view import ChannelRow
from mffit.report.catalogue import ChannelPicture, Picture
from mffit.report.channel import NamedChannel
from mffit.report.curves import Curve, CurveKey, curves
from mffit.report.figures import compared, fit
from mffit.report.lines import CurveLine, model_lines


@dataclass(frozen=True, slots=True, kw_only=True)
class Overlay:
    """Measured points and the file's curves, as the figure of a fit needs them."""

    points: Points
    curves: Sequence[Curve]
    lines: Mapping[CurveKey, CurveLine]
    channels: Sequence[ChannelRow]

    def marked(self, channel: str) -> tuple[np.ndarray, np.ndarray]:
        """No rows: a comparison weights all readings alike."""
        return np.zeros(0, dtype=int), np.zeros(0, dtype=int)


READ = "{word}: readings, and as lines those that the file would give on the rig. The colour is the angle that is held."
COMPARISON: tuple[ChannelPicture[Comparison, NamedChannel] | Picture[Comparison], ...] = (
    ChannelPicture(
        name="curves_{channel}",
        title="{word} of both over sideslip and camber, or over slip",
        shows="{word} on a straight path, with the other angle zero. Shaded areas are 95 % bands, if a build states them.",
        section="curves",
        channels=lambda found: [
            NamedChannel(name=name) for name in dict.fromkeys(gap.channel for gap in found.curves)
        ],
        draw=lambda found, channel: compared.curves(found, channel.name),
    ),
    Picture(
        name="differences",
        title="Ranked differences in units of their uncertainty",
        shows="Differences over their standard uncertainties, the largest first. Those beyond the dashed lines are significant.",
        draw=compared.differences,
        when=lambda found: any(row.z is not None for row in found.numbers),
    ),
)
"""Pictures of two files."""
OVERLAID: tuple[ChannelPicture[Overlay, ChannelRow], ...] = (
    ChannelPicture(
        name="fit_{channel}",
        title="{word} measured and simulated",
        shows=READ,
        section="curves",
        channels=lambda view: view.channels,
        draw=fit.model_against_points,
        when=lambda view, channel: bool(fit.varied(view.curves, fit.ANGLES)),
    ),
    ChannelPicture(
        name="slip_{channel}",
        title="{word} measured and simulated over longitudinal slip",
        shows=READ,
        section="curves",
        channels=lambda view: view.channels,
        draw=lambda view, channel: fit.model_against_points(view, channel, fit.SLIP),
        when=lambda view, channel: bool(fit.varied(view.curves, fit.SLIP)),
    ),
)
"""Pictures of a file and readings."""


def write_comparison(found: Comparison, folder: Path) -> None:
    """Write the pictures and ``compare.html`` of a comparison to an existing folder."""
    planned = [one for picture in COMPARISON for one in picture.planned(found)]
    view = _overlay(found)
    if view is not None:
        planned += [one for picture in OVERLAID for one in picture.planned(view)]
    page.write(
        "compare.html.j2",
        folder / "compare.html",
        planned,
        found=found,
        say=wording,
        channels=CHANNELS,
        most=constants.MOST_ROWS,
    )


def _overlay(found: Comparison) -> Overlay | None:
    """The readings over the file, if there are any."""
    if found.points is None or found.simulation is None:
        return None
    points, members = found.points, curves(found.points)
    measured = [name for name in channels_of(points) if name in points.measured]
    return Overlay(
        points=points,
        curves=members,
        lines=model_lines(found.simulation, points, members, measured),
        channels=[ChannelRow.of_readings(name, points.channel(name), points.u(name)) for name in measured],
    )

"""The build report: plots/*.png and report.html."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from mffit.diagnosis import wording as of_residuals
from mffit.measured import constants, wording
from mffit.quantities import CHANNELS, CONDITIONS, DIRECT
from mffit.report import constants as report_constants
from mffit.report import page, published
from mffit.report.build_view import PER_LOAD, STATUS_ORDER, BuildView, ChannelRow, CoefficientRow, view_of
from mffit.report.drawing.records import Sheet
from mffit.report.figures import (
    bands,
    campaigns,
    decomposition,
    files,
    fit,
    radii,
    residuals,
    sister,
    slip,
    spin,
    structure,
)
from mffit.results import BuildResult
from mffit.rig_errors import MEANINGS, UNITS

SECTION_TITLES = {
    "LATERAL_COEFFICIENTS": "Side force",
    "ALIGNING_COEFFICIENTS": "Self-aligning moment",
    "TURNSLIP_COEFFICIENTS": "Turn slip",
    "ROLLING_COEFFICIENTS": "Rolling resistance",
}
OTHER_SECTIONS = "Everything else"
PLACES = {"straight_with_turn_slip": "turn slip on", "disc": "turn slip on, on the disc"}
"""Uses for which a file that serves both is judged, beside the straight path without turn slip."""


OF_CAMPAIGN = {
    "fit": "%(channel)s at every load, pressure and camber.",
    "slip": "%(channel)s over longitudinal slip, coloured by sideslip.",
    "friction": "friction ellipse of the upright wheel, coloured by sideslip.",
    "weights": "weights of combined slip, coloured by sideslip.",
    "trail": "pneumatic trail and residual moment at three longitudinal slips.",
    "radii": "radii of the freely rolling wheel.",
}
"""Captions of the pictures of another campaign, by the first word of their names."""


def write_build(result: BuildResult, folder: Path) -> None:
    """Write ``plots/*.png`` and ``report.html`` of a build.

    Parameters
    ----------
    result : the result of the build
    folder : existing folder to write to
    """
    view = view_of(result)
    page.write(
        "build.html.j2",
        folder / "report.html",
        _figures(view),
        readings="points.csv",
        view=view,
        sections=_by_section(view),
        statuses=[s for s in STATUS_ORDER if any(row.status == s for row in view.rows)],
        residual_unit=residual_unit(view),
        published=published,
        channels=CHANNELS,
        places=PLACES,
        epsilon_values=wording.epsilon_values(result.measured),
        of_spin=wording,
        of_residuals=of_residuals,
        conditions=CONDITIONS,
        direct=DIRECT,
        per_load=PER_LOAD,
        aligned_below=constants.LARGEST_DIFFERENCE,
        degrees=math.degrees(1.0),
        of_setups=wording.setup_scatter,
        radians=math.radians(1.0),
        meanings=MEANINGS,
        units=UNITS,
        captions=OF_CAMPAIGN,
        least_pure=report_constants.LEAST_PURE_FORCE,
    )


def _figures(view: BuildView) -> dict[str, Callable[[], Sheet]]:
    """The figures in the order of the page."""
    out: dict[str, Callable[[], Sheet]] = {}
    if view.several_files:
        out["files"] = partial(files.files_on_a_straight_path, view)
    if view.on_disc:
        out["camber_reduction"] = partial(spin.camber_reduction, view)
        if spin.both_directions(view):
            out["alignment"] = partial(spin.alignment, view)
        for channel in view.channels:
            if decomposition.worth_drawing(view.curves, channel):
                out[f"parts_{channel.name}"] = partial(decomposition.decomposition, view, channel)
        if decomposition.pure_curves(view):
            out["even_parts"] = partial(decomposition.even_parts, view)
    if any(curve.over != "kappa" for curve in view.curves):
        for channel in view.channels:
            out[f"fit_{channel.name}"] = partial(fit.model_against_points, view, channel)
    out |= _under_slip(view)
    for number, other in enumerate(view.campaigns, 1):
        own = {channel.name for channel in view.channels}
        theirs: dict[str, Callable[[], Sheet]] = {
            f"fit_{channel.name}": partial(fit.model_against_points, other.build, channel)
            for channel in other.build.channels
            if channel.name not in own and any(curve.over != "kappa" for curve in other.build.curves)
        }
        theirs |= _under_slip(other.build)
        out |= {f"campaign{number}_{name}": make for name, make in theirs.items()}
    if view.campaigns:
        out["campaigns"] = partial(campaigns.where_run, view)
    if view.files is not None:
        out["bands"] = partial(bands.bands, view)
    if view.files is not None and view.lent is not None:
        out["borrowed_Fx"] = partial(sister.borrowed_force, view)
    scaled = [(c.symbol, (c.measured - c.model) / _scale(view, c)) for c in view.channels]
    rolling, driven = (which(view.points, view.conditions) for which in (residuals.rolling, residuals.driven))
    maps = partial(residuals.residual_maps, view.points, scaled)
    out["residuals"] = partial(maps, rolling, residual_unit(view))
    if driven:
        out["residuals_slip"] = partial(maps, driven, residual_unit(view), over=residuals.SLIPS)
    if any(c.bins for c in view.remains.structure.comparisons):
        out["structure"] = partial(structure.residual_means, view.remains.structure)
    return out


def _under_slip(view: BuildView) -> dict[str, Callable[[], Sheet]]:
    """The figures of longitudinal slip and of radii."""
    out: dict[str, Callable[[], Sheet]] = {}
    if slip.slip_curves(view.curves):
        for channel in view.channels:
            out[f"slip_{channel.name}"] = partial(slip.over_slip, view, channel)
    if slip.combined(view) and {"Fx", "Fy"} <= {channel.name for channel in view.channels}:
        out["friction_ellipse"] = partial(slip.friction_ellipse, view)
        out["weights"] = partial(slip.weights, view)
        out["trail"] = partial(slip.trail, view)
    if view.radii.rms:
        out["radii"] = partial(radii.radii, view)
    return out


def _scale(view: BuildView, channel: ChannelRow) -> np.ndarray | float:
    """The noise of each point, or the misfit of the channel where no noise is known."""
    if residual_unit(view) == "u":
        return np.where(np.isfinite(channel.u), channel.u, channel.noise)
    return view.agreement[channel.name].rmse


def residual_unit(view: BuildView) -> str:
    """The unit of the residuals: the point's uncertainty if every channel states one, else the rms misfit."""
    return "u" if all(np.isfinite(c.noise) for c in view.channels) else "rms misfit"


def _by_section(view: BuildView) -> dict[str, list[CoefficientRow]]:
    """The rows of the coefficient table by section; values of other sections come last."""
    out: dict[str, list[CoefficientRow]] = {title: [] for title in (*SECTION_TITLES.values(), OTHER_SECTIONS)}
    for row in view.rows:
        out[SECTION_TITLES.get(row.section, OTHER_SECTIONS)].append(row)
    return {title: rows for title, rows in out.items() if rows}

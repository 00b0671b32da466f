"""The build report: plots/*.png and report.html, and THE table of its pictures."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from mffit.diagnosis import wording as of_residuals
from mffit.measured import wording
from mffit.quantities import CHANNELS, CONDITIONS, DIRECT
from mffit.report import page, words
from mffit.report.build_view import PER_LOAD, STATUS_ORDER, BuildView, ChannelRow, CoefficientRow, view_of
from mffit.report.catalogue import ChannelPicture, Picture, Planned
from mffit.report.figures import (
    bands,
    decomposition,
    fit,
    radii,
    residuals,
    slip,
    spin,
    structure,
)
from mffit.report.verdict import headlines, purposes, verdict
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


BUILD: tuple[Picture[BuildView] | ChannelPicture[BuildView, ChannelRow], ...] = (
    Picture(
        name="overview",
        title="Readings and fitted model of every channel at nominal load and pressure",
        shows="Every channel at the load and pressure nearest to the nominal ones: readings, and the model as lines. The colour "
        "is the angle that is held, dark to light from its smallest to its largest value.",
        section="top",
        draw=fit.overview,
        when=lambda view: bool(view.curves),
    ),
    Picture(
        name="files",
        title="Side force and moment of both files and the fitted model on a straight path, over camber and over sideslip",
        shows="The files and the fitted model (dots) on a straight path at nominal load, over camber at zero and some sideslip, "
        "and over sideslip at three cambers. Dotted verticals are the ends of the tested range. Dashed curves have turn slip "
        "off: without spin the formula cannot reproduce exactly how camber reduces grip.",
        section="files",
        draw=bands.files_on_a_straight_path,
        when=lambda view: view.several_files,
    ),
    Picture(
        name="camber_reduction",
        title="Camber reduction factor beside published tyres, its uncertainty budget and its course over load",
        shows=f"Left: this tyre among the six that have been published ({spin.SOURCE}). Middle: the contribution of each "
        "source to u(eps_gamma); the orange line is the combined uncertainty with correlations. Right: eps_gamma at every load "
        "and the line that the file carries.",
        section="spin",
        draw=spin.camber_reduction,
        when=lambda view: view.on_disc,
    ),
    Picture(
        name="alignment",
        title="Side force rolling forwards and backwards around zero sideslip, one panel per load",
        shows="The slip force vanishes where both lines cross; with an aligned axis they cross on the vertical line. The height "
        "of the crossing is the turn-slip force. The points are raw readings. The table is corrected for the play of the axis "
        "and, if five angles were run near zero, evaluates a parabola through them at zero; so its forces differ slightly.",
        section="alignment",
        draw=spin.alignment,
        when=lambda view: view.on_disc and bool(spin.both_directions(view)),
    ),
    Picture(
        name="parts",
        title="Raw, odd and even curves of every channel at nominal load",
        shows="Raw readings, odd and even part of the forward sweeps over one angle with the other at zero, at the load and the "
        "pressure nearest to the nominal ones.",
        draw=decomposition.parts,
        when=lambda view: view.on_disc and bool(decomposition.pure_curves(view)),
    ),
    Picture(
        name="even_parts",
        title="Even part at nominal pressure, measured and of the model",
        shows="The even part of the same sweeps, measured and of the fitted model. In MF-6.2 turn slip shifts the Fy curve "
        "sideways, so its even part has the shape of the local cornering stiffness and is not flat. A misaligned sideslip axis "
        "and ply-steer have nearly the same shape: a vertical gap here that follows the curve suggests one of them, a constant "
        "gap a load-cell offset or conicity. A step near zero is backlash: the moment changes its sign there, and with it the "
        "side on which the play is taken up. The model of the rig includes what is declared.",
        section="parts",
        draw=decomposition.even_parts,
        when=lambda view: view.on_disc and bool(decomposition.pure_curves(view)),
    ),
    *fit.OF_CHANNELS,
    Picture(
        name="friction_ellipse",
        title="Longitudinal over lateral force at every load, with the friction limit of the model",
        shows="Friction ellipse of the upright wheel at the pressure nearest to the nominal one. Each colour is a sideslip, "
        "along which slip goes from full braking to full drive. Points are readings less the fitted errors of the rig. The dark "
        "line is the largest force of the model in every direction within the tested sideslip and slip; it is dotted where no "
        "sweep combined as much sideslip with slip. Bands (95 %) are narrow where they cannot be seen.",
        section="slip",
        draw=slip.friction_ellipse,
        when=slip.combined,
    ),
    Picture(
        name="radii",
        title="Loaded radius and rolling radius over load at every pressure",
        shows="Radii of the freely rolling wheel: means over the sweeps, and the file with 95 % bands from the scatter of these "
        "means. Points include camber and speeds that the lines leave out.",
        section="slip",
        draw=radii.radii,
        when=lambda view: bool(view.build.fit.radii.rms),
    ),
    Picture(
        name="bands",
        title="Forces and moments of the fitted model with 95 % bands at three loads",
        shows="Uncertainty of the curves: the fitted model on a straight path, at the smallest, the nominal and the largest load "
        "of the file. The bands contain the tyre's own curve with a probability of 95 %, if noise, errors of the rig and "
        "unconstrained coefficients are the only errors. Dotted lines are the ends of the tested range. Beyond them a band "
        "covers what the formula allows, not what a tyre may do.",
        section="bands",
        draw=bands.bands,
        when=lambda view: view.build.fit.files is not None,
    ),
    Picture(
        name="borrowed_Fx",
        title="Longitudinal force of the sister tyre, scaled, over longitudinal slip at three loads, with 95 % bands",
        shows="Longitudinal force of the file over longitudinal slip, without and with sideslip, at the smallest, the nominal "
        "and the largest load of the file. The bands contain the uncertainty of both ratios and the scatter of the shapes among "
        "similar tyres.",
        section="sister",
        draw=bands.borrowed_force,
        when=lambda view: view.build.fit.files is not None and view.build.fit.lent is not None,
    ),
    Picture(
        name="residuals",
        title="Residuals over sideslip and camber, one map per load and pressure",
        shows="Measured minus model of the freely rolling wheel. A good fit shows pale colours without order. A patch of one "
        "colour is structure that the model misses; mffit diagnose looks for its cause. Points with equal angles are drawn side "
        "by side; a small dot marks a point that was run backwards.",
        section="residuals",
        draw=residuals.of_rolling,
    ),
    Picture(
        name="residuals_slip",
        title="Residuals over longitudinal slip and sideslip, one map per load and pressure",
        shows="The same of the driven and braked wheel, over longitudinal slip and sideslip. Cambers lie side by side.",
        section="residuals",
        draw=residuals.of_driven,
        when=lambda view: bool(residuals.driven(view.points, view.conditions)),
    ),
    Picture(
        name="structure",
        title="Mean residuals over the conditions over which they are not random",
        shows="Mean of measured minus model over bins of each condition, in units of the point's uncertainty; bars show one "
        "standard deviation of what a sound fit leaves. The side of the other angle, or the sign of the force, splits each bin. "
        "Only what chance does not explain is drawn, the number of comparisons accounted for.",
        section="structure",
        draw=lambda view: structure.residual_means(view.build.remains.structure),
        when=lambda view: bool(view.build.remains.structure.found),
    ),
)
"""Every picture of the report, in its order."""


def planned(view: BuildView) -> Iterator[Planned]:
    """The pictures that the report of a build shows."""
    opening = "camber_reduction" if view.on_disc else "bands"
    for one in (one for picture in BUILD for one in picture.planned(view)):
        yield replace(one, section="top") if one.name == opening else one


def write_build(result: BuildResult, folder: Path) -> None:
    """Write ``plots/*.png`` and ``report.html`` of a build to an existing folder."""
    view = view_of(result)
    page.write(
        "build.html.j2",
        folder / "report.html",
        planned(view),
        view=view,
        build=result,
        fit=result.fit,
        paired={
            kind: int(np.sum(result.parts.paired == kind)) for kind in ("exact", "interpolated", "unpaired")
        },
        radii_agreement=result.fit.radii.agreement(result.fit.tyre.values),
        verdict=verdict(result),
        headlines=headlines(result),
        purposes=purposes(result),
        sections=_by_section(view),
        statuses=[s for s in STATUS_ORDER if any(row.found.status == s for row in view.rows)],
        channels=CHANNELS,
        places=PLACES,
        of_number=words.of_number,
        epsilon_values=wording.epsilon_values(result.measured),
        of_spin=wording,
        of_residuals=of_residuals,
        conditions=CONDITIONS,
        direct=DIRECT,
        per_load=PER_LOAD,
        degrees=math.degrees(1.0),
        of_setups=wording.setup_scatter,
        meanings=MEANINGS,
        units=UNITS,
    )


def _by_section(view: BuildView) -> dict[str, list[CoefficientRow]]:
    """The rows of the coefficient table by section; values of other sections come last."""
    out: dict[str, list[CoefficientRow]] = {title: [] for title in (*SECTION_TITLES.values(), OTHER_SECTIONS)}
    for row in view.rows:
        out[SECTION_TITLES.get(row.known.section, OTHER_SECTIONS)].append(row)
    return {title: rows for title, rows in out.items() if rows}

"""The build report: plots/*.png and report.html, and THE table of its pictures."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import groupby
from pathlib import Path

import numpy as np

from mffit.diagnosis import wording as of_residuals
from mffit.measured import wording
from mffit.quantities import CHANNELS, CONDITIONS, DIRECT
from mffit.report import page, words
from mffit.report.build_view import BuildView, CoefficientRow, view_of
from mffit.report.catalogue import Picture
from mffit.report.figures import bands, decomposition, fit, missed, radii, residuals, slip, spin
from mffit.report.text.direct import PER_LOAD
from mffit.report.verdict import headlines, purposes, verdict
from mffit.results import BuildResult
from mffit.rig_errors import MEANINGS, UNITS

OTHERS = "EVERYTHING_ELSE"
"""The section of dimensions, ranges and nominal conditions."""

BUILD: tuple[Picture[BuildView], ...] = (
    Picture(
        name="overview",
        title="Readings and fitted model of every channel at nominal load and pressure",
        shows="Every channel at the load and pressure nearest to the nominal ones: readings, and the model as lines. The colour "
        "is the angle that is held, from violet at the smallest to green at the largest.",
        section="top",
        draw=fit.overview,
    ),
    Picture(
        name="files",
        title="Side force and moment of both files and the fitted model on a straight path, over camber and over sideslip",
        shows="The files and the fitted model (dots) on a straight path at nominal load, over camber at zero and some sideslip, "
        "and over sideslip at three cambers. Dotted verticals are the ends of the tested range. Dashed curves have turn slip "
        "off: without spin the formula cannot reproduce exactly how camber reduces grip.",
        section="files",
        draw=bands.files_on_a_straight_path,
    ),
    Picture(
        name="camber_reduction",
        title="Camber reduction factor beside published tyres, its uncertainty budget and its course over load",
        shows=f"This tyre among the six that have been published ({spin.SOURCE}). In the budget, the orange line is the "
        "combined uncertainty, with correlations. Over the load, the line is that of the file.",
        section="spin",
        draw=spin.camber_reduction,
    ),
    Picture(
        name="alignment",
        title="Side force rolling forwards and backwards around zero sideslip, one panel per load",
        shows="The slip force vanishes where both lines cross; with an aligned axis they cross on the vertical line. The height "
        "of the crossing is the turn-slip force. The points are raw readings. The table is corrected for the play of the axis "
        "and, if five angles were run near zero, evaluates a parabola through them at zero; so its forces differ slightly.",
        draw=spin.alignment,
    ),
    Picture(
        name="parts",
        title="Raw, odd and even curves of every channel at nominal load, and the even part at every load with the model",
        shows="Forward sweeps over one angle with the other at zero, at nominal pressure. First the readings with their odd and "
        "even part at nominal load, then the even part at every load, with one standard uncertainty, and that of the fitted "
        "model. In MF-6.2 turn slip shifts the Fy curve sideways, so its even part has the shape of the local cornering "
        "stiffness and is not flat. A misaligned sideslip axis and ply-steer have nearly the same shape: a vertical gap that "
        "follows the curve suggests one of them, a constant gap a load-cell offset or conicity. A step near zero is backlash: "
        "the moment changes its sign there. The model of the rig includes what is declared.",
        draw=decomposition.parts,
    ),
    *fit.OF_CHANNELS,
    Picture(
        name="friction_ellipse",
        title="Longitudinal over lateral force at every load, with the friction limit of the model",
        shows="Friction ellipse of the upright wheel at the pressure nearest to the nominal one. Each colour is a sideslip, "
        "along which slip goes from full braking to full drive. Points are readings less the fitted errors of the rig. The dark "
        "line is the largest force of the model in every direction within the slip and sideslip that were run together.",
        section="slip",
        draw=slip.friction_ellipse,
    ),
    Picture(
        name="radii",
        title="Loaded radius and rolling radius over load at every pressure",
        shows="Radii of the freely rolling wheel: means over the sweeps, and the file. "
        "Points include camber and speeds that the lines leave out.",
        section="slip",
        draw=radii.radii,
    ),
    Picture(
        name="bands",
        title="Forces and moments of the fitted model with 95 % bands at three loads",
        shows="Uncertainty of the curves: the fitted model on a straight path, at the smallest, the nominal and the largest load "
        "of the file. The bands contain the tyre's own curve with a probability of 95 %, if noise, errors of the rig and "
        "unconstrained coefficients are the only errors. Dotted lines are the ends of the tested range. Beyond them a band "
        "covers what the formula allows, not what a tyre may do.",
        draw=bands.bands,
    ),
    Picture(
        name="residuals",
        title="Residuals over sideslip and camber, or over slip and sideslip, one map per load and pressure",
        shows="Measured minus model, of the freely rolling wheel over sideslip and camber, of the driven and braked wheel over "
        "longitudinal slip and sideslip. A good fit shows pale colours without order. A patch of one colour is structure that "
        "the model misses; mffit diagnose looks for its cause. Of readings at one place the worst is on top; a small dot marks "
        "a point that was run backwards.",
        draw=residuals.residual_maps,
    ),
    Picture(
        name="missed",
        title="What the formula misses smoothly and alike in all sweeps, by the conditions with which it changes most",
        shows="Measured minus model without what differs from run to run and without noise, with 95 % uncertainty: lines at a "
        "tenth, the middle and nine tenths of one condition, all others in the middle of their readings. Only channels in which "
        "chance does not explain it are drawn. No sweep is at fault for it; mffit predict adds it.",
        section="residuals",
        draw=missed.missed,
    ),
)
"""Every picture of the report, in its order."""


def pictures_of(view: BuildView) -> list[Picture[BuildView]]:
    """The pictures of a build, two of them at the top of the page."""
    opening = "camber_reduction" if view.on_disc else "bands"
    return [replace(one, section="top") if one.name == opening else one for one in BUILD]


def write_build(result: BuildResult, folder: Path) -> None:
    """Write ``plots/*.png`` and ``report.html`` of a build to an existing folder."""
    view = view_of(result)
    page.write(
        "build.html.j2",
        folder / "report.html",
        pictures_of(view),
        view,
        build=result,
        fit=result.fit,
        paired={
            kind: int(np.sum(result.parts.paired == kind)) for kind in ("exact", "interpolated", "unpaired")
        },
        radii_agreement=result.fit.radii.agreement(result.fit.tyre.values),
        verdict=verdict(result),
        headlines=headlines(result),
        purposes=purposes(result),
        sections=groupby(sorted(view.rows, key=lambda row: _section(row) == OTHERS), key=_section),
        channels=CHANNELS,
        of_number=words.of_number,
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


def _section(row: CoefficientRow) -> str:
    """The section of the table in which a coefficient is."""
    section = row.known.section
    return section if section.endswith("_COEFFICIENTS") else OTHERS

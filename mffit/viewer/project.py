"""A project as a page: measured points, curves, and coefficients that move them at once."""

from __future__ import annotations

import mffit
from mffit.fit.agreement import with_points
from mffit.quantities import CHANNELS
from mffit.results import BuildResult
from mffit.results.values import Json, document
from mffit.templates import environment
from mffit.viewer.page import Page, on_page
from mffit.viewer.project_coefficients import coefficient_rows
from mffit.viewer.project_points import axis_quantities, columns, delivered
from tir.codegen.javascript import javascript
from tir.codegen.program import INPUTS, Switches, trace
from tir.equations.forces import Forces, State
from tir.evaluate import CONICITY

MODELLED = tuple(name for name in CHANNELS if name in Forces._fields + State._fields)
"""The outputs that the page computes."""


def project_data(result: BuildResult) -> dict[str, Json]:
    """All that the page shows of a build, as plain JSON; numbers in SI, null for what is not finite."""
    fitted, points = result.fit, result.points
    simulation = fitted.simulation
    switches = Switches(simulation.turn_slip, simulation.star)
    parameters = trace(switches, MODELLED).parameters
    rows = coefficient_rows(result, parameters)
    values = {name: float(simulation.values[name]) for name in parameters}
    return document(
        {
            "name": result.config.tyre.name,
            "order": INPUTS,
            "turn_slip": simulation.turn_slip,
            "star": simulation.star,
            "quantities": {name: on_page(quantity) for name, quantity in axis_quantities().items()},
            "channels": [
                {
                    "name": name,
                    "rmse": rmse,
                    "over_noise": result.trust.over_noise.get(name),
                    "of_fit": name in fitted.channels,
                    "uses": trace(switches, (name,)).parameters,
                }
                for name, rmse in _misfits(result).items()
            ],
            "values": values | {row["name"]: row["value"] for row in rows},
            "conicity": [name for name in CONICITY if name in parameters],
            "coefficients": rows,
            "points": columns(points, result.excluded, fitted),
            "hand": result.config.hand,
            "exclude": result.config.fit.exclude,
            "trusted": result.trusted,
            "warnings": result.warnings,
            "rig": [{"name": name, "value": value, "stderr": u} for name, (value, u) in fitted.rig.items()],
            "seconds": result.seconds,
        }
    )


def project_html(
    name: str,
    data: dict[str, Json] | None,
    *,
    turn_slip: bool,
    star: bool,
    window: dict[str, Json] | None = None,
    here: dict[str, Json] | None = None,
) -> str:
    """The page of a project.

    Parameters
    ----------
    name : of the tyre
    data : of :func:`project_data`; None before the first fit
    turn_slip, star : which model the page evaluates
    window, here : state of the local window, see :mod:`mffit.window`, and folder and endings of recordings that it takes; None
        for a page without a server
    """
    return (
        environment("mffit.viewer")
        .get_template("project.html.j2")
        .render(
            content={"project": data, "window": window},
            name=name,
            models={name: javascript((name,), turn_slip=turn_slip, star=star) for name in _computed(data)},
            turn_slip=turn_slip,
            window=window,
            here=here,
            version=mffit.__version__,
        )
    )


def project_page(result: BuildResult) -> Page:
    """The page of a build without a server: one file with the points in it."""
    name, simulation = result.config.tyre.name, result.fit.simulation
    html = project_html(name, project_data(result), turn_slip=simulation.turn_slip, star=simulation.star)
    return Page(html, (name,))


def _computed(data: dict[str, Json] | None) -> list[str]:
    """The channels that a page with this data computes, each with code of its own, so that a picture pays for no other."""
    channels = [] if data is None else data["channels"]
    assert isinstance(channels, list)
    return [str(channel["name"]) for channel in channels if isinstance(channel, dict)]


def _misfits(result: BuildResult) -> dict[str, float]:
    """By channel that was measured and that the page computes, rms misfit of the fitted model.

    Some, such as the wheel speed, are fitted by themselves, from the freely rolling wheel only, and are no channel of the fit.
    """
    fitted, measured = result.fit, [name for name in result.points.measured if name in MODELLED]
    others = [name for name in measured if name not in fitted.channels]
    readings = delivered(fitted).readings(result.points, others)
    found = {**with_points(readings, result.points), **fitted.channels}
    return {name: found[name].rmse for name in measured if found[name].n}

"""A project as a page: measured points, curves, and coefficients that move them at once."""

import math
from collections.abc import Iterable
from dataclasses import replace

from mffit.as_json import Json, document
from mffit.config import Config
from mffit.config.by_hand import may_be_free, unsettable
from mffit.constants import CERTAIN_SIGMA
from mffit.fit import Coefficient, FitResult, name_at_temperature
from mffit.fit.agreement import with_points
from mffit.fit.influences.modelled import without_runs
from mffit.points.loading import Reading
from mffit.quantities import CHANNELS
from mffit.results import BuildResult
from mffit.rig import SIMULATED
from mffit.viewer import constants
from mffit.viewer.page import Page, code, on_page, rendered
from mffit.viewer.project_points import axis_quantities, columns, delivered, differing
from tir.codegen.program import INPUTS, LOADED, Switches, trace
from tir.evaluate import CONICITY
from tir.parameters import TABLE, Parameter

FOUND = frozenset({"fitted", "regularised", "measured"})
"""Status of coefficients that the data determine."""


def project_data(result: BuildResult, *, verdict: str = "", judgement: str = "") -> dict[str, Json]:
    """All that the page shows of a build, as plain JSON; numbers in SI, null for what is not finite.

    ``verdict`` is the sentence at its top, ``judgement`` that in a word, both as by :mod:`mffit.report.verdict`.

    ``others`` are further fits of the same points: ``title``, and what of the rest is different, with the columns that are.
    """
    fitted, points = result.fit, result.points
    simulation = fitted.simulation
    others = [_at_temperature(result)] if fitted.temperature is not None else []
    return document(
        {
            "name": result.config.tyre.name,
            "title": f"{result.config.tyre.name}.tir, as delivered",
            "order": INPUTS,
            "turn_slip": simulation.turn_slip,
            "star": simulation.star,
            "quantities": {name: on_page(quantity) for name, quantity in axis_quantities().items()},
            **_of_fit(result),
            "points": columns(points, result.excluded, fitted),
            "hand": result.config.hand,
            "exclude": result.config.fit.exclude,
            "inputs": result.made.inputs,
            "verdict": verdict,
            "judgement": judgement,
            "trusted": result.trusted,
            "warnings": result.warnings,
            "seconds": result.seconds,
            "others": [
                {
                    "title": title,
                    **_of_fit(other),
                    "points": differing(points, result.excluded, fitted, other.fit),
                }
                for title, other in others
            ],
        }
    )


def readings_data(config: Config, reading: Reading) -> dict[str, Json]:
    """What the page shows of a project before its first fit: the keys of :func:`project_data` with readings and no model."""
    return document(
        {
            "name": config.tyre.name,
            "title": "",
            "order": INPUTS,
            "turn_slip": config.rig.on_disc,
            "star": False,
            "quantities": {name: on_page(quantity) for name, quantity in axis_quantities().items()},
            "channels": [],
            "values": {},
            "conicity": [],
            "coefficients": [],
            "points": columns(reading.points, reading.excluded, None),
            "hand": config.hand,
            "exclude": config.fit.exclude,
            "verdict": "",
            "judgement": "",
            "trusted": True,
            "warnings": [],
            "others": [],
        }
    )


def _of_fit(result: BuildResult) -> dict[str, object]:
    """What the page shows of a fit in addition to its points."""
    fitted = result.fit
    simulation, misfits = fitted.simulation, _misfits(result)
    switches = Switches(simulation.turn_slip, simulation.star)
    parameters = trace(
        switches, tuple(name for name in CHANNELS if name in {*SIMULATED, *misfits})
    ).parameters
    rows = coefficient_rows(result, parameters)
    values = {name: float(simulation.values[name]) for name in parameters}
    return {
        "channels": [
            {
                "name": name,
                "rmse": rmse,
                "over_noise": result.trust.over_noise.get(name),
                "of_fit": name in fitted.channels,
                "uses": trace(switches, (name,)).parameters,
            }
            for name, rmse in misfits.items()
        ],
        "values": values | {row["name"]: row["value"] for row in rows},
        "conicity": [name for name in CONICITY if name in parameters],
        "coefficients": rows,
        "rig": [{"name": name, "value": value, "stderr": u} for name, (value, u) in fitted.rig.items()],
    }


def _at_temperature(result: BuildResult) -> tuple[str, BuildResult]:
    """The fit with temperature terms, at one temperature and the mean of the runs; and its title."""
    fitted, found = result.fit, result.fit.temperature
    assert found is not None
    assert fitted.full is not None
    other = replace(
        fitted,
        tyre=found.file.tyre,
        simulation=without_runs(fitted.full.simulation),
        coefficients=found.coefficients,
        channels=found.channels,
        rig=found.rig,
    )
    title = f"{name_at_temperature(result.config.tyre.name)}, at {found.T_ref:.1f} degC"
    return title, replace(result, fit=other)


def project_html(
    name: str,
    data: dict[str, Json] | None,
    *,
    turn_slip: bool,
    star: bool,
    window: dict[str, Json] | None = None,
    here: dict[str, Json] | None = None,
) -> str:
    """The page of a tyre, with the data of :func:`project_data`, None before the first fit.

    ``window`` is the state of the local window, see :mod:`mffit.window`, ``here`` folder and endings of recordings that it
    takes; None for a page without a server.
    """
    channels = [] if data is None else data["channels"]
    assert isinstance(channels, list)
    names = [str(channel["name"]) for channel in channels if isinstance(channel, dict)]
    return rendered(
        "page",
        {"project": data, "window": window},
        code(names, Switches(turn_slip, star)),
        title=name,
        module="page" if window is None else "window",
        turn_slip=turn_slip,
        window=window,
        here=here,
    )


def project_page(result: BuildResult, *, verdict: str = "", judgement: str = "") -> Page:
    """The page of a build without a server: one file with the points in it; arguments as of :func:`project_data`."""
    name, simulation = result.config.tyre.name, result.fit.simulation
    data = project_data(result, verdict=verdict, judgement=judgement)
    html = project_html(name, data, turn_slip=simulation.turn_slip, star=simulation.star)
    return Page(html, (name,))


def _misfits(result: BuildResult) -> dict[str, float]:
    """By channel that was measured and that the page computes, rms misfit of the fitted model.

    Some, such as the wheel speed, are fitted by themselves, from the freely rolling wheel only, and are not channels of the fit;
    so is the loaded radius, which has a curve where the file's terms of the radius were fitted.
    """
    fitted = result.fit
    apart = {name: x for name, x in fitted.radii.agreement(fitted.tyre.values).items() if name == LOADED}
    measured = [name for name in result.points.measured if name in {*SIMULATED, *apart}]
    others = [name for name in measured if name not in {*fitted.channels, *apart}]
    readings = delivered(fitted).readings(result.points, others)
    found = {**with_points(readings, result.points), **fitted.channels, **apart}
    return {name: found[name].rmse for name in measured if found[name].n}


def coefficient_rows(result: BuildResult, used: Iterable[str]) -> list[dict[str, object]]:
    """The coefficients on which the page's curves depend (``used`` by its model), in the order of a property file."""
    names = set(used)
    rows = [row for row in TABLE if row.name in names and not unsettable(row.name)]
    return [_row(row, result.fit) for row in rows]


def _row(row: Parameter, fitted: FitResult) -> dict[str, object]:
    record = fitted.coefficients[row.name]
    value = float(fitted.tyre[row.name])
    lower, upper = record.bounds or row.bounds
    low, high = _reach(value, record, lower, upper)
    return {
        "name": row.name,
        "group": row.section.removesuffix("_COEFFICIENTS").replace("_", " ").capitalize(),
        "about": row.description,
        "unit": "" if row.unit == "-" else row.unit,
        "value": value,
        "stderr": record.stderr,
        "status": record.status,
        "found": record.status in FOUND or bool(record.by_hand),
        "at_bound": record.at_bound,
        "may_be_free": may_be_free(row),
        "bounds": [x if math.isfinite(x) else None for x in (lower, upper)],
        "divisor": row.divisor,
        "slider": [low, high],
        "partner": [record.correlated_with, record.correlation] if record.correlated_with else None,
    }


def _reach(value: float, record: Coefficient, lower: float, upper: float) -> tuple[float, float]:
    """Ends of the slider, within the bounds."""
    least = constants.SLIDER_LEAST * (1.0 + abs(value))
    reach = max(CERTAIN_SIGMA * (record.stderr or 0.0), least)
    return min(max(value - reach, lower), value), max(min(value + reach, upper), value)

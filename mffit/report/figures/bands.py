"""The file's curves: how certain they are, and the files of both uses side by side."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mffit.constants import COVERAGE_FACTOR_95, STEPS_OF_LINE
from mffit.fit.written.files import Files
from mffit.points import make_points
from mffit.quantities import CHANNELS, SIDEWAYS
from mffit.report import constants, labels, style, words
from mffit.report.build_view import BuildView
from mffit.report.drawing.records import NOTHING, Guide, Look, Panel, Sheet, Trace, both_sides
from mffit.rig import Simulation
from mffit.rounding import number

LIMITS = {"gamma": "CAMMAX", "alpha": "ALPMAX"}
"""The file's key for the end of an angle's range."""
SLIP_LIMITS = ("KPUMIN", "KPUMAX")
DOTTED = Look(colour=style.FAINT, line=":", width=0.8)


def bands(view: BuildView) -> Sheet:
    """The channels with 95 % bands over camber, over sideslip and over slip if it was run, at three loads."""
    files = view.build.fit.files
    if files is None:
        return NOTHING
    loads = files.written["FZMIN"], float(view.build.fit.tyre["FNOMIN"]), files.written["FZMAX"]
    colours = style.ramp(loads)
    sideways = [
        name for name in CHANNELS if name in SIDEWAYS or (name == "Mx" and name in view.points.measured)
    ]
    rows = [[_panel(view, over, name, colours) for name in sideways] for over in LIMITS]
    if len(sideways) == len(SIDEWAYS):  # both angles beside each other
        rows = [[panel for row in rows for panel in row]]
    if "KPUMAX" in files.tested and "Fx" in view.points.measured:
        driven = [name for name in ("Fx", "Mz") if name in view.points.measured]
        rows.append([_panel(view, "kappa", name, colours) for name in driven])
    key = {labels.LOAD.of(load): Look(colour=colour, line="-") for load, colour in colours.items()}
    remark = " ".join(filter(None, (_why_wide(view, name, rows) for name in sideways)))
    return Sheet(rows=rows, height=2.1, key=key, remark=remark)


def _why_wide(view: BuildView, channel: str, rows: Sequence[Sequence[Panel]]) -> str:
    """Why the band of a channel at nominal load is wider than the misfit even where it is narrowest; empty if it is not."""
    build = view.build
    known, agreement = build.prediction, build.fit.channels.get(channel)
    if known is None or agreement is None or channel not in known.channels:
        return ""
    name, unit = CHANNELS[channel].short_axis, CHANNELS[channel].unit
    nominal = labels.LOAD.of(float(build.fit.tyre["FNOMIN"]))
    drawn = [
        s
        for row in rows
        for panel in row
        if panel.title == name
        for s in panel.series
        if isinstance(s, Trace)
    ]
    least = min(float(np.min(s.half)) for s in drawn if s.name == nominal and s.half is not None)
    if not least > COVERAGE_FACTOR_95 * agreement.rmse:
        return ""
    cause = known.least_known(build.fit.tyre, channel)
    partner = build.fit.coefficients[cause].correlated_with
    with_it = f", which goes with {words.of_number(partner)}" if partner else ""
    return (
        f"The band of {channel} is ±{number(least, digits=2)} {unit} or more at nominal load, wider than the misfit of "
        f"{number(agreement.rmse, digits=2)} {unit}, because the readings leave {cause} uncertain{with_it}."
    )


def _panel(view: BuildView, over: str, name: str, colours: Mapping[float, str]) -> Panel:
    files = view.build.fit.files
    assert files is not None
    x, guides = _ends(files, over)
    series = []
    for load, colour in colours.items():
        y, half = _best(view, name, {over: x, "Fz": load})
        at = x if over == "kappa" else np.degrees(x)
        look = Look(colour=colour, line="-", width=1.0)
        series.append(Trace(name=labels.LOAD.of(load), x=at, y=y, half=half, look=look))
    return Panel(title=CHANNELS[name].short_axis, x=labels.angle_axis(over), series=series, guides=guides)


def _ends(files: Files, over: str) -> tuple[np.ndarray, list[Guide]]:
    """Values [rad, -] (m,) over the range of the file, and the ends of the tested range."""
    if over != "kappa":
        end = files.written[LIMITS[over]]
        return np.linspace(-end, end, STEPS_OF_LINE), both_sides(
            "x", float(np.degrees(files.tested[LIMITS[over]])), DOTTED
        )
    low, high = (files.written.get(key, files.tested[key]) for key in SLIP_LIMITS)
    guides = [Guide(axis="x", at=files.tested[key], look=DOTTED) for key in SLIP_LIMITS]
    return np.linspace(low, high, STEPS_OF_LINE), guides


def _best(view: BuildView, channel: str, at: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """The best estimate (m,) of a channel on a straight path, and half the height of its band, as those of the road."""
    fitted, known = view.build.fit.tyre, view.build.prediction
    tyre = Simulation.of(fitted, turn_slip=view.on_disc)
    inputs: dict[str, Any] = {"alpha": 0.0, "gamma": 0.0, "kappa": 0.0, **at}
    where = make_points(**inputs, p=float(fitted["NOMPRES"]), V=float(fitted["LONGVL"]), phi_t=0.0)
    if known is not None and channel in known.channels:
        found = known.forces(tyre, tyre, where, (channel,))[channel]
        return found.best, COVERAGE_FACTOR_95 * np.sqrt(found.variance)
    posterior = view.build.fit.posterior  # not measured: nothing but its coefficients is known
    names = [name for name in posterior.names if name in tyre.values]
    read, slopes = tyre.sensitivities(where, names, (channel,))
    return read[channel], COVERAGE_FACTOR_95 * posterior.spread_of(slopes[channel], names)


LOOKS = {
    "turn-slip": Look(colour=style.ACCENT, line="-", width=1.2),
    "normal": Look(colour=style.CONTRAST, line="--", width=1.2),
    "both": Look(colour=style.MUTED, line=":", width=1.2),
}
MODEL = Look(colour=style.INK, marker=".", size=2.0)


def files_on_a_straight_path(view: BuildView) -> Sheet:
    """Fy and Mz of the files over camber and over sideslip at nominal load, the model as dots, with the ends of the tests."""
    if not view.several_files or view.build.fit.files is None:
        return NOTHING
    panels = [_panel_of_files(view, channel, over) for channel in SIDEWAYS for over in LIMITS]
    key = {"fitted model": MODEL, **{view.file_names[use]: LOOKS[use] for use in view.build.fit.files.by_use}}
    return Sheet(rows=[panels], height=2.1, key=key)


def _panel_of_files(view: BuildView, channel: str, over: str) -> Panel:
    files = view.build.fit.files
    assert files is not None
    load = float(files.by_use["normal"].tyre["FNOMIN"])
    end, other = LIMITS[over], labels.OTHER[over]
    x = np.linspace(-files.written[end], files.written[end], STEPS_OF_LINE)
    series = []
    for share in constants.HELD_SHARES[:2] if over == "gamma" else constants.HELD_SHARES:
        held = np.full_like(x, share * files.tested[LIMITS[other]])
        alpha, gamma = (held, x) if over == "gamma" else (x, held)
        at = labels.angle(other, float(np.degrees(held[0])), 1)
        for use, file in files.by_use.items():
            force = getattr(file.tyre(load, alpha, gamma, turn_slip=use == "turn-slip"), channel)
            name = f"{view.file_names[use]}, {at}"
            series.append(Trace(name=name, x=np.degrees(x), y=force, look=LOOKS[use]))
        model = getattr(view.build.fit.tyre(load, alpha, gamma, turn_slip=True), channel)
        series.append(Trace(name=f"fitted model, {at}", x=np.degrees(x)[::5], y=model[::5], look=MODEL))
    return Panel(
        title=f"{CHANNELS[channel].short_axis}, {labels.LOAD.of(load)}",
        x=labels.angle_axis(over),
        series=series,
        guides=both_sides("x", float(np.degrees(files.tested[end])), DOTTED),
    )

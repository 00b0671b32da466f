"""The gap between simulation and measurement, before and after what the diagnosis added."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.constants import COVERAGE_FACTOR_95, MOST_ROWS, NAMED_IN_SENTENCE, UPRIGHT
from mffit.diagnosis import Diagnosis
from mffit.diagnosis.constants import TIED_EVIDENCE
from mffit.diagnosis.selection import Contest
from mffit.diagnosis.where import Region
from mffit.quantities import CHANNELS, QuantityName
from mffit.report import constants, labels, style
from mffit.report.curves import Curve, CurveLine, conditions, curves, model_lines
from mffit.report.drawing.records import (
    NOTHING,
    Axis,
    Bars,
    ColourScale,
    Guide,
    Look,
    Note,
    Panel,
    Sheet,
    Trace,
    in_rows,
    listed,
)
from mffit.report.figures.residuals import SLIPS, Framed, of_wheel, residual_map
from mffit.rounding import number
from mffit.scatter import rms
from tir.frozen import ReadOnlyArrays

KIND_COLOURS = {"tyre": style.ACCENT, "rig": style.CONTRAST, "environment": style.CALM}
MEASURED = Look(colour=style.INK, marker="o", size=3.2)
GIVEN = Look(colour=style.CONTRAST, line="--", width=1.2)
FOUND = Look(colour=style.ACCENT, line="-", width=1.2)
LEFT_OUT = Look(colour=style.INK, marker="D", size=3.0, hollow=True)
LEAST_GAIN = 1.0
"""Where the logarithmic axis of gains begins."""
HEIGHT_OF_NAME = 0.25
"""Of a row whose name takes two lines [in]."""
THRESHOLD = Look(colour=style.INK, line="--", width=1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class GapChannel(ReadOnlyArrays):
    """One channel before and after: measured minus simulated in units of the noise of each point, (n,)."""

    name: str
    before: np.ndarray
    after: np.ndarray

    @property
    def known(self) -> QuantityName:
        return CHANNELS[self.name]


def gap_channels(diagnosis: Diagnosis) -> list[GapChannel]:
    """The channels that were measured."""
    points, noise = diagnosis.points, diagnosis.noise
    found = []
    for name, u in noise.by_channel(noise.u).items():
        u = np.where(np.isfinite(u), u, np.nan)
        before, after = (
            (points.channel(name) - noise.of_channel(model, name)) / u
            for model in (diagnosis.before, diagnosis.after)
        )
        if np.isfinite(before).any():
            found.append(GapChannel(name=name, before=before, after=after))
    return found


def gap_by_effect(diagnosis: Diagnosis) -> Sheet:
    """The rms misfit as given and with one effect after the other, of all readings and of left-out sweeps, by channel."""
    steps = diagnosis.steps
    if len(steps) < 2:
        return NOTHING
    names = [labels.typeset(f"{'' if k == 0 else '+ '}{one.name}") for k, one in enumerate(steps)]
    kinds = {one.effect.id: one.effect.kind for one in diagnosis.repaired}
    colours = [KIND_COLOURS.get(kinds.get(one.id, ""), style.MUTED) for one in steps]
    panels = []
    for channel in gap_channels(diagnosis):
        name, noise = channel.name, diagnosis.noise.typical(channel.name)
        sizes = np.array([one.gap.rms(name) for one in steps])
        left_out = np.array([one.held_out.rms(name) for one in steps])
        high = 1.3 * max(noise, *sizes, *left_out)
        panels.append(
            Panel(
                title=channel.known.mathtext,
                x=Axis(label=f"rms misfit [{channel.known.unit}]", low=0.0, high=high),
                y=listed(names),
                series=[
                    Bars(name="all readings", lengths=sizes, colours=colours),
                    Trace(name="left-out sweeps", x=left_out, y=np.arange(float(len(steps))), look=LEFT_OUT),
                ],
                guides=[Guide(axis="x", at=noise, look=THRESHOLD)],
                notes=[
                    Note(x=float(max(a, b)), y=k, text=f"  {number(a, digits=3)}")
                    for k, (a, b) in enumerate(zip(sizes, left_out, strict=True))
                ],
            )
        )
    key = {
        kind: Look(colour=colour, opacity=1.0)
        for kind, colour in KIND_COLOURS.items()
        if kind in kinds.values()
    }
    return Sheet(
        rows=in_rows(panels, columns=2),
        height=HEIGHT_OF_NAME * len(steps) + 0.2,
        key=key | {"left-out sweeps": LEFT_OUT, "noise": THRESHOLD},
    )


def curves_before_after(diagnosis: Diagnosis) -> Sheet:
    """The worst and the typical sweep: readings, the simulation as given and with what was added, a panel per channel."""
    channels = gap_channels(diagnosis)
    shown = _worst_and_typical(diagnosis, channels)
    simulated = {"simulated as given": (diagnosis.given, GIVEN)}
    if diagnosis.repaired:
        simulated["with what was found"] = diagnosis.state, FOUND
    points, names = diagnosis.points, diagnosis.noise.channels
    lines = {
        said: (model_lines(simulation, points, list(shown.values()), names), look)
        for said, (simulation, look) in simulated.items()
    }
    panels = [
        _sweep(diagnosis, word, curve, channel.name, lines)
        for word, curve in shown.items()
        for channel in channels
    ]
    key = {"measured": MEASURED, **{said: look for said, (_, look) in lines.items()}}
    remark = (
        "Blue lines include the effects below, errors of the rig among them." if diagnosis.repaired else ""
    )
    return Sheet(rows=in_rows(panels, columns=4), height=1.9, key=key, remark=remark)


def _worst_and_typical(diagnosis: Diagnosis, channels: Sequence[GapChannel]) -> dict[str, Curve]:
    """The sweep with the largest and the one with the median misfit of the given model, in units of the noise."""
    found = curves(diagnosis.points)
    if not found or not channels:
        return {}
    squares = np.sum([np.nan_to_num(c.before) ** 2 for c in channels], axis=0)
    order = sorted(found, key=lambda curve: float(np.mean(squares[curve.index])))
    typical = {"Typical": order[(len(order) - 1) // 2]} if len(order) > 1 else {}
    return {"Worst": order[-1], **typical}


def _sweep(
    diagnosis: Diagnosis,
    word: str,
    curve: Curve,
    name: str,
    lines: Mapping[str, tuple[Mapping[Curve, CurveLine], Look]],
) -> Panel:
    points = diagnosis.points
    held = f", {labels.held(curve)}" if abs(curve.held) >= UPRIGHT else ""
    backward = "" if curve.forward else ", backward"
    title = f"{word}: {labels.LOAD.of(curve.load)}{held}{backward}"
    read = Trace(name="measured", x=curve.varied(points), y=points.channel(name)[curve.index], look=MEASURED)
    drawn = [
        Trace(name=said, x=of[curve].x, y=of[curve].raw[name], look=look)
        for said, (of, look) in lines.items()
    ]
    return labels.over_angle(curve.over, name, title, [read, *drawn])


def residuals_before_after(diagnosis: Diagnosis) -> Sheet:
    """Maps side by side: a row per load and pressure, channels before and after, one colour scale for all."""
    channels, points = gap_channels(diagnosis), diagnosis.points
    if not channels:
        return NOTHING
    whens = ("before", "after") if diagnosis.repaired else ("before",)
    rows = []
    for over in (labels.ANGLES, SLIPS):
        for condition in of_wheel(points, conditions(points), over):
            maps = []
            for channel in channels:
                frames = (
                    _frames(framed(diagnosis, channel.name), condition.load) if over == labels.ANGLES else []
                )
                for when in whens:
                    title = f"{channel.known.mathtext}{' ' + when if diagnosis.repaired else ''}, {condition.title}"
                    values = getattr(channel, when)
                    shown = frames if when == "before" else ()
                    maps.append(residual_map(points, values, condition, title, shown, over=over))
            rows.append(maps)
    scale = ColourScale(limit=colour_limit(channels), label="measured − simulated [noise of a point]")
    remark = "The maps after should be pale, too." if diagnosis.repaired else ""
    return Sheet(rows=rows, height=1.40, scale=scale, remark=remark)


def framed(diagnosis: Diagnosis, channel: str) -> list[Region]:
    """Regions of a channel to be framed in the maps, unexplained ones first."""
    found = diagnosis.unexplained_where or diagnosis.where
    return [region for region in found if region.channel == channel][:NAMED_IN_SENTENCE]


def colour_limit(channels: Sequence[GapChannel]) -> float:
    """End of the scale: it holds nearly all residuals before, and noise looks plain."""
    sizes = np.concatenate([c.before[np.isfinite(c.before)] for c in channels])
    wanted = np.ceil(COVERAGE_FACTOR_95 * rms(sizes))
    return float(np.clip(wanted, constants.RESIDUAL_SCALE, constants.LARGEST_GAP_SCALE))


def evidence(diagnosis: Diagnosis) -> Sheet:
    """The gain in log evidence of every candidate in the place of each effect, a panel per place, coloured by kind."""
    contests = [
        one for one in diagnosis.contests if one.trials and one.gain > LEAST_GAIN
    ]  # others have no bar
    named = {one.effect.id: one.effect.name for one in diagnosis.effects}
    panels = [_candidates(one, named.get(one.best.effects[-1].id, "")) for one in contests]
    most = max((len(panel.y.words or {}) for panel in panels), default=1)
    present = {trial.effects[-1].kind for one in contests for trial in one.trials}
    key = {kind: Look(colour=colour, opacity=1.0) for kind, colour in KIND_COLOURS.items() if kind in present}
    return Sheet(rows=in_rows(panels, columns=2), height=HEIGHT_OF_NAME * most, key=key)


def _candidates(step: Contest, named: str) -> Panel:
    gained = [(trial.log_evidence - step.before.log_evidence, trial.effects[-1]) for trial in step.trials]
    rows = sorted(gained, key=lambda row: -row[0])[:MOST_ROWS]
    gains = np.array([max(gain, LEAST_GAIN) for gain, _ in rows])
    passed = rows[0][0] > step.threshold
    title = f"Instead of {named}" if named else "One effect alone"
    title += "" if passed else ": nothing passes"
    colours = [KIND_COLOURS.get(effect.kind, style.MUTED) for _, effect in rows]
    return Panel(
        title=labels.typeset(title),
        x=Axis(label="gain in log evidence", low=LEAST_GAIN, high=12.0 * max(10.0, *gains), logarithmic=True),
        y=listed([labels.typeset(effect.name) for _, effect in rows]),
        series=[Bars(name="gain", lengths=gains, colours=colours)],
        guides=[Guide(axis="x", at=step.threshold, look=THRESHOLD)],
        notes=_distances([gain for gain, _ in rows], gains) if passed else [],
    )


def _distances(gained: Sequence[float], ends: np.ndarray) -> list[Note]:
    """At the end of each bar its distance to the best, dark where it may be a tie."""
    notes = []
    for place, (gain, end) in enumerate(zip(gained, ends, strict=True)):
        behind = gained[0] - gain
        text = "best" if place == 0 else number(-behind, 0 if behind >= 10.0 else None, digits=2)
        colour = style.INK if behind < TIED_EVIDENCE else style.MUTED
        notes.append(Note(x=float(end), y=place, text=text, colour=colour))
    return notes


def _frames(regions: Sequence[Region], load: float) -> list[Framed]:
    """A frame around every region at this load; none for a range of slip, over which the maps are not drawn."""
    found = []
    for region in (item.region for item in regions):
        low, high = np.round(region.get("Fz_N", (-np.inf, np.inf)), -1)
        if "kappa" in region:
            continue
        if {"alpha_deg", "gamma_deg"} & region.keys() and low <= load <= high:
            found.append((region.get("alpha_deg"), region.get("gamma_deg")))
    return found

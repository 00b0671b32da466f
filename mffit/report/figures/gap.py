"""The gap between simulation and measurement, before and after what the diagnosis added."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

import numpy as np

from mffit.constants import COVERAGE_FACTOR_95
from mffit.diagnosis.constants import TIED_EVIDENCE
from mffit.diagnosis.selection import ForwardStep
from mffit.diagnosis.where import Region
from mffit.report import constants, labels, style
from mffit.report.diagnosis_view import DiagnosisView, GapChannel, Shown
from mffit.report.drawing.records import (
    NOTHING,
    ZERO,
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
from mffit.report.figures.residuals import ANGLES, SLIPS, Framed, driven, residual_map, rolling
from mffit.rounding import number
from mffit.scatter import rms

KIND_COLOURS = {"tyre": style.ACCENT, "rig": style.CONTRAST, "environment": style.CALM}
MEASURED = Look(colour=style.INK, marker="o", size=3.2)
GIVEN = Look(colour=style.CONTRAST, line="--", width=1.2)
FOUND = Look(colour=style.ACCENT, line="-", width=1.2)
LEAST_GAIN = 1.0
"""Where the logarithmic axis of gains begins."""
THRESHOLD = Look(colour=style.INK, line="--", width=1.0)


def curves_before_after(view: DiagnosisView) -> Sheet:
    """The worst and the typical sweep: readings, the simulation as given and with what was added, a panel per channel."""
    panels = [_sweep(view, shown, channel) for shown in view.shown for channel in view.channels]
    key = {"measured": MEASURED, "simulated as given": GIVEN}
    if view.changed:
        key["with what was found"] = FOUND
    return Sheet(rows=in_rows(panels, columns=4), height=1.9, key=key)


def _sweep(view: DiagnosisView, shown: Shown, channel: GapChannel) -> Panel:
    curve, name = shown.curve, channel.name
    lines = [("simulated as given", shown.before, GIVEN)]
    if view.changed:
        lines.append(("with what was found", shown.after, FOUND))
    backward = "" if curve.forward else ", backward"
    return Panel(
        title=f"{shown.word}: {labels.LOAD.of(curve.load)}{labels.held_unless_zero(curve)}{backward}",
        x=labels.angle_axis(curve.over),
        y=Axis(label=channel.known.short_axis),
        series=[
            Trace(
                name="measured",
                x=curve.varied(view.points),
                y=getattr(view.points, name)[curve.index],
                look=MEASURED,
            ),
            *(Trace(name=said, x=line.x, y=line.raw[name], look=look) for said, line, look in lines),
        ],
        guides=[ZERO],
    )


def residuals_before_after(view: DiagnosisView) -> Sheet:
    """Maps side by side: a row per load and pressure, channels before and after, one colour scale for all."""
    if not view.channels:
        return NOTHING
    limit = colour_limit(view.channels)
    rows = []
    for which, over in ((rolling, ANGLES), (driven, SLIPS)):
        for condition in which(view.points, view.conditions):
            maps = []
            for channel in view.channels:
                frames = _frames(view.frames(channel.name), condition.load) if over == ANGLES else []
                for when in ("before", "after") if view.changed else ("before",):
                    title = f"{channel.known.mathtext}{' ' + when if view.changed else ''}, {condition.title}"
                    framed = frames if when == "before" else ()
                    values = getattr(channel, when)
                    maps.append(residual_map(view.points, values, condition, title, framed, over=over))
            rows.append(maps)
    label = "measured − simulated [noise of a point]"
    scale = ColourScale(limit=limit, label=label)
    return Sheet(rows=rows, height=1.40, scale=scale)


def colour_limit(channels: Sequence[GapChannel]) -> float:
    """End of the scale: it holds nearly all residuals before, and noise looks plain."""
    sizes = np.concatenate([c.before[np.isfinite(c.before)] for c in channels])
    wanted = np.ceil(COVERAGE_FACTOR_95 * rms(sizes))
    return float(np.clip(wanted, constants.RESIDUAL_SCALE, constants.LARGEST_GAP_SCALE))


def evidence(view: DiagnosisView) -> Sheet:
    """The gain in log evidence of every candidate, a panel per forward step, coloured by kind."""
    panels = [_candidates(step, number_of) for number_of, step in enumerate(view.steps, 1)]
    most = max((len(panel.y.words or {}) for panel in panels), default=1)
    present = {trial.effects[-1].kind for step in view.steps for trial in step.trials}
    key = {kind: Look(colour=colour, opacity=1.0) for kind, colour in KIND_COLOURS.items() if kind in present}
    return Sheet(rows=in_rows(panels, columns=2), height=0.185 * most, key=key)


def _candidates(step: ForwardStep, number_of: int) -> Panel:
    gained = [(trial.log_evidence - step.before.log_evidence, trial.effects[-1]) for trial in step.trials]
    rows = sorted(gained, key=lambda row: -row[0])[: constants.MOST_ROWS]
    gains = np.array([max(gain, LEAST_GAIN) for gain, _ in rows])
    beside = " and ".join(effect.name for effect in step.before.effects)
    passed = rows[0][0] > step.threshold
    after = f"beside {beside}" if beside else "one effect alone"
    title = f"Step {number_of}{'' if passed else ', nothing passes'}: {after}"
    bars = Bars(
        name="gain",
        lengths=gains,
        places=np.arange(len(rows)),
        colours=[KIND_COLOURS.get(effect.kind, style.MUTED) for _, effect in rows],
    )
    return Panel(
        title=labels.typeset(textwrap.shorten(title, 52, placeholder="…")),
        x=Axis(label="gain in log evidence", low=LEAST_GAIN, high=12.0 * max(10.0, *gains), logarithmic=True),
        y=listed([labels.typeset(textwrap.shorten(effect.name, 31, placeholder="…")) for _, effect in rows]),
        series=[bars],
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

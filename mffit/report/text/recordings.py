"""The content of recordings, for the terminal."""

from __future__ import annotations

import numpy as np

from mffit.points.stretch import MOVE
from mffit.recordings import Sniffed
from mffit.recordings.project_file import title_of
from mffit.recordings.sniffed import Level, SniffedRecording
from mffit.report import constants
from mffit.report.text.layout import blocks, paragraphs, table

SETTINGS = {
    "load": ("N", 1.0, 0),
    "camber": ("deg", 180.0 / np.pi, 1),
    "pressure": ("kPa", 1e-3, 1),
    "speed": ("m/s", 1.0, 2),
    "sideslip": ("deg", 180.0 / np.pi, 1),
}
"""Unit, factor and decimals of a setting."""


def sniff_summary(sniffed: Sniffed) -> str:
    """Channels, units, axes, conditions, rates, gaps and stretches."""
    return blocks(
        [
            *(_file(recording) for recording in sniffed.recordings),
            _axes(sniffed),
            _conditions(sniffed),
            _stretches(sniffed),
            paragraphs(
                [f"{r.path}: {remark}" for r in sniffed.recordings for remark in r.remarks]
                + list(sniffed.reading.warnings)
            ),
        ]
    )


def _file(recording: SniffedRecording) -> str:
    taken = {guess.heading: guess for guess in recording.guesses.values()}
    rows = []
    for heading, unit in zip(recording.headings, recording.units, strict=True):
        guess = taken.get(heading)
        if guess is None:
            rows.append((heading, unit or "-", "not used", ""))
        else:
            found = "" if np.isnan(guess.lower) else f"{guess.lower:.5g} to {guess.upper:.5g}"
            rows.append(
                (heading, unit or (f"{guess.unit}?" if guess.assumed else "-"), guess.channel.name, found)
            )
    rate = (
        f", {recording.rate:.4g} samples per second over {recording.seconds:.0f} s, {recording.gaps} gaps in time"
        if np.isfinite(recording.rate)
        else " without a time channel"
    )
    head = f"{recording.path}: {recording.kind}, {recording.samples} rows{rate}"
    said = {**recording.about, "title": title_of(recording.about)}
    about = "; ".join(f"{key}: {text[:90]}" for key, text in said.items() if text)
    return "\n".join(
        part
        for part in (head, about, "", table(("heading", "unit", "is", "range"), rows, left=3))
        if part or not about
    )


def _axes(sniffed: Sniffed) -> str:
    if not sniffed.axes:
        return f"axes: none of the known axes fit; in ISO signs {' and '.join(sniffed.wrong)}"
    names = " or ".join(sniffed.axes)
    doubt = (
        ", which these recordings cannot tell apart, as they hold too little camber"
        if len(sniffed.axes) > 1
        else ""
    )
    return f"axes: {names}{doubt} (from camber thrust, the sign of the load, and the slopes of force and moment over sideslip)"


def _conditions(sniffed: Sniffed) -> str:
    rows = []
    for name, levels in sniffed.conditions.items():
        unit, factor, digits = SETTINGS[name]
        rows.append(
            (name, unit, ", ".join(_level(level, factor, digits) for level in levels) or "not measured")
        )
    return table(("setting", "unit", "conditions found (times)"), rows, left=3)


def _level(level: Level, factor: float, digits: int) -> str:
    return f"{factor * level.value + 0.0:.{digits}f} ({level.stretches})"


def _stretches(sniffed: Sniffed) -> str:
    notes = sniffed.reading.stretches
    if not notes:
        return f"{len(sniffed.points)} finished points"
    kept = [note for note in notes if note.points]
    lost = [note for note in notes if note.dropped]
    head = f"{len(kept)} stretches give {len(sniffed.points)} points; {len(lost)} stretches give none"
    rows = [
        (note.sweep, note.kind, f"{note.begin_s:.2f}", f"{note.end_s:.2f}", note.dropped)
        for note in sorted(lost, key=lambda note: (note.kind == MOVE, note.begin_s))[
            : constants.MOST_ROWS_IN_TERMINAL
        ]
    ]
    shown = (
        table(("part of", "kind", "from [s]", "to [s]", "why it gives no point"), rows, left=2)
        if rows
        else ""
    )
    hidden = len(lost) - len(rows)
    more = f"... and {hidden} more in stretches.csv" if hidden else ""
    return "\n".join(part for part in (head, shown, more) if part)

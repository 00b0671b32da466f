"""The content of recordings, for the terminal."""

from collections.abc import Sequence

import numpy as np

from mffit.constants import MOST_ROWS
from mffit.points.stretch import MOVE
from mffit.recordings import Sniffed
from mffit.recordings.project_file import how_to_agree
from mffit.recordings.recording import SniffedRecording
from mffit.recordings.sniffed import Level, axes_reason
from mffit.report.text.layout import blocks, paragraphs, table
from mffit.sweeps.about import names_tyre, title_of
from tir.errors import counted

SETTINGS = {
    "load": ("N", 1.0, 0),
    "camber": ("deg", 180.0 / np.pi, 1),
    "pressure": ("kPa", 1e-3, 1),
    "speed": ("m/s", 1.0, 2),
    "sideslip": ("deg", 180.0 / np.pi, 1),
}
"""Unit, factor and decimals of a setting."""


def sniff_summary(sniffed: Sniffed) -> str:
    """Channels, units, axes, conditions, rates, gaps and stretches; files with the same columns share a table."""
    alike: dict[tuple[object, ...], list[SniffedRecording]] = {}
    for recording in sniffed.recordings:
        alike.setdefault(_columns(recording), []).append(recording)
    return blocks(
        [
            *(_files(recordings) for recordings in alike.values()),
            _axes(sniffed),
            _conditions(sniffed),
            _stretches(sniffed),
            paragraphs([*_remarks(sniffed.recordings), *sniffed.reading.notes, *sniffed.reading.warnings]),
        ]
    )


def _columns(recording: SniffedRecording) -> tuple[object, ...]:
    """What files with one table have in common."""
    taken = tuple((guess.heading, name, guess.unit) for name, guess in recording.guesses.items())
    return recording.kind, recording.headings, recording.units, taken


def _remarks(recordings: Sequence[SniffedRecording]) -> list[str]:
    """The remarks on columns, each once, with its file or the number of its files."""
    files: dict[str, list[SniffedRecording]] = {}
    for recording in recordings:
        for remark in recording.remarks:
            files.setdefault(remark, []).append(recording)
    return [f"{_named(named)}: {remark}" for remark, named in files.items()]


def _named(recordings: Sequence[SniffedRecording]) -> str:
    first, *others = recordings
    return f"{first.path} and {len(others)} more" if others else str(first.path)


def _files(recordings: Sequence[SniffedRecording]) -> str:
    """Files with the same columns: a line for each, and the columns with their ranges over all of them."""
    first = recordings[0]
    rows = []
    for heading, unit in zip(first.headings, first.units, strict=True):
        guesses = [guess for r in recordings for guess in r.guesses.values() if guess.heading == heading]
        if not guesses:
            rows.append((heading, unit or "-", _use(heading, recordings), ""))
            continue
        guess = guesses[0]
        lower, upper = min(g.lower for g in guesses), max(g.upper for g in guesses)
        found = "" if np.isnan(lower) else f"{lower:.5g} to {upper:.5g}"
        rows.append(
            (heading, unit or (f"{guess.unit}?" if guess.assumed else "-"), guess.channel.name, found)
        )
    heads = [_head(recording) for recording in recordings]
    texts = {_about(recording): None for recording in recordings}
    about = next(iter(texts)) if len(texts) == 1 else ""
    columns = table(("heading", "unit", "is", "range"), rows, left=3)
    return "\n".join([*heads, *([about] if about else []), "", columns])


def _use(heading: str, recordings: Sequence[SniffedRecording]) -> str:
    """Use of a column that is not a channel."""
    stated = (key for r in recordings for key, one in r.tyre.items() if one.heading == heading)
    return next(stated, "name of the tyre" if names_tyre(heading) else "not used")


def _head(recording: SniffedRecording) -> str:
    if np.isfinite(recording.rate):
        rows = (
            f"{counted(recording.samples, 'row')}, {recording.rate:.4g} samples per second over {recording.seconds:.0f} s, "
            f"{counted(recording.gaps, 'gap')} in time"
        )
    elif "t_s" in recording.guesses:
        rows = f"{counted(recording.samples, 'row')}, each a finished point"
    else:
        rows = counted(recording.samples, "row without a time channel")
    return f"{recording.path}: {recording.kind}, {rows}"


def _about(recording: SniffedRecording) -> str:
    said = {**recording.about, "title": title_of(recording.about)}
    return "; ".join(f"{key}: {text[:90]}" for key, text in said.items() if text)


def _axes(sniffed: Sniffed) -> str:
    if not sniffed.axes:
        return f"axes: none of the known axes fit; in ISO signs {' and '.join(sniffed.wrong)}; {how_to_agree(sniffed)}"
    return f"axes: {sniffed.axes[0]} ({axes_reason(sniffed)})"


def _conditions(sniffed: Sniffed) -> str:
    rows = []
    for name, levels in sniffed.conditions.items():
        unit, factor, digits = SETTINGS[name]
        rows.append(
            (name, unit, ", ".join(_level(level, factor, digits) for level in levels) or "not measured")
        )
    return table(("setting", "unit", "conditions found (points)"), rows, left=3)


def _level(level: Level, factor: float, digits: int) -> str:
    ends = [level.value] if level.upper is None else [level.value, level.upper]
    return f"{' to '.join(f'{factor * x + 0.0:.{digits}f}' for x in ends)} ({level.points})"


def _stretches(sniffed: Sniffed) -> str:
    notes = sniffed.reading.stretches
    if not notes:
        return counted(len(sniffed.points), "point")
    kept = [note for note in notes if note.points]
    lost = [note for note in notes if note.dropped]
    points = counted(len(sniffed.points), "point")
    head = f"{points} from {counted(len(kept), 'stretch')}; none from {counted(len(lost), 'stretch')}"
    moves = [note for note in lost if note.kind == MOVE]
    if moves:
        head += f", of which {counted(len(moves), 'move')} between set-points"
    other = sorted((note for note in lost if note.kind != MOVE), key=lambda note: note.begin_s)
    rows = [
        (note.sweep, note.kind, f"{note.begin_s:.2f}", f"{note.end_s:.2f}", note.dropped)
        for note in other[:MOST_ROWS]
    ]
    shown = (
        table(("part of", "kind", "from [s]", "to [s]", "why it gives no point"), rows, left=2)
        if rows
        else ""
    )
    hidden = len(other) - len(rows)
    more = f"... and {hidden} more in stretches.csv" if hidden else ""
    return "\n".join(part for part in (head, shown, more) if part)

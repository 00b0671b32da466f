"""The ``tyre.toml`` for recordings: everything that they state themselves, with comments that say where it comes from."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path

import numpy as np
import tomli_w

from mffit.config.models import Column, TyreTable
from mffit.points import main_pressure
from mffit.recordings.guess import Guess
from mffit.recordings.sniffed import Sniffed, SniffedRecording, holding, points_from
from mffit.sweeps.formats import stem

TYRE_IN_TITLE = re.compile(r"\b(?:tyre|tire|reifen)\s*[:=]\s*(.*\S)", re.IGNORECASE)
SECTION_IN_TITLE = re.compile(r"\[[^\]]*\]")
"""The heading of a section in a text file, ``[DATA]``."""


def project_text(
    sniffed: Sniffed,
    folder: Path,
    *,
    unloaded_radius: float | None,
    nominal_load: float | None,
    nominal_pressure: float | None = None,
    name: str | None = None,
) -> str:
    """The text of a ``tyre.toml``.

    Parameters
    ----------
    sniffed : the recordings
    folder : where the file will be; recordings are named relative to it
    unloaded_radius : [m]; None leaves it to the user
    nominal_load : [N]; None leaves it to the user
    nominal_pressure : [kPa]; None takes the most frequent pressure
    name : of the output files; None takes the name of the first recording
    """
    recordings = sniffed.recordings
    shared = _shared_columns(sniffed)
    of_all = [remark for remark in recordings[0].remarks if all(remark in r.remarks for r in recordings)]
    tables = [
        [
            "# From the recordings below, as `mffit sniff` reads them. The comments say where each value comes from."
        ],
        [
            "[tyre]",
            f"name = {quoted(name or slug(recordings[0].path))}",
            *_size(recordings),
            _given("unloaded_radius", unloaded_radius, "m"),
            _given("nominal_load", nominal_load, "N, FNOMIN"),
            _pressure(sniffed, nominal_pressure),
            *_speed(sniffed),
        ],
        [
            "[rig]",
            'type = "flat-track"  # a straight path; for a disc, give path_centre and path_radius as well',
            _axes(sniffed),
        ],
        ["[columns]  # of all files", *_comments(of_all), *_columns(shared)],
        *(_sweep(recording, folder, shared, of_all) for recording in recordings),
    ]
    return "\n\n".join("\n".join(lines) for lines in tables) + "\n"


def _size(recordings: Collection[SniffedRecording]) -> list[str]:
    """The tyre as a recording names it; else a recording's title as a comment."""
    most = 60  # characters
    tyre = next((tyre for r in recordings if (tyre := named_tyre(r.about))), "")
    title = next((r.about["title"] for r in recordings if r.about.get("title")), "")
    if tyre:
        return [f"size = {quoted(tyre[:most])}  # as the recording names the tyre"]
    return [f'# size = ""  # the title of the recording is: {_one_line(title)[:most]}'] if title else []


def _pressure(sniffed: Sniffed, given: float | None) -> str:
    if given is not None:
        return f"nominal_pressure = {given:g}  # kPa, NOMPRES"
    measured = points_from(sniffed.points, holding(sniffed.recordings, "p_kPa"))
    usual = float(np.median(measured.p[main_pressure(measured)])) if len(measured) else np.nan
    if not np.isfinite(usual):
        return _given("nominal_pressure", None, "kPa, NOMPRES")
    return f"nominal_pressure = {usual / 1e3:.0f}  # kPa, NOMPRES: the most frequent pressure"


def _speed(sniffed: Sniffed) -> list[str]:
    if not any("V_mps" in recording.guesses for recording in sniffed.recordings):
        return []
    levels = sniffed.conditions["speed"]
    default = TyreTable.model_fields["nominal_speed"].default
    speed = max(levels, key=lambda level: level.stretches).value if levels else default
    return [f"nominal_speed = {speed:.3g}  # m/s, LONGVL: the most frequent speed"]


def _sweep(
    recording: SniffedRecording, folder: Path, shared: Mapping[str, Guess], remarks_of_all: Collection[str]
) -> list[str]:
    own = {name: guess for name, guess in recording.guesses.items() if _differs(shared[name], guess)}
    return [
        "[[sweep]]",
        *_comments(remark for remark in recording.remarks if remark not in remarks_of_all),
        f"file = {quoted(relative(recording.path, folder))}",
        *(["[sweep.columns]", *(_column(guess) for guess in own.values())] if own else []),
    ]


def _comments(remarks: Iterable[str]) -> list[str]:
    return [f"# {_one_line(remark)}" for remark in remarks]


def named_tyre(about: Mapping[str, str]) -> str:
    """The tyre that a recording names; of a title, only what follows the word tyre."""
    if about.get("tireid"):
        return about["tireid"]
    found = TYRE_IN_TITLE.search(SECTION_IN_TITLE.sub("", about.get("title", "")))
    return found[1].strip() if found else ""


def _axes(sniffed: Sniffed) -> str:
    if not sniffed.axes:
        wrong = " and ".join(sniffed.wrong[:2])
        return f'axes = "iso"  # no known axes fit: in ISO signs {wrong}; map a column with scale = -1'
    first, *others = sniffed.axes
    reason = "from the signs of side force, aligning moment, camber thrust and load"
    if others:
        also = " or ".join(f'"{axes}"' for axes in others)
        reason = f"{also} would fit these recordings, too: they hold too little camber"
    return f'axes = "{first}"  # {reason}'


def _shared_columns(sniffed: Sniffed) -> dict[str, Guess]:
    """The column of every channel, as in the first file that has it."""
    shared: dict[str, Guess] = {}
    for recording in sniffed.recordings:
        shared |= {name: guess for name, guess in recording.guesses.items() if name not in shared}
    return shared


def _differs(shared: Guess, guess: Guess) -> bool:
    return shared.column != guess.column


def _columns(guesses: Mapping[str, Guess]) -> list[str]:
    """The columns that have another heading or unit than the contract."""
    return [_column(guess) for guess in guesses.values() if guess.column != Column(column=guess.channel.name)]


def _column(guess: Guess) -> str:
    name, heading = guess.channel.name, quoted(guess.heading)
    if guess.unit or guess.scale != 1.0 or guess.against:
        given = {"unit": guess.unit, "against": guess.against}
        keys = [f"column = {heading}", *(f"{key} = {quoted(value)}" for key, value in given.items() if value)]
        if guess.scale != 1.0:
            keys.append(f"scale = {guess.scale:g}")
        text = f"{name} = {{ {', '.join(keys)} }}"
        note = f"the file states no unit: {guess.why}" if guess.unit else guess.why
    else:
        text = f"{name} = {heading}"
        note = f"in {guess.stated}, as the file says" if guess.stated else ""
    return f"{text}  # {_one_line(note)}" if note else text


def _given(key: str, value: float | None, unit: str) -> str:
    return f"# {key} =   # {unit}: fill this in" if value is None else f"{key} = {value:g}  # {unit}"


def quoted(text: str) -> str:
    """A text in TOML's notation."""
    return tomli_w.dumps({"x": text}).partition("=")[2].strip()


def _one_line(text: str) -> str:
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def slug(path: Path) -> str:
    """A name for output files, from the name of a recording."""
    return re.sub(r"[^\w-]+", "-", stem(path.name)).strip("-._") or "tyre"


def relative(path: Path, folder: Path) -> str:
    """The name of a recording relative to a folder."""
    try:
        return Path(os.path.relpath(path.absolute(), folder.absolute())).as_posix()
    except ValueError:  # another drive
        return str(path.absolute())

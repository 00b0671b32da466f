"""The ``tyre.toml`` to go with recordings: everything that they say themselves, each with where it comes from."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import tomli_w

from mffit.points import main_pressure
from mffit.recordings.guess import Guess
from mffit.recordings.sniffed import Sniffed, holding, points_from
from mffit.sweeps.formats import stem

LONGEST = 60
TYRE_IN_TITLE = re.compile(r"\b(?:tyre|tire|reifen)\s*[:=]\s*(.*\S)", re.IGNORECASE)


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
    folder : where the file will stand; recordings are named relative to it
    unloaded_radius : [m]; None leaves it to be filled in
    nominal_load : [N]; None leaves it to be filled in
    nominal_pressure : [kPa]; None takes the pressure at which most was run
    name : of the output files; None takes the first recording's
    """
    first = sniffed.recordings[0]
    said = next((found for r in sniffed.recordings if (found := named_tyre(r.about))), "")
    title = next((r.about["title"] for r in sniffed.recordings if r.about.get("title")), "")
    measured = points_from(sniffed.points, holding(sniffed.recordings, "p_kPa"))
    usual = float(np.median(measured.p[main_pressure(measured)])) if len(measured) else np.nan
    speeds = sniffed.conditions["speed"]
    speed = max(speeds, key=lambda level: level.stretches).value if speeds else 10.0
    lines = [
        "# From the recordings below, as `mffit sniff` reads them. Every comment says where a value comes from.",
        "",
        "[tyre]",
        f"name = {quoted(name or slug(first.path))}",
    ]
    if said:
        lines.append(f"size = {quoted(said[:LONGEST])}  # as the recording names the tyre")
    elif title:
        lines.append(f'# size = ""  # the recording has the title: {_one_line(title)[:LONGEST]}')
    lines += [
        _given("unloaded_radius", unloaded_radius, "m"),
        _given("nominal_load", nominal_load, "N, FNOMIN"),
    ]
    if nominal_pressure is not None:
        lines.append(f"nominal_pressure = {nominal_pressure:g}  # kPa, NOMPRES")
    elif np.isfinite(usual):
        lines.append(
            f"nominal_pressure = {usual / 1e3:.0f}  # kPa, NOMPRES: the middle one of those at which most was run"
        )
    else:
        lines.append(_given("nominal_pressure", None, "kPa, NOMPRES"))
    if any("V_mps" in r.guesses for r in sniffed.recordings):
        lines.append(f"nominal_speed = {speed:.3g}  # m/s, LONGVL: the speed at which most was run")
    lines += [
        "",
        "[rig]",
        'type = "flat-track"  # a straight path; a disc needs path_centre and path_radius, too',
    ]
    lines += _axes(sniffed)
    shared = _shared(sniffed)
    lines += ["", "[columns]  # of all files"]
    said_of_all = [remark for remark in first.remarks if all(remark in r.remarks for r in sniffed.recordings)]
    lines += [f"# {_one_line(remark)}" for remark in said_of_all]
    lines += [
        _column(guess) for guess in shared.values() if guess.heading != guess.channel.name or guess.unit
    ]
    for recording in sniffed.recordings:
        lines += ["", "[[sweep]]"]
        lines += [f"# {_one_line(remark)}" for remark in recording.remarks if remark not in said_of_all]
        lines += [f"file = {quoted(relative(recording.path, folder))}"]
        own = {
            key: guess
            for key, guess in recording.guesses.items()
            if shared.get(key) != guess and _differs(shared, guess)
        }
        if own:
            lines.append("[sweep.columns]")
            lines += [_column(guess) for guess in own.values()]
    return "\n".join(lines) + "\n"


def named_tyre(about: Mapping[str, str]) -> str:
    """What a recording says of its tyre; a title may be of anything and counts only from the word tyre on."""
    if about.get("tireid"):
        return about["tireid"]
    behind = TYRE_IN_TITLE.search(about.get("title", ""))
    return behind[1].strip() if behind else ""


def _axes(sniffed: Sniffed) -> list[str]:
    if not sniffed.axes:
        wrong = " and ".join(sniffed.wrong[:2])
        return [f'axes = "iso"  # no known axes fit: in ISO signs {wrong}; map a column with scale = -1']
    if len(sniffed.axes) == 1:
        return [f'axes = "{sniffed.axes[0]}"  # as side force, aligning moment, camber thrust and load say']
    others = " or ".join(f'"{axes}"' for axes in sniffed.axes[1:])
    return [
        f'axes = "{sniffed.axes[0]}"  # {others} would agree with these recordings, too: they hold too little camber'
    ]


def _shared(sniffed: Sniffed) -> dict[str, Guess]:
    """The columns as the first file that has them names them."""
    out: dict[str, Guess] = {}
    for recording in sniffed.recordings:
        for key, guess in recording.guesses.items():
            out.setdefault(key, guess)
    return out


def _differs(shared: Mapping[str, Guess], guess: Guess) -> bool:
    other = shared[guess.channel.name]
    return (other.heading, other.unit) != (guess.heading, guess.unit)


def _column(guess: Guess) -> str:
    name, heading = guess.channel.name, quoted(guess.heading)
    if guess.unit:
        text = f"{name} = {{ column = {heading}, unit = {quoted(guess.unit)} }}"
        note = f"the file states no unit: {guess.why}"
    else:
        text = f"{name} = {heading}"
        note = f"in {guess.stated}, as the file says" if guess.stated else ""
    return f"{text}  # {_one_line(note)}" if note else text


def _given(key: str, value: float | None, unit: str) -> str:
    return f"# {key} =   # {unit}: to be filled in" if value is None else f"{key} = {value:g}  # {unit}"


def quoted(text: str) -> str:
    """A text as TOML writes it."""
    return tomli_w.dumps({"x": text}).partition("=")[2].strip()


def _one_line(text: str) -> str:
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def slug(path: Path) -> str:
    """A name for output files from a recording's."""
    return re.sub(r"[^\w-]+", "-", stem(path.name)).strip("-._") or "tyre"


def relative(path: Path, folder: Path) -> str:
    """A recording's name as seen from the folder."""
    try:
        return Path(os.path.relpath(path.absolute(), folder.absolute())).as_posix()
    except ValueError:  # another drive
        return str(path.absolute())

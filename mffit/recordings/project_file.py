"""The ``tyre.toml`` for recordings: every value that they state, with comments that name its source."""

import math
import os
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import tomli_w

from mffit.config.models import Column, RigTable, TyreTable
from mffit.constants import NAMED_IN_SENTENCE, USUAL_CORNERING_STIFFNESS
from mffit.points import main_pressure
from mffit.recordings.disc import DiscPath, disc_signs
from mffit.recordings.recording import SniffedRecording, rolls_backward, speed_is_negative
from mffit.recordings.sniffed import Sniffed, axes_reason, holding, points_from, stated_of_tyre
from mffit.recordings.unstated import Guess
from mffit.suspicion.all_files import LevelsOfLoad
from mffit.sweeps.about import named_tyre, title_of
from mffit.sweeps.formats import stem
from tir.errors import counted

MOST_OF_SIZE = 60
"""Maximum number of characters of a size or title in ``tyre.toml``."""
ZEROS_OF_A_DISC = [
    "# backlash_deg = 0.0       # full play of the sideslip axis; this and how well the zeros are known decide how certain",
    '# u_loadcell_offset_N = 10 # the camber reduction factor is; see "Run a programme on a disc" in the documentation',
]
ROLLING_RADIUS = [
    "# One turn of the disc; without it the camber reduction factor is not measured. One [[rolling_radius]] per load:",
    "# [[rolling_radius]]",
    "# load_N = ",
    "# revolutions =            # whole turns of the wheel",
    "# angle_start_deg =        # of the wheel, before and after",
    "# angle_end_deg = ",
]
"""Placeholder for measurements that recordings of a disc do not contain."""
METRIC_SIZE = re.compile(r"(?<!\d)([6-9]\d|\d{3})/\d{2}\s*-?\s*[A-Z]{0,3}\s*-?\s*(\d{2})(?!\d)")
"""``120/70 ZR17``: width in millimetres, rim in inches."""
INCH_SIZE = re.compile(r"(?<!\d)\d{2}(?:\.\d+)?\s*x\s*(\d{1,2}(?:\.\d+)?)\s*-\s*(\d{2})(?!\d)", re.IGNORECASE)
"""``16x7.5-10``: diameter, width and rim in inches."""
INCH = 0.0254


class Stated(NamedTuple):
    """Data of tyre and rig that a user or recordings state; None where they state nothing."""

    unloaded_radius: float | None = None  #: [m]
    nominal_load: float | None = None  #: [N]
    nominal_pressure: float | None = None  #: [kPa]; else the most frequent pressure
    nominal_speed: float | None = None  #: [m/s]; else the most frequent speed
    name: str | None = None
    """Of the output files; else the name of the project's folder, or of the only recording if it lies there."""
    size: str | None = None
    width: float | None = None  #: [m]; else from the size
    rim_radius: float | None = None  #: [m]; else from the size
    side: str | None = None
    axes: str | None = None  #: else the axes that agree with physics
    disc: DiscPath | None = None  #: None for a belt, or if it is not known
    belt: bool = False  #: whether the path is straight for certain, even if the recordings look like a disc


NOTHING_STATED = Stated()


def tyre_found(sniffed: Sniffed, folder: Path) -> Stated:
    """Data of the tyre from the recordings and the name of the project's folder, rounded as in ``tyre.toml``."""
    size = next((tyre for r in sniffed.recordings if (tyre := named_tyre(r.about))), "")
    width, rim_radius = _of_size(size)
    first = sniffed.recordings[0].path
    own = folder.name and (len(sniffed.recordings) > 1 or folder.resolve() != first.parent.resolve())
    of_files = {key: one.value for key, one in stated_of_tyre(sniffed).items()}
    return Stated(
        unloaded_radius=of_files.get("unloaded_radius"),
        nominal_load=of_files.get("nominal_load"),
        name=slug(folder if own else first),
        size=size[:MOST_OF_SIZE] or None,
        width=width,
        rim_radius=rim_radius,
        nominal_pressure=of_files.get("nominal_pressure", _pressure(sniffed)),
        nominal_speed=_speed(sniffed),
    )


def project_text(sniffed: Sniffed, folder: Path, stated: Stated = NOTHING_STATED) -> str:
    """The text of a ``tyre.toml`` in ``folder``; its paths to recordings are relative to ``folder``."""
    recordings = sniffed.recordings
    shared = _shared_columns(sniffed)
    of_all = [remark for remark in recordings[0].remarks if all(remark in r.remarks for r in recordings)]
    tables = [
        [
            "# From the recordings below, as `mffit sniff` reads them. The comments say where each value comes from."
        ],
        ["[tyre]", *_tyre(sniffed, folder, stated)],
        [
            "[rig]",
            *_path(sniffed, stated.disc, stated.belt),
            _axes(sniffed, stated.axes),
            *_alignment(stated.nominal_load or tyre_found(sniffed, folder).nominal_load),
            *(ZEROS_OF_A_DISC if stated.disc is not None else ()),
        ],
        *([ROLLING_RADIUS] if stated.disc is not None else []),
        ["[columns]  # of all files", *_comments(of_all), *_columns(shared)],
        *_bad_runs(sniffed, folder),
        *_sweeps(recordings, folder, {name: guess.column for name, guess in shared.items()}, of_all),
    ]
    return _text(tables)


def _alignment(nominal_load: float | None) -> Iterator[str]:
    """The line on the alignment that is assumed unless the user states it; none without a nominal load [N]."""
    key = "u_slip_alignment_N"
    force = RigTable.model_fields[key].default
    if nominal_load:
        angle = math.degrees(force / (USUAL_CORNERING_STIFFNESS * nominal_load))
        yield (
            f"# {key} = {force:g}  # side force that a misaligned sideslip axis may still cause: about {angle:.1g} deg of this "
            "tyre; state what the rig is set up to"
        )


def sweeps_text(sniffed: Sniffed, folder: Path, columns: Mapping[str, Column]) -> str:
    """The text of one [[sweep]] per recording, for a ``tyre.toml`` in ``folder`` with these [columns]."""
    own_names = {name: Column(column=name) for recording in sniffed.recordings for name in recording.guesses}
    named = {
        name: one if one.value is not None else one.model_copy(update={"column": one.column or name})
        for name, one in columns.items()
    }
    return _text(_sweeps(sniffed.recordings, folder, {**own_names, **named}, ()))


def _text(tables: Sequence[Sequence[str]]) -> str:
    return "\n\n".join("\n".join(lines) for lines in tables) + "\n"


OF_TYRE = (
    ("size", "", "as the recording names the tyre"),
    ("width", "m", ", as the size says"),
    ("rim_radius", "m", ", as the size says"),
    ("unloaded_radius", "m", ""),
    ("nominal_load", "N, FNOMIN", ""),
    ("nominal_pressure", "kPa, NOMPRES", ": the most frequent pressure"),
    ("nominal_speed", "m/s, LONGVL", ": the most frequent speed"),
)
"""Keys of [tyre] with their unit and the source of a value that recordings give without stating it."""


def _tyre(sniffed: Sniffed, folder: Path, stated: Stated) -> Iterator[str]:
    """The lines of [tyre]; a stated value equal to that of the recordings gets the comment that names them as source."""
    found, of_files = tyre_found(sniffed, folder), stated_of_tyre(sniffed)
    title = next((title for r in sniffed.recordings if (title := title_of(r.about))), "")
    load = found.nominal_load if stated.nominal_load is None else stated.nominal_load
    doubts = {"nominal_load": _one_line(load_beyond(sniffed, load))}
    yield f"name = {quoted(stated.name or str(found.name))}"
    if title and not (stated.size or found.size):
        yield f'# size = ""  # the title of the recording is: {_one_line(title)[:MOST_OF_SIZE]}'
    for key, unit, why in OF_TYRE:
        value, own, note = getattr(stated, key), getattr(found, key), unit
        if value is None or value == own:
            value, note = own, unit + (f", {of_files[key].why}" if key in of_files else why)
        comment = "; ".join(filter(None, (note, doubts.get(key))))
        if value is not None:
            text = quoted(value) if isinstance(value, str) else f"{value:g}"
            yield f"{key} = {text}" + f"  # {comment}" * bool(comment)
        elif TyreTable.model_fields[key].is_required():
            yield f"# {key} =   # {unit}: fill this in"
    if stated.side not in (None, TyreTable.model_fields["side"].default):
        yield f"side = {quoted(str(stated.side))}"


def _of_size(tyre: str) -> tuple[float | None, float | None]:
    """Width and rim radius [m] from the size of a tyre; None for an unknown notation."""
    metric, inches = METRIC_SIZE.search(tyre), INCH_SIZE.search(tyre)
    if metric:
        width, rim = 1e-3 * float(metric[1]), INCH * float(metric[2])
    elif inches:
        width, rim = INCH * float(inches[1]), INCH * float(inches[2])
    else:
        return None, None
    return float(f"{width:.4g}"), float(f"{0.5 * rim:.4g}")


def load_beyond(sniffed: Sniffed, nominal_load: float | None) -> str:
    """A remark if the nominal load [N] is above every load of the recordings; "" otherwise."""
    loads = LevelsOfLoad.of(sniffed.points)
    if nominal_load is None or not loads.below(nominal_load):
        return ""
    return (
        f"the nominal load of {nominal_load:g} N is above the highest load of {loads.highest:.0f} N: check the unit of the load "
        f"({', '.join(sorted({r.guesses['Fz_N'].unit_of_readings for r in sniffed.recordings}))})"
    )


def _pressure(sniffed: Sniffed) -> float | None:
    """The most frequent pressure [kPa]; None if none is measured."""
    measured = points_from(sniffed.points, holding(sniffed.recordings, "p_kPa"))
    usual = float(np.median(measured.p[main_pressure(measured)])) if len(measured) else np.nan
    return float(round(usual / 1e3)) if np.isfinite(usual) else None


def _speed(sniffed: Sniffed) -> float | None:
    """The most frequent speed [m/s]; None if none is measured."""
    if not any("V_mps" in recording.guesses for recording in sniffed.recordings):
        return None
    levels = sniffed.conditions["speed"]
    default = TyreTable.model_fields["nominal_speed"].default
    speed = max(levels, key=lambda level: level.points).value if levels else default
    return float(f"{speed:.3g}")


def _path(sniffed: Sniffed, disc: DiscPath | None, belt: bool) -> list[str]:
    """The lines of [rig] about the path: as given, else by signs of a disc in the recordings."""
    if disc is not None:
        return [
            'type = "rotating-disk"',
            f"path_centre = {quoted(disc.centre)}  # of the disc, seen rolling forwards",
            f"path_radius = {disc.radius:g}  # m",
        ]
    signs = [] if belt else disc_signs(sniffed)
    if not signs:
        return [
            'type = "flat-track"  # a straight path; for a disc, give path_centre and path_radius as well'
        ]
    return [
        f'type = "rotating-disk"  # it looks like a disc: {_one_line("; ".join(signs))}',
        '# path_centre =   # "left" or "right", where the disc\'s centre is, seen rolling forwards: fill this in',
        "# path_radius =   # m: fill this in",
    ]


def _bad_runs(sniffed: Sniffed, folder: Path) -> list[list[str]]:
    """The table [fit] with ``exclude`` for the runs that a summary calls bad; empty without any."""
    entries = [
        f"    {{ file = {quoted(relative(run.recording, folder))}, lines = {quoted(run.lines)}, why = {quoted(run.why)} }},"
        for run in sniffed.bad_runs
    ]
    return [["[fit]", "exclude = [", *entries, "]"]] if entries else []


def _sweeps(
    recordings: Sequence[SniffedRecording],
    folder: Path,
    shared: Mapping[str, Column],
    remarks_of_all: Collection[str],
) -> list[list[str]]:
    """A [[sweep]] for every recording; a remark on several is with the first, with their number."""
    number = Counter(remark for recording in recordings for remark in set(recording.remarks))
    first = {remark: recording for recording in reversed(recordings) for remark in recording.remarks}
    return [
        [
            "[[sweep]]",
            *_comments(
                remark + f" (also {counted(number[remark] - 1, 'file')} below)" * (number[remark] > 1)
                for remark in recording.remarks
                if remark not in remarks_of_all and first[remark] is recording
            ),
            f"file = {quoted(relative(recording.path, folder))}",
            *_content(recording, shared),
        ]
        for recording in recordings
    ]


def _content(recording: SniffedRecording, shared: Mapping[str, Column]) -> Iterator[str]:
    """The lines of a recording's [[sweep]] after ``file``: direction, and columns that differ from [columns]."""
    if recording.backward:
        of_speed = "from the sign of the speed" if speed_is_negative(recording.guesses) else "as chosen"
        of_name = "from the name of the file" if rolls_backward(recording.path) else ""
        yield f'direction = "backward"  # {of_name or of_speed}'
    own = [_column(guess) for name, guess in recording.guesses.items() if guess.column != shared.get(name)]
    yield from ["[sweep.columns]", *own] if own else []


def _comments(remarks: Iterable[str]) -> list[str]:
    return [f"# {_one_line(remark)}" for remark in remarks]


def _axes(sniffed: Sniffed, stated: str | None) -> str:
    if stated is not None and stated not in sniffed.axes[:1]:
        return f'axes = "{stated}"  # as chosen'
    if not sniffed.axes:
        wrong = " and ".join(sniffed.wrong[:2])
        return f'axes = "iso"  # no known axes fit: in ISO signs {wrong}; {how_to_agree(sniffed)}'
    return f'axes = "{sniffed.axes[0]}"  # {axes_reason(sniffed)}'


def how_to_agree(sniffed: Sniffed) -> str:
    """What to write if no axes fit: the fewest columns whose reversal lets some fit, with the axes."""
    guesses = _shared_columns(sniffed)
    cures = [
        " and ".join(
            _column(guess._replace(scale=-guess.scale, why="")).partition("  #")[0]
            for guess in (guesses[name] for name in names)
        )
        + f' under [columns] with axes = "{axes}"'
        for names, axes in sniffed.reversible
        if all(name in guesses and guesses[name].value is None for name in names)
    ]
    if not cures:
        return "more than one column has the wrong sign: map each with scale = -1"
    return f"all signs agree with {', or with '.join(cures[:NAMED_IN_SENTENCE])}"


def _shared_columns(sniffed: Sniffed) -> dict[str, Guess]:
    """The column of every channel in the first file that has it; headings that name several channels are left out."""
    shared: dict[str, Guess] = {}
    channels: dict[str, set[str]] = {}
    for recording in sniffed.recordings:
        shared |= {name: guess for name, guess in recording.guesses.items() if name not in shared}
        for name, guess in recording.guesses.items():
            channels.setdefault(guess.heading, set()).add(name)
    return {name: guess for name, guess in shared.items() if len(channels[guess.heading]) == 1}


def _columns(guesses: Mapping[str, Guess]) -> list[str]:
    """Lines for the columns whose heading, unit or sign differs from the contract."""
    return [_column(guess) for guess in guesses.values() if guess.column != Column(column=guess.channel.name)]


def _column(guess: Guess) -> str:
    name, heading = guess.channel.name, quoted(guess.heading)
    if guess.value is not None:
        return f"{name} = {guess.value:g}  # {', '.join(filter(None, (guess.channel.unit, 'as given for all rows')))}"
    if guess.unit or guess.scale != 1.0 or guess.against or guess.over:
        given = {"unit": guess.unit, "over": guess.over, "against": guess.against}
        keys = [f"column = {heading}", *(f"{key} = {quoted(value)}" for key, value in given.items() if value)]
        if guess.scale != 1.0:
            keys.append(f"scale = {guess.scale:g}")
        text = f"{name} = {{ {', '.join(keys)} }}"
        note = f"the file states no unit: {guess.why}" if guess.unit and guess.assumed else guess.why
    else:
        text = f"{name} = {heading}"
        stated = f"in {guess.stated}, as the file says" if guess.stated and guess.channel.unit else ""
        note = "; ".join(part for part in (stated, guess.why) if part)
    return f"{text}  # {_one_line(note)}" if note else text


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

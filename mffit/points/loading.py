"""All sweeps of a configuration, or a single table, as points."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from mffit import config as configuration
from mffit import sweeps as files
from mffit.config import Config, path_curvature
from mffit.config.loading import STAND_IN, as_declared
from mffit.constants import NAMED_IN_SENTENCE
from mffit.errors import InputError
from mffit.points import levels
from mffit.points.averaging import rows_as_points
from mffit.points.choice import settings_of
from mffit.points.clock import evenly_timed, with_common_clock
from mffit.points.faulty import DRIVEN, bridged
from mffit.points.left_out import LeftOut, at_standstill, by_hand
from mffit.points.lost import little_used, lost_sweeps
from mffit.points.other_label import other_labels
from mffit.points.points import Points, concatenate
from mffit.points.reduction import Reduced, reduce
from mffit.points.silent import without_silent_moments
from mffit.points.slip_zero import SlipRemarks, SlipZero, against_free_rolling, readings_of
from mffit.points.steady import scale_of
from mffit.points.steps import steps
from mffit.points.stretch import StretchNote
from mffit.points.unlike import unlike_files
from mffit.sweeps.sweep import Sweep, Sweeps
from tir.conventions import FLIPPED

SIDES = ("left", "right")
KEEPS_MOVING = "keeps moving and gives no steady point; only mffit diagnose uses it"


class Reading(NamedTuple):
    """The points of a configuration, with warnings, notes and the stretches of its recordings."""

    points: Points
    warnings: tuple[str, ...]
    stretches: tuple[StretchNote, ...]  #: of all recordings
    left_out: tuple[LeftOut, ...] = ()  #: readings left out by hand and by rules
    excluded: Points | None = None  #: finished points that were left out by hand; None without any
    steps: Mapping[str, Points] = MappingProxyType({})
    """By stepped setting (sideslip angle or slip), samples of steps, with each run as a sweep."""
    notes: tuple[str, ...] = ()  #: remarks that need no action
    taken_off: tuple[str, ...] = ()  #: sentences about undeclared rig errors that were subtracted
    as_read: Points | None = None  #: the points before this subtraction; None without any
    doubts: tuple[str, ...] = ()  #: warnings for which a result of these points is in doubt
    reasons: tuple[str, ...] = ()  #: warnings for which a result of these points is not to be trusted


def read(config: Config, *, continuous: bool = False, may_be_empty: bool = False) -> Reading:
    """The sweeps of a checked ``tyre.toml`` as points in ISO-W axes; :func:`mffit.suspicion.before_the_fit` judges them.

    On a straight path the means along continuous sweeps are points like any others, because the fit models their lag. A disc
    needs pairs of steady points and leaves them out, unless ``continuous``: they are then kept, marked so, and an undeclared
    zero of the longitudinal slip stays in the readings.

    Raises InputError if a file cannot be read, or no point is found and the result must not be empty (``may_be_empty``).
    """
    phi_t = {entry.file: path_curvature(config.rig, entry) for entry in config.sweep}
    radius = config.tyre.unloaded_radius
    with as_declared(config):
        found, of_slip = _loaded(config, continuous)
        series = list(zip(found.sweeps, _as_recorded(config, found.sweeps, continuous), strict=True))
        scale = scale_of([settings_of(whole or one) for one, whole in series if one.is_series])
        reduced = [reduce(one, phi_t[one.file], scale, whole, radius) for one, whole in series]
    points = concatenate([part.points for part in reduced if len(part.points)] or [reduced[0].points])
    points = points if config.rig.on_disc or continuous else points.replace(continuous=False)
    steady = points.select(~points.continuous) if config.rig.on_disc else points
    if not len(steady) and not may_be_empty:
        raise InputError(_nothing(reduced), file=config.path)
    moving = () if continuous else _moving_left_out(points)
    reasons, doubts = _doubted(reduced, steady, points)
    kept, silent = without_silent_moments(points if continuous else steady) if len(steady) else (steady, ())
    return Reading(
        kept,
        warnings=(
            *reasons,
            *doubts,
            *found.warnings,
            *(sentence for part in reduced for sentence in part.warnings),
            *(f"{one.file}: {KEEPS_MOVING}" for one in moving),
            *(_thin(steady, config) if len(steady) else [_nothing(reduced)]),
            *silent,
        ),
        stretches=tuple(note for part in reduced for note in part.stretches),
        left_out=(
            *by_hand(found.excluded),
            *at_standstill(found.standing),
            *(one for part in reduced for one in part.left_out),
            *moving,
        ),
        excluded=_excluded(found.of_excluded, phi_t),
        steps=steps(found.sweeps, phi_t, radius, scale),
        notes=of_slip.notes,
        taken_off=tuple(dict.fromkeys(said for _, said in of_slip.taken_off.values())),
        as_read=_slip_as_read(kept, of_slip.taken_off),
        doubts=doubts,
        reasons=reasons,
    )


def _loaded(config: Config, continuous: bool) -> tuple[Sweeps, SlipRemarks]:
    """The sweeps as read, with even times on a common clock, without short gaps, and with slip against free rolling."""
    found = files.load(config)
    timed = [evenly_timed(sweep) for sweep in found.sweeps]
    held = [bridged(sweep, ("p", "V", "T")) for sweep, _ in timed]  # often logged at a lower rate
    sweeps, of_slip = against_free_rolling(with_common_clock(held), config, with_errors=continuous)
    said = (sentence for _, sentences in timed for sentence in sentences)
    return replace(found, sweeps=sweeps, warnings=(*found.warnings, *said, *of_slip.warnings)), of_slip


def _as_recorded(config: Config, sweeps: Sequence[Sweep], continuous: bool) -> list[Sweep | None]:
    """For each sweep, the recording with the lines that are left out by hand; None if there are none, or one cannot be read."""
    shortened = {sweep.file for sweep in sweeps if sweep.is_series} & {one.file for one in config.fit.exclude}
    fit = config.fit.model_copy(update={"exclude": ()})
    found: dict[tuple[str, str], Sweep] = {}
    for entry in config.sweep:
        if entry.file in shortened:
            with suppress(InputError):
                own = _loaded(config.model_copy(update={"sweep": (entry,), "fit": fit}), continuous)[0].sweeps
                found |= {(one.file, one.name): one for one in own if np.all(np.diff(one.time) > 0.0)}
    return [found.get((sweep.file, sweep.name)) for sweep in sweeps]


def _doubted(
    reduced: Sequence[Reduced], compared: Points, points: Points
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Why a result of the points is not to be trusted, and why it is in doubt.

    Settings of the recordings may be lost in the ``points``; files and labels may be contradicted by others at like conditions
    among those ``compared``.
    """
    stretches = [note for part in reduced for note in part.stretches]
    lost = lost_sweeps((part.ranges for part in reduced), points, stretches)
    unlike = (unlike_files(compared), other_labels(compared))
    return (
        tuple(one.sentence for one in lost if one.whole),
        (
            *(one.sentence for one in lost if not one.whole),
            *(() if lost else little_used(stretches)),
            *(one.sentence for kind in unlike for one in kind[:NAMED_IN_SENTENCE]),
        ),
    )


def _slip_as_read(points: Points, taken_off: Mapping[str, tuple[SlipZero, str]]) -> Points | None:
    """The points with the slip as the rig read it; None if no zero was subtracted."""
    if not taken_off:
        return None
    kappa = points.kappa.copy()
    of = readings_of(points)
    for file, (zero, _) in taken_off.items():
        own = points.file == points.files.index(file) if file in points.files else np.zeros(len(points), bool)
        kappa[own] = ((1.0 + kappa) * (1.0 + zero.at(of)) - 1.0)[own]
    return points.replace(kappa=kappa)


def _excluded(excluded: Sequence[Sweep], phi_t: Mapping[str, float]) -> Points | None:
    """Finished points that were left out by hand; None without any."""
    parts = [
        rows_as_points(sweep, phi_t[sweep.file], np.arange(len(sweep)))
        for sweep in excluded
        if not sweep.is_series
    ]
    return concatenate(parts) if parts else None


def _nothing(reduced: Sequence[Reduced]) -> str:
    """The error sentence if no recording gives a point."""
    reasons: dict[str, float] = {}
    for note in (note for part in reduced for note in part.stretches if note.dropped):
        reasons[note.dropped] = reasons.get(note.dropped, 0.0) + note.end_s - note.begin_s
    if not any(part.stretches for part in reduced):
        return f"there is no point left: all are {DRIVEN}"
    longest = max(reasons, key=lambda reason: reasons[reason], default="")
    if longest == DRIVEN:
        return (
            f'no sweep is left: the readings are {DRIVEN}; name its column, Fx_N = "HEADING" under [columns]'
        )
    if any(note.points for part in reduced for note in part.stretches):
        return (
            "no sweep rests long enough for a steady point: on a disc, angles that keep moving give none, because turn slip is "
            "found from pairs of like rests; hold every set-point for some seconds"
        )
    most = f" (most of the time: {longest})" if longest else ""
    remedy = "hold every set-point for some seconds"
    if DRIVEN not in reasons:
        remedy += ", or leave out column time_s to take each row for a finished point"
    return f"no sweep rests long enough for a steady point{most}; {remedy}"


def load_table(path: str | Path, *, axes: str | None = None, path_centre: str | None = None) -> Points:
    """Points of a table without ``tyre.toml``, with the headings of docs/files.md, for the alignment of the sideslip axis.

    ``axes`` are "iso", "sae" or "adapted-sae", ``path_centre`` "left" or "right"; the radius is unknown, so phi_t is -1 or 1
    and only its sign has a meaning. A continuous sweep has no zero points and is left out.

    Raises InputError if ``axes`` or ``path_centre`` is not given, or the file cannot be read.
    """
    rig = {
        "axes": _given("axes", axes, tuple(FLIPPED), path),
        "path_centre": _given("path_centre", path_centre, SIDES, path),
        "path_radius": 1.0,
    }
    content = {"tyre": {"name": "table", **STAND_IN}, "rig": rig, "sweep": [{"file": Path(path).name}]}
    return read(configuration.load(content, folder=Path(path).parent), may_be_empty=True).points


def _given(name: str, value: str | None, choice: tuple[str, ...], path: str | Path) -> str:
    """The value of an argument that a bare table cannot state; raises InputError if it is not one of ``choice``."""
    if value in choice:
        return value
    found = f"does not say the rig's {name}" if value is None else f'{name} = "{value}" is not known'
    written = " or ".join(f'"{one}"' for one in choice)
    raise InputError(f"{found}; give {name} = {written}, or a tyre.toml", file=path)


def _moving_left_out(points: Points) -> tuple[LeftOut, ...]:
    """Entries about means along moving sweeps of a disc; ``count`` is the number of means."""
    return tuple(
        LeftOut(
            file=points.files[index],
            lines="",
            count=int(np.sum(points.continuous & (points.file == index))),
            by="rule",
            rule="steady-state",
            why="means along a moving sweep; only mffit diagnose uses them",
        )
        for index in np.unique(points.file[points.continuous]).tolist()
    )


def _thin(points: Points, config: Config) -> list[str]:
    """Warnings about missing channels, directions and loads."""
    out = []
    if not np.any(np.isfinite(points.Mz)):
        out.append("Mz_Nm was not measured: the coefficients of the self-aligning moment are held")
    one_side = len(np.unique(np.sign(points.phi_t))) == 1
    if config.rig.on_disc and one_side and not np.any(points.direction < 0):
        out.append(
            "there are no backward runs: sideslip misalignment cannot be separated from turn slip and ply-steer"
        )
    if levels.count(points.Fz, levels.LOAD) == 1:
        out.append(f"there is one load only ({np.mean(points.Fz):.0f} N): terms that vary with load are held")
    return out

"""Builds of other campaigns of the same tyre, from which this project takes coefficients."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from mffit.config import Config
from mffit.fit import constants
from mffit.fit.borrowed.campaign import FittedCampaign, shared_conditions
from mffit.pipeline.inputs import other_project, read_points, wrong_campaign
from mffit.points import Points, concatenate
from mffit.points.loading import Reading
from mffit.progress import Progress
from mffit.results import BuildResult
from mffit.rig_errors import BY_NAME, OF_RUN, number_of
from mffit.suspicion.other_tyre import two_tyres

SAME_OF_ONE_TYRE = ("unloaded_radius", "width", "rim_radius", "nominal_load", "nominal_pressure")
"""Keys of [tyre] that the projects of one tyre share: coefficients are relative to them."""


def projects_of(config: Config) -> tuple[Config, ...]:
    """The projects that ``[[campaign]]`` names.

    An InputError says that one of them cannot be read, names campaigns itself, or is of another tyre.
    """
    out = tuple(other_project(config, index) for index in range(len(config.campaign)))
    for index, other in enumerate(out):
        _refuse_another_tyre(config, other, index)
    return out


def campaigns_of(
    config: Config,
    projects: Sequence[Config],
    points: Points,
    build: Callable[..., BuildResult],
    progress: Progress,
) -> tuple[tuple[FittedCampaign, ...], tuple[BuildResult, ...], tuple[str, ...]]:
    """The fitted campaigns of the other projects, their builds, and warnings about them.

    Parameters
    ----------
    config : of this project
    projects : the others
    points : of this project
    build : a configuration to its result
    progress : called with a sentence before each build

    Raises
    ------
    InputError
        The readings of a project cannot be fitted, or their radii are those of another tyre.
    """
    out, built, warned = [], [], []
    for index, (row, other) in enumerate(zip(config.campaign, projects, strict=True)):
        progress(f"building the campaign {row.toml}")
        result = build(other, progress=progress)
        _refuse_other_radii(config, points, result.points, index)
        if not result.trusted:
            warned.append(f"the campaign {row.toml} is not to be trusted: {'; '.join(result.reasons)}")
        fit = result.fit
        built.append(result)
        out.append(
            FittedCampaign(
                name=row.toml,
                tyre=fit.tyre,
                coefficients=fit.coefficients,
                posterior=fit.posterior,
                shared=shared_conditions(points, result.points),
                rig=_rig_in(row.toml, fit.rig),
                misfit=fit.headline,
                combined=fit.band_of_combined,
            )
        )
    return tuple(out), tuple(built), tuple(warned)


def _rig_in(campaign: str, rig: Mapping[str, tuple[float, float]]) -> dict[str, tuple[float, float]]:
    """Errors of the rig of a campaign as joined points call them; what belongs to the tyre is left out."""
    out = {}
    for name, found in rig.items():
        error, _, part = name.partition(OF_RUN)
        if BY_NAME[error].kind == "rig":
            out[number_of(error, f"{Path(campaign).parent.as_posix()}/{part}" if part else campaign)] = found
    return out


def points_of_all(
    config: Config, projects: Sequence[Config], reading: Reading, *, continuous: bool
) -> tuple[Reading, dict[str, Config]]:
    """The readings of this project and of all others together, and the configurations of the others.

    The campaigns of the points, the keys of the second result, are named as ``[[campaign]]`` names them, this project after its
    own file. Files, sweeps and set-ups of the others are renamed after their folders.

    Parameters
    ----------
    config, projects : this project and the others
    reading : of this project
    continuous : see :func:`mffit.points.read`
    """
    if not projects:
        return reading, {}
    own = config.path.name if config.path is not None else "this project"
    parts, warnings, left_out, others = [_named(reading.points, own, "")], [], [], {}
    as_read, taken_off = [_named(reading.as_read or reading.points, own, "")], list(reading.taken_off)
    for index, (row, other) in enumerate(zip(config.campaign, projects, strict=True)):
        found = read_points(other, continuous=continuous)
        _refuse_other_radii(config, reading.points, found.points, index)
        folder = Path(row.toml).parent.as_posix()
        parts.append(_named(found.points, row.toml, folder))
        as_read.append(_named(found.as_read or found.points, row.toml, folder))
        taken_off += [f"{row.toml}: {sentence}" for sentence in found.taken_off]
        left_out += [replace(one, file=f"{folder}/{one.file}") for one in found.left_out]
        warnings += [f"{row.toml}: {sentence}" for sentence in found.warnings]
        others[row.toml] = other
    return (
        reading._replace(
            points=concatenate(parts),
            warnings=(*reading.warnings, *warnings),
            left_out=(*reading.left_out, *left_out),
            taken_off=tuple(taken_off),
            as_read=concatenate(as_read) if taken_off else None,
        ),
        others,
    )


def _named(points: Points, campaign: str, folder: str) -> Points:
    """The points as those of a campaign, whose folder precedes the names of its files and sweeps."""

    def within(names: tuple[str, ...]) -> tuple[str, ...]:
        return tuple(f"{folder}/{name}" for name in names) if folder else names

    setups = points.setups if len(points.setups) > 1 and not folder else within(points.setups)
    if len(points.used_setups) < 2:
        setups = (campaign,) * len(points.setups)
    return points.replace(
        campaign=0,
        campaigns=(campaign,),
        files=within(points.files),
        sweep_names=within(points.sweep_names),
        setups=setups,
    )


def _refuse_another_tyre(config: Config, other: Config, index: int) -> None:
    """Refuse a project whose tyre has other dimensions or another nominal condition."""
    mine, theirs, name = config.tyre, other.tyre, config.campaign[index].toml
    if "-" not in (mine.size, theirs.size) and mine.size != theirs.size:
        sentence = (
            f"{name} is of a tyre of size {theirs.size}, this one is {mine.size}; campaigns are of one tyre"
        )
        raise wrong_campaign(config, index, sentence)
    for key in SAME_OF_ONE_TYRE:
        a, b = getattr(mine, key), getattr(theirs, key)
        if a is not None and b is not None and abs(a - b) > constants.SAME_NOMINAL_CONDITION * a:
            sentence = (
                f"{name} has {key} = {b:g}, but this project {a:g}: campaigns are of one tyre, and coefficients are relative to "
                "it; correct one of them"
            )
            raise wrong_campaign(config, index, sentence)


def _refuse_other_radii(config: Config, points: Points, others: Points, index: int) -> None:
    """Refuse readings whose loaded or rolling radius is that of another tyre."""
    folder = Path(config.campaign[index].toml).parent
    renamed = replace(others, files=tuple((folder / file).as_posix() for file in others.files))
    found = next(iter(two_tyres.find(concatenate([points, renamed]), config)), None)
    if found is not None:
        raise wrong_campaign(config, index, two_tyres.said(found.facts))

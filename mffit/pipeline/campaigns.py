"""Builds of other campaigns of the same tyre, from which this project takes coefficients."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from mffit.config import Config
from mffit.fit import constants
from mffit.fit.campaign import FittedCampaign, shared_conditions
from mffit.pipeline.inputs import other_project, wrong_campaign
from mffit.points import Points, concatenate
from mffit.progress import Progress
from mffit.results import BuildResult
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
) -> tuple[tuple[FittedCampaign, ...], tuple[str, ...]]:
    """The fitted campaigns of the other projects, and warnings about them.

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
    out, warned = [], []
    for index, (row, other) in enumerate(zip(config.campaign, projects, strict=True)):
        progress(f"building the campaign {row.toml}")
        result = build(other, progress=progress)
        _refuse_other_radii(config, points, result.points, index)
        if not result.trusted:
            warned.append(f"the campaign {row.toml} is not to be trusted: {'; '.join(result.reasons)}")
        fit = result.fit
        out.append(
            FittedCampaign(
                name=row.toml,
                tyre=fit.tyre,
                coefficients=fit.coefficients,
                posterior=fit.posterior,
                shared=shared_conditions(points, result.points),
            )
        )
    return tuple(out), tuple(warned)


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

"""Other campaigns of the same tyre: their projects, built for what they give to this one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from mffit.config import Config
from mffit.errors import InputError
from mffit.fit import constants
from mffit.fit.campaign import Campaign, shared_conditions
from mffit.pipeline.inputs import other_project
from mffit.points import Points, concatenate
from mffit.progress import Progress
from mffit.results import BuildResult
from mffit.suspicion.other_tyre import two_tyres

SAME_OF_ONE_TYRE = ("unloaded_radius", "width", "rim_radius", "nominal_load", "nominal_pressure")
"""Keys of [tyre] that the projects of one tyre share: coefficients are relative to them."""


def campaigns_of(
    config: Config, points: Points, build: Callable[..., BuildResult], progress: Progress
) -> tuple[tuple[Campaign, ...], tuple[str, ...]]:
    """The fitted campaigns that ``[[campaign]]`` names, and warnings about them.

    Parameters
    ----------
    config : of this project
    points : of this project
    build : a configuration to its result
    progress : called with a sentence before each build

    Raises
    ------
    InputError
        A project cannot be read, names campaigns itself, or is of another tyre.
    """
    out, warned = [], []
    for index, row in enumerate(config.campaign):
        place = {
            "file": config.path,
            "line": config.line_of(f"campaign.{index}.toml"),
            "key": "campaign.toml",
        }
        other = other_project(config, index)
        _refuse_another_tyre(config, other, row.toml, place)
        progress(f"building the campaign {row.toml}")
        result = build(other, progress=progress)
        _refuse_other_radii(config, points, result.points, row.toml, place)
        if not result.trusted:
            warned.append(f"the campaign {row.toml} is not to be trusted: {'; '.join(result.reasons)}")
        fit = result.fit
        out.append(
            Campaign(
                name=row.toml,
                tyre=fit.tyre,
                coefficients=fit.coefficients,
                posterior=fit.posterior,
                shared=shared_conditions(points, result.points),
            )
        )
    return tuple(out), tuple(warned)


def _refuse_another_tyre(config: Config, other: Config, name: str, place: dict[str, Any]) -> None:
    """Refuse a project whose tyre has other dimensions or another nominal condition."""
    mine, theirs = config.tyre, other.tyre
    if "-" not in (mine.size, theirs.size) and mine.size != theirs.size:
        raise InputError(
            f"{name} is of a tyre of size {theirs.size}, this one is {mine.size}; campaigns are of one tyre",
            **place,
        )
    for key in SAME_OF_ONE_TYRE:
        a, b = getattr(mine, key), getattr(theirs, key)
        if a is not None and b is not None and abs(a - b) > constants.SAME_NOMINAL_CONDITION * a:
            raise InputError(
                f"{name} has {key} = {b:g}, but this project {a:g}: campaigns are of one tyre, and coefficients are relative to "
                "it; correct one of them",
                **place,
            )


def _refuse_other_radii(
    config: Config, points: Points, others: Points, name: str, place: dict[str, Any]
) -> None:
    """Refuse readings whose loaded or rolling radius is that of another tyre."""
    folder = Path(name).parent
    renamed = replace(others, files=tuple((folder / file).as_posix() for file in others.files))
    found = next(iter(two_tyres.find(concatenate([points, renamed]), config)), None)
    if found is not None:
        raise InputError(two_tyres.said(found.facts), **place)

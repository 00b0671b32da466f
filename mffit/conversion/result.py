"""The record of a conversion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from mffit.as_json import keys
from mffit.brief import Brief
from mffit.conversion import constants
from mffit.conversion.grid import Reach
from mffit.conversion.old_files import OldFile
from tir import Problem, Tyre

MOMENTS = ("Mx", "Mz")
ROUNDING = 1e-9
"""Misfit over the largest force of the same load that is rounding."""


class RegionMisfit(NamedTuple):
    """New minus old force in one channel and region."""

    channel: str
    small_camber: bool  #: within SMALL_CAMBER, or beyond
    slipping: bool  #: with longitudinal slip, or without
    rms: float  #: [N] or [Nm]
    rms_share: float  #: rms of the misfit over the largest old force of the same load and region
    load: float  #: at which it is the largest share of the old force [N]
    largest: float  #: at this load [N] or [Nm]
    greatest_force: float  #: largest old force of the region at this load [N] or [Nm]
    within: float
    """Share of the conditions within GOOD_SHARE of the largest force of the same load and region."""

    @property
    def share(self) -> float:
        """The largest misfit over the largest old force, both of one load and region."""
        return self.largest / self.greatest_force


@dataclass(frozen=True, slots=True, repr=False, kw_only=True)
class _Converted(Brief):
    """How near a converted file comes to the other one."""

    reach: Reach
    misfit: tuple[RegionMisfit, ...]
    fitted: tuple[str, ...]
    """Names of the coefficients that were fitted; the others mean the same in both formulae."""

    @property
    def poor(self) -> tuple[RegionMisfit, ...]:
        """Where the aim is missed at small camber: a force somewhere off by more than GOOD_SHARE, a moment in rms."""
        return tuple(
            row
            for row in self.misfit
            if row.small_camber
            and (row.rms_share if row.channel in MOMENTS else row.share) > constants.GOOD_SHARE
        )


@dataclass(frozen=True, slots=True, repr=False, kw_only=True)
class OldConversion(_Converted):
    """A file of an older formula, and how near it comes to that of MF 6.2."""

    source: Tyre  #: of MF 6.2
    path: Path  #: its file
    kind: str  #: of the older formula, in words
    text: str  #: the converted file

    @property
    def problems(self) -> tuple[Problem, ...]:
        """What the file of MF 6.2 has of note."""
        return self.source.problems


keys(
    OldConversion,
    "kind trusted reasons ranges=reach fitted misfit",
    trusted="mffit.conversion.wording.trusted",
    reasons="mffit.conversion.wording.reasons",
)


@dataclass(frozen=True, slots=True, repr=False, kw_only=True)
class Conversion(_Converted):
    """A converted file and how near it comes to the old one."""

    tyre: Tyre  #: MF 6.2, every coefficient marked as converted
    old: OldFile
    held: Mapping[str, float]
    """Curvature factors that the old formula holds to 1 in this file, and what they would be."""

    @property
    def path(self) -> Path:
        """The old file."""
        return self.old.path

    @property
    def text(self) -> str:
        """The converted file."""
        return self.tyre.text()

    @property
    def problems(self) -> tuple[Problem, ...]:
        """What the old file has of note."""
        return self.old.problems


keys(
    Conversion,
    "kind=old.kind trusted reasons ranges=reach fitted curvature_held_to_1=held misfit problems=old.problems",
    trusted="mffit.conversion.wording.trusted",
    reasons="mffit.conversion.wording.reasons",
)

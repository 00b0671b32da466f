"""The record of a conversion."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from mffit.as_json import keys
from mffit.brief import Brief
from mffit.conversion import constants
from mffit.conversion.grid import Conditions, Reach
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


def misfits(new: Sequence[Any], at: Conditions, goal: Mapping[str, np.ndarray]) -> Iterator[RegionMisfit]:
    """The misfit of every channel within the small camber and beyond, with and without longitudinal slip."""
    slipping = at.kappa != 0.0
    for (channel, wanted), force in zip(goal.items(), new, strict=True):
        most = at.largest_alike(wanted)
        off = np.abs(np.broadcast_to(force, at.Fz.shape) - wanted)
        for region in ((True, False), (True, True), (False, False), (False, True)):
            chosen = (at.small_camber == region[0]) & (slipping == region[1]) & (most > 0.0)
            if not np.any(chosen):
                continue
            here, alike = off[chosen], most[chosen]
            worst = int(np.argmax(here / alike))
            yield RegionMisfit(
                channel, *region,
                rms=float(np.sqrt(np.mean(here**2))),
                rms_share=float(np.sqrt(np.mean((here / alike) ** 2))),
                load=float(at.Fz[chosen][worst]),
                largest=float(here[worst]),
                greatest_force=float(alike[worst]),
                within=float(np.mean(here <= float(constants.GOOD_SHARE) * alike)),
            )  # fmt: skip


@dataclass(frozen=True, slots=True, repr=False, kw_only=True)
class Conversion(Brief):
    """A converted file, of either formula, and its misfit to the other one."""

    path: Path  #: the file that was converted
    problems: tuple[Problem, ...]  #: of either formula
    old: OldFile | None  #: itself, if it is of the older formula
    tyre: Tyre  #: the tyre in MF 6.2: what was made, each coefficient marked as converted; else what was read
    kind: str  #: the older formula in words
    text: str  #: the converted file
    reach: Reach
    misfit: tuple[RegionMisfit, ...]
    fitted: tuple[str, ...]
    """Names of the coefficients that were fitted; the others mean the same in both formulae."""
    held: Mapping[str, float]
    """Curvature factors that the older formula holds to 1 in its file, and what they would be."""

    @property
    def poor(self) -> tuple[RegionMisfit, ...]:
        """Where the aim is missed at small camber: a force somewhere off by more than GOOD_SHARE, a moment in rms."""
        return tuple(
            row
            for row in self.misfit
            if row.small_camber
            and (row.rms_share if row.channel in MOMENTS else row.share) > constants.GOOD_SHARE
        )


keys(
    Conversion,
    "kind trusted reasons ranges=reach fitted curvature_held_to_1=held misfit problems",
    trusted="mffit.conversion.wording.trusted",
    reasons="mffit.conversion.wording.reasons",
)

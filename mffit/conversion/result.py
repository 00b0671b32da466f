"""The record of a conversion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from mffit.brief import Brief
from mffit.conversion import constants
from mffit.conversion.grid import Reach
from mffit.conversion.old_files import OldFile
from tir import Tyre

MOMENTS = ("Mx", "Mz")


class RegionMisfit(NamedTuple):
    """New minus old force in one channel and region."""

    channel: str
    small_camber: bool  #: within SMALL_CAMBER, or beyond
    slipping: bool  #: with longitudinal slip, or without
    rms: float  #: [N] or [Nm]
    largest: float  #: [N] or [Nm]
    greatest_force: float  #: largest old force over all conditions [N] or [Nm]
    within: float  #: share of the conditions within GOOD_SHARE of the largest force


@dataclass(frozen=True, slots=True, repr=False)
class Conversion(Brief):
    """A converted file and how near it comes to the old one."""

    tyre: Tyre  #: MF 6.2, every coefficient marked as converted
    old: OldFile
    reach: Reach
    misfit: tuple[RegionMisfit, ...]
    fitted: tuple[
        str, ...
    ]  #: names of the coefficients that were fitted; the others mean the same in both formulae

    @property
    def poor(self) -> tuple[RegionMisfit, ...]:
        """Where the aim is missed: forces at small camber off by more than GOOD_SHARE, moments in too many conditions."""
        return tuple(
            row
            for row in self.misfit
            if row.small_camber
            and (
                row.within < constants.GOOD_CONDITIONS
                if row.channel in MOMENTS
                else row.largest > constants.GOOD_SHARE * row.greatest_force
            )
        )

"""Readings of a rig, channel by channel."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mffit.quantities import CHANNELS


class Readings(dict[str, np.ndarray]):
    """Arrays by channel, in the order of ``CHANNELS`` and in their units.

    Each array is (n,), one reading per point, or (n, k), its derivatives by k numbers.

    Examples
    --------
    >>> readings = Readings(Mz=np.array([2.0]), Fy=np.array([-100.0]))
    >>> list(readings), float(readings.Fy[0])
    (['Fy', 'Mz'], -100.0)
    >>> readings.stacked
    array([-100.,    2.])
    """

    def __init__(self, **channels: np.ndarray) -> None:
        unknown = sorted(set(channels) - set(CHANNELS))
        if unknown:
            raise KeyError(f"{unknown[0]} is no channel")
        super().__init__({name: channels[name] for name in CHANNELS if name in channels})

    def __getattr__(self, name: str) -> np.ndarray:
        if name in self:
            return self[name]
        raise AttributeError(f"there are no readings of {name}")

    @property
    def stacked(self) -> np.ndarray:
        """All channels concatenated: (c n,) or (c n, k)."""
        return np.concatenate([*self.values()])

    @classmethod
    def split(cls, stacked: np.ndarray, channels: Sequence[str]) -> Readings:
        """The readings from concatenated channels, the inverse of :attr:`stacked`."""
        return cls(**dict(zip(channels, np.split(stacked, len(channels)), strict=True)))

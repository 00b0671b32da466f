"""Readings of a rig, channel by channel."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from mffit.quantities import CHANNELS


class Readings(Mapping[str, np.ndarray]):
    """Arrays by channel, in the order of ``CHANNELS`` and in their units; immutable.

    Each array is (n,), a reading per point; or (n, k), its derivatives by k numbers.

    Parameters
    ----------
    channels : one array for each channel

    Examples
    --------
    >>> readings = Readings(Mz=np.array([2.0]), Fy=np.array([-100.0]))
    >>> list(readings), float(readings.Fy[0])
    (['Fy', 'Mz'], -100.0)
    >>> readings.stacked
    array([-100.,    2.])
    """

    __slots__ = ("_arrays",)

    def __init__(self, **channels: np.ndarray) -> None:
        unknown = sorted(set(channels) - set(CHANNELS))
        if unknown:
            raise KeyError(f"{unknown[0]} is no channel")
        self._arrays = {name: channels[name] for name in CHANNELS if name in channels}

    def __getitem__(self, name: str) -> np.ndarray:
        return self._arrays[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def __getattr__(self, name: str) -> np.ndarray:
        if name in CHANNELS and name in self._arrays:
            return self._arrays[name]
        raise AttributeError(f"there are no readings of {name}")

    def __reduce__(self) -> tuple[Any, ...]:
        return _of_arrays, (self._arrays,)

    def __repr__(self) -> str:
        return f"Readings({', '.join(self._arrays)})"

    @property
    def stacked(self) -> np.ndarray:
        """All channels one below the other: (c n,), or (c n, k)."""
        return np.concatenate(list(self._arrays.values()))

    @classmethod
    def split(cls, stacked: np.ndarray, channels: Any) -> Readings:
        """The readings of some channels, from :attr:`stacked`."""
        return cls(**dict(zip(channels, np.split(stacked, len(channels)), strict=True)))


def _of_arrays(arrays: Mapping[str, np.ndarray]) -> Readings:
    return Readings(**arrays)

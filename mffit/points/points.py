"""The record of finished measuring points, the input of every later step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import pandas as pd

from mffit.points import constants
from mffit.quantities import CHANNELS, CONDITIONS
from mffit.sweeps.sweep import MeasuredRows
from tir.errors import counted

INTEGER = frozenset({"direction", "mount", "sweep", "file", "line", "last_line", "setup"})
SHARED = frozenset({"sweep_names", "files", "setups", "table"})
OF_SI = {"deg": 180.0 / np.pi, "kPa": 1e-3}
"""Factors from SI to units of conditions."""
COUNTED = {"sweep": "sweep_names", "file": "files", "setup": "setups"}
"""Index fields, and the field with the corresponding names."""
OPTIONAL: Mapping[str, Any] = {
    **dict.fromkeys((*CHANNELS, *(f"u_{name}" for name in CHANNELS), "T", "t", "iteration", "time"), np.nan),
    "kappa": 0.0,
    **dict.fromkeys(("direction", "mount"), 1),
    **dict.fromkeys(("sweep", "file", "line", "setup"), 0),
    "continuous": False,
    **{"sweep_names": ("sweep",), "files": ("",), "setups": ("",), "table": None},
}
"""Defaults of :func:`make_points`: not measured, rolling freely, forwards, normal mount, one of everything."""


def of_si(column: str) -> float:
    """Factor from SI to the unit of a condition of :data:`mffit.quantities.CONDITIONS`, by its column."""
    return OF_SI.get(CONDITIONS[column].unit, 1.0)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Points(MeasuredRows):
    """Steady points; arrays are read-only. Angles are the rig's readings in ISO axes, uncorrected.

    Built by :func:`make_points`. Code for any channel should use :attr:`measured`, :meth:`channel` and :meth:`u`; the fields are
    for code about one particular channel.
    """

    phi_t: np.ndarray  #: turn slip of the path, declared radius [1/m]
    mount: np.ndarray  #: +1 normal, -1 tyre turned on its rim
    continuous: np.ndarray  #: bool: a sample of a moving sweep, not a steady point
    last_line: np.ndarray
    """Last line of the readings that belong to a point, from ``line`` on: its rest, with the samples in which forces settle."""
    sweep: np.ndarray  #: index into ``sweep_names``
    file: np.ndarray  #: index into ``files``
    setup: np.ndarray  #: set-up of the rig, index into ``setups``
    sweep_names: tuple[str, ...]
    files: tuple[str, ...]
    setups: tuple[str, ...]  #: names of the set-ups of the rig; one empty name if none is declared

    @property
    def headline(self) -> str:
        """Number of points and sweeps, in words."""
        return f"{len(self)} in {counted(len(self.sweep_names), 'sweep')}"

    def channel(self, name: str) -> np.ndarray:
        """Readings (n,) of a channel of :data:`mffit.quantities.CHANNELS`, in its unit; NaN where it was not measured."""
        return np.asarray(getattr(self, name))

    def u(self, name: str) -> np.ndarray:
        """Standard uncertainty (n,) of a channel; NaN where none is stated."""
        return np.asarray(getattr(self, f"u_{name}"))

    def condition(self, column: str) -> np.ndarray:
        """A condition (n,) of :data:`mffit.quantities.CONDITIONS` in its unit, by its column; NaN where it was not measured."""
        values: np.ndarray = getattr(self, column.partition("_")[0])
        return values * of_si(column)

    @property
    def measured(self) -> tuple[str, ...]:
        """Names of the channels that have a reading at any point, in the order of ``CHANNELS``."""
        return tuple(name for name in CHANNELS if np.any(np.isfinite(self.channel(name))))

    @property
    def free_rolling(self) -> np.ndarray:
        """Mask (n,) of the points at which the wheel was neither driven nor braked."""
        return np.asarray(np.abs(self.kappa) <= constants.SLIP)

    @property
    def curved(self) -> bool:
        """Whether the path of every point curves, as on a disc."""
        return bool(np.all(self.phi_t))

    @property
    def one_sided(self) -> bool:
        """Whether the path of every point curves to the same side."""
        return self.curved and len(np.unique(np.sign(self.phi_t))) == 1

    @property
    def rolling_radius(self) -> np.ndarray:
        """Radius of free rolling (n,) [m]: speed over rotation, without the slip; NaN where the wheel speed was not measured."""
        turns = np.abs(self.omega)
        turning = turns > 0.0
        return np.where(turning, (1.0 + self.kappa) * self.V / np.where(turning, turns, 1.0), np.nan)

    @property
    def rows_of_sweeps(self) -> dict[int, np.ndarray]:
        """Row indices (m,) of every sweep that has points, by its index."""
        return {k: np.flatnonzero(self.sweep == k) for k in np.unique(self.sweep).tolist()}

    @property
    def used_setups(self) -> tuple[str, ...]:
        """Names of the set-ups that have points, in the order of ``setups``."""
        return tuple(self.setups[k] for k in np.unique(self.setup))

    @property
    def Vx(self) -> np.ndarray:
        """Signed speed (n,) [m/s]: negative when the wheel rolls backwards."""
        return np.asarray(self.direction * self.V)

    def select(self, which: np.ndarray | slice, *, with_table: bool = True) -> Points:
        """The points of a boolean mask (n,), of an index array (m,) in its order, or of a slice (views, not copies).

        Without ``with_table`` the table is empty, which is faster.
        """
        if not isinstance(which, slice):
            which = np.asarray(which)
            which = np.flatnonzero(which) if which.dtype == bool else which
        taken: dict[str, Any] = {name: getattr(self, name)[which] for name in ARRAYS}
        return Points(
            **taken,
            sweep_names=self.sweep_names,
            files=self.files,
            setups=self.setups,
            table=self.table.iloc[which].reset_index(drop=True)
            if with_table
            else _no_table(len(taken["alpha"])),
        )

    def replace(self, **arrays: Any) -> Points:
        """A copy with some fields changed; scalars are broadcast to (n,)."""
        _refuse_unknown(arrays)
        taken = {name: arrays.get(name, getattr(self, name)) for name in ARRAYS}
        shared = {name: arrays.get(name, getattr(self, name)) for name in SHARED}
        filled: dict[str, Any] = {name: _filled(name, taken[name], len(self)) for name in ARRAYS}
        return Points(**filled, **shared)


FIELDS = tuple(field.name for field in fields(Points))
ARRAYS = tuple(name for name in FIELDS if name not in SHARED)


def make_points(alpha: Any, gamma: Any, Fz: Any, **fields: Any) -> Points:
    """Points from arrays or scalars in ISO-W and SI, broadcast to the common length (n,).

    Of the other ``fields`` of :class:`Points`, ``p``, ``V`` and ``phi_t`` are required; ``OPTIONAL`` has the defaults of the
    others; ``last_line`` is ``line`` if it is not given. ``sweep_names``, ``files`` and ``setups`` are the names that the
    fields ``sweep``, ``file`` and ``setup`` count; ``table`` has the input columns as reported.

    Raises TypeError if a required field is missing, or a field is unknown; ValueError if lengths disagree, or ``direction`` or
    ``mount`` is neither +1 nor -1.
    """
    given = {**OPTIONAL, "alpha": alpha, "gamma": gamma, "Fz": Fz, **fields}
    given.setdefault("last_line", given["line"])
    if missing := [name for name in ARRAYS if name not in given]:
        raise TypeError(f"make_points needs {', '.join(missing)}")
    _refuse_unknown(given)
    table = given.pop("table")
    names: dict[str, Any] = {name: tuple(given.pop(name)) for name in COUNTED.values()}
    (n,) = np.broadcast_shapes((1,), *(np.shape(values) for values in given.values()))
    arrays: dict[str, Any] = {name: _filled(name, given[name], n) for name in ARRAYS}
    for name in ("direction", "mount"):
        if not np.all(np.abs(arrays[name]) == 1):
            raise ValueError(f"{name} must be +1 or -1 at every point")
    table = _no_table(n) if table is None else table.reset_index(drop=True)
    if len(table) != n:
        raise ValueError(f"the table has {len(table)} rows for {n} points")
    return Points(**arrays, **names, table=table)


def concatenate(parts: Sequence[Points]) -> Points:
    """All points in one record; sweeps, files and set-ups are renumbered, tables joined by column name."""
    arrays: dict[str, Any] = {
        name: np.concatenate([getattr(part, name) for part in parts]) for name in ARRAYS
    }
    names: dict[str, Any] = {}
    for field, of_field in COUNTED.items():
        names[of_field] = tuple(dict.fromkeys(name for part in parts for name in getattr(part, of_field)))
        arrays[field] = np.concatenate(
            [_renumbered(getattr(part, field), getattr(part, of_field), names[of_field]) for part in parts]
        )
    table = pd.concat([part.table for part in parts], ignore_index=True)
    return Points(**arrays, **names, table=table)


def _no_table(n: int) -> pd.DataFrame:
    return pd.DataFrame(index=pd.RangeIndex(n))


def _refuse_unknown(given: Mapping[str, Any]) -> None:
    unknown = sorted(set(given) - set(FIELDS))
    if unknown:
        raise TypeError(f"Points has no field {', '.join(unknown)}")


def _renumbered(index: np.ndarray, old: Sequence[str], new: Sequence[str]) -> np.ndarray:
    """An index array (n,) into ``old``, converted to one into ``new``."""
    return np.asarray(np.array([new.index(name) for name in old], dtype=int)[index])


def _filled(name: str, values: Any, n: int) -> np.ndarray:
    """The values as a new array (n,) of the field's type."""
    kind = int if name in INTEGER else bool if name == "continuous" else float
    values = np.asarray(values)
    if values.ndim > 1:
        raise ValueError(f"{name} must be a scalar or one-dimensional")
    return np.array(np.broadcast_to(values, (n,)), dtype=kind)

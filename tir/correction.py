"""Model error of a measured tyre, next to its file: a table over the inputs, interpolated and added to the forces.

``mffit build`` writes it; docs/correction.md says how to add it in any simulation.
"""

import csv
import hashlib
import itertools
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from tir import constants
from tir.codegen.program import INPUTS
from tir.equations.forces import Forces
from tir.errors import TirError
from tir.frozen import ReadOnlyArrays
from tir.parameters import TABLE

AXES: Mapping[str, tuple[str, float]] = MappingProxyType(
    {
        "alpha_deg": ("alpha", np.pi / 180.0),
        "gamma_deg": ("gamma", np.pi / 180.0),
        "Fz_N": ("Fz", 1.0),
        "p_kPa": ("pressure", 1e3),
        "kappa": ("kappa", 1.0),
    }
)
"""Columns of the inputs, each with the input of a call and the factor to its unit."""
MISSED: Mapping[str, str] = MappingProxyType(
    {name: f"{name}_missed_{'N' if name[0] == 'F' else 'Nm'}" for name in Forces._fields if name != "Fz"}
)
"""Columns of the forces and moments, in ISO-W."""
COUNTED = (
    "FNOMIN",
    "NOMPRES",
    *(row.name for row in TABLE if row.section.endswith("_COEFFICIENTS") and not row.scaling),
)
"""Values of the file that a table holds for; modes, ranges and scaling factors may differ in a simulation."""
FILE, COEFFICIENTS, PATH, FADING = "file", "coefficients", "phi_t_per_m", "fading of"
"""Names of the comment lines above the table."""


def digest(values: Mapping[str, Any]) -> str:
    """Digest of the coefficients of a file."""
    text = "\n".join(f"{name} {float(values[name])!r}" for name in COUNTED)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def share_of_load(Fz: Any, lowest: float) -> Any:
    """Share of the model error at the ``lowest`` tested load that is left at a load: below, proportional to it, as forces are."""
    return np.minimum(np.maximum(Fz / lowest, 0.0), 1.0)


def slip_beyond(kappa: Any, alpha: Any, braked: float, driven: float) -> Any:
    """Exponent by which the model error of free rolling fades at a longitudinal slip beyond the tested ``braked`` to ``driven``.

    It fades with the combined slip: the larger the sideslip, the longer it lasts.
    """
    beyond = kappa - np.minimum(np.maximum(kappa, braked), driven)  # np.clip is slower for one number
    return 0.5 * beyond**2 / (constants.SLIP_OF_FREE_ROLLING**2 + np.tan(alpha) ** 2)


@dataclass(frozen=True)
class Correction(ReadOnlyArrays):
    """The model error over a grid of d inputs."""

    content: str  #: SHA-256 of the table, by which two are the same
    nodes: Mapping[str, np.ndarray] = field(compare=False)  #: by input of a call, rising, SI
    missed: np.ndarray = field(compare=False)  #: (*grid, channels) [N], [Nm]
    channels: tuple[int, ...] = field(compare=False)  #: places among the forces
    fading: np.ndarray = field(compare=False)
    """(channels, d) lengths over which the model error fades outside of the grid, SI."""
    path: float = field(compare=False)  #: curvature of the path of the measurement [1/m]
    lowest: float = field(compare=False)  #: load below which the model error falls with the load [N]

    def added(self, forces: Forces[Any], inputs: Sequence[Any], *, limits: bool) -> Forces[Any]:
        """Forces of the formula plus the model error, at the ``inputs`` of the call, in the order of ``INPUTS``.

        With ``limits`` the inputs are held to the file's ranges; then the model error fades outside of the grid only towards a
        wheel in the air and over a longitudinal slip that nobody measured. Raises TirError if an input is not a real number.
        """
        kinds = {x.dtype.kind for x in map(np.asarray, inputs)}
        if not kinds <= set("fiub"):
            raise TirError("the model error is added at real numbers only; call the tyre of the file")
        by_name = dict(zip(INPUTS, inputs, strict=True))
        if isinstance(forces.Fz, float):
            missed = self._once([float(by_name[name]) for name in self.nodes], fades=not limits)
        else:
            shape = np.broadcast_shapes(*(np.shape(x) for x in inputs))
            by_name = {name: np.broadcast_to(x, shape).astype(float) for name, x in by_name.items()}
            at = np.array([by_name[name].ravel() for name in self.nodes])
            missed = interpolated([*self.nodes.values()], self.missed, at)
            if not limits:
                missed = missed * self._left(at)
            missed = missed.reshape(-1, *shape)
        missed = missed * self._left_of_any(by_name)
        if self.path:
            missed = missed * np.exp(-0.5 * (by_name["phi_t"] / self.path - 1.0) ** 2)
        missed = np.where(by_name["Vx"] < 0.0, 0.0, missed)
        found = list(forces)
        for k, one in zip(self.channels, missed if missed.ndim > 1 else missed.tolist(), strict=True):
            found[k] = found[k] + one
        return Forces(*found)

    def _left_of_any(self, by_name: Mapping[str, Any]) -> Any:
        """Share (channels, ...) that is left at this load and longitudinal slip, whatever the length of fading."""
        known = self.nodes.get("kappa", np.zeros(1))
        driven = slip_beyond(by_name["kappa"], by_name["alpha"], known[0], known[-1])
        fades = np.multiply.outer(self._of_free_rolling, driven)
        return share_of_load(by_name["Fz"], self.lowest) * np.exp(-fades)

    @cached_property
    def _of_free_rolling(self) -> np.ndarray:
        """By channel, 1 where the table has no length of fading over longitudinal slip."""
        if "kappa" not in self.nodes:
            return np.ones(len(self.channels))
        return np.where(np.isinf(self.fading[:, [*self.nodes].index("kappa")]), 1.0, 0.0)

    def _left(self, at: np.ndarray) -> np.ndarray:
        """Share (channels, n) of the model error that is left outside of the grid."""
        nodes = self.nodes.values()
        beyond = np.array([x - np.clip(x, known[0], known[-1]) for x, known in zip(at, nodes, strict=True)])
        return np.asarray(np.exp(-0.5 * np.sum((beyond / self.fading[:, :, None]) ** 2, axis=1)))

    def _once(self, at: Sequence[float], *, fades: bool) -> np.ndarray:
        """Model error (channels,) at one condition, ten times as fast as with arrays."""
        cells, shares, beyond = [], [], []
        for x, known in zip(at, self._lists, strict=True):
            cell = min(max(bisect_right(known, x) - 1, 0), len(known) - 2)
            low, high = known[cell], known[cell + 1]
            cells.append(slice(cell, cell + 2))
            shares.append(min(max((x - low) / (high - low), 0.0), 1.0))
            beyond.append(x - min(max(x, known[0]), known[-1]))
        found = self.missed[tuple(cells)]
        for share in shares:
            found = (1.0 - share) * found[0] + share * found[1]
        if fades and any(beyond):
            found = found * np.exp(-0.5 * np.sum((np.array(beyond) / self.fading) ** 2, axis=1))
        return found

    @cached_property
    def _lists(self) -> list[list[float]]:
        return [known.tolist() for known in self.nodes.values()]


def interpolated(nodes: Sequence[np.ndarray], missed: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Values (channels, n) at inputs (d, n), linear in each between the rising ``nodes``; outside those of the nearest end.

    ``missed`` are the values at the nodes: an axis for each input, then one for the channels.
    """
    cells, shares = [], []
    for x, known in zip(at, nodes, strict=True):
        cell = np.clip(np.searchsorted(known, x, side="right") - 1, 0, len(known) - 2)
        shares.append(np.clip((x - known[cell]) / (known[cell + 1] - known[cell]), 0.0, 1.0))
        cells.append(cell)
    found = np.zeros((at.shape[1], missed.shape[-1]))
    for corner in itertools.product((0, 1), repeat=len(cells)):
        weight = np.ones(at.shape[1])
        for high, share in zip(corner, shares, strict=True):
            weight = weight * (share if high else 1.0 - share)
        place = tuple(cell + high for cell, high in zip(cells, corner, strict=True))
        found += weight[:, None] * missed[place]
    return found.T


def read_correction(path: str | Path, values: Mapping[str, Any]) -> Correction:
    """The table of a file with these values.

    Raises TirError if the table cannot be read, is not as a build writes it, or belongs to another file.
    """
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise TirError(f"cannot be read ({error}); name the table that a build wrote", path=path) from None
    lines = text.splitlines()
    head = dict(line[1:].strip().partition(": ")[::2] for line in lines if line.startswith("#"))
    try:
        heading, *rows = csv.reader(line for line in lines if not line.startswith("#"))
        known = head[COEFFICIENTS]
        found = _correction(text, head, heading, np.array(rows, dtype=float), float(values["FNOMIN"]))
    except (ValueError, LookupError, StopIteration):
        sentence = "is not the whole table of a model error, as a build writes it; build the tyre again"
        raise TirError(sentence, path=path) from None
    if known != digest(values):
        of = head.get(FILE, "another file")
        sentence = (
            f"belongs to {of} as it was built, and the coefficients of this tyre are others; read that file"
        )
        raise TirError(sentence, path=path)
    return found


def _correction(
    text: str, head: Mapping[str, str], heading: list[str], rows: np.ndarray, nominal: float
) -> Correction:
    """The record of a table, of ``nominal`` load if it has none; raises ValueError or LookupError if it is incomplete."""
    axes = [name for name in AXES if name in heading]
    names = [name for name in MISSED if f"{FADING} {name}" in head]
    nodes = [np.unique(rows[:, heading.index(name)]) for name in axes]
    shape = [len(known) for known in nodes]
    order = np.lexsort([rows[:, heading.index(name)] for name in reversed(axes)])
    grid = np.array(list(itertools.product(*nodes)))
    rows = rows[order]
    whole = np.array_equal(grid, rows[:, [heading.index(name) for name in axes]]) and np.all(
        np.isfinite(rows)
    )
    if not (whole and names and min(shape) > 1):
        raise ValueError("the grid is not whole")
    lengths = [dict(pair.split(" ") for pair in head[f"{FADING} {name}"].split(", ")) for name in names]
    by_input = {AXES[name][0]: AXES[name][1] * known for name, known in zip(axes, nodes, strict=True)}
    return Correction(
        content=hashlib.sha256(text.encode()).hexdigest(),
        nodes=by_input,
        missed=rows[:, [heading.index(MISSED[name]) for name in names]].reshape(*shape, len(names)),
        channels=tuple(Forces._fields.index(name) for name in names),
        fading=np.array([[AXES[name][1] * float(own[name]) for name in axes] for own in lengths]),
        path=float(head[PATH]),
        lowest=float(by_input.get("Fz", [nominal])[0]),
    )

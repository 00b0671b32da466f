"""The model error as a table over a grid of the inputs, for simulations: ``<name>-correction.csv``."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from mffit.csv_tables import csv_text
from mffit.points.points import of_si
from mffit.prediction import constants
from mffit.prediction.predictor import Predictor
from mffit.quantities import COLUMNS, column
from mffit.scatter import rms
from tir import Tyre
from tir.constants import SLIP_OF_FREE_ROLLING
from tir.correction import AXES, COEFFICIENTS, FADING, FILE, MISSED, PATH, digest, interpolated


@dataclass(frozen=True, slots=True, eq=False)
class CorrectionTable:
    """The estimated model error of a property file over a grid of the inputs."""

    table: pd.DataFrame
    """One row per node: the inputs, and for every channel the model error and its standard uncertainty; ISO-W axes."""
    fading: Mapping[str, Mapping[str, float]]
    """By channel and input, the length over which the model error fades outside the grid [unit of the input]."""
    path: float  #: curvature of the path [1/m]
    added: float
    """Rms error of linear interpolation over the rms model error [-], for the worst channel."""
    coefficients: str  #: digest of the file's coefficients


def correction(known: Predictor, fitted: Tyre, proven: Collection[str]) -> CorrectionTable | None:
    """The table for the channels with a ``proven`` model error; None if there is none.

    ``fitted`` is the file of the fitted model, to whose forces a simulation adds the table.
    """
    names = [name for name in MISSED if name in proven]
    inputs: dict[str, tuple[float, float]] = {}
    for name in names:
        for one in known.channels[name].smooth.inputs:
            heading = COLUMNS.get(one.name, "")
            if heading in AXES:
                factor = of_si(heading)
                low, high = inputs.get(heading, (np.inf, -np.inf))
                inputs[heading] = (min(low, factor * one.lower), max(high, factor * one.upper))
    if not inputs:
        return None
    missed = _Missed(known, fitted, names)
    nodes, at, of_nodes, added = _grid(missed, inputs)
    found, table = known.predict(fitted, fitted, _whole(at, fitted), names), at.copy()
    for name in names:
        u = found[f"u_{column(name, 'best')}"].to_numpy()
        digits = 2 - int(np.floor(np.log10(np.median(u))))  # three digits of a typical uncertainty
        table[MISSED[name]] = of_nodes[name].round(digits)
        table[f"u_{MISSED[name]}"] = u.round(digits)
    return CorrectionTable(
        table, {name: _fading(known, name, nodes) for name in names}, known.path, added, digest(fitted.values)
    )


def text_of(found: CorrectionTable, file: str) -> str:
    """The content of the correction file; ``file`` is the property file to whose forces the table is added."""
    head = [
        f"Model error, to be added to the forces of {file}; ISO-W axes. See docs/correction.md.",
        f"Between the nodes linear in every input, which adds {100.0 * found.added:.1f} % of the model error (rms).",
        f"{FILE}: {file}",
        f"{COEFFICIENTS}: {found.coefficients}",
        f"{PATH}: {found.path:.6g}",
        f"fading with kappa: {float(SLIP_OF_FREE_ROLLING):g}",
    ]
    for name, lengths in found.fading.items():
        head.append(f"{FADING} {name}: " + ", ".join(f"{key} {value:.4g}" for key, value in lengths.items()))
    return "".join(f"# {line}\n" for line in head) + csv_text(found.table)


def write_correction(path: Path, found: CorrectionTable, file: str) -> None:
    """Write the table; ``file`` is the property file to which it belongs."""
    path.write_text(text_of(found, file), encoding="utf-8", newline="")


@dataclass(frozen=True, slots=True)
class _Missed:
    """Function of conditions, in the units of their columns: the model error by channel, on the path of the measurement."""

    known: Predictor
    fitted: Tyre
    names: Sequence[str]

    def __call__(self, at: pd.DataFrame) -> dict[str, np.ndarray]:
        points = self.known.points(self.fitted, _whole(at, self.fitted))
        beyond = self.known.beyond(self.fitted, points, self.names)
        return {name: self.known.missed(name, points) + beyond[name] for name in self.names}


class _Grid(NamedTuple):
    """The nodes of a table."""

    nodes: dict[str, np.ndarray]  #: by input, values of the nodes
    at: pd.DataFrame  #: conditions of all nodes
    missed: dict[str, np.ndarray]  #: by channel, model error at the nodes
    added: float  #: as in :class:`CorrectionTable`


def _whole(at: pd.DataFrame, fitted: Tyre) -> pd.DataFrame:
    """The conditions, completed by required columns that the test did not vary."""
    held = {"alpha_deg": 0.0, "gamma_deg": 0.0, "Fz_N": float(fitted["FNOMIN"])}
    return at.assign(**{name: value for name, value in held.items() if name not in at})


def _grid(missed: _Missed, inputs: Mapping[str, tuple[float, float]]) -> _Grid:
    """The coarsest grid whose interpolation error along every input stays within its share of the allowed one.

    The input with the largest error gets the next node, until all are within it or there are too many nodes.
    """
    random = np.random.default_rng(0)
    n = max(len(missed.known.channels[name].missed) for name in missed.names)
    at = pd.DataFrame({name: random.uniform(*ends, n) for name, ends in inputs.items()})
    drawn, share = _Drawn(missed, at, missed(at)), constants.INTERPOLATION_ADDS / np.sqrt(len(inputs))
    nodes = {name: _nodes(ends, 1) for name, ends in inputs.items()}
    off = {name: drawn.off_along(name, own) for name, own in nodes.items()}
    while off[worst := max(off, key=lambda name: off[name])] > share:
        more = nodes | {worst: _nodes(inputs[worst], len(nodes[worst]))}
        if np.prod([len(own) for own in more.values()]) > constants.MOST_NODES:
            break
        nodes, off[worst] = more, drawn.off_along(worst, more[worst])
    whole = pd.DataFrame(itertools.product(*nodes.values()), columns=list(nodes))
    found = missed(whole)
    values = np.column_stack([*found.values()]).reshape(*(len(own) for own in nodes.values()), len(found))
    lines = dict(zip(found, interpolated([*nodes.values()], values, at.to_numpy().T), strict=True))
    return _Grid(nodes, whole, found, drawn.off(lines))


class _Drawn(NamedTuple):
    """The model error at conditions drawn over the grid, which its interpolation is compared with."""

    missed: _Missed
    at: pd.DataFrame
    exact: Mapping[str, np.ndarray]

    def off(self, lines: Mapping[str, np.ndarray]) -> float:
        """Rms error of the interpolated model error over its rms, for the worst channel."""
        return max(rms(lines[name] - exact) / max(rms(exact), 1e-12) for name, exact in self.exact.items())

    def off_along(self, name: str, nodes: np.ndarray) -> float:
        """The same, if it is interpolated along one input only."""
        x = self.at[name].to_numpy()
        below = np.clip(np.searchsorted(nodes, x) - 1, 0, len(nodes) - 2)
        low, high = (self.missed(self.at.assign(**{name: nodes[below + k]})) for k in (0, 1))
        weight = (x - nodes[below]) / (nodes[below + 1] - nodes[below])
        return self.off({key: (1.0 - weight) * low[key] + weight * high[key] for key in low})


def _nodes(ends: tuple[float, float], intervals: int) -> np.ndarray:
    """Nodes of an input, at equal distances."""
    return np.array([float(f"{node:.4g}") for node in np.linspace(*ends, intervals + 1)])


def _fading(known: Predictor, name: str, nodes: Mapping[str, np.ndarray]) -> dict[str, float]:
    """The fading lengths of a channel along the inputs of the table; infinite for inputs over which it does not change."""
    channel = known.channels[name]
    found = dict.fromkeys(nodes, np.inf)
    for one, length in zip(channel.smooth.inputs, channel.components.lengths, strict=True):
        if COLUMNS.get(one.name) in found:
            heading = COLUMNS[one.name]
            found[heading] = length * of_si(heading)
    return found

"""The records that the fit returns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mffit.brief import Brief
from mffit.fit.coverage import StageCoverage
from mffit.fit.files import Files
from mffit.fit.posterior import Posterior
from mffit.fit.staged import Fitted
from mffit.fit.stages import StageRecord
from mffit.quantities import CHANNELS
from mffit.rig import Simulation
from mffit.scatter import rms
from mffit.suspicion import Doubt, Outlier
from tir import Tyre


@dataclass(frozen=True, slots=True)
class Coefficient:
    """One coefficient of the written file and how it came by its value."""

    value: float
    stderr: float | None  #: k = 1; None if held
    stage: str
    fixed: bool
    at_bound: bool
    status: str  #: measured | fitted | regularised | default | base
    correlated_with: str = ""  #: the coefficient with the largest correlation, if above 0.95
    correlation: float = 0.0
    interval: tuple[float, float] | None = None  #: of 95 %; None if held
    origin: str = ""  #: where the value comes from, as the file's comment says it


@dataclass(frozen=True, slots=True)
class Agreement:
    """How one channel of the model agrees with the points."""

    rmse: float
    nrmse: float  #: rmse over the range of the measured values
    r2: float
    max_abs: float
    n: int


@dataclass(frozen=True, slots=True, repr=False)
class FitResult(Brief):
    """The fitted tyre and everything the report says of it."""

    tyre: Tyre  #: the fitted model, right with turn slip on
    written: Tyre  #: what the .tir with the plain name holds: the same, or its derivative for turn slip off
    coefficients: Mapping[str, Coefficient]
    channels: Mapping[str, Agreement]  #: of ``tyre`` on the raw points, turn slip on
    odd: Mapping[str, Agreement]  #: of the file for turn slip off on the odd part, turn slip off
    simulation: Simulation  #: ``tyre`` on the rig as the fit found it
    rig: Mapping[str, tuple[float, float]]  #: rig error -> (value, standard error)
    Fy_model: np.ndarray  #: (n,) [N]
    Mz_model: np.ndarray  #: (n,) [Nm]
    posterior: Posterior  #: what the fit leaves uncertain
    stages: tuple[StageRecord, ...]
    coverage: tuple[StageCoverage, ...]
    explanations: tuple[str, ...]
    warnings: tuple[str, ...]
    seconds: float
    epsilon_gamma_model: float | None = None
    doubts: tuple[Doubt, ...] = ()  #: sweeps that do not fit the others
    outliers: tuple[Outlier, ...] = ()  #: single readings that count with no weight
    distrusted: tuple[
        str, ...
    ] = ()  #: why the file is not to be trusted; among the warnings too, first of all
    search: Fitted | None = None  #: where the search ended, to draw tyres from
    files: Files | None = None  #: every file that is written, and how good each is

    @property
    def headline(self) -> str:
        """How far the model is from the points."""
        gaps = {name: found for name, found in self.channels.items() if found.n}
        return ", ".join(f"{name} rmse {x.rmse:.3g} {CHANNELS[name].unit}" for name, x in gaps.items())


def agreement(model: np.ndarray, measured: np.ndarray) -> Agreement:
    """Compare a channel (n,); points where it was not measured do not count."""
    used = np.isfinite(model) & np.isfinite(measured)
    difference, measured = (model - measured)[used], measured[used]
    if not len(measured):
        return Agreement(float("nan"), float("nan"), float("nan"), float("nan"), 0)
    rmse = rms(difference)
    spread = float(np.ptp(measured))
    variance = float(np.var(measured))
    return Agreement(
        rmse=rmse,
        nrmse=rmse / spread if spread > 0 else float("nan"),
        r2=1.0 - rmse**2 / variance if variance > 0 else float("nan"),
        max_abs=float(np.max(np.abs(difference))),
        n=len(measured),
    )

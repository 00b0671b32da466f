"""The result of a fit."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from mffit.as_json import document, keys
from mffit.brief import Brief
from mffit.fit.agreement import Agreement
from mffit.fit.bands import Bands
from mffit.fit.coefficients import Coefficient
from mffit.fit.coverage import StageCoverage
from mffit.fit.fitted import Fitted
from mffit.fit.influences.confounding import Confounding
from mffit.fit.influences.modelled import AtTemperature, BetweenRuns, OverSpeed
from mffit.fit.influences.nuisance_choice import NuisanceChoice
from mffit.fit.relaxation import Relaxation
from mffit.fit.wheel.vertical import Vertical
from mffit.fit.written.files import Files
from mffit.linearised import LinearisedFit
from mffit.numbers import Numbers
from mffit.prediction import Predictor
from mffit.quantities import CHANNELS
from mffit.rig import Readings, Simulation
from mffit.rig_errors import rig_estimates
from mffit.suspicion import Doubt, Outlier
from tir import Tyre
from tir.frozen import ReadOnlyArrays


@dataclass(frozen=True, slots=True, repr=False)
class FitResult(ReadOnlyArrays, Brief):
    """The fitted tyre and everything that the report needs."""

    tyre: Tyre  #: the fitted model: for turn slip on if the rig is a disc
    written: Tyre  #: the .tir with the plain name: the fitted model or the file for turn slip off
    coefficients: Mapping[str, Coefficient]  #: of ``written``
    channels: Mapping[str, Agreement]  #: of the model's readings with the raw points
    odd: Mapping[str, Agreement]  #: of the file for turn slip off with the odd part, turn slip off
    simulation: Simulation  #: ``tyre`` on the rig as fitted
    rig: Mapping[str, tuple[float, float]]  #: rig error -> (value, standard error) of the plain file's fit
    model: Readings  #: of ``simulation`` at the points, in the channels of the fit
    posterior: Numbers  #: joint uncertainty of tyre and rig
    coverage: tuple[StageCoverage, ...]
    explanations: tuple[str, ...]
    warnings: tuple[str, ...]
    seconds: float
    epsilon_gamma_model: float | None = None  #: of the fitted model; None on a flat track
    doubts: tuple[Doubt, ...] = ()  #: sweeps that contradict the others
    mounts: tuple[str, ...] = ()  #: files that were perhaps measured with another mount, as a sentence
    left_by_formula: LinearisedFit | None = field(default=None, repr=False)
    """Linear model of the full fit's residuals."""
    left_by_file: LinearisedFit | None = field(default=None, repr=False)
    """Linear model of the residuals of the plain file's fit."""
    prediction: Predictor | None = field(default=None, repr=False)  #: of forces at any conditions
    outliers: tuple[Outlier, ...] = ()  #: single readings with zero weight
    at_turns: Mapping[str, np.ndarray] = field(default_factory=dict, repr=False)
    """By channel, mask (n,) of the readings where sweeps turn back, which are weighted by their own scatter."""
    search: Fitted | None = None  #: the fit of the plain file, from whose posterior tyres are drawn
    full: Fitted | None = None  #: the fit with every modelled influence, temperature included
    bands: Bands | None = None  #: widths of the 95 % bands
    files: Files | None = None  #: every written file and its misfit
    temperature: AtTemperature | None = None  #: the model with temperature terms, if modelled
    speed: OverSpeed | None = None  #: terms over the speed, if modelled
    confounded: tuple[Confounding, ...] = ()  #: settings that are correlated with temperature
    relaxation: tuple[Relaxation, ...] = ()  #: carcass stiffnesses from steps of sideslip and of slip
    runs: BetweenRuns | None = None  #: random effects of the runs, if modelled
    choice: NuisanceChoice | None = None
    """Influences modelled in addition to coefficients and declared rig errors, with reasons."""
    radii: Vertical = field(default_factory=Vertical)  #: from loaded radius and wheel speed

    @property
    def left(self) -> float:
        """Predicted decrease of the sum of squares by one more step, of the less converged fit; 0 at the minimum."""
        return max((fit.left for fit in (self.search, self.full) if fit is not None), default=0.0)

    @property
    def of_file(self) -> Mapping[str, Agreement]:
        """By channel, agreement with the points of the written file, which has neither effects of single runs nor of speed."""
        beside = self.runs or self.speed
        return self.channels if beside is None else beside.alone

    @property
    def headline(self) -> str:
        """The misfit of each measured channel."""
        gaps = {name: found for name, found in self.of_file.items() if found.n}
        return ", ".join(f"{name} rmse {x.rmse:.3g} {CHANNELS[name].unit}" for name, x in gaps.items())


keys(
    FitResult,
    "channels radii odd coefficients rig temperature speed modelled runs relaxation confounded bands "
    "posterior coverage left files explanations seconds",
    radii=lambda found: found.radii.agreement(found.tyre.values),
    rig=lambda found: rig_estimates(found.rig if found.temperature is None else found.temperature.rig),
    modelled=lambda found: () if found.choice is None else found.choice.verdicts,
    relaxation=lambda found: (
        {**document(found.relaxation[0]), "slip": found.relaxation[1]} if found.relaxation else None
    ),
    files=lambda found: found.files or {},
)

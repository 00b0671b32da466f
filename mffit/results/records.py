"""The results of one build, and its outcome among many builds."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from mffit.as_json import Json, document, keys, plain
from mffit.brief import Brief
from mffit.config import Config
from mffit.diagnosis.remains import NOTHING_REMAINS, Remains
from mffit.fit import FitResult, fitted_use
from mffit.made import Made
from mffit.made import made as made_now
from mffit.measured import Measured
from mffit.parts import Parts
from mffit.points import Points
from mffit.points.left_out import LeftOut
from mffit.prediction import CorrectionTable, MissedAtReadings, OnRoad, Predictor, missed_sentence
from mffit.suspicion import SOUND, Trust
from tir import Quantity, Tyre

CORRECTION = "-correction.csv"
"""End of the file name of the table of model error."""
TEMPERATURE = "temperature"
"""Key of the file that holds at one temperature, among the uses of the others."""


@dataclass(frozen=True, slots=True, repr=False)
class BuildResult(Brief):
    """The results of a build."""

    config: Config
    points: Points
    parts: Parts
    measured: Measured
    fit: FitResult
    files: Mapping[str, str]
    """Name of each file by use, "turn-slip" or "normal"; "temperature": that at one temperature."""
    tyres: Mapping[str, Tyre]  #: the tyre of each file, by use
    plain: str  #: the use whose file has the plain name
    warnings: tuple[str, ...]
    seconds: float = 0.0  #: time of the whole build
    members: tuple[Tyre, ...] = ()  #: tyres drawn from the posterior, if requested
    trust: Trust = SOUND  #: the judgement by all rules
    remains: Remains = NOTHING_REMAINS  #: the examination of the residuals
    made: Made = field(default_factory=made_now)
    left_out: tuple[LeftOut, ...] = ()  #: readings that are left out, have less weight or are doubted
    missed: Mapping[str, MissedAtReadings] = field(default_factory=dict)
    """Model error at the readings, by channel, where it is proven."""
    correction: CorrectionTable | None = None  #: table of the model error, where it is proven
    excluded: Points | None = None  #: finished points excluded by hand; None without any
    road: OnRoad | None = None  #: the tyre on a straight path; None if no sideslip was tested

    @property
    def headline(self) -> str:
        """Name of the tyre, its eps_gamma if measured, and the misfit of the model."""
        return ", ".join(filter(None, (self.config.tyre.name, self.measured.headline, self.fit.headline)))

    @property
    def trusted(self) -> bool:
        """Whether no rule found a reason against the result."""
        return self.trust.trusted

    @property
    def reasons(self) -> tuple[str, ...]:
        """Sentences on why the result is not to be trusted; empty if it is to be trusted."""
        return self.trust.reasons

    @property
    def on_disc(self) -> bool:
        """Whether the path was curved."""
        return self.config.rig.on_disc

    @property
    def uses(self) -> tuple[str, ...]:
        """Uses of the written files that do not have the temperature as an input."""
        return () if self.fit.files is None else tuple(self.fit.files.by_use)

    @property
    def tyre(self) -> Tyre:
        """The tyre of the file with the plain name."""
        return self.tyres[self.plain]

    @property
    def fitted(self) -> str:
        """The use of the file that holds the fitted model."""
        return fitted_use(self.files)

    @property
    def prediction(self) -> Predictor | None:
        """Predicts forces at any conditions."""
        return self.fit.prediction

    @property
    def predicting(self) -> tuple[Predictor | None, str]:
        """The predictor for any conditions, and the use of the file of its fitted model.

        Where temperature is modelled and the plain file is the fitted model, the file at one temperature has that role.
        """
        warm = self.fit.temperature
        if warm is not None and self.files[self.fitted] == self.tir_path:
            return warm.prediction, TEMPERATURE
        return self.prediction, self.fitted

    @property
    def correction_name(self) -> str:
        """File name of the table of model error."""
        return f"{self.config.tyre.name}{CORRECTION}"

    @property
    def tir_path(self) -> str:
        """The file with the plain name, relative to the output folder."""
        return self.files[self.plain]


keys(
    BuildResult,
    "trusted reasons in_doubt=trust.doubts road tyre=config.tyre spin=measured fit residuals remarks=trust.remarks "
    "tir=tir_path files made lab=config.lab left_out warnings doubts=fit.doubts outliers=fit.outliers",
    fit=lambda found: _fit(found.fit, found.trust.over_noise),
    residuals=lambda found: _residuals(found.remains, found.missed),
    files=lambda found: {
        **found.files,
        **({"correction": found.correction_name} if found.correction else {}),
    },
)


def _fit(found: FitResult, over_noise: Mapping[str, float]) -> dict[str, Json]:
    """The ``fit`` part of ``result.json``; ``over_noise`` is the ratio of misfit to stated noise, by channel."""
    channels: dict[str, Json] = {
        name: {**document(row), "over_noise": over_noise.get(name)} for name, row in found.channels.items()
    }
    return document(found) | {"channels": channels}


def _residuals(remains: Remains, missed: Mapping[str, MissedAtReadings]) -> dict[str, Json]:
    """The ``residuals`` part of ``result.json``.

    Where model error at the readings is proven, ``rms`` is that of the written file, and ``most`` is the region of its maximum.
    """
    found = document(remains)
    for name, one in missed.items():
        of_channel = found["missed"][name]  # type: ignore[call-overload, index]
        of_channel |= {"rms": one.size, "of_file": one.size, "most": plain(one.region)}  # type: ignore[operator]
        of_channel["sentence"] = missed_sentence(one)
    return found


State = Literal["built", "unchanged", "refused", "failed"]


@dataclass(frozen=True, slots=True)
class BuildOutcome:
    """How the build of one ``tyre.toml`` ended."""

    source: Path  #: the tyre.toml
    name: str  #: of the tyre; path of the file if it cannot be read
    out: Path | None  #: output folder
    state: State  #: refused: bad input; failed: a bug, or a worker that died
    sentence: str = ""  #: the reason, without output
    seconds: float = 0.0
    epsilon_gamma: Quantity | None = None
    misfit: Mapping[str, float] = field(default_factory=dict)  #: rms by channel, [N] and [Nm]
    warnings: int = 0
    file: str = ""  #: the property file with the plain name, in ``out``
    reasons: tuple[str, ...] = ()  #: why the result is not to be trusted; empty if it is
    in_doubt: tuple[str, ...] = ()  #: doubts for the engineer to check

    @property
    def whole(self) -> bool:
        """Whether the output is complete."""
        return self.state in ("built", "unchanged")

    @property
    def trusted(self) -> bool:
        """Whether the output is complete and no rule found a reason against the result."""
        return self.whole and not self.reasons


keys(
    BuildOutcome,
    "tyre_toml=source name out state sentence? seconds epsilon_gamma rmse=misfit warnings trusted reasons in_doubt tir=file?",
    trusted=lambda found: found.trusted if found.whole else None,
)

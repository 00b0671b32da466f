"""The records of a build, and of one of many builds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

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
from mffit.prediction import CorrectionTable, MissedAtReadings, Predictor
from mffit.suspicion import SOUND, Trust
from tir import Quantity, Tyre

CORRECTION = "-correction.csv"
"""End of the name of the table of what the formula misses."""


@dataclass(frozen=True, slots=True, repr=False)
class BuildResult(Brief):
    """The results of a build."""

    config: Config
    points: Points
    parts: Parts
    measured: Measured
    fit: FitResult
    files: Mapping[
        str, str
    ]  #: name of each file by use, "turn-slip" or "normal"; "temperature": that at one temperature
    tyres: Mapping[str, Tyre]  #: the tyre of each file, by use
    plain: str  #: the use whose file has the plain name
    warnings: tuple[str, ...]
    seconds: float
    members: tuple[Tyre, ...] = ()  #: drawn from the posterior, if requested
    trust: Trust = SOUND  #: the judgement by all rules
    remains: Remains = NOTHING_REMAINS  #: what the fit leaves of the readings
    made: Made = field(default_factory=made_now)
    left_out: tuple[LeftOut, ...] = ()  #: readings that are left out, have less weight or are doubted
    prediction: Predictor | None = None  #: of forces at any conditions
    missed: Mapping[str, MissedAtReadings] = field(default_factory=dict)
    """By channel, what the formula is proven to miss at the readings."""
    correction: CorrectionTable | None = None  #: what the formula misses, where that is proven
    excluded: Points | None = None  #: finished points that were left out by hand; None without any

    @property
    def headline(self) -> str:
        """Name of the tyre, its eps_gamma if measured, and the misfit of the model."""
        return ", ".join(filter(None, (self.config.tyre.name, self.measured.headline, self.fit.headline)))

    @property
    def trusted(self) -> bool:
        """Whether nothing speaks against the result."""
        return self.trust.trusted

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why the result is not to be trusted, as sentences; empty for a sound one."""
        return self.trust.reasons

    @property
    def on_disc(self) -> bool:
        """Whether the path was curved."""
        return self.config.rig.on_disc

    @property
    def uses(self) -> tuple[str, ...]:
        """Uses of the files without the temperature as an input."""
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
    def correction_name(self) -> str:
        """Name of the table of what the formula misses."""
        return f"{self.config.tyre.name}{CORRECTION}"

    @property
    def tir_path(self) -> str:
        """The plain name, relative to the output folder."""
        return self.files[self.plain]


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
    reasons: tuple[str, ...] = ()  #: why the result is not to be trusted; empty for a sound one
    in_doubt: tuple[str, ...] = ()  #: what the engineer should look at

    @property
    def whole(self) -> bool:
        """Whether its output is complete."""
        return self.state in ("built", "unchanged")

    @property
    def trusted(self) -> bool:
        """Whether it was built, and nothing speaks against the result."""
        return self.whole and not self.reasons

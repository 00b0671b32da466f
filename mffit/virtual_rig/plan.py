"""``rig.toml`` as frozen records: true tyre, rig errors, noise and sweeps.

Angles, forces and directions are in ISO-W axes here, whatever axes the rig reports in.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    NonNegativeFloat,
    PositiveFloat,
    create_model,
    model_validator,
)

from mffit.config import Config, path_curvature, setup_names
from mffit.config import quantities as q
from mffit.config import uncertainty as stated
from mffit.config.models import SetupTable
from mffit.config.table import Table, list_of_tables
from mffit.rig_errors import BY_NAME as RIG_ERROR_NAMES
from mffit.rig_errors import RIG_ERRORS, RigError


def angles(given: Any) -> Any:
    """A number, a list, or ``{ from, to, step }`` with both ends included, as a tuple of numbers."""
    if isinstance(given, int | float) and not isinstance(given, bool):
        return (float(given),)
    if isinstance(given, dict):
        return _range(given)
    return tuple(given) if isinstance(given, list) else given


def _range(given: dict[str, Any]) -> tuple[float, ...]:
    if set(given) != {"from", "to", "step"} or not all(isinstance(v, int | float) for v in given.values()):
        raise q.wrong("needs the numbers from, to and step; give them, or a list of angles")
    steps = (given["to"] - given["from"]) / given["step"] if given["step"] else -1.0
    if not 0 <= steps <= 10_000 or abs(steps - round(steps)) > 1e-6:
        raise q.wrong("is not a whole number of steps from one end to the other; correct step")
    return tuple(float(x) for x in np.linspace(given["from"], given["to"], round(steps) + 1))


Angles = Annotated[tuple[float, ...], BeforeValidator(angles), Field(min_length=1)]


Numbers = BeforeValidator(angles)
"""Validator of a tuple of numbers that accepts the same forms as :func:`angles`."""
Loads = Annotated[tuple[q.Load, ...], Numbers, Field(min_length=1)]
Pressures = Annotated[tuple[q.Pressure, ...], Numbers, Field(min_length=1)]
Speeds = Annotated[tuple[q.Speed, ...], Numbers, Field(min_length=1)]
Slip = Annotated[float, AfterValidator(q.Range(-1.0, 4.0, "-"))]
Slips = Annotated[tuple[Slip, ...], Numbers, Field(min_length=1)]


class TruthTable(Table):
    """[truth]: the true tyre."""

    tyre: str  #: property file, relative to rig.toml


def _error_field(error: RigError) -> tuple[Any, None]:
    """Type and default of the key of a rig error."""
    accepted: Any = Annotated[float, AfterValidator(q.Range(error.lower, error.upper, error.unit))]
    return accepted | None, None


if TYPE_CHECKING:
    RigErrorValues = Table
else:
    RigErrorValues = create_model(
        "RigErrorValues", __base__=Table, **{error.name: _error_field(error) for error in RIG_ERRORS}
    )


class OwnFaultsTable(RigErrorValues):
    """[sweep.faults], [setup.NAME]: rig errors of one sweep or set-up in addition to those of the rig."""

    def values(self) -> dict[str, float]:
        """The rig errors given in the file."""
        return self.model_dump(include=set(RIG_ERROR_NAMES), exclude_none=True)


class FaultsTable(OwnFaultsTable):
    """[faults]: the errors of the rig, with one key for each record of :mod:`mffit.rig_errors`."""

    draw: bool = False  #: draw declared errors without a given value from their uncertainty in [rig]


MEASURED = ("Fy_N", "Mz_Nm", "My_Nm")
ADDED = ("Fx_N", "Mx_Nm", "RL_m", "omega_radps")
"""Columns of the channels that a rig measures, and may measure in addition. Noise is drawn in this order, so that an additional
channel does not change the others."""


class NoiseTable(Table):
    """[noise]: scatter of a finished point, one standard deviation."""

    Fy_N: NonNegativeFloat = 0.0
    Mz_Nm: NonNegativeFloat = 0.0
    My_Nm: NonNegativeFloat | None = None  #: None: the rig does not measure My; likewise for the keys below
    Fx_N: NonNegativeFloat | None = None
    Mx_Nm: NonNegativeFloat | None = None
    RL_m: NonNegativeFloat | None = None
    omega_radps: NonNegativeFloat | None = None
    declared: bool = True  #: whether to write the scatter with every point, as u_Fy_N and so on

    def of(self, channel: str) -> float | None:
        """Scatter of a channel by its column; None if it is not measured."""
        scatter: float | None = getattr(self, channel)
        return scatter

    @property
    def added(self) -> tuple[str, ...]:
        """Columns measured in addition to Fy, Mz and My, in the order of the table."""
        return tuple(name for name in ADDED if self.of(name) is not None)


class DriveTable(Table):
    """[drive]: the drive of the wheel, and the reference of the reported slip."""

    slip_against: Literal["free-rolling", "loaded-radius"] = "free-rolling"
    drag_Nm: NonNegativeFloat = 0.0
    """Moment of bearings and brake against the rotation of a wheel that rolls freely."""


class ConditionsTable(Table):
    """[conditions]: the defaults of all sweeps."""

    p_kPa: q.Pressure | None = None  #: None: the nominal pressure
    V_mps: q.Speed = 6.0
    T_degC: float = 25.0
    seconds_per_point: PositiveFloat | None = None  #: time from point to point; writes the column t_s


class RollingRadiusPlan(Table):
    """[[rolling_radius]]: one disc revolution to simulate, or a radius given with its uncertainty."""

    load_N: q.Load
    u_angle_deg: stated.Angle = 1.0
    u_arc_m: stated.Length = 0.001
    u_effective_radius: stated.Length | None = None
    """If given, a radius with this uncertainty is written instead of a revolution."""


class RecordingTable(Table):
    """[sweep.recording]: the sweep as a time series instead of finished points."""

    rate_Hz: PositiveFloat = 20.0
    hold_s: NonNegativeFloat = 30.0  #: time at every set-point; 0 for a continuous sweep
    steering_deg_per_s: PositiveFloat = 2.0
    noise_Fy_N: NonNegativeFloat = 25.0
    noise_Mz_Nm: NonNegativeFloat = 2.5
    noise_My_Nm: NonNegativeFloat = 0.0
    noise_Fz_N: NonNegativeFloat = 0.0
    slip_per_s: PositiveFloat = 0.1  #: rate of the longitudinal slip between points
    noise_Fx_N: NonNegativeFloat = 25.0
    noise_Mx_Nm: NonNegativeFloat = 5.0
    noise_RL_m: NonNegativeFloat = 0.0
    noise_omega_radps: NonNegativeFloat = 0.0
    correlation_s: NonNegativeFloat = 0.8  #: correlation time of the noise
    ripple_Fy_N: NonNegativeFloat = 0.0  #: amplitude, once per revolution of the wheel
    ripple_Mz_Nm: NonNegativeFloat = 0.0


class SweepPlan(SetupTable):
    """[[sweep]]: set-points; slip runs fastest, then sideslip, camber, load, pressure and speed."""

    load_N: Loads
    alpha_deg: Angles = (0.0,)
    gamma_deg: Angles = (0.0,)
    kappa: Slips = (0.0,)
    free_rolling: bool = False
    """Whether the wheel is undriven: rolling resistance and drag then cause a small slip."""
    p_kPa: Pressures | None = None
    V_mps: Speeds | None = None
    T_degC: Angles | None = None  #: one temperature, or those of the first and the last point
    faults: OwnFaultsTable = OwnFaultsTable()
    recording: RecordingTable | None = None

    @model_validator(mode="after")
    def _file_inside_the_folder(self) -> SweepPlan:
        if Path(self.file).name != self.file or not self.file.endswith((".csv", ".csv.gz")):
            raise q.wrong(
                f'"{self.file}" is not a plain file name that ends in .csv or .csv.gz; write one', "file"
            )
        return self

    @model_validator(mode="after")
    def _one_motion(self) -> SweepPlan:
        if self.free_rolling and self.kappa != (0.0,):
            raise q.wrong("is given, but the wheel rolls freely; remove it or free_rolling", "kappa")
        several = [name for name in ("load_N", "p_kPa", "V_mps") if len(getattr(self, name) or ()) > 1]
        if self.recording is not None and several:
            raise q.wrong(
                "has several values, but a recording has one; write a [[sweep]] for each", several[0]
            )
        return self


class RigTables(Table):
    """The tables of ``rig.toml`` that ``tyre.toml`` lacks or has in another form."""

    seed: int = 0
    truth: TruthTable
    faults: FaultsTable = FaultsTable()
    setup: dict[str, OwnFaultsTable] = Field(default_factory=dict)
    noise: NoiseTable = NoiseTable()
    drive: DriveTable = DriveTable()
    conditions: ConditionsTable = ConditionsTable()
    rolling_radius: Annotated[tuple[RollingRadiusPlan, ...], BeforeValidator(list_of_tables)] = ()
    sweep: Annotated[tuple[SweepPlan, ...], BeforeValidator(list_of_tables), Field(min_length=1)]


@dataclass(frozen=True, slots=True)
class RigPlan:
    """A virtual test campaign: the rig as ``tyre.toml`` declares it, and the truth behind the data."""

    declared: Config  #: the content of tyre.toml without the rolling radii
    tables: RigTables  #: tables that only rig.toml has
    folder: Path  #: base of relative file names

    @property
    def tyre_path(self) -> Path:
        """The property file of the tyre on the rig."""
        return self.folder / self.tables.truth.tyre

    @property
    def phi_t_sign(self) -> int:
        """Sign of the path's turn slip: -1 with the centre to the left, 0 on a flat track."""
        return int(np.sign(path_curvature(self.declared.rig)))

    def path(self, sweep: SweepPlan) -> float:
        """Turn slip of a sweep's path as declared [1/m]; 0 on a flat track."""
        return path_curvature(self.declared.rig, sweep)

    @property
    def setups(self) -> tuple[str, ...]:
        """Name of the set-up of every sweep, empty if there is only one."""
        return setup_names(self.declared.rig, self.tables.sweep)

    @property
    def reports_slip(self) -> bool:
        """Whether the rig has a column of longitudinal slip."""
        tables = self.tables
        return tables.noise.Fx_N is not None or any(sweep.kappa != (0.0,) for sweep in tables.sweep)

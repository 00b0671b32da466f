"""The tables of ``tyre.toml`` as frozen records: keys, types, defaults and checks between keys.

Every ``u_`` is one standard deviation (k = 1). Units are those of the file, as the key or the comment says.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, PrivateAttr, create_model, model_validator
from uncertainties import ufloat

from mffit.brief import Brief
from mffit.config import constants
from mffit.config import quantities as q
from mffit.config import uncertainty as stated
from mffit.config.by_hand import Entries, as_in_the_file, check_coefficients, named
from mffit.config.laboratory import LabTable
from mffit.config.lines import ExcludeTable, check_exclusions
from mffit.config.problems import shown
from mffit.config.radii import effective_radius, path_radius
from mffit.config.table import Table, list_of_tables
from mffit.config.toml_file import line_of
from mffit.errors import InputError
from mffit.rig_errors import BY_NAME, CALIBRATED, DECLARED, Declared
from tir.constants import EFFECTIVE_RADIUS_RANGE

SETUP_NAME = re.compile(r"[A-Za-z0-9_.+-]+( +[A-Za-z0-9_.+-]+)*")
RESERVED_NAME = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)
"""Devices of Windows, whatever the ending."""
FORBIDDEN_IN_NAMES = set('/\\:*?"<>|') | {chr(code) for code in range(32)}


def _file_stem(name: str) -> str:
    reserved = RESERVED_NAME.fullmatch(name)
    if not name.strip() or name.startswith(".") or set(name) & FORBIDDEN_IN_NAMES or reserved:
        raise q.wrong(f'"{name}" cannot name the output files; use letters, digits, - and _')
    return name


class TyreTable(Table):
    """[tyre]: what is known about the tyre before the fit."""

    name: Annotated[str, AfterValidator(_file_stem)]  #: stem of the output file
    size: str = "-"
    unloaded_radius: q.WheelRadius  #: [m]
    width: q.Width | None = None  #: [m]
    rim_radius: q.WheelRadius | None = None  #: [m]
    nominal_load: q.Load  #: FNOMIN [N]
    nominal_pressure: q.Pressure  #: NOMPRES [kPa]
    nominal_speed: q.Speed = 10.0  #: LONGVL [m/s]
    side: Literal["left", "right", "symmetric"] = "left"  #: TYRESIDE of the measured tyre
    base: str | None = None  #: property file with the coefficients that are not fitted
    priors: str | None = None  #: JSON file with priors from a fleet of such tyres

    @model_validator(mode="after")
    def _rim_inside_tyre(self) -> TyreTable:
        if self.rim_radius is not None and self.rim_radius >= self.unloaded_radius:
            raise q.wrong(
                f"{self.rim_radius:g} m is not smaller than the unloaded radius, {self.unloaded_radius:g} m; "
                "write the rim's radius in metres, not its diameter",
                "rim_radius",
            )
        return self


class PathTable(Table):
    """[rig.path]: the four tape measures of (19)."""

    shaft_diameter: q.Length  #: diameter of the disc's shaft [m]
    L_B: q.Length  #: shaft to the inner edge of the path [m]
    L_C: q.Length  #: inner edge of the path to the inner sidewall [m]
    L_D: q.Length  #: inner edge of the path to the outer sidewall [m]


ALSO_CALLED = {"calspan": "sae"}
"""Other names of axes: data of Calspan's flat belt, published by the tyre test consortium, are in SAE axes."""


U_RANGES = {
    "-": stated.Share,
    "N": stated.Force,
    "Nm": stated.Moment,
    "deg": stated.Angle,
    "m": stated.Length,
    "deg/Nm": stated.Compliance,
    "deg/kN": stated.Tilt,
}
"""Accepted range of a standard uncertainty by its unit."""


def _u_field(declared: Declared) -> tuple[object, float | None]:
    """Type and default of the key that declares the uncertainty of a rig error."""
    accepted: Any = U_RANGES[declared.unit]
    return (accepted | None, None) if declared.default is None else (accepted, float(declared.default))


class MachineTable(Table):
    """[rig] without the keys ``u_...`` of the rig errors: the machine and its axes."""

    name: str | None = None
    """Builds of one rig and set-up are recognised by this name and those of the set-ups."""
    type: Literal["rotating-disk", "flat-track"] = "rotating-disk"
    axes: Annotated[
        Literal["iso", "sae", "adapted-sae"], BeforeValidator(lambda name: ALSO_CALLED.get(str(name), name))
    ] = "iso"
    force_frame: Literal["W", "C"] = "W"
    moments: Literal["contact", "wheel-centre"] = "contact"
    path_centre: Literal["left", "right"] = "left"
    path_radius: q.PathRadius | None = None  #: [m]
    path: PathTable | None = None
    u_length: stated.Length = 0.001  #: each tape measure [m]
    backlash_deg: q.Play = 0.0  #: full play of the sideslip axis
    u_conicity: stated.Share = float(constants.PLAUSIBLE_CONICITY)  #: of the tyre, force over load

    @property
    def on_disc(self) -> bool:
        """Whether the path is curved."""
        return self.type == "rotating-disk"

    @property
    def radius(self) -> float | None:
        """Path radius R [m], declared or by (19); None on a flat track."""
        if not self.on_disc:
            return None
        return self.path_radius if self.path is None else path_radius(**self.path.model_dump())

    def u(self, name: str) -> float:
        """Standard uncertainty of a rig error, such as "F0_N", in the unit of its key; 0 if it is not declared."""
        declared = BY_NAME[name].declared
        given = None if declared is None else getattr(self, declared.key)
        if given is None and self.path is not None:
            lengths = {key: ufloat(x, self.u_length) for key, x in self.path.model_dump().items()}
            return float(path_radius(**lengths).s)
        return given or 0.0

    @model_validator(mode="before")
    @classmethod
    def _default_u(cls, given: object) -> object:
        if isinstance(given, dict) and "path_radius" in given and "u_path_radius" not in given:
            return {**given, "u_path_radius": float(constants.U_GIVEN_PATH_RADIUS)}
        return given

    @model_validator(mode="after")
    def _one_radius(self) -> MachineTable:
        if self.type == "flat-track":
            return self
        if self.path_radius is None and self.path is None:
            raise q.wrong(
                "is missing for a rotating disc; add it in metres, or [rig.path] with shaft_diameter, L_B, "
                'L_C and L_D, or set type = "flat-track"',
                "rig.path_radius",
            )
        if self.path_radius is not None and self.path is not None:
            raise q.wrong("is given together with [rig.path]; keep one of the two", "rig.path_radius")
        radius, (least, most) = self.radius, q.PATH_RADII
        assert radius is not None
        if not least <= radius <= most:
            raise q.wrong(
                f"gives a path radius of {radius:g} m, outside {least:g} to {most:g} m; check the four lengths",
                "rig.path",
            )
        if self.u("path_radius_m") > constants.LARGEST_U_OF_A_RADIUS * radius:
            raise q.wrong(
                f"{self.u('path_radius_m'):g} m is more than a tenth of the path radius; write it in metres",
                "rig.u_path_radius",
            )
        return self


if TYPE_CHECKING:
    RigTable = MachineTable
else:
    RigTable = create_model(
        "RigTable",
        __base__=MachineTable,
        __doc__="[rig]: the machine, its axes, and a key ``u_...`` for every declared rig error.",
        **{declared.key: _u_field(declared) for _, declared in DECLARED},
    )


class RollingRadiusTable(Table):
    """[rolling_radius]: one disc revolution (18), or the effective radius itself."""

    load_N: q.Load | None = None  #: default nominal_load
    revolutions: q.Revolutions | None = None  #: whole turns of the wheel
    angle_start_deg: q.Inclination | None = None
    angle_end_deg: q.Inclination | None = None
    u_angle_deg: stated.Angle = 1.0
    u_arc_m: stated.Length = 0.001
    effective_radius: q.WheelRadius | None = None  #: [m]
    u_effective_radius: stated.Length | None = None  #: [m]

    @property
    def is_measured(self) -> bool:
        """Whether r_e follows from a disc revolution rather than being given."""
        return self.effective_radius is None

    @model_validator(mode="after")
    def _one_way(self) -> RollingRadiusTable:
        turned = (self.revolutions, self.angle_start_deg, self.angle_end_deg)
        if self.effective_radius is None and None in turned:
            raise q.wrong(
                "is incomplete; give revolutions, angle_start_deg and angle_end_deg, or effective_radius with "
                "u_effective_radius"
            )
        if self.effective_radius is not None and any(value is not None for value in turned):
            raise q.wrong(
                "is given as well as a measured revolution; keep one of the two", "effective_radius"
            )
        if self.effective_radius is not None and self.u_effective_radius is None:
            raise q.wrong("is missing, but effective_radius needs it; add it in metres", "u_effective_radius")
        return self


class CamberStiffnessTable(Table):
    """[camber_stiffness]: the estimate of C_gamma that counts; both are reported."""

    method: Literal["slope", "secant"] = "slope"
    angle_deg: q.EstimateAngle = 15.0


class SpinTable(Table):
    """[spin]: which of the two files gets the plain name, and the source of PECP1."""

    exact: Literal["turn-slip", "normal", "both"] = "turn-slip"
    pecp1: Literal["direct", "debiased", "model"] = "direct"


class FitTable(Table):
    """[fit]: numbers of the tyre's state and of the rig that the fit may free, and readings that it leaves out.

    "auto" frees a number if left-out sweeps are then predicted better.
    """

    temperature: Literal["auto", True, False] = "auto"
    T_ref_degC: q.Temperature | None = None  #: of the file at temperature; None: the mean of the data
    pressure: Literal["auto", True, False] = "auto"  #: what pressure does beyond the coefficients
    speed: Literal["auto", True, False] = "auto"
    sense: Literal["auto", "hysteresis", "lag", False] = "auto"
    warm_up: Literal["auto", True, False] = False
    wear: Literal["auto", True, False] = False
    run_scale: Literal["auto", True, False] = "auto"  #: friction and cornering stiffness of every sweep
    exclude: Annotated[tuple[ExcludeTable, ...], BeforeValidator(list_of_tables)] = ()


class NormalTable(Table):
    """[normal]: the file for turn slip off."""

    weight: Literal["everything", "road"] = "everything"
    camber_max_deg: q.CamberLimit | None = None  #: None: the written range

    @property
    def camber_max(self) -> float | None:
        """The limit of camber [rad]; None without one."""
        return None if self.camber_max_deg is None else math.radians(self.camber_max_deg)


class ModelTable(Table):
    """[model]: settings of the simulation that measurements are compared with."""

    turn_slip: bool = True
    star: bool = False
    u_coefficients: stated.Share = 0.0


class Column(Table):
    """Heading, unit and scale of a sweep column in a file with other headings or units, or one value for all rows."""

    column: str | None = None  #: heading in the file; None: the column's own name
    value: float | None = None  #: of all rows, in place of a column of the file
    unit: str | None = None  #: None: as the file says, else the column's own unit
    scale: float = 1.0
    against: Literal["free-rolling", "loaded-radius", "unloaded-radius"] | None = None
    """Radius of kappa; None: found from Fx = 0."""
    over: Literal["road", "wheel", "larger"] | None = None
    """Speed by which kappa is divided; None: the road's, unless the recorded speeds show another."""

    @model_validator(mode="after")
    def _one_source(self) -> Column:
        if self.column is not None and self.value is not None:
            raise q.wrong("is given together with column; keep one of the two", "value")
        return self


def _as_column(given: object) -> object:
    """A heading or a value alone as a table."""
    if isinstance(given, int | float) and not isinstance(given, bool):
        return {"value": given}
    return {"column": given} if isinstance(given, str) else given


Columns = dict[str, Annotated[Column, BeforeValidator(_as_column)]]


def _setup_name(name: str) -> str:
    if not SETUP_NAME.fullmatch(name):
        raise q.wrong(f'"{name}" cannot name a set-up; use letters, digits, spaces and - _ . +')
    return name


SetupName = Annotated[str, AfterValidator(_setup_name)]


class SetupTable(Table):
    """Keys of a [[sweep]] about its set-up: path, mount and rolling direction."""

    file: str
    direction: Literal["forward", "backward"] | None = None
    """None: the file's column if it has one, else forward."""
    mount: Literal["normal", "flipped"] = "normal"
    path_centre: Literal["left", "right"] | None = None  #: None: that of [rig]
    path_radius: q.PathRadius | None = None  #: [m]; None: that of [rig]
    setup: SetupName | None = None
    """Sweeps between which the rig was not set up anew; None: one per path."""


class SweepTable(SetupTable):
    """[[sweep]]: one file."""

    columns: Columns = Field(default_factory=dict)


class Config(Brief, Table):
    """The whole of ``tyre.toml``."""

    tyre: TyreTable
    rig: RigTable
    rolling_radius: Annotated[tuple[RollingRadiusTable, ...], BeforeValidator(list_of_tables)] = ()
    camber_stiffness: CamberStiffnessTable = CamberStiffnessTable()
    spin: SpinTable = SpinTable()
    coefficients: Annotated[Entries, BeforeValidator(named)] = Field(default_factory=dict)
    fit: FitTable = FitTable()
    normal: NormalTable = NormalTable()
    model: ModelTable = ModelTable()
    lab: LabTable = LabTable()
    columns: Columns = Field(default_factory=dict)  #: of all files; those of a sweep take precedence
    sweep: Annotated[tuple[SweepTable, ...], BeforeValidator(list_of_tables)]

    _path: Path | None = PrivateAttr(default=None)
    _folder: Path = PrivateAttr(default_factory=Path)
    _lines: dict[str, int] = PrivateAttr(default_factory=dict)

    @property
    def headline(self) -> str:
        """The tyre's name."""
        return self.tyre.name

    @property
    def path(self) -> Path | None:
        """The file that was read; None for a mapping."""
        return self._path

    @property
    def folder(self) -> Path:
        """Folder to which relative file names refer."""
        return self._folder

    @property
    def base_path(self) -> Path | None:
        """The base property file; None if none is named."""
        return None if self.tyre.base is None else self._folder / self.tyre.base

    @property
    def hand(self) -> dict[str, object]:
        """The entries of [coefficients] as the file has them."""
        return {name: as_in_the_file(entry) for name, entry in self.coefficients.items()}

    @property
    def priors_path(self) -> Path | None:
        """The file with priors from a fleet; None if none is named."""
        return None if self.tyre.priors is None else self._folder / self.tyre.priors

    def line_of(self, key: str) -> int | None:
        """Line of a dotted key (``sweep.2.file`` for the third sweep), else of the table around it; None without either."""
        return line_of(key, self._lines)

    def refusal(self, sentence: str, key: str) -> InputError:
        """The error about a dotted key, such as ``sweep.2.file`` for the third sweep, with its line in the file."""
        return InputError(sentence, file=self.path, line=self.line_of(key), key=shown(key, self._lines))

    @model_validator(mode="before")
    @classmethod
    def _load_of_radius(cls, given: object) -> object:
        """A rolling radius without a load holds at the nominal load."""
        if not isinstance(given, dict) or not isinstance(given.get("tyre"), dict):
            return given
        rows, load = list_of_tables(given.get("rolling_radius", ())), given["tyre"].get("nominal_load")
        if not isinstance(rows, tuple) or not all(isinstance(row, dict) for row in rows):
            return given
        return {**given, "rolling_radius": tuple({"load_N": load, **row} for row in rows)}

    @model_validator(mode="after")
    def _calibrated_as_certified(self) -> Config:
        """Keys ``u_..._gain`` that the file leaves out get the uncertainty of the channel's certificate."""
        of_channel: dict[str, float] = {}
        for index, one in enumerate(self.lab.instruments):
            if one.channel is not None and one.u_gain is not None:
                if one.channel in of_channel:
                    key = f"lab.instruments.{index}.channel"
                    raise q.wrong(f"{one.channel} is read by an instrument above, too; remove one", key)
                of_channel[one.channel] = one.u_gain
        certified = {CALIBRATED[channel]: u for channel, u in of_channel.items()}
        left_out = {key: u for key, u in certified.items() if key not in self.rig.model_fields_set}
        if left_out:
            object.__setattr__(self, "rig", self.rig.model_copy(update=left_out))
        return self

    @model_validator(mode="after")
    def _sweeps_agree_with_rig(self) -> Config:
        if not self.sweep:
            raise q.wrong('is empty; add a [[sweep]] with file = "..." for each measured file', "sweep")
        seen: set[str] = set()
        for index, sweep in enumerate(self.sweep):
            if sweep.file in seen:
                raise q.wrong(f'"{sweep.file}" is listed twice; remove one', f"sweep.{index}.file")
            seen.add(sweep.file)
            if sweep.setup is not None and sweep.setup in {other.file for other in self.sweep}:
                raise q.wrong(
                    f'"{sweep.setup}" is also the name of a file; give the set-up another name',
                    f"sweep.{index}.setup",
                )
            for key in ("path_centre", "path_radius"):
                if not self.rig.on_disc and getattr(sweep, key) is not None:
                    raise q.wrong(
                        "is given, but the path of a flat track is straight; remove it",
                        f"sweep.{index}.{key}",
                    )
        check_exclusions(self.fit.exclude, seen)
        return self

    @model_validator(mode="after")
    def _coefficients_agree_with_other_keys(self) -> Config:
        check_coefficients(
            self.coefficients,
            symmetric=self.tyre.side == "symmetric",
            has_base=self.tyre.base is not None,
            direct=self.rig.on_disc and self.spin.pecp1 != "model",
        )
        return self

    @model_validator(mode="after")
    def _rolling_radius_near_unloaded(self) -> Config:
        R, R0 = self.rig.radius, self.tyre.unloaded_radius
        for index, row in enumerate(self.rolling_radius):
            key = f"rolling_radius.{index}"
            if row.is_measured and R is None:
                raise q.wrong(
                    "has a disc revolution, but the rig is a flat track; give effective_radius instead", key
                )
            r_e = effective_radius(row, R) if row.effective_radius is None else row.effective_radius
            least, most = EFFECTIVE_RADIUS_RANGE
            if not least * R0 <= r_e <= most * R0:
                raise q.wrong(_radius_sentence(r_e, R0, row.is_measured), key)
            u = row.u_effective_radius
            if u is not None and u > constants.LARGEST_U_OF_A_RADIUS * r_e:
                raise q.wrong(
                    f"{u:g} m is more than a tenth of the radius; write it in metres",
                    f"{key}.u_effective_radius",
                )
        return self


def _radius_sentence(r_e: float, R0: float, measured: bool) -> str:
    ratio = r_e / R0
    sentence = f"gives an effective radius of {r_e:.4g} m, {ratio:.2f} times the unloaded radius of {R0:g} m"
    if not measured:
        return f"{sentence}; check both, in metres"
    least, most = EFFECTIVE_RADIUS_RANGE
    if least < ratio / 2.0 < most:
        return f"{sentence}; path_radius looks like a diameter, halve it"
    return f"{sentence}; check path_radius, revolutions and the angles, which are in degrees"


def given_values(tyre: TyreTable) -> dict[str, Any]:
    """Values of ``[tyre]``, stated or by default, in the units of :mod:`tir`, and FITTYP of MF 6.2."""
    given = {
        "FNOMIN": tyre.nominal_load,
        "NOMPRES": tyre.nominal_pressure * 1e3,
        "INFLPRES": tyre.nominal_pressure * 1e3,
        "LONGVL": tyre.nominal_speed,
        "UNLOADED_RADIUS": tyre.unloaded_radius,
        "WIDTH": tyre.width,
        "RIM_RADIUS": tyre.rim_radius,
        "TYRESIDE": tyre.side.upper(),
        "FITTYP": 62,
    }
    return {name: value for name, value in given.items() if value is not None}

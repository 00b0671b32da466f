"""The records of the direct method."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import numpy as np

from mffit.as_json import keys, with_u
from mffit.brief import Brief
from mffit.constants import COVERAGE_FACTOR_95, FALSE_ALARM, USUAL_CORNERING_STIFFNESS
from mffit.made import Made
from mffit.measured import constants
from mffit.measured.one_way import OneWayLag
from mffit.measured.uncertain import Contribution, Expanded, expanded
from mffit.quantities import CONDITIONS, DIRECT, KEYS
from tir import Quantity
from tir.parameters import BY_NAME

FINITE_SPIN = "finite spin of the disc"
"""Name of the bias of finite spin in the budget."""


def usual_ply_steer() -> float:
    """Prior standard deviation of ply-steer [rad], which looks like a misaligned sideslip axis."""
    spread = BY_NAME["PHY1"].disc_spread
    assert spread is not None
    return float(spread)


class SideslipReading(NamedTuple):
    """alpha_M from forward and backward zeros at one load and path."""

    load: float  #: [N]
    phi_t: float  #: turn slip of the path [1/m]
    alpha_M: Quantity  #: [rad]


class SideslipZeros(NamedTuple):
    """Consistency of the sideslip zeros at the loads and paths of one set-up."""

    setup: str
    chance: float  #: probability of such differences in one set-up
    one: SideslipReading  #: one of the two readings that are farthest apart
    other: SideslipReading  #: the other of the two


class Drift(NamedTuple):
    """Relative differences between sweeps of the forces at the same condition."""

    scatter: float  #: standard deviation between sweeps
    chance: float  #: probability of such differences if the state of the tyre does not change
    least: str  #: sweep with the smallest forces
    most: str  #: sweep with the largest forces
    apart: float  #: difference of these two

    @property
    def counts(self) -> bool:
        """Whether the drift is significant and larger than the uncertainty of a slope at zero from its shape."""
        return self.chance < FALSE_ALARM and self.scatter > constants.SLOPE_SHAPE


keys(Drift, "scatter chance least most apart")


class SetupResult(NamedTuple):
    """Results from the zeros of one set-up on one path at one load alone."""

    name: str  #: name of the set-up
    phi_t: float  #: turn slip of the path [1/m]
    F_phit: Quantity  #: turn-slip force, corrected (23) [N]
    C_phit: Quantity  #: [Nm]
    epsilon_gamma: Quantity
    alpha_M: Quantity | None  #: of the set-up, at this load [rad]; None without backward runs
    misaligned: bool  #: whether alpha_M exceeds the rig's alignment uncertainty
    axis_off: bool = False  #: whether moreover the misalignment of the axis is clearly not zero

    @property
    def path(self) -> str:
        """The path in words."""
        return path_in_words(self.phi_t)


keys(
    SetupResult,
    "setup=name path_centre path_radius_m ±F_phit_N ±C_phit_Nm ±epsilon_gamma ±alpha_M_deg misaligned",
    path_centre=lambda row: "left" if row.phi_t < 0.0 else "right",
    path_radius_m=lambda row: abs(1.0 / row.phi_t),
)


def path_in_words(phi_t: float) -> str:
    """Radius and side of the path with a turn slip [1/m]."""
    return f"{abs(1.0 / phi_t):.4g} m to the {'left' if phi_t < 0.0 else 'right'}"


class SetupScatter(NamedTuple):
    """Scatter of the zeros of repeated set-ups on one path, by one-way analysis of variance."""

    load: float  #: load of the zeros [N]
    setups: tuple[str, ...]  #: the repeated set-ups
    between: float  #: standard deviation of the force at zero between set-ups [N]
    degrees_of_freedom: int
    declared: float  #: standard deviation expected from the uncertainties in [rig] [N]
    chance: float  #: probability of such scatter if the declaration holds
    excess: float  #: standard deviation in excess of the declared one [N]


keys(SetupScatter, "load_N setups between_N degrees_of_freedom declared_N chance excess_N")


def is_clear(misalignment: Quantity | None) -> bool:
    """Whether a misalignment differs clearly from zero."""
    return misalignment is not None and abs(misalignment.value) > COVERAGE_FACTOR_95 * misalignment.u


@dataclass(frozen=True, slots=True, repr=False)
class LoadResult(Brief):
    """Results of the direct method at one load; quantities in SI and ISO signs, u with k = 1."""

    load: float  #: [N]
    C_alpha: Quantity | None = None  #: slope at zero on the path [N/rad]
    C_alpha_straight: Quantity | None = None  #: as C_alpha, on a straight path, by the fitted model [N/rad]
    C_gamma: Quantity | None = None  #: by the chosen method on the path, corrected for rig errors [N/rad]
    r_e: Quantity | None = None  #: [m]
    R: Quantity | None = None  #: [m]
    F_phit: Quantity | None = None  #: turn-slip force, corrected (23) [N]
    C_phit: Quantity | None = None  #: [Nm]
    epsilon_gamma: Quantity | None = None
    epsilon_debiased: Quantity | None = None  #: corrected for the finite spin of the disc
    epsilon_slope: float | None = None
    epsilon_secant: float | None = None
    epsilon_moment: float | None = None  #: from moments; informational, so without uncertainty
    alpha_M: Quantity | None = None  #: sum of misalignment and ply-steer, of the set-up [rad]
    misalignment: Quantity | None = None  #: part of alpha_M from the axis, by the priors of both parts [rad]
    ply_steer: Quantity | None = None  #: part of alpha_M from the tyre [rad]
    conicity: Quantity | None = None  #: from zeros on both mounts [N]
    F_forward: float = math.nan  #: mean raw force of the forward zeros, backlash removed [N]
    F_backward: float = math.nan  #: [N]; NaN without backward runs
    budget: tuple[Contribution, ...] = ()  #: of epsilon_gamma
    budgets: Mapping[str, tuple[Contribution, ...]] = field(default_factory=dict)
    """Budgets of the other measured quantities, by their name in :data:`KEYS`."""
    paths: tuple[float, ...] = ()  #: turn slip of every path with zeros, the usual path first [1/m]
    setups: tuple[SetupResult, ...] = ()  #: results from every path and set-up alone, if there are several
    yields: float = 0.0  #: relative change of C_alpha by a compliance of the steering of 1 deg/Nm

    def slip_force(self, angle: float) -> float:
        """Side force [N] of a small sideslip angle [rad], with the usual stiffness if none was measured."""
        C_alpha = -USUAL_CORNERING_STIFFNESS * self.load if self.C_alpha is None else self.C_alpha.value
        return C_alpha * angle

    def slips_beyond(self, u_force: float) -> bool:
        """Whether the side force of alpha_M exceeds ``u_force``, the declared alignment uncertainty as a force [N]."""
        return self.alpha_M is not None and abs(self.slip_force(self.alpha_M.value)) > u_force

    def axis_off(self, u_force: float) -> bool:
        """Whether alpha_M exceeds the alignment uncertainty and the misalignment of the axis is clearly not zero."""
        return self.slips_beyond(u_force) and is_clear(self.misalignment)

    def shift_by(self, force: float) -> float:
        """Change of eps_gamma if a force [N] is wrongly counted as turn-slip force."""
        assert self.epsilon_gamma is not None
        assert self.F_phit is not None
        return abs((1.0 - self.epsilon_gamma.value) * force / self.F_phit.value)

    @property
    def secant_bias(self) -> float | None:
        """eps_gamma by the secant less eps_gamma by the slope at zero; None without both."""
        if self.epsilon_secant is None or self.epsilon_slope is None:
            return None
        return self.epsilon_secant - self.epsilon_slope

    @property
    def expanded(self) -> Expanded | None:
        """The expanded uncertainty of eps_gamma; None without a budget."""
        return expanded(self.budget) if self.budget else None

    @property
    def of_model(self) -> dict[str, Quantity]:
        """The quantities that are results of a fitted model, by name."""
        found = {name: getattr(self, name) for name in KEYS}
        return {name: q for name, q in found.items() if q is not None and q.origin == "fitted"}

    @property
    def headline(self) -> str:
        """The load, and eps_gamma if it was measured there."""
        return headline(self.load, self.epsilon_gamma)


def headline(load: float, epsilon: Quantity | None) -> str:
    """A load [N], and eps_gamma if it is known there."""
    said = (
        "" if epsilon is None else f", {DIRECT['epsilon_gamma'].ascii} {epsilon.value:.3f} +- {epsilon.u:.2g}"
    )
    return f"{CONDITIONS['Fz_N'].of(load)}{said}"


keys(
    LoadResult,
    f"load_N {' '.join(f'±{key}={name}' for name, key in KEYS.items())} "
    "epsilon_gamma_secant=epsilon_secant epsilon_gamma_secant_bias=secant_bias epsilon_gamma_slope=epsilon_slope "
    "epsilon_gamma_moment=epsilon_moment u_epsilon_gamma_moment ±epsilon_gamma_debiased=epsilon_debiased "
    "±alpha_M_deg ±alpha_0_deg=misalignment ±ply_steer_deg ±conicity_N F_forward_N F_backward_N",
    u_epsilon_gamma_moment=lambda _: None,
)


class StepFromPaper(NamedTuple):
    """What one step from the published procedure to the result of this program changes."""

    what: str
    change: float  #: of the turn-slip force, or of the camber force at the angle of the secant [N]
    epsilon_gamma: float  #: after this step and those before it


keys(StepFromPaper, "what change_N=change epsilon_gamma")


@dataclass(frozen=True, slots=True)
class PublishedResult:
    """Results of the published procedure at one load; u with k = 1."""

    epsilon_gamma: Quantity
    F_phit: Quantity  #: [N]
    C_gamma: float  #: secant, without uncertainty in the paper [N/rad]
    corrections: tuple[StepFromPaper, ...]  #: in order, up to eps_gamma as this program measures it


keys(PublishedResult, "±epsilon_gamma ±F_phit_N C_gamma_N_per_rad=C_gamma corrections")


NO_LOAD = {"load_N": None, **{key: None for name in KEYS.values() for key in with_u(name, None)}}
"""The numbers at the nominal load if nothing was measured there."""


Source = Literal["direct", "debiased", "model", "hand"]
"""Origins of PECP1 on a disc: the choices of ``[spin] pecp1``, and a value held in [coefficients]."""


class LoadDependence(NamedTuple):
    """PECP2 of eps_gamma(Fz) = PECP1 (1 + PECP2 dfz)."""

    pecp2: float
    u_pecp2: float | None
    note: str  #: the value, or why it is 0


class CarriedEpsilon(NamedTuple):
    """eps_gamma as the property file carries it."""

    source: Source
    pecp1: Quantity  #: at the nominal load; before a fit that frees PECP1, the direct value, from which it starts
    over_load: LoadDependence

    @property
    def is_free(self) -> bool:
        """Whether the fit determines PECP1."""
        return self.source in ("model", "hand")


@dataclass(frozen=True, slots=True)
class AfterFit:
    """What a fitted model adds to the direct measurements; nothing before a fit."""

    spin: Quantity | None = None  #: bias of finite spin over (1 - eps_gamma) phi_t^2, by the model [m^2]
    epsilon_gamma: float | None = None  #: by (17) from the forces of the model
    pecp1: Quantity | None = None  #: PECP1 of the written file
    stiffnesses: Mapping[float, Mapping[str, Quantity]] = field(default_factory=dict)
    """By load [N], stiffnesses by their names in :class:`LoadResult`, which replace measured ones."""


NO_FIT = AfterFit()


@dataclass(frozen=True, slots=True, repr=False)
class Measured(Brief):
    """Results of the direct method, without a model."""

    per_load: tuple[LoadResult, ...]
    nominal: LoadResult | None  #: the load nearest FNOMIN; None if nothing could be measured
    carried: CarriedEpsilon | None  #: eps_gamma of the property file; None if it was not measured
    r_e_loads: Mapping[float, float]  #: measured effective radius [m] by load [N]
    misaligned: bool  #: whether alpha_M exceeds the alignment uncertainty; the fit then accounts for alpha_M
    notes: tuple[str, ...]  #: remarks that need no action
    warnings: tuple[str, ...]  #: warnings that need action
    setup_scatter: SetupScatter | None = None  #: None without repeated set-ups
    sideslip_zeros: tuple[SideslipZeros, ...] = ()  #: of every set-up with several zeros in both directions
    drift: Drift | None = None  #: None without repeated conditions, or if the temperature varies
    lag: OneWayLag | None = None  #: of moving sweeps that all go one way
    misaligned_setups: Mapping[str, float] = field(default_factory=dict)
    """By set-up whose alpha_M exceeds the alignment uncertainty, alpha_M at the nominal load [rad]."""
    axis_off: bool = False  #: whether moreover the misalignment of the axis is clearly not zero
    camber_skew: Quantity | None = None  #: from camber sweeps in both directions [deg]
    epsilon_gamma_model: float | None = None  #: by (17) from the forces of the model; None before a fit
    made: Made | None = None  #: of ``mffit spin`` only
    reasons: tuple[str, ...] = ()  #: reasons against trust, of ``mffit spin`` only
    published: PublishedResult | None = None  #: at the nominal load; None without eps_gamma or secant

    @property
    def trusted(self) -> bool:
        """Whether no rule found a reason against the result."""
        return not self.reasons

    @property
    def headline(self) -> str:
        """The nominal load, and eps_gamma of the property file if it was measured."""
        return headline(self.nominal.load, self.epsilon_of_file) if self.nominal else "nothing"

    @property
    def epsilon_of_file(self) -> Quantity | None:
        """eps_gamma at the nominal load as the property file carries it."""
        return self.carried.pecp1 if self.carried else None

    @property
    def pecp1(self) -> float | None:
        return self.carried.pecp1.value if self.carried else None

    @property
    def pecp2(self) -> float:
        return self.carried.over_load.pecp2 if self.carried else 0.0

    @property
    def epsilon_gamma(self) -> Quantity | None:
        """eps_gamma at the nominal load as measured, by (17)."""
        return self.nominal.epsilon_gamma if self.nominal else None

    @property
    def F_phit(self) -> Quantity | None:
        return self.nominal.F_phit if self.nominal else None

    @property
    def C_gamma(self) -> Quantity | None:
        return self.nominal.C_gamma if self.nominal else None

    @property
    def epsilon_gamma_debiased(self) -> Quantity | None:
        """eps_gamma corrected for the finite spin of the disc."""
        return self.nominal.epsilon_debiased if self.nominal else None

    @property
    def C_alpha(self) -> Quantity | None:
        return self.nominal.C_alpha if self.nominal else None

    @property
    def r_e(self) -> Quantity | None:
        return self.nominal.r_e if self.nominal else None

    @property
    def alpha_M(self) -> Quantity | None:
        return self.nominal.alpha_M if self.nominal else None

    @property
    def budget(self) -> tuple[Contribution, ...]:
        return self.nominal.budget if self.nominal else ()

    def by_load(self, key: str) -> dict[float, float]:
        """One quantity by load [N], such as "C_alpha"."""
        found = {row.load: getattr(row, key) for row in self.per_load}
        return {load: quantity.value for load, quantity in found.items() if quantity is not None}

    def quantities(self) -> dict[str, Quantity]:
        """The quantities at the nominal load for the structured comments of the property file."""
        if self.nominal is None:
            return {}
        found = {key: getattr(self.nominal, name) for name, key in KEYS.items()}
        if self.carried is not None and self.carried.source != "direct":
            found |= {"epsilon_gamma": self.epsilon_of_file, "epsilon_gamma_direct": self.epsilon_gamma}
        out = {key: quantity for key, quantity in found.items() if quantity is not None}
        if self.epsilon_gamma_debiased is not None:
            out["epsilon_gamma_debiased"] = self.epsilon_gamma_debiased
        for key, value in (("epsilon_gamma_model", self.epsilon_gamma_model), ("load_N", self.nominal.load)):
            if value is not None:
                known = ("N", "measured") if key == "load_N" else ("-", "fitted")
                out[key] = Quantity(float(value), 0.0, *known)
        return out


# SI units, ISO signs, k = 1. The judgement is at the top of ``spin.json`` and of ``result.json``.
keys(
    Measured,
    "**judged **at_nominal ±epsilon_gamma=epsilon_of_file ±epsilon_gamma_direct=epsilon_gamma epsilon_gamma_source "
    "epsilon_gamma_model ±epsilon_gamma_debiased pecp1 pecp2 "
    "u_pecp2=carried.over_load.u_pecp2 budget budgets "
    "expanded=nominal.expanded ±camber_skew_deg misaligned=axis_off coverage_factor setups setup_scatter drift published notes "
    "per_load [made]",
    judged=lambda found: (
        {}
        if found.made is None
        else {"trusted": found.trusted, "reasons": found.reasons, "warnings": found.warnings}
    ),
    at_nominal=lambda found: found.nominal or NO_LOAD,
    budgets=lambda found: (
        {KEYS[n]: rows for n, rows in found.nominal.budgets.items()} if found.nominal else {}
    ),
    epsilon_gamma_source=lambda found: found.carried and found.carried.source,
    coverage_factor=lambda _: 1,
    setups=lambda found: () if found.nominal is None else found.nominal.setups,
)


@dataclass(frozen=True, slots=True)
class AlignmentStep:
    """One iteration at one load."""

    load: float  #: [N]
    iteration: int
    F_forward: float  #: force at the forward zeros, ISO [N]
    F_backward: float  #: [N]
    F_turn_slip: float  #: (6) [N]
    F_slip: float  #: (7) [N]
    C_alpha: float  #: used for the correction, ISO, negative [N/rad]
    correction_deg: float  #: next correction of the steering reading, in degrees of the rig's axis
    source: str  #: origin of C_alpha: "measured" from a sideslip sweep, "secant" of two iterations (9), or "guess"
    u_deg: float  #: standard uncertainty of the correction


@dataclass(frozen=True, slots=True, repr=False)
class Alignment(Brief):
    """All steps, in the order of loads and iterations."""

    steps: tuple[AlignmentStep, ...]
    warnings: tuple[str, ...]
    resolution_deg: float = 0.0

    @property
    def last(self) -> tuple[AlignmentStep, ...]:
        """The last iteration at every load."""
        return tuple({step.load: step for step in self.steps}.values())

    @property
    def correction_deg(self) -> float:
        """The next correction: mean over loads of the last iteration, weighted by stiffness."""
        return float(self._weights() @ [step.correction_deg for step in self.last])

    @property
    def u_deg(self) -> float:
        """Standard uncertainty of the next correction."""
        return float(np.linalg.norm(self._weights() * [step.u_deg for step in self.last]))

    @property
    def u_axis_deg(self) -> float:
        """Standard uncertainty of the misalignment of the axis alone, including the unknown ply-steer."""
        return math.hypot(self.u_deg, math.degrees(usual_ply_steer()))

    @property
    def aligned(self) -> bool:
        """Whether the correction is within its uncertainty, or below the resolution of the axis."""
        return abs(self.correction_deg) <= max(self.u_deg, self.resolution_deg)

    def _weights(self) -> np.ndarray:
        stiffness = np.array([abs(step.C_alpha) for step in self.last])
        return np.asarray(stiffness / stiffness.sum())


keys(Alignment, "correction_deg u_correction_deg=u_deg u_axis_deg aligned steps warnings")

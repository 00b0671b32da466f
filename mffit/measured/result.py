"""The records of the direct method."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from mffit.brief import Brief
from mffit.constants import COVERAGE_FACTOR_95, FALSE_ALARM, USUAL_CORNERING_STIFFNESS
from mffit.made import Made
from mffit.measured import constants
from mffit.measured.uncertain import Contribution, Expanded, expanded
from mffit.quantities import CONDITIONS, DIRECT
from tir import Quantity
from tir.parameters import BY_NAME

FINITE_SPIN = "finite spin of the disc"
"""Its name in the budget."""


def usual_ply_steer() -> float:
    """Prior standard deviation of ply-steer [rad], which looks like a misaligned sideslip axis."""
    spread = BY_NAME["PHY1"].disc_spread
    assert spread is not None
    return float(spread)


class SideslipReading(NamedTuple):
    """alpha_M as the zeros both ways at one load and path give it."""

    load: float  #: [N]
    phi_t: float  #: turn slip of the path [1/m]
    alpha_M: Quantity  #: [rad]


class SideslipZeros(NamedTuple):
    """How well the zeros both ways of one set-up agree on its sideslip zero."""

    setup: str
    chance: float  #: probability that zeros of one set-up differ by so much
    one: SideslipReading  #: the two that are farthest apart
    other: SideslipReading


class Drift(NamedTuple):
    """How far forces of one condition differ from sweep to sweep, relative."""

    scatter: float  #: standard deviation between sweeps
    chance: float  #: probability that sweeps of one tyre in one state differ by so much
    least: str  #: sweep with the smallest forces
    most: str  #: sweep with the largest forces
    apart: float  #: by which the two differ

    @property
    def counts(self) -> bool:
        """Whether chance does not explain it, and it is more than the uncertainty that every slope at zero has anyway."""
        return self.chance < FALSE_ALARM and self.scatter > constants.SLOPE_SHAPE


class SetupResult(NamedTuple):
    """The zeros of one set-up of the rig on one path and at one load, by themselves."""

    name: str  #: of the set-up
    phi_t: float  #: turn slip of the path [1/m]
    F_phit: Quantity  #: turn-slip force, corrected (23) [N]
    C_phit: Quantity  #: [Nm]
    epsilon_gamma: Quantity
    alpha_M: Quantity | None  #: of the set-up, at this load [rad]; None without backward runs
    misaligned: bool  #: alpha_M is beyond what the rig's alignment leaves
    axis_off: bool = False  #: its split supports that the axis, and not the tyre, causes it

    @property
    def path(self) -> str:
        """The path in words."""
        return path_in_words(self.phi_t)


def path_in_words(phi_t: float) -> str:
    """Radius and side of the path with a turn slip [1/m]."""
    return f"{abs(1.0 / phi_t):.4g} m to the {'left' if phi_t < 0.0 else 'right'}"


class SetupScatter(NamedTuple):
    """Scatter of the zeros of repeated set-ups on one path, in addition to what is declared; one-way analysis of variance."""

    load: float  #: at which it was measured [N]
    setups: tuple[str, ...]  #: the repeated ones
    between: float  #: standard deviation of the force at zero from set-up to set-up [N]
    degrees_of_freedom: int
    declared: float  #: the same as the uncertainties in [rig] give it [N]
    chance: float  #: probability of so much scatter if the declaration holds
    excess: float  #: force by which a set-up scatters beyond what is declared [N]


def is_clear(misalignment: Quantity | None) -> bool:
    """Whether a misalignment differs clearly from zero."""
    return misalignment is not None and abs(misalignment.value) > COVERAGE_FACTOR_95 * misalignment.u


@dataclass(frozen=True, slots=True, repr=False)
class LoadResult(Brief):
    """Everything measured at one load; quantities in SI and ISO signs, u with k = 1."""

    load: float  #: [N]
    C_alpha: Quantity | None = None  #: slope at zero on the path [N/rad]
    C_alpha_straight: Quantity | None = None  #: the same without spin, by the model of a build [N/rad]
    C_gamma: Quantity | None = None  #: the chosen estimate on the path, corrected for rig errors [N/rad]
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
    misalignment: Quantity | None = None  #: its part of the axis, by the priors of both [rad]
    ply_steer: Quantity | None = None  #: its part of the tyre [rad]
    conicity: Quantity | None = None  #: from zeros on both mounts [N]
    F_forward: float = math.nan  #: mean raw force of the forward zeros, backlash removed [N]
    F_backward: float = math.nan  #: [N]; NaN without backward runs
    budget: tuple[Contribution, ...] = ()  #: of epsilon_gamma
    budgets: Mapping[str, tuple[Contribution, ...]] = field(default_factory=dict)
    """Of the other quantities that were measured, by their name in :data:`KEYS`."""
    paths: tuple[float, ...] = ()  #: turn slip of every path with zeros, the usual one first [1/m]
    setups: tuple[
        SetupResult, ...
    ] = ()  #: the zeros of every path and set-up by themselves, if there are several

    def slip_force(self, angle: float) -> float:
        """Side force [N] of a small sideslip angle [rad], by the usual stiffness if none was measured."""
        C_alpha = -USUAL_CORNERING_STIFFNESS * self.load if self.C_alpha is None else self.C_alpha.value
        return C_alpha * angle

    def slips_beyond(self, u_force: float) -> bool:
        """Whether the side force of alpha_M exceeds what the alignment of the axis is declared to leave [N]."""
        return self.alpha_M is not None and abs(self.slip_force(self.alpha_M.value)) > u_force

    def axis_off(self, u_force: float) -> bool:
        """Whether it does, and the axis, not the tyre, clearly causes it."""
        return self.slips_beyond(u_force) and is_clear(self.misalignment)

    def shift_by(self, force: float) -> float:
        """Change of eps_gamma by a force [N] that is taken for turn slip."""
        assert self.epsilon_gamma is not None
        assert self.F_phit is not None
        return abs((1.0 - self.epsilon_gamma.value) * force / self.F_phit.value)

    @property
    def secant_bias(self) -> float | None:
        """How much larger eps_gamma by the secant is than by the slope at zero."""
        if self.epsilon_secant is None or self.epsilon_slope is None:
            return None
        return self.epsilon_secant - self.epsilon_slope

    @property
    def expanded(self) -> Expanded | None:
        """The expanded uncertainty of eps_gamma; None without a budget."""
        return expanded(self.budget) if self.budget else None

    @property
    def headline(self) -> str:
        """The load, and eps_gamma if it was measured there."""
        found = self.epsilon_gamma
        said = (
            "" if found is None else f", {DIRECT['epsilon_gamma'].ascii} {found.value:.3f} +- {found.u:.2g}"
        )
        return f"{CONDITIONS['Fz_N'].of(self.load)}{said}"


@dataclass(frozen=True, slots=True, repr=False)
class Measured(Brief):
    """Results of the direct method, without a model."""

    per_load: tuple[LoadResult, ...]
    nominal: LoadResult | None  #: the load nearest FNOMIN; None if nothing could be measured
    pecp1: float | None
    pecp2: float
    u_pecp2: float | None
    r_e_loads: Mapping[float, float]  #: by load, where it was measured
    misaligned: (
        bool  #: the slip force is beyond what the alignment leaves; the fit corrects the points for alpha_M
    )
    notes: tuple[str, ...]  #: to know beside the numbers
    warnings: tuple[str, ...]  #: to act on
    load_note: str = ""  #: the value of PECP2, or why it is 0
    setup_scatter: SetupScatter | None = None  #: None without repeated set-ups
    sideslip_zeros: tuple[SideslipZeros, ...] = ()  #: of every set-up with several zeros both ways
    drift: Drift | None = None  #: None where nothing repeated shows one, or warmth is known
    misaligned_setups: Mapping[str, float] = field(default_factory=dict)
    """alpha_M [rad] of the set-ups that are beyond what the alignment leaves, each known from any of its loads."""
    axis_off: bool = False  #: the split of alpha_M supports that the sideslip axis is misaligned
    camber_skew: Quantity | None = None  #: from camber sweeps in both directions [deg]
    epsilon_gamma_model: float | None = None
    made: Made | None = None  #: set by ``mffit spin``
    reasons: tuple[str, ...] = ()  #: against trusting it, set by ``mffit spin``; a build judges the whole

    @property
    def trusted(self) -> bool:
        """Whether ``mffit spin`` found nothing against the result."""
        return not self.reasons

    @property
    def headline(self) -> str:
        """eps_gamma at the nominal load."""
        return self.nominal.headline if self.nominal else "nothing"

    @property
    def epsilon_gamma(self) -> Quantity | None:
        return self.nominal.epsilon_gamma if self.nominal else None

    @property
    def F_phit(self) -> Quantity | None:
        return self.nominal.F_phit if self.nominal else None

    @property
    def F_phit_load(self) -> float:
        assert self.nominal is not None
        return self.nominal.load

    @property
    def C_phit(self) -> Quantity | None:
        return self.nominal.C_phit if self.nominal else None

    @property
    def C_gamma(self) -> Quantity | None:
        return self.nominal.C_gamma if self.nominal else None

    @property
    def epsilon_gamma_debiased(self) -> Quantity | None:
        """Corrected for the finite spin of the disc."""
        return self.nominal.epsilon_debiased if self.nominal else None

    @property
    def C_alpha(self) -> Quantity | None:
        return self.nominal.C_alpha if self.nominal else None

    @property
    def r_e(self) -> Quantity | None:
        return self.nominal.r_e if self.nominal else None

    @property
    def R(self) -> Quantity | None:
        return self.nominal.R if self.nominal else None

    @property
    def alpha_M(self) -> Quantity | None:
        return self.nominal.alpha_M if self.nominal else None

    @property
    def budget(self) -> tuple[Contribution, ...]:
        return self.nominal.budget if self.nominal else ()

    @property
    def budgets(self) -> dict[str, tuple[Contribution, ...]]:
        """Of every other quantity at the nominal load, by its key in JSON."""
        return {KEYS[name]: rows for name, rows in self.nominal.budgets.items()} if self.nominal else {}

    def by_load(self, key: str) -> dict[float, float]:
        """One quantity by load [N], such as "C_alpha"."""
        found = {row.load: getattr(row, key) for row in self.per_load}
        return {load: quantity.value for load, quantity in found.items() if quantity is not None}

    def debiased(self, bias: float) -> Measured:
        """The record with the bias of finite spin as a fitted model predicts it, in place of the usual bias.

        The measured value still contains the bias, so its uncertainty does too.
        """
        row, direct = self.nominal, self.epsilon_gamma
        assert row is not None
        assert direct is not None
        u_bias = constants.SPIN_BIAS_OF_MODEL * abs(bias)
        before = math.hypot(*(line.contribution for line in row.budget if line.source == FINITE_SPIN))
        rest = math.sqrt(max(direct.u**2 - before**2, 0.0))
        both = math.hypot(bias, u_bias)
        spin = Contribution(FINITE_SPIN, both, "-", both, value=0.0, sensitivity=1.0)
        lines = [line for line in row.budget if line.source != FINITE_SPIN]
        whole, corrected = math.hypot(rest, both), direct.value - bias
        named = dataclasses.replace(
            row,
            epsilon_gamma=Quantity(direct.value, whole, direct.unit),
            epsilon_debiased=Quantity(corrected, math.hypot(rest, u_bias), direct.unit),
            budget=tuple(sorted((*lines, spin), key=lambda line: -line.contribution)),
        )
        return self.with_nominal(named)

    def with_nominal(self, row: LoadResult) -> Measured:
        """The record with another row at the nominal load."""
        rows = tuple(row if other is self.nominal else other for other in self.per_load)
        return dataclasses.replace(self, nominal=row, per_load=rows)

    def quantities(self) -> dict[str, Quantity]:
        """What goes into the property file's structured comments."""
        if self.nominal is None:
            return {}
        found = {key: getattr(self.nominal, name) for name, key in KEYS.items()}
        out = {key: quantity for key, quantity in found.items() if quantity is not None}
        if self.epsilon_gamma_debiased is not None:
            out["epsilon_gamma_debiased"] = self.epsilon_gamma_debiased
        for key, value in (("epsilon_gamma_model", self.epsilon_gamma_model), ("load_N", self.nominal.load)):
            if value is not None:
                out[key] = Quantity(float(value), 0.0, "N" if key == "load_N" else "-")
        return out


KEYS = {
    "epsilon_gamma": "epsilon_gamma",
    "C_phit": "C_phit_Nm",
    "C_gamma": "C_gamma_N_per_rad",
    "C_alpha": "C_alpha_N_per_rad",
    "C_alpha_straight": "C_alpha_straight_N_per_rad",
    "r_e": "r_e_m",
    "R": "R_m",
    "F_phit": "F_phit_N",
}
"""What the quantities of a load are called, with their unit, in property files and JSON; by attribute."""


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
    source: str  #: of C_alpha: "measured" from a sideslip sweep, "secant" of two iterations (9), or "guess"
    u_deg: float  #: standard uncertainty of the correction


@dataclass(frozen=True, slots=True, repr=False)
class Alignment(Brief):
    """All steps, in the order of loads and iterations."""

    steps: tuple[AlignmentStep, ...]
    warnings: tuple[str, ...]
    resolution_deg: float = field(default=constants.AXIS_RESOLUTION)

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
        """Its standard uncertainty."""
        return float(np.linalg.norm(self._weights() * [step.u_deg for step in self.last]))

    @property
    def u_axis_deg(self) -> float:
        """Standard uncertainty of the axis's own misalignment, of which ply-steer takes an unknown part."""
        return math.hypot(self.u_deg, math.degrees(usual_ply_steer()))

    @property
    def aligned(self) -> bool:
        """Whether the correction is within its uncertainty, or below the resolution of the axis."""
        return abs(self.correction_deg) <= max(self.u_deg, self.resolution_deg)

    def _weights(self) -> np.ndarray:
        stiffness = np.array([abs(step.C_alpha) for step in self.last])
        return np.asarray(stiffness / stiffness.sum())

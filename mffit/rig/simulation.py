"""The forward model: what this rig would read of this tyre, and how that changes with any number in it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from mffit.brief import Brief
from mffit.points import Points, main_path
from mffit.quantities import CHANNELS
from mffit.rig.faults import FAULT_NAMES, NO_FAULTS, OF_RUN, RigFaults
from mffit.rig.lag import lagged_points
from mffit.rig.play import Moment, Settled, settled
from tir import Tyre
from tir.derivatives import Traced, following, gradient, plain, traced
from tir.evaluate import turned_on_rim
from tir.outputs import outputs_of

SWITCH = "turn_slip"
RELAXATION = "relaxation_m"
RADIANS = math.pi / 180.0
YIELDINGS = 12
SETTLED = 1e-7
"""Change of sideslip [rad] at which a compliant steering has found its angle, and rounds that it takes at most."""
DIFFERENCE = 1e-6
"""Step of sideslip [rad] for the moment's slope."""
HELD = math.radians(0.02)
"""Change of sideslip from point to point [rad] below which it was held."""
WARM_KM = 1.0
"""Distance over which a tyre warms up [km]."""


class Readings(NamedTuple):
    """What the rig reports; arrays (n,)."""

    Fy: np.ndarray  #: [N]
    Mz: np.ndarray  #: [Nm]


@dataclass(frozen=True, slots=True, repr=False)
class Simulation(Brief):
    """A tyre on a rig. Points keep the angle as read; whatever stands between reading and tyre is in ``faults``."""

    values: Mapping[str, Any]  #: every value of the property file
    faults: RigFaults = NO_FAULTS
    turn_slip: bool = True  #: whether the simulation knows path curvature and spin
    star: bool = False  #: tan(alpha), sin(gamma) as inputs
    relaxation_m: float = 0.0  #: lag of continuous sweeps [m]
    radius_m: float = math.nan  #: declared radius of the rig's usual path [m]; NaN: that of most points
    of_runs: Mapping[str, float] = field(
        default_factory=dict
    )  #: what single runs add to a fault, as ``F0_N@zeros.csv``: [deg], [N] or [Nm]

    @classmethod
    def of(
        cls, tyre: Tyre, faults: RigFaults = NO_FAULTS, *, turn_slip: bool = True, star: bool = False
    ) -> Simulation:
        """The simulation of a tyre."""
        return cls(dict(tyre.values), faults, turn_slip, star)

    def number(self, name: str, points: Points) -> float:
        """Current value of a coefficient, a rig fault or a switch."""
        if name == SWITCH:
            return float(self.turn_slip)
        if name == RELAXATION:
            return self.relaxation_m
        if OF_RUN in name:
            return self.of_runs.get(name, 0.0)
        if name == "path_radius_m" and math.isnan(self.faults.path_radius_m):
            return self.declared(points)
        return float(getattr(self.faults, name) if name in FAULT_NAMES else self.values[name])

    def declared(self, points: Points) -> float:
        """Radius of the usual path [m] as declared, which the fault ``path_radius_m`` replaces."""
        return declared_radius(points) if math.isnan(self.radius_m) else self.radius_m

    def with_numbers(self, numbers: Mapping[str, float]) -> Simulation:
        """The same with some coefficients, rig faults or switches replaced."""
        faults = {name: value for name, value in numbers.items() if name in FAULT_NAMES}
        of_runs = {name: value for name, value in numbers.items() if OF_RUN in name}
        others = {*FAULT_NAMES, *of_runs, SWITCH, RELAXATION}
        values = {n: v for n, v in numbers.items() if n not in others}
        return replace(
            self,
            values={**self.values, **values} if values else self.values,
            faults=replace(self.faults, **faults) if faults else self.faults,
            turn_slip=bool(numbers.get(SWITCH, self.turn_slip)),
            relaxation_m=float(numbers.get(RELAXATION, self.relaxation_m)),
            of_runs={**self.of_runs, **of_runs} if of_runs else self.of_runs,
        )

    @property
    def faultless(self) -> Simulation:
        """The same tyre on a perfect rig at reference conditions."""
        return replace(self, faults=NO_FAULTS, of_runs={})

    def readings(self, points: Points) -> Readings:
        """What the rig would report at every point.

        Parameters
        ----------
        points : set-points (n,): angles as read, load, pressure, speed, direction, mount and path curvature

        Returns
        -------
        Readings
            Fy [N] and Mz [Nm] in ISO-W, contact frame, rig-fixed also when rolling backwards.
        """
        return Readings(*self._reported(points, {}))

    def predict(self, points: Points) -> np.ndarray:
        """The readings in one row (2n,): Fy [N], then Mz [Nm]."""
        return np.concatenate(self.readings(points))

    def sensitivities(self, points: Points, names: Sequence[str]) -> tuple[Readings, Readings]:
        """The readings, and their exact derivatives by the named numbers: each channel (n, k).

        The stop at which the moment holds a wheel with play stays the same; one that floats keeps without moment.
        """
        numbers = traced({name: self.number(name, points) for name in names})
        out = self._reported(points, numbers)
        columns = list(numbers.values())
        n = len(points)
        slopes = (np.broadcast_to(gradient(channel, columns), (n, len(columns))) for channel in out)
        return Readings(*(np.broadcast_to(plain(channel), n) for channel in out)), Readings(*slopes)

    def _reported(self, points: Points, numbers: Mapping[str, Traced]) -> tuple[Any, Any]:
        """Fy and Mz as the rig reports them, plain or traced."""
        fault = self._faults(numbers, points)
        Fy, Mz = self._forces(points, self._true_alpha(points, fault, numbers), fault, numbers)
        environment = _environment(points, fault)
        Fy = fault.gain * Fy * environment
        if _present(fault.nonlinearity_per_kN):
            Fy = Fy * (1.0 + 1e-3 * fault.nonlinearity_per_kN * abs(Fy))
        return Fy + fault.F0_N + fault.crosstalk * points.Fz, Mz * environment + fault.M0_Nm

    def _faults(self, numbers: Mapping[str, Traced], points: Points) -> Any:
        """The rig's faults, with what single runs add to them."""
        fault = {**asdict(self.faults), **{n: x for n, x in numbers.items() if n in FAULT_NAMES}}
        of_runs = {**self.of_runs, **{n: x for n, x in numbers.items() if OF_RUN in n}}
        for key, added in of_runs.items():
            name, _, file = key.partition(OF_RUN)
            fault[name] = fault[name] + added * of_run(points, file)
        return SimpleNamespace(**fault)

    def _forces(
        self,
        points: Points,
        alpha: Any,
        fault: Any,
        numbers: Mapping[str, Traced],
        wanted: tuple[str, ...] = tuple(CHANNELS),
    ) -> list[Any]:
        """Fy [N] and Mz [Nm] of the tyre at its true sideslip angle ``alpha`` (n,) [rad], or one of them."""
        p: Any = SimpleNamespace(**{**self.values, **{n: x for n, x in numbers.items() if n in self.values}})
        if np.any(points.mount < 0):
            p = turned_on_rim(p, points.mount)
        for name, scale in (("k_T_grip_per_K", "LMUY"), ("k_T_stiffness_per_K", "LKY")):
            factor = getattr(fault, name)
            if _present(factor):
                scaled = getattr(p, scale) * (1.0 + factor * _warmth(points, fault))
                p = SimpleNamespace(**{**vars(p), scale: scaled})
        phi_t: Any = points.phi_t
        if not math.isnan(plain(fault.path_radius_m)):
            # What the usual path's radius is off, every other path is off too: the wheel is moved by known distances.
            apart = path_radii(points) - self.declared(points)
            phi_t = np.sign(points.phi_t) / (fault.path_radius_m + apart)
        inputs = {
            "Fz": points.Fz,
            "alpha": alpha,
            "gamma": points.gamma + fault.gamma_0_deg * RADIANS,
            "phi_t": phi_t,
            "Vx": points.Vx,
            "pressure": points.p,
        }
        return outputs_of(wanted, p, inputs, turn_slip=self.turn_slip, star=self.star)

    def _moment(self, points: Points, alpha: Any, fault: Any, numbers: Mapping[str, Traced]) -> Any:
        return self._forces(points, alpha, fault, numbers, ("Mz",))[0]

    def _true_alpha(self, points: Points, fault: Any, numbers: Mapping[str, Traced]) -> Any:
        """Sideslip angle of the tyre (n,) [rad]: what is read, followed with lag, misaligned, and the play taken up."""
        alpha = self._followed(points, numbers.get(RELAXATION)) + fault.alpha_0_deg * RADIANS
        if _present(fault.hysteresis_deg):
            alpha = alpha - fault.hysteresis_deg * (RADIANS * sense(points))
        if _present(fault.compliance_deg_per_Nm):
            give = fault.compliance_deg_per_Nm * RADIANS
            alpha = _yielding(
                give,
                alpha,
                lambda at: self._moment(points, at, fault, numbers),
                derivatives=bool(numbers),
            )
        if not _present(fault.backlash_deg):
            return alpha
        half_play = 0.5 * RADIANS * fault.backlash_deg

        plainly = self._faults({}, points)

        def moment_of(which: np.ndarray) -> Moment:
            part = points if len(which) == len(points) else points.select(which)
            return lambda at: self._moment(part, at, plainly, {})

        rest = settled(moment_of, np.broadcast_to(plain(alpha), len(points)), plain(half_play))
        held = alpha - half_play * rest.side
        if not np.any(rest.floats):
            return held
        return np.where(rest.floats, self._floating(points, rest, numbers), held)

    def _floating(self, points: Points, rest: Settled, numbers: Mapping[str, Traced]) -> Any:
        """The angle without moment (n,); it moves with the numbers so that the moment stays away."""
        if not numbers:
            return rest.alpha
        which = np.flatnonzero(rest.floats)
        again = traced({n: x.value for n, x in numbers.items()} | {"alpha": rest.alpha[which]})
        at = again.pop("alpha")
        some = points.select(which)
        Mz = self._moment(some, at, self._faults(again, some), again)
        slopes = gradient(Mz, [*again.values(), at])
        moves = np.zeros((len(points), len(numbers)))
        turning = slopes[:, -1:]
        moves[which] = np.divide(
            -slopes[:, :-1], turning, out=np.zeros_like(slopes[:, :-1]), where=turning != 0.0
        )
        value = np.where(rest.floats, rest.alpha, 0.0)
        return following(value, list(numbers.values()), moves)

    def _followed(self, points: Points, relaxation: Traced | None) -> Any:
        """Sideslip that the force answers to (n,): along continuous sweeps it lags behind the reading."""
        length = plain(relaxation) if relaxation is not None else self.relaxation_m
        alpha = lagged_points(points, length).alpha if length else points.alpha
        if relaxation is None:
            return alpha
        step = 1e-4
        return relaxation.derived(alpha, (lagged_points(points, length + step).alpha - alpha) / step)


def of_run(points: Points, file: str) -> np.ndarray:
    """1 at the points (n,) of the run that a file holds, else 0."""
    return np.array([float(name == file) for name in points.files])[points.file]


def declared_radius(points: Points) -> float:
    """Path radius [m] that most points were declared with; very large on a straight path."""
    return 1.0 / max(abs(main_path(points)), 1e-12)


def path_radii(points: Points) -> np.ndarray:
    """Declared path radius (n,) of every point [m]; very large on a straight path."""
    return 1.0 / np.maximum(np.abs(points.phi_t), 1e-12)


def reference_speed(points: Points) -> float:
    """The most frequent speed of the data [m/s], to 0.1 m/s."""
    values, counts = np.unique(np.round(points.V[np.isfinite(points.V)], 1), return_counts=True)
    return float(values[counts.argmax()])


def sense(points: Points) -> np.ndarray:
    """Way (n,) in which the sideslip was moving along its sweep: 1, -1, or 0 where it was held."""
    out = np.zeros(len(points))
    for k in np.unique(points.sweep):
        rows = np.flatnonzero(points.sweep == k)
        if len(rows) > 1:
            moving = np.gradient(points.alpha[rows])
            out[rows] = np.where(np.abs(moving) > HELD, np.sign(moving), 0.0)
    return out


def distance_km(points: Points) -> np.ndarray:
    """Distance (n,) rolled since time zero [km]; 0 where times are not known."""
    out = np.zeros(len(points))
    rows = np.flatnonzero(np.isfinite(points.t))
    rows = rows[np.argsort(points.t[rows], kind="stable")]
    t, V = points.t[rows], points.V[rows]
    if len(rows):
        steps = np.diff(t) * 0.5 * (V[1:] + V[:-1])
        out[rows] = 1e-3 * (max(t[0], 0.0) * V[0] + np.concatenate([[0.0], np.cumsum(steps)]))
    return out


def _yielding(give: Any, alpha: Any, moment: Callable[[Any], Any], derivatives: bool) -> Any:
    """Sideslip (n,) of a wheel that its own moment turns by ``give`` [rad/Nm] from ``alpha``."""
    k, start = float(plain(give)), plain(alpha)
    if not k and not isinstance(give, Traced):
        return alpha
    held: Any = start
    slope: Any = 0.0
    if k:
        turned = plain(moment(held))
        slope = (plain(moment(held + DIFFERENCE)) - turned) / DIFFERENCE
        for _ in range(YIELDINGS):
            move = (start + k * turned - held) / (1.0 - k * slope)
            held = held + move
            if np.max(np.abs(move)) < SETTLED:
                break
            before, turned = turned, plain(moment(held))
            far = np.abs(move) > SETTLED
            slope = np.where(far, (turned - before) / np.where(far, move, 1.0), slope)
    if not derivatives:
        return held
    if k:
        slope = _moment_slope(moment, held)
    return held + (alpha + give * moment(held) - held) / (1.0 - k * slope)


def _moment_slope(moment: Callable[[Any], Any], alpha: np.ndarray) -> np.ndarray:
    """dMz/dalpha (n,) [Nm/rad]."""
    up, down = (plain(moment(alpha + step)) for step in (DIFFERENCE, -DIFFERENCE))
    return (up - down) / (2.0 * DIFFERENCE)


def _warmth(points: Points, fault: Any) -> Any:
    """Temperature above the reference (n,) [K]; 0 where it was not measured."""
    known = np.isfinite(points.T)
    return np.where(known, np.nan_to_num(points.T) - fault.T_ref_degC, 0.0)


def _environment(points: Points, fault: Any) -> Any:
    """Factor (n,) on Fy and Mz; a channel that was not measured has no influence."""
    factor = (1.0 + fault.k_T_per_K * _warmth(points, fault)) * (
        1.0 + fault.k_t_per_s * np.nan_to_num(points.t)
    )
    rolled = [n for n in ("wear_per_km", "warm_up") if _present(getattr(fault, n))]
    if rolled:
        s = distance_km(points)
        factor = factor * (1.0 + fault.wear_per_km * s) * (1.0 - fault.warm_up * np.exp(-s / WARM_KM))
    if not _present(fault.k_V_per_mps):
        return factor
    return factor * (1.0 + fault.k_V_per_mps * np.nan_to_num(points.V - reference_speed(points)))


def _present(number: Any) -> bool:
    return isinstance(number, Traced) or bool(number)

"""The chain from the set-points as read, through the tyre, to the readings of the load cells."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property
from types import SimpleNamespace
from typing import Any

import numpy as np

from mffit.points import Points
from mffit.quantities import CHANNELS
from mffit.rig.histories import History, RowsOfTest, path_radii
from mffit.rig.lag import lagged_setting
from mffit.rig.play import settled
from mffit.rig_errors import AFTER, BEFORE, P_REF, T_REF, V_REF, RigError
from tir.derivatives import Traced, gradient, plain, traced
from tir.evaluate import turned_on_rim
from tir.outputs import outputs_of


class Chain:
    """Computation of readings from set-points through rig and tyre; every quantity may be plain or traced.

    The formulae of :mod:`mffit.rig_errors` use the public attributes.

    Parameters
    ----------
    points : set-points (n,) as read
    coefficients : every value of the property file
    numbers : every rig error, scalar or (n,)
    usual_radius : declared radius of the usual path [m]
    modes : ``turn_slip`` and ``star`` as in :class:`mffit.rig.Simulation`
    place : of the points in their test; default: the points are the whole test
    """

    def __init__(
        self,
        points: Points,
        coefficients: Mapping[str, Any],
        numbers: Mapping[str, Any],
        *,
        usual_radius: float,
        modes: Mapping[str, bool],
        place: RowsOfTest | None = None,
    ) -> None:
        self.points, self.numbers = points, numbers
        self._history, self._rows = RowsOfTest(History(points)) if place is None else place
        self.true: dict[str, Any] = {}  #: channels (n,) of the tyre before their readings
        self._usual_radius, self._modes = usual_radius, modes
        if np.any(points.mount < 0):
            coefficients = vars(turned_on_rim(SimpleNamespace(**coefficients), points.mount))
        self._coefficients = dict(coefficients)
        self._quantities: dict[str, Any] = {
            name: getattr(points, name) for name in ("alpha", "gamma", "Fz", "phi_t")
        } | {"pressure": points.p}
        driven = any(self._acts(error) for error in BEFORE if "kappa" in error.acts_on)
        if driven or np.any(points.kappa):  # free rolling needs fewer equations
            self._quantities["kappa"] = points.kappa
        self._conditions = tuple(name for name in self._quantities if name != "alpha")

    def readings(self, channels: tuple[str, ...]) -> list[Any]:
        """Readings (n,) of some channels, in their units."""
        read = (name for error in AFTER if self._acts(error) for name in error.reads)
        wanted = tuple(dict.fromkeys((*channels, *read)))
        self._pass(BEFORE)
        self.true = dict(zip(wanted, self._tyre(wanted, self._quantities["alpha"]), strict=True))
        self._quantities.update({name: self.true[name] for name in channels})
        self._pass(AFTER)
        return [self._quantities[channel] for channel in channels]

    def at_the_tyre(self) -> dict[str, np.ndarray]:
        """True sideslip, camber [rad], load [N], turn slip [1/m] and longitudinal slip of the tyre (n,)."""
        self._pass(BEFORE)
        names = [n for n in ("alpha", "gamma", "Fz", "phi_t", "kappa") if n in self._quantities]
        return {name: np.broadcast_to(plain(self._quantities[name]), len(self.points)) for name in names}

    def _pass(self, errors: Iterable[RigError]) -> None:
        """Apply rig errors to the quantities and coefficients that they change."""
        for error in errors:
            if error.formula is None or not self._acts(error):
                continue
            number = self.numbers[error.name]
            for name in error.acts_on:
                if name in CHANNELS and name not in self._quantities:  # channel not requested
                    continue
                owner = self._quantities if name in self._quantities else self._coefficients
                owner[name] = error.formula(number, owner[name], self)

    def _acts(self, error: RigError) -> bool:
        """Whether an error has an effect or is traced for derivatives."""
        number = self.numbers[error.name]
        return isinstance(number, Traced) or error.acts(number)

    @property
    def gamma(self) -> Any:
        """Camber (n,) [rad]."""
        return self._quantities["gamma"]

    @property
    def Fz(self) -> Any:
        """Load (n,) [N]."""
        return self._quantities["Fz"]

    @property
    def nominal_load(self) -> Any:
        """FNOMIN of the tyre [N]."""
        return self._coefficients["FNOMIN"]

    @cached_property
    def beyond_usual_path(self) -> np.ndarray:
        """Radius (n,) of each path less that of the usual one [m]."""
        return path_radii(self.points) - self._usual_radius

    def above(self, reference: str) -> Any:
        """What the temperature [K], speed [m/s] or pressure [kPa] exceeds its ``reference`` by (n,); 0 where it is unknown.

        A reference speed that is not stated is the most frequent one, a pressure NOMPRES.
        """
        stated, points = self.numbers[reference], self.points
        here = {T_REF: points.T, V_REF: points.V, P_REF: 1e-3 * points.p}[reference]
        if np.isnan(plain(stated)):
            stated = self._history.usual_speed if reference == V_REF else 1e-3 * self._coefficients["NOMPRES"]
        return np.where(np.isfinite(here), np.nan_to_num(here) - stated, 0.0)

    @cached_property
    def time(self) -> np.ndarray:
        """Time of every point (n,) [s]; 0 where it is not known."""
        return np.asarray(np.nan_to_num(self.points.t))

    @property
    def distance_km(self) -> np.ndarray:
        """Distance rolled (n,) [km]."""
        return self._history.distance_km[self._rows]

    @property
    def sense(self) -> np.ndarray:
        """Sense (n,) of the sweep: 1, -1, or 0 where the angle was held."""
        return self._history.sense[self._rows]

    @property
    def along_sweep(self) -> np.ndarray:
        """Position (n,) of every point in its sweep: 0 for the first, 1 for the last."""
        return self._history.along_sweep[self._rows]

    def lagged(self, alpha: np.ndarray, sigma: Any) -> Any:
        """Sideslip (n,) [rad] that lags behind the reading ``alpha`` by the relaxation length ``sigma`` [m]."""
        read = plain(alpha)
        follows, slope = lagged_setting(self.points.replace(alpha=read), plain(sigma))
        # Derivatives by the reading neglect the lag.
        return alpha + (follows - read) + slope * (sigma - plain(sigma))

    def turned_by_moment(self, alpha: Any, give: Any) -> Any:
        """Sideslip (n,) [rad] of a wheel on a steering with compliance ``give`` [rad/Nm], unloaded at ``alpha`` [rad]."""
        k, start = float(plain(give)), plain(alpha)
        held, conditions = np.broadcast_to(start, len(self.points)), self._without_history()
        if not k:  # only the derivative by the compliance itself
            return alpha + give * conditions._moment(held)
        for _ in range(12):  # Newton steps; three are usual
            moment, slope = conditions.moment_and_slope(held)
            move = (start + k * moment - held) / (1.0 - k * slope)
            held = held + move
            if np.max(np.abs(move)) < 1e-7:  # [rad]
                break
        if self._tape is None:
            return held
        # One Newton step with traced numbers keeps the solution and gives it the derivatives by the implicit function theorem.
        return held + (alpha + give * self._moment(held) - held) / (1.0 - k * slope)

    def held_in_play(self, alpha: Any, half_play: Any) -> Any:
        """Sideslip (n,) [rad] of a wheel that can turn freely by ``half_play`` [rad] to either side of ``alpha``."""
        conditions = self._without_history()
        middle = np.broadcast_to(plain(alpha), len(self.points))
        rest = settled(
            lambda rows: lambda angle: conditions._moment(angle, rows), middle, float(plain(half_play))
        )
        held = alpha - half_play * rest.side
        if not np.any(rest.floats):
            return held
        return np.where(
            rest.floats, self._following_root(np.where(rest.floats, rest.alpha, plain(held))), held
        )

    def moment_and_slope(self, alpha: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Aligning moment (n,) [Nm] of plain conditions at sideslip ``alpha`` (n,) [rad], and dMz/dalpha [Nm/rad]."""
        at = traced({"alpha": alpha})["alpha"]
        Mz = self._moment(at)
        return plain(Mz), gradient(Mz, [at])[..., 0]

    def _following_root(self, alpha: np.ndarray) -> Any:
        """Angles (n,) of zero moment, with derivatives by the traced numbers such that the moment stays zero."""
        tape = self._tape
        if tape is None:
            return alpha
        at = Traced(alpha, tape)
        Mz = self._moment(at)
        slope = gradient(Mz, [at])[..., 0]
        by_moment = np.divide(-1.0, slope, out=np.zeros_like(slope), where=slope != 0.0)
        return alpha + by_moment * (Mz - plain(Mz))

    def _moment(self, alpha: Any, rows: np.ndarray | None = None) -> Any:
        return self._tyre(("Mz",), alpha, rows)[0]

    def _tyre(self, wanted: tuple[str, ...], alpha: Any, rows: np.ndarray | None = None) -> list[Any]:
        """Some outputs of the tyre at its true sideslip angle ``alpha`` [rad], for all or some rows."""
        conditions = {**{name: self._quantities[name] for name in self._conditions}, "Vx": self.points.Vx}
        p = self._coefficients
        if rows is not None:
            conditions, p = ({k: _of_rows(v, rows) for k, v in each.items()} for each in (conditions, p))
        inputs = {**conditions, "alpha": alpha}
        return outputs_of(wanted, SimpleNamespace(**p), inputs, **self._modes)

    @property
    def _tape(self) -> list[Traced] | None:
        """The tape of the traced numbers; None without any."""
        known = (*self._coefficients.values(), *self.numbers.values())
        return next((value.tape for value in known if isinstance(value, Traced)), None)

    def _without_history(self) -> Chain:
        """A copy with plain values only."""
        other = object.__new__(Chain)
        vars(other).update(vars(self))
        for name in ("_coefficients", "_quantities"):
            setattr(other, name, {key: plain(value) for key, value in getattr(self, name).items()})
        return other


def _of_rows(value: Any, rows: np.ndarray) -> Any:
    return value if isinstance(value, float) or not np.ndim(value) else value[rows]

"""The tyre as a simulation uses it: a frozen record of values that is read from a file and can be called."""

from __future__ import annotations

import reprlib
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import FrozenInstanceError
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Never, Protocol, Self, TypeVar, Unpack, overload

from tir import calls
from tir.codegen.arrays import array_function
from tir.constants import NAMES_IN_A_SENTENCE
from tir.document import Document, encoded, read_document
from tir.equations.forces import Forces, State
from tir.errors import Problem, counted, some
from tir.exporting import exported
from tir.mode import SwitchOptions
from tir.parameters import BY_NAME, TABLE
from tir.properties import described
from tir.record import TyreRecord
from tir.targets import FITTYPS
from tir.temperature import at_temperature
from tir.writing import content, replace_file

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from tir.drawing import Figure

    Floats = NDArray[np.float64]


Single = TypeVar("Single", covariant=True)
Several = TypeVar("Several", covariant=True)


class Evaluation(Protocol[Single, Several]):
    """A call at an operating condition, for type checkers: floats give ``Single``, arrays ``Several``."""

    @overload
    def __call__(
        self,
        Fz: float,
        alpha: float = ...,
        gamma: float = ...,
        kappa: float = ...,
        phi_t: float | None = ...,
        Vx: float | None = ...,
        p: float | None = ...,
        **switches: Unpack[SwitchOptions],
    ) -> Single: ...

    @overload
    def __call__(
        self,
        Fz: ArrayLike,
        alpha: ArrayLike = ...,
        gamma: ArrayLike = ...,
        kappa: ArrayLike = ...,
        phi_t: ArrayLike | None = ...,
        Vx: ArrayLike | None = ...,
        p: ArrayLike | None = ...,
        **switches: Unpack[SwitchOptions],
    ) -> Several: ...


@overload
def evaluation(function: Callable[..., Forces[Any]]) -> Evaluation[Forces[float], Forces[Floats]]: ...


@overload
def evaluation(function: Callable[..., State[Any]]) -> Evaluation[State[float], State[Floats]]: ...


def evaluation(function: Callable[..., Any]) -> Any:
    """The method itself, with the types of an :class:`Evaluation`."""
    return function


class Tyre(TyreRecord):
    """``tyre(Fz, alpha, gamma, kappa, phi_t, Vx, p)`` gives forces and moments: MF 6.2 in steady state, N, rad, m/s, Pa, ISO-W.

    Create one with ``tir.read("front.tir")`` or :meth:`from_values`; they fill the fields.

    >>> tyre = Tyre.from_values({"FNOMIN": 1500.0, "UNLOADED_RADIUS": 0.3})
    >>> tyre(1500.0, alpha=0.02).Fy < 0
    True

    ``tyre["PKY1"]`` is a parameter in SI, ``tyre.replace(PKY1=-20.0)`` a copy with another value, ``tyre.state(...)`` the
    other results of the model, ``tyre.plot()`` a figure. ``tyre.write("other.tir")`` writes a file. Axes and signs:
    :mod:`tir.conventions`.
    """

    def __setattr__(self, name: str, value: Any) -> Never:
        """Raise FrozenInstanceError with the way to a tyre of another value: a tyre does not change."""
        raise FrozenInstanceError(_unchanged(name, value))

    def __delattr__(self, name: str) -> Never:
        raise FrozenInstanceError(_unchanged())

    def __setitem__(self, name: str, value: Any) -> Never:
        raise TypeError(_unchanged(name, value))

    def __delitem__(self, name: str) -> Never:
        raise TypeError(_unchanged())

    def __getattr__(self, name: str) -> Never:
        """Raise AttributeError; for a parameter, with the way to read it."""
        way = f"; its parameter is tyre[{name!r}]" if name in BY_NAME else ""
        raise AttributeError(f"a tyre has no attribute {name!r}{way}", name=name, obj=self)

    @cached_property
    def problems(self) -> tuple[Problem, ...]:
        """Everything unusual about the tyre, the gravest first: :func:`tir.check` for no program in particular."""
        from tir.checking import check

        return tuple(check(self))

    def __repr__(self) -> str:
        """The tyre in a few lines; ``tyre.values`` holds everything."""
        given = f"{len(self.present)} of {len(TABLE)} keys given"
        origins = Counter(text.split()[0].rstrip(":,") for text in self.status.values())
        version = self["FITTYP"]
        name = (
            f"of MF 6.{int(version) % 10}" if version in FITTYPS else f"with the unknown FITTYP {version:g}"
        )
        head = f"Tyre {name}, FNOMIN {self['FNOMIN']:g} N, "
        lines = [f"{head}UNLOADED_RADIUS {self['UNLOADED_RADIUS']:g} m; {given}"]
        if origins:
            lines.append("origins: " + some([f"{n} {word}" for word, n in origins.most_common()]))
        shown = [*self.measured.items()][:NAMES_IN_A_SENTENCE]
        lines += [f"{name} = {q.value:.6g} +- {q.u:.2g} {q.unit}" for name, q in shown]
        if self.on_reading:
            lines.append(f"{counted(len(self.on_reading), 'problem')} on reading, see tyre.problems")
        return "<" + "\n ".join(lines) + ">"

    def _repr_html_(self) -> str:
        """HTML for notebooks: the lines of the repr, and a small picture."""
        from tir.drawing import notebook

        return notebook(self)

    def at_temperature(self, T_degC: float) -> Self:
        """A copy that holds at another temperature of the tread, by the temperature terms of its file.

        Parameters
        ----------
        T_degC : temperature [degC]; outside the range in which the terms were measured, the copy is the tyre at the nearest end
            of it, and ``problems`` gets a warning

        Returns
        -------
        Tyre
            With other scaling factors: LMUY for friction, LKY for cornering stiffness, LKYC for camber stiffness. Its terms
            count from ``T_degC``, so that it can be taken to another temperature again.

        Raises
        ------
        TirError
            If the file has no such terms, or they leave no friction or stiffness.
        """
        return at_temperature(self, T_degC)

    @evaluation
    def __call__(
        self,
        Fz: Any,
        alpha: Any = 0.0,
        gamma: Any = 0.0,
        kappa: Any = 0.0,
        phi_t: Any = None,
        Vx: Any = None,
        p: Any = None,
        *,
        turn_slip: bool | None = None,
        star: bool = False,
        limits: bool = False,
    ) -> Forces[Any]:
        """Forces and moments in steady state.

        Parameters
        ----------
        Fz : load [N], scalar or array; all inputs broadcast
        alpha, gamma : sideslip and camber angle [rad]
        kappa : longitudinal slip [-]
        phi_t : turn slip -psi_dot/Vc [1/m]; -1/R on a left-hand path
        Vx : speed [m/s], default LONGVL; < 0 rolls backwards
        p : inflation pressure [Pa], default INFLPRES
        turn_slip : let spin act; default: if the units digit of USE_MODE is 5, or ``phi_t`` is given
        star : tan(alpha) and sin(gamma) as inputs of the formulae
        limits : hold the inputs to the file's ranges

        Returns
        -------
        Forces
            ``.Fx .Fy .Fz`` [N], ``.Mx .My .Mz`` [Nm] in the contact frame W: floats if every input is a single number,
            else arrays of the common shape.
        """
        if turn_slip is None:
            turn_slip = (phi_t is not None or self.turn_slip) and self.may_turn
        if phi_t is None:
            phi_t = 0.0
        if Vx is None:
            Vx = self.values["LONGVL"]
        if p is None:
            p = self.values["INFLPRES"]
        try:  # fast path for scalar calls: the function raises TypeError for anything but plain numbers
            run = self.prepared[turn_slip, star, limits]
            return tuple.__new__(Forces, run(Fz, alpha, gamma, kappa, phi_t, Vx, p))
        except (KeyError, TypeError, ArithmeticError, ValueError):
            pass
        switches = self.switches(phi_t, turn_slip=turn_slip, star=star, limits=limits)
        return calls.forces(self, (Fz, alpha, gamma, kappa, phi_t, Vx, p), switches)

    @evaluation
    def state(
        self,
        Fz: Any,
        alpha: Any = 0.0,
        gamma: Any = 0.0,
        kappa: Any = 0.0,
        phi_t: Any = None,
        Vx: Any = None,
        p: Any = None,
        *,
        turn_slip: bool | None = None,
        star: bool = False,
        limits: bool = False,
    ) -> State[Any]:
        """The other results at the condition: stiffnesses, radius, trail, spin; arguments as in a call.

        Returns
        -------
        State
            Floats or arrays as in a call; units with its fields.
        """
        inputs = (
            Fz,
            alpha,
            gamma,
            kappa,
            0.0 if phi_t is None else phi_t,
            self.values["LONGVL"] if Vx is None else Vx,
            self.values["INFLPRES"] if p is None else p,
        )
        switches = self.switches(phi_t, turn_slip=turn_slip, star=star, limits=limits)
        return calls.state(self, inputs, switches)

    def array_function(
        self,
        xp: Any,
        *,
        outputs: tuple[str, ...] = Forces._fields,
        tunable: Sequence[str] = (),
        **switches: Unpack[SwitchOptions],
    ) -> Callable[..., Any]:
        """The tyre as a function of the arrays of a library that differentiates: JAX, torch; also numpy and CuPy.

        ``f = tyre.array_function(jax.numpy)`` takes Fz, alpha, gamma, kappa, phi_t, Vx, p (ISO-W, SI, radians) in this order or
        by name, real scalars or arrays that broadcast; it refuses what a call of the tyre refuses. It goes through ``jit``,
        ``vmap`` and ``grad``. An input that is left out has the value that it has in a call, and a factor that of the file.
        Derivatives are finite everywhere: where one is infinite, it is 0.

        Parameters
        ----------
        xp : ``jax.numpy``, ``torch``, ``numpy`` or ``cupy``; JAX computes in double precision with ``jax_enable_x64`` only
        outputs : fields of Forces and State
        tunable : scaling factors, and ``T_degC`` if the file has temperature terms, that become further inputs, in this order
        switches : ``turn_slip``: whether spin acts, default: if the units digit of the file's USE_MODE is 5; ``star``,
            ``limits``: as in a call of the tyre

        Returns
        -------
        callable
            It returns Forces, or a named tuple of the outputs, as arrays.

        Raises
        ------
        TirError
            If ``xp`` is no array library, a value by which the equations divide is 0, a name cannot be turned, or an output is
            unknown.
        """
        made = exported(self, outputs, tunable, **switches)
        return array_function(made, outputs, xp)

    def plot(self, *, loads: Iterable[float] | None = None, turn_slip: bool | None = None) -> Figure:
        """Draw the forces: Fy and Mz over sideslip, Fx over longitudinal slip, Fy over camber.

        Parameters
        ----------
        loads : loads [N], one curve each; default: 0.5, 1 and 1.5 times FNOMIN
        turn_slip : as in a call of the tyre

        Returns
        -------
        matplotlib.figure.Figure
            Ranges are those of the file, up to usual values. ``figure.savefig("front.png")`` saves it.

        Raises
        ------
        TirError
            If matplotlib is not installed.
        """
        from tir.drawing import plot

        return plot(self, loads=loads, turn_slip=turn_slip)

    def text(self, target: str | None = None) -> str:
        """The property file as text.

        Parameters
        ----------
        target : name of a program, see :data:`tir.targets.TARGETS`; gives a complete new file for it. Without one, a tyre that
            was read gives the text of its file with only its changes, and any other tyre gives the file for MF-Tyre.

        Raises
        ------
        TirError
            If a value is not finite, or the target cannot use an MF 6.2 tyre.
        """
        return content(self, target)[0]

    def write(self, path: str | Path, target: str | None = None) -> None:
        """Write :meth:`text`; an existing file is replaced only when the new one is complete."""
        text, encoding = content(self, target)
        replace_file(Path(path), encoded(text, encoding))


def _unchanged(name: str = "", value: Any = None) -> str:
    """Why a value of a tyre cannot be changed, and what to do."""
    change = f"{name}={reprlib.repr(value)}" if name in BY_NAME else "..."
    return f"a tyre does not change: take a copy with another value, other = tyre.replace({change})"


def read(path: str | Path, **lacking: float | str) -> Tyre:
    """The tyre of a ``.tir`` file of MF 6.0, 6.1 or 6.2.

    Units other than SI are converted, and missing keys take the defaults of the table. ``Tyre.problems`` lists
    everything unusual with its line.

    Parameters
    ----------
    path : the file
    lacking : values [SI] of keys that the file lacks, such as ``UNLOADED_RADIUS=0.3``; a key of the file keeps its value

    Raises
    ------
    TirError
        If the file is not a property file, is truncated, contains an unreadable number, or has another MF version.
    """
    return interpret(read_document(path), lacking)


def interpret(document: Document, lacking: Mapping[str, float | str] = MappingProxyType({})) -> Tyre:
    """The tyre that a document describes, with values of keys that it lacks; raises as :func:`read`."""
    return described(Tyre, document, lacking)

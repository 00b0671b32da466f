"""The tyre as a simulation uses it: a frozen record of values that can be called."""

from __future__ import annotations

import reprlib
from collections import Counter
from collections.abc import Iterable, Iterator, KeysView, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from inspect import Parameter, Signature
from numbers import Complex, Number
from pathlib import Path
from types import MappingProxyType, SimpleNamespace
from typing import TYPE_CHECKING, Any, NamedTuple

from tir import calls
from tir.codegen.program import Switches
from tir.document import Document
from tir.equations.forces import Forces, State
from tir.errors import Problem, TirError, counted
from tir.mode import asks_for_turn_slip, warn_of_doubt
from tir.parameters import BY_NAME, TABLE
from tir.targets import FITTYPS

if TYPE_CHECKING:
    from tir.drawing import Figure

EMPTY: Mapping[str, Any] = MappingProxyType({})


class Quantity(NamedTuple):
    """A measured quantity, as the structured comments of a file state it."""

    value: float
    u: float  #: standard uncertainty, k = 1
    unit: str


@dataclass(frozen=True, repr=False)
class Tyre:
    """``tyre(Fz, alpha, gamma, kappa, phi_t, Vx, p)`` gives forces and moments: MF 6.2 in steady state, N, rad, m/s, Pa, ISO-W.

    Create one with ``tir.read("front.tir")`` or :meth:`from_values`; they fill the fields.

    >>> tyre = Tyre.from_values({"FNOMIN": 1500.0, "UNLOADED_RADIUS": 0.3})
    >>> tyre(1500.0, alpha=0.02).Fy < 0
    True

    ``tyre["PKY1"]`` is a parameter in SI, ``tyre.replace(PKY1=-20.0)`` a copy with another value, ``tyre.state(...)`` the
    other results of the model, ``tyre.plot()`` a figure. ``tyre.write("other.tir")`` writes a file. Axes and signs:
    :mod:`tir.conventions`.
    """

    values: Mapping[str, float | str]  #: every parameter of the table; defaults where the file has none
    present: frozenset[str] = frozenset()  #: names in the file, or given later
    status: Mapping[str, str] = field(default_factory=lambda: EMPTY)  #: name -> origin of the value
    measured: Mapping[str, Quantity] = field(default_factory=lambda: EMPTY)
    provenance: Mapping[str, str] = field(default_factory=lambda: EMPTY)
    extra: Mapping[str, str] = field(default_factory=lambda: EMPTY)  #: "SECTION.KEY" -> text of unknown keys
    problems: tuple[Problem, ...] = ()  #: problems found on reading
    document: Document | None = field(default=None, repr=False)  #: the file's text, which is kept on writing

    @classmethod
    def from_values(cls, given: Mapping[str, float | str]) -> Tyre:
        """A tyre from some values; the others take the defaults of the table.

        Raises
        ------
        TirError
            For a name that is not in MF 6.2, or a value of the wrong kind.
        """
        _usable(given)
        values = {row.name: row.default for row in TABLE} | dict(given)
        return cls(MappingProxyType(values), frozenset(given))

    def __getitem__(self, name: str) -> Any:
        try:
            return self.values[name]
        except KeyError:
            raise KeyError(f"MF 6.2 has no parameter {name}") from None

    def __contains__(self, name: object) -> bool:
        return name in self.values

    def __iter__(self) -> Iterator[str]:
        return iter(self.values)

    def keys(self) -> KeysView[str]:
        """Names of all parameters, including those with default values."""
        return self.values.keys()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Tyre) and dict(self.values) == dict(other.values)

    def __hash__(self) -> int:
        """Hash of the values that can be hashed; arrays, for example, are left out."""
        return hash(frozenset((k, v) for k, v in self.values.items() if isinstance(v, str | Complex)))

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
            lines.append("origins: " + ", ".join(f"{n} {word}" for word, n in origins.most_common(6)))
        lines += [f"{name} = {q.value:.6g} +- {q.u:.2g} {q.unit}" for name, q in [*self.measured.items()][:6]]
        if self.problems:
            lines.append(f"{counted(len(self.problems), 'problem')} on reading, see tyre.problems")
        return "<" + "\n ".join(lines) + ">"

    def _repr_html_(self) -> str:
        """HTML for notebooks: the lines of the repr, and a small picture."""
        from tir.drawing import notebook

        return notebook(self)

    def __reduce__(self) -> tuple[Any, ...]:
        """For pickling: all fields, without the functions prepared for calls."""
        plain = {key: dict(x) if isinstance(x, Mapping) else x for key, x in _fields(self).items()}
        return _rebuilt, (plain,)

    @cached_property
    def p(self) -> SimpleNamespace:
        """The parameters as attributes, for the equations."""
        return SimpleNamespace(**self.values)

    @cached_property
    def turn_slip(self) -> bool:
        """Whether the file asks for turn slip: the units digit of USE_MODE is 5."""
        return asks_for_turn_slip(self.values)

    def turns(self, turn_slip: bool | None, phi_t: Any) -> bool:
        """Whether spin acts in a call with these arguments; warns once if it does so unasked by doubtful coefficients."""
        if turn_slip is not None:
            return bool(turn_slip)
        return (phi_t is not None or self.turn_slip) and self._on

    @cached_property
    def _on(self) -> bool:
        """True, after one warning if the tyre's coefficients of turn slip are doubtful."""
        warn_of_doubt(self.values, self.present)
        return True

    @cached_property
    def prepared(self) -> dict[Any, Any]:
        """Cached functions for calls with floats and arrays; see :mod:`tir.calls`."""
        return {}

    def replace(self, **changes: float | str) -> Tyre:
        """A copy with some values changed; their status is dropped. Raises as :meth:`from_values`."""
        _usable(changes)
        status = {name: text for name, text in self.status.items() if name not in changes}
        return replace(
            self,
            values=MappingProxyType({**self.values, **changes}),
            present=self.present | changes.keys(),
            status=MappingProxyType(status),
        )

    def annotate(
        self,
        *,
        status: Mapping[str, str] = EMPTY,
        measured: Mapping[str, Quantity] = EMPTY,
        provenance: Mapping[str, str] = EMPTY,
    ) -> Tyre:
        """A copy with origins of values, measured quantities and provenance added."""
        return replace(
            self,
            status=MappingProxyType({**self.status, **status}),
            measured=MappingProxyType({**self.measured, **measured}),
            provenance=MappingProxyType({**self.provenance, **provenance}),
        )

    def at_temperature(self, T_degC: float) -> Tyre:
        """A copy that holds at another temperature of the tread, by the temperature terms of its file.

        Parameters
        ----------
        T_degC : temperature [degC]; outside the range of the terms, ``problems`` gets a warning

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
        from tir.temperature import at_temperature

        return at_temperature(self, T_degC)

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
    ) -> Forces:
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
            turn_slip = (phi_t is not None or self.turn_slip) and self._on
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
        switches = Switches(bool(turn_slip), bool(star), bool(limits))
        return calls.forces(self, (Fz, alpha, gamma, kappa, phi_t, Vx, p), switches)

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
    ) -> State:
        """The other results at the condition: stiffnesses, radius, trail, spin; arguments as in a call."""
        inputs = (
            Fz,
            alpha,
            gamma,
            kappa,
            0.0 if phi_t is None else phi_t,
            self.values["LONGVL"] if Vx is None else Vx,
            self.values["INFLPRES"] if p is None else p,
        )
        on = phi_t is not None or self.turn_slip if turn_slip is None else bool(turn_slip)
        return calls.state(self, inputs, Switches(on, bool(star), bool(limits)))

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

    def expand(self) -> Tyre:
        """A copy in which missing keys are given with the defaults of the table, marked as not measured.

        Without this, missing keys stay missing in a written file: MF-Tyre estimates the value of an
        absent key, which differs from the default of this table.
        """
        known = {"", "some", "motorcycle"} | (set() if self.values["FITTYP"] in (60, 61) else {"62"})
        missing = [row.name for row in TABLE if row.name not in self.present and row.files in known]
        status = dict.fromkeys(missing, "default, not measured")
        return replace(self, present=self.present | set(missing)).annotate(status=status)

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
        from tir.writing import content

        return content(self, target)[0]

    def write(self, path: str | Path, target: str | None = None) -> None:
        """Write :meth:`text`; an existing file is replaced only when the new one is complete."""
        from tir.writing import write

        write(self, path, target)


# help() prints this signature first: nobody creates a tyre by filling its fields.
SIGNATURE = Signature([Parameter(name, Parameter.POSITIONAL_OR_KEYWORD) for name in ("self", "values")])
Tyre.__init__.__signature__ = SIGNATURE  # type: ignore[attr-defined]


def _fields(tyre: Tyre) -> dict[str, Any]:
    return {f.name: getattr(tyre, f.name) for f in fields(tyre)}


def _rebuilt(plain: dict[str, Any]) -> Tyre:
    frozen: dict[str, Any] = {k: MappingProxyType(x) if isinstance(x, dict) else x for k, x in plain.items()}
    return Tyre(**frozen)


def _usable(given: Mapping[str, Any]) -> None:
    """Raise TirError for names that are not in MF 6.2 and for values of the wrong kind."""
    for name, value in given.items():
        if name not in BY_NAME:
            raise TirError(f"MF 6.2 has no parameter {name}", name=name)
        text = BY_NAME[name].kind == "text"
        if not (isinstance(value, str) if text else _calculable(value)):
            expected = "text" if text else "number"
            raise TirError(f"{name} is {reprlib.repr(value)}, but a {expected} was expected", name=name)


def _calculable(value: Any) -> bool:
    """Whether the equations can compute with it: a number, an array, a traced number, a symbol of another program."""
    if isinstance(value, Number):
        return isinstance(value, Complex)  # a Decimal does not combine with floats
    return hasattr(value, "__neg__") and hasattr(value, "__truediv__")

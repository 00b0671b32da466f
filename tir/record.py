"""The values of a tyre with their origins, and the text that they were read from: what the rest of ``tir`` works on.

:class:`tir.Tyre` is this record with the methods of a user: it can be called, drawn and written. Modules below it know the record
only, so that imports point in one direction.
"""

import reprlib
from collections.abc import Iterator, KeysView, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from inspect import Parameter, Signature
from numbers import Complex
from pathlib import Path
from types import MappingProxyType, SimpleNamespace
from typing import Any, Literal, NamedTuple, Self, Unpack, overload

import numpy as np

from tir.correction import Correction, read_correction
from tir.defaults import completed, followed
from tir.document import Document
from tir.equations.normalise import Switches
from tir.errors import Problem, TirError
from tir.inputs import records, switch_of, way_for
from tir.mode import SwitchOptions, asks_for_turn_slip, warn, warn_of_doubt
from tir.parameters import BY_NAME, TABLE

TextKey = Literal["TYRESIDE", "PROPERTY_FILE_FORMAT"]
"""Parameters of the table that are text; all others are numbers."""
DISTRUSTED = "NOT TO BE TRUSTED"
"""Key of the reasons in the provenance of a file that the build which wrote it does not trust."""
EMPTY: Mapping[str, Any] = MappingProxyType({})


class Quantity(NamedTuple):
    """A measured or fitted quantity, as the structured comments of a file state it."""

    value: float
    u: float  #: standard uncertainty, k = 1
    unit: str
    origin: str = "measured"  #: "measured" by itself, or "fitted": a result of the fitted model


@dataclass(frozen=True, repr=False)
class TyreRecord:
    """Every parameter of MF 6.2, and what is known about it."""

    values: Mapping[str, float | str]  #: every parameter of the table; given or by default
    present: frozenset[str] = frozenset()  #: names in the file, or given later
    status: Mapping[str, str] = field(default_factory=lambda: EMPTY)  #: name -> origin of the value
    measured: Mapping[str, Quantity] = field(default_factory=lambda: EMPTY)
    provenance: Mapping[str, str] = field(default_factory=lambda: EMPTY)
    extra: Mapping[str, str] = field(default_factory=lambda: EMPTY)  #: "SECTION.KEY" -> text of unknown keys
    on_reading: tuple[Problem, ...] = ()  #: what only the text of the file shows; all: ``Tyre.problems``
    document: Document | None = field(default=None, repr=False)  #: the file's text, which is kept on writing
    correction: Correction | None = None  #: model error, added by calls

    @classmethod
    def from_values(cls, given: Mapping[str, float | str]) -> Self:
        """A tyre from some values; the others take the defaults of the table, on the scale of the tyre (:mod:`tir.defaults`).

        Raises
        ------
        TirError
            For a name that is not in MF 6.2, or a value of the wrong kind.
        """
        _usable(given)
        return cls(MappingProxyType(completed(given)), frozenset(given))

    @overload
    def __getitem__(self, name: TextKey) -> str: ...  # type: ignore[overload-overlap]  # other names are those of numbers

    @overload
    def __getitem__(self, name: str) -> float: ...

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
        if not isinstance(other, TyreRecord):
            return False
        return self.correction == other.correction and dict(self.values) == dict(other.values)

    def __hash__(self) -> int:
        """Hash of the values that can be hashed; arrays, for example, are left out."""
        return hash(frozenset((k, v) for k, v in self.values.items() if isinstance(v, str | Complex)))

    def __reduce__(self) -> tuple[Any, ...]:
        """For pickling: all fields, without the functions prepared for calls."""
        plain = {key: dict(x) if isinstance(x, Mapping) else x for key, x in _fields(self).items()}
        return _rebuilt, (type(self), plain)

    @cached_property
    def p(self) -> SimpleNamespace:
        """The parameters as attributes, for the equations."""
        return SimpleNamespace(**self.values)

    @cached_property
    def turn_slip(self) -> bool:
        """Whether the file asks for turn slip: the units digit of USE_MODE is 5."""
        return asks_for_turn_slip(self.values)

    def switches(self, phi_t: Any = None, **options: Unpack[SwitchOptions]) -> Switches:
        """The switches of a call or an export; by default spin also acts in a call that gives ``phi_t``.

        Raises TirError for what is neither True nor False.
        """
        if options.get("turn_slip") is None:
            options["turn_slip"] = phi_t is not None or self.turn_slip
        return Switches(**{name: switch_of(name, x) for name, x in options.items()})

    @cached_property
    def may_turn(self) -> bool:
        """True, after one warning if the tyre's coefficients of turn slip are doubtful: in a call, spin acts by default."""
        warn_of_doubt(self.values, self.present)
        return True

    @cached_property
    def prepared(self) -> dict[Any, Any]:
        """Cached functions for calls with floats and arrays; see :mod:`tir.calls`."""
        return {}

    def replace(self, **changes: float | str) -> Self:
        """A copy with some values changed; their status is dropped, and defaults follow. Raises as :meth:`from_values`."""
        _usable(changes)
        status = {name: text for name, text in self.status.items() if name not in changes}
        return replace(
            self,
            values=MappingProxyType(followed(self.values, self.present, changes)),
            present=self.present | changes.keys(),
            status=MappingProxyType(status),
        )

    def annotate(
        self,
        *,
        status: Mapping[str, str] = EMPTY,
        measured: Mapping[str, Quantity] = EMPTY,
        provenance: Mapping[str, str] = EMPTY,
    ) -> Self:
        """A copy with origins of values, measured quantities and provenance added, which a written file states in comments.

        Parameters
        ----------
        status : origin of a value, by name of the parameter
        measured : measured or fitted quantities by name
        provenance : texts by key, such as the date
        """
        return replace(
            self,
            status=MappingProxyType({**self.status, **status}),
            measured=MappingProxyType({**self.measured, **measured}),
            provenance=MappingProxyType({**self.provenance, **provenance}),
        )

    def with_correction(self, path: str | Path) -> Self:
        """A copy whose calls add the model error, from the table that a build wrote next to the file.

        The table is linear in each input between its nodes. Beyond them the model error fades to zero: below the lowest load
        with the load, over unmeasured longitudinal slip with the combined slip. On another path than that of the
        measurement it is known in part, as in ``mffit predict``; with ``limits=True`` it fades with load and longitudinal slip
        alone. Nothing is added to a wheel in the air or rolling backwards. A changed value keeps the table. Property files,
        exports, ``state`` and ``tir.transient`` do not have it; the first two and the last warn of it.

        Parameters
        ----------
        path : ``<name>-correction.csv`` of the build

        Raises
        ------
        TirError
            If the table cannot be read, is incomplete, or belongs to a file of other coefficients.
        """
        return replace(self, correction=read_correction(path, self.values))

    def leave_correction(self, where: str) -> None:
        """Warn that something made of the tyre lacks the model error."""
        if self.correction is not None:
            warn(
                f"{where} holds the formula alone: what it misses does not travel with it; give the table of with_correction "
                "with it (docs/correction.md)"
            )

    def expand(self) -> Self:
        """A copy in which missing keys are given with the defaults of the table, marked as not measured.

        Without this, missing keys stay missing in a written file: MF-Tyre estimates the value of an
        absent key, which differs from the default of this table.
        """
        known = {"", "some", "motorcycle"} | (set() if self.values["FITTYP"] in (60, 61) else {"62"})
        missing = [row.name for row in TABLE if row.name not in self.present and row.files in known]
        status = dict.fromkeys(missing, "default, not measured")
        return replace(self, present=self.present | set(missing)).annotate(status=status)


# help() prints this signature first: nobody creates a tyre by filling its fields.
SIGNATURE = Signature([Parameter(name, Parameter.POSITIONAL_OR_KEYWORD) for name in ("self", "values")])
TyreRecord.__init__.__signature__ = SIGNATURE  # type: ignore[attr-defined]


def _fields(tyre: TyreRecord) -> dict[str, Any]:
    return {f.name: getattr(tyre, f.name) for f in fields(tyre)}


def _rebuilt(kind: type[TyreRecord], plain: dict[str, Any]) -> TyreRecord:
    frozen: dict[str, Any] = {k: MappingProxyType(x) if isinstance(x, dict) else x for k, x in plain.items()}
    return kind(**frozen)


def _usable(given: Mapping[str, Any]) -> None:
    """Raise TirError for names that are not in MF 6.2 and for values of the wrong kind."""
    for name, value in given.items():
        if name not in BY_NAME:
            raise TirError(f"MF 6.2 has no parameter {name}", name=name)
        text = BY_NAME[name].kind == "text"
        if not (isinstance(value, str) if text else _calculable(value)):
            expected = "text" if text else "number"
            way = f"; {way}" if (way := way_for(value)) else ""
            raise TirError(f"{name} is {reprlib.repr(value)}, but a {expected} was expected{way}", name=name)


def _calculable(value: Any) -> bool:
    """Whether the equations can compute with it: a number, an array, a traced number. A Decimal does not combine with floats."""
    return isinstance(value, Complex | np.ndarray) or records(value)

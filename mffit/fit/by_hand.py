"""Settings of ``[coefficients]`` in tyre.toml, as the fit uses them: held values, bounds, priors and starting values."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from mffit.config import Config
from mffit.errors import InputError
from mffit.fit.priors import Prior
from tir import Tyre
from tir.constants import MARGIN_INSIDE_RANGE
from tir.parameters import BY_NAME

Bounds = tuple[float, float]
HELD_BY_HAND = "held in [coefficients] of tyre.toml"
"""Reason given for a held coefficient that the data may well determine."""


@dataclass(frozen=True, slots=True)
class Hand:
    """Coefficients that the engineer set; empty by default."""

    held: Mapping[str, float] = field(default_factory=dict)  #: value of every held coefficient
    from_base: frozenset[str] = frozenset()  #: coefficients held at the base file's value
    bounded: Mapping[str, Bounds] = field(default_factory=dict)
    priors: Mapping[str, Prior] = field(default_factory=dict)
    starts: Mapping[str, float] = field(default_factory=dict)

    @property
    def names(self) -> tuple[str, ...]:
        """Every coefficient that was set."""
        return tuple(dict.fromkeys([*self.held, *self.bounded, *self.priors, *self.starts]))

    def bounds(self, name: str) -> Bounds:
        """The bounds of a coefficient: those set by hand, else those of the table."""
        return self.bounded.get(name, BY_NAME[name].bounds)

    def inside(self, name: str, value: float) -> float:
        """The value, moved slightly inside the bounds: a search that starts on a bound can stay there."""
        if name not in self.bounded:
            return BY_NAME[name].inside(value)
        lower, upper = self.bounded[name]
        margin = MARGIN_INSIDE_RANGE * (upper - lower) if math.isfinite(upper - lower) else 0.0
        return min(max(value, lower + margin), upper - margin)

    def within(self, values: Mapping[str, float]) -> dict[str, float]:
        """The values, clipped to the bounds set by hand."""
        found = {name: values[name] for name in self.bounded if name in values}
        return {
            **values,
            **{name: min(max(x, self.bounded[name][0]), self.bounded[name][1]) for name, x in found.items()},
        }

    def starting(self, values: Mapping[str, float]) -> dict[str, float]:
        """The starting values, replaced by those set by hand and clipped to the bounds set by hand."""
        return self.within({**values, **self.starts})

    def without_held(self, names: Any) -> list[str]:
        """The names without those of held coefficients."""
        return [name for name in names if name not in self.held]

    def mark(self, name: str) -> str:
        """What is set for a coefficient, in a few words; empty if nothing is."""
        if name in self.from_base:
            return "base value held by hand"
        if name in self.held:
            return "held by hand"
        kinds = {"bounds": self.bounded, "prior": self.priors, "start": self.starts}
        found = [word for word, of in kinds.items() if name in of]
        return f"{' and '.join(found)} by hand" if found else ""

    def said(self, name: str) -> str:
        """What is set for a coefficient, in words with numbers."""
        if name in self.held:
            return f"{name} held at {self.held[name]:.6g}{' (base file)' if name in self.from_base else ''}"
        parts = []
        if name in self.bounded:
            lower, upper = self.bounded[name]
            parts.append(f"between {lower:g} and {upper:g}")
        if name in self.priors:
            expected, u = self.priors[name]
            parts.append(f"{expected:g} +- {u:g} known beforehand")
        if name in self.starts:
            parts.append(f"started at {self.starts[name]:g}")
        return f"{name} {', '.join(parts)}"


NO_HAND = Hand()


def hand_of(config: Config, base: Tyre | None) -> Hand:
    """The settings of ``[coefficients]``; raises InputError if the base file lacks a value that is to come from it."""
    entries = config.coefficients
    held = {}
    for name, entry in entries.items():
        if entry.from_base:
            held[name] = _of_base(config, base, name)
        elif entry.held is not None:
            held[name] = entry.held
    return Hand(
        held=held,
        from_base=frozenset(name for name, entry in entries.items() if entry.from_base),
        bounded={name: entry.bounds(name) for name, entry in entries.items() if entry.bounded},
        priors={
            name: Prior(e.value, e.u)
            for name, e in entries.items()
            if e.value is not None and e.u is not None
        },
        starts={name: e.start for name, e in entries.items() if e.start is not None},
    )


def _of_base(config: Config, base: Tyre | None, name: str) -> float:
    key = f"coefficients.{name}"
    if base is None or name not in base.present:
        raise InputError(
            f'is "base", but the base file {config.tyre.base} does not state {name}; write its value',
            file=config.path,
            line=config.line_of(key),
            key=key,
        )
    return float(base[name])

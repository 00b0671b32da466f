"""The contract of an effect: one small declarative object, no code of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from mffit.rig_errors import number_of
from tir.parameters import BY_NAME


@dataclass(frozen=True, slots=True)
class Free:
    """One number that an effect sets free.

    ``spread`` is how large the effect usually is, 1 sigma around the current model: it scales the evidence, not the fit's
    answer. ``scan`` are changes to start from; an effect that is even in its number has no slope at zero and needs them
    finite.
    """

    name: str  #: coefficient of the file, rig error, or "turn_slip"
    spread: float
    scan: tuple[float, ...] = (0.0,)
    lower: float = float("-inf")  #: of the number itself; the limits of a coefficient hold anyway
    upper: float = float("inf")
    relative: bool = False  #: spread and scan are relative to the current value
    per_run: bool = False  #: one such number for every run, added to the fault of this name

    per_setup: bool = False  #: one such number for every set-up of the rig, if there are several

    def __post_init__(self) -> None:
        if self.name in BY_NAME:
            lower, upper = BY_NAME[self.name].bounds
            object.__setattr__(self, "lower", max(self.lower, lower))
            object.__setattr__(self, "upper", min(self.upper, upper))


@dataclass(frozen=True, slots=True)
class Effect:
    """A physical cause that can make simulation and measurement disagree."""

    id: str
    name: str
    kind: str  #: "tyre" | "rig" | "environment"
    physics: str  #: one sentence
    free: tuple[Free, ...]
    needs: tuple[str, ...] = ()  #: what the data must vary for the effect to be seen; see effects.needs
    remedy: str = ""  #: what to do at the rig; {value}, {opposite}: the first number in the rig's own axes, with its sign
    axes: tuple[str, ...] = ()  #: channels in whose axes that number counts
    prior: float = 0.0  #: log prior weight, decides ties only: rig causes before tyre causes
    runs_written_out: bool = False  #: its numbers are those of single runs

    @property
    def parameters(self) -> tuple[str, ...]:
        return tuple(free.name for free in self.free)

    @property
    def switches(self) -> bool:
        """Whether it switches the simulation's turn slip on."""
        return any(free.name == "turn_slip" for free in self.free)

    @property
    def in_file(self) -> bool:
        """Whether a property file can hold a number of it."""
        return self.switches or any(name in BY_NAME for name in self.parameters)

    @property
    def differs_by_run(self) -> bool:
        """Whether it frees numbers of single runs."""
        return any(free.per_run for free in self.free) or self.runs_written_out

    def written_out(self, files: Sequence[str], setups: Sequence[str]) -> Effect:
        """The same with the numbers of these runs written out, and the zeros of these set-ups if there are several."""
        zeros = setups if len(setups) > 1 else ("",)
        free = [
            replace(number, name=number_of(number.name, part), per_run=False, per_setup=False)
            for number in self.free
            for part in (files if number.per_run else zeros if number.per_setup else ("",))
        ]
        return replace(self, free=tuple(free), runs_written_out=self.differs_by_run)

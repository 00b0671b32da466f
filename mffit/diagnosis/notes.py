"""Remarks of a diagnosis in addition to its findings: facts and sentence of each."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from mffit.constants import ASSUMED_NOISE_SHARE
from mffit.diagnosis.validation import Gap, Validation
from mffit.effects import NEEDS, Effect
from mffit.quantities import CHANNELS
from mffit.rounding import to_uncertainty
from tir import Quantity
from tir.errors import begun, counted, listed
from tir.parameters import BY_NAME


class DiagnosisNote(Protocol):
    """A remark."""

    @property
    def sentence(self) -> str:
        """The remark in words."""


def short(value: float) -> str:
    """A number with three digits, without exponent for large numbers."""
    return f"{value:.3g}" if abs(value) < 999.5 else f"{value:.0f}"


def _with_u(value: float, u: float) -> str:
    return f"{to_uncertainty(value, u)} +- {to_uncertainty(u, u)}"


def held_out(before: Gap, after: Gap) -> str:
    """The rms errors of every channel on left-out sweeps, before and after, in words."""
    return listed(
        [
            f"the {CHANNELS[name].word} misses by {short(rmse)} {CHANNELS[name].unit} instead of {short(before.rms(name))} "
            f"{CHANNELS[name].unit}"
            for name, rmse in after.rmse.items()
            if math.isfinite(rmse)
        ]
    )


@dataclass(frozen=True, slots=True)
class OneSweep:
    """There is only one sweep, which cannot separate causes."""

    sentence: str = "One sweep cannot separate causes: add sweeps at another load, camber or direction."


@dataclass(frozen=True, slots=True)
class AnotherTyre:
    """The model has other dimensions or nominal conditions than the configuration."""

    differences: tuple[tuple[str, float, float], ...]
    """Key of the property file, its value in the model, its value in tyre.toml."""

    @property
    def sentence(self) -> str:
        said = []
        for name, model, stated in self.differences:
            row = BY_NAME[name]
            scale, unit = (1e-3, "kPa") if row.unit == "Pa" else (1.0, row.unit)
            said.append(
                f"{row.description} {scale * model:.4g} instead of {scale * stated:.4g} {unit} ({name})"
            )
        if all(BY_NAME[name].section != "DIMENSION" for name, *_ in self.differences):
            return (
                f"The model is for other nominal conditions than tyre.toml: {'; '.join(said)}. A file of this tyre may be; if it "
                "is of another tyre, give the model of this one."
            )
        return (
            f"The model seems to be of another tyre than tyre.toml: {'; '.join(said)}. Give the model of this tyre, or correct "
            "[tyre]."
        )


@dataclass(frozen=True, slots=True)
class TakenOff:
    """A rig error that was subtracted from the readings before the search for effects."""

    said: str

    @property
    def sentence(self) -> str:
        return f"{begun(self.said)}. The gap of all readings, uncorrected, has it; all else is without it."


@dataclass(frozen=True, slots=True)
class WithoutNoise:
    """The readings of some channels hardly scatter, like those of a simulation."""

    assumed: tuple[tuple[str, float], ...]  #: channel, and its assumed noise [N], [Nm]

    @property
    def sentence(self) -> str:
        sizes = " and ".join(f"{short(u)} {CHANNELS[name].unit} in {name}" for name, u in self.assumed)
        share = f"{100.0 * ASSUMED_NOISE_SHARE:g} %"
        return (
            f"The readings scatter far less than those of a rig, as if they came from a simulation: {sizes} are assumed as their "
            f"noise ({share} of the rms reading), so that uncertainties and confidences hold for a rig, not for numerical noise."
        )


@dataclass(frozen=True, slots=True)
class WithinPlay:
    """Points at which friction decides where within its play the wheel rests."""

    points: int

    @property
    def sentence(self) -> str:
        return (
            f"At {counted(self.points, 'point')} the aligning moment changes sign within the play of the steering axis: friction "
            "decides where the wheel rests, so they may be far off and have no weight."
        )


@dataclass(frozen=True, slots=True)
class OffsetsOrMemory:
    """Autocorrelated errors of a channel may be offsets of runs; these data cannot separate the two."""

    channel: str
    memory: float  #: correlation from one point to the next
    noise: float  #: typical noise [N] or [Nm]
    effects: tuple[Effect, ...]  #: offsets of runs that are as likely

    @property
    def sentence(self) -> str:
        return (
            f"The errors of {self.channel} ({short(self.noise)} {CHANNELS[self.channel].unit}) are correlated "
            f"({self.memory:.2f} between neighbours) and may as well be a {' or a '.join(e.name for e in self.effects)}: measure "
            "one condition again in several runs to separate them."
        )


@dataclass(frozen=True, slots=True)
class NotVisible:
    """Effects that the data cannot reveal."""

    needs: tuple[str, ...]  #: missing properties of the data, keys of ``mffit.effects.NEEDS``
    effects: tuple[Effect, ...]

    @property
    def sentence(self) -> str:
        lack = " and ".join(NEEDS[need] for need in self.needs)
        return f"Not visible in these data, which lack {lack}: {', '.join(e.name for e in self.effects)}."


@dataclass(frozen=True, slots=True)
class NoRepair:
    """The best explanation increases the gap on left-out sweeps, so no repair is written."""

    effects: tuple[str, ...]  #: their names
    validation: Validation

    @property
    def sentence(self) -> str:
        tried = listed(self.effects) if self.effects else "other coefficients"
        return (
            f"No repair is written: {tried} would fit these points better, but on left-out sweeps "
            f"{held_out(self.validation.gap_before, self.validation.gap_after)}."
        )


@dataclass(frozen=True, slots=True)
class FileKept:
    """The given property file is kept, because the corrected one predicts left-out sweeps worse."""

    effects: tuple[str, ...]  #: names of the effects of the tyre
    validation: Validation

    @property
    def sentence(self) -> str:
        check = self.validation
        return (
            f"The property file stays as given: with {listed(self.effects)} it would predict left-out sweeps worse, all channels "
            f"together and the errors of the rig taken out ({held_out(check.gap_given_file, check.gap_after)})."
        )


@dataclass(frozen=True, slots=True)
class ModelOfLastBuild:
    """The model is a file of the last build, but not the one with the plain name."""

    file: str

    @property
    def sentence(self) -> str:
        return f"The model is {self.file} of the last build."


@dataclass(frozen=True, slots=True)
class WithoutModelError:
    """The model error that the build of the model found is taken out of the readings."""

    missed: Mapping[str, float]  #: by channel, rms at the build's own readings [N], [Nm]

    @property
    def sentence(self) -> str:
        return (
            f"The model error that the build of the model found, {_sizes(self.missed)} rms, is taken out of the readings; the "
            "gap of all readings, uncorrected, has it."
        )


def _sizes(of: Mapping[str, float]) -> str:
    """A size of every channel, in words."""
    return listed([f"{short(x)} {CHANNELS[name].unit} in {CHANNELS[name].word}" for name, x in of.items()])


@dataclass(frozen=True, slots=True)
class LeftByFormula:
    """What remains may be what the formula cannot follow: the build of the model left as much, or it is declared that inexact."""

    left: Mapping[str, float]
    """By channel, rms [N], [Nm] beyond noise and known model error of the build, or by which inexact coefficients act."""
    declared: bool  #: whether it follows from ``model.u_coefficients``

    @property
    def sentence(self) -> str:
        why = (
            f"coefficients as inexact as [model] u_coefficients says change the readings by {_sizes(self.left)} rms"
            if self.declared
            else f"of its own readings the build of the model left {_sizes(self.left)} rms beyond what it explained"
        )
        return f"What remains is taken for what the formula cannot follow: {why}, and up to twice as much needs no cause."


@dataclass(frozen=True, slots=True)
class CountsAsExact:
    """Structure that needs a cause because the coefficients of the given file are declared exact, or nearly so."""

    inexactness: float  #: relative, of all coefficients, from which on it would need none
    declared: float  #: as declared

    @property
    def cure(self) -> str:
        """What to declare, as a clause."""
        return (
            f"if coefficients of the given file are inexact, state it: [model] u_coefficients = {self.inexactness:g} instead of "
            f"{self.declared:g} would explain as much"
        )

    @property
    def sentence(self) -> str:
        return f"{begun(self.cure)}."


@dataclass(frozen=True, slots=True)
class MoreThanBuild:
    """The model misses more than twice what its build left, even with the errors of the rig that are declared."""

    missed: Mapping[str, tuple[float, float]]
    """By channel that shows it, what the model misses beyond the noise and what its build left, rms [N], [Nm]."""

    @property
    def sentence(self) -> str:
        sizes = [
            f"the {CHANNELS[n].word} by {short(x)} {CHANNELS[n].unit} where its build left {short(left)}"
            for n, (x, left) in self.missed.items()
        ]
        return (
            f"With the declared errors of the rig the model misses {listed(sizes)}, both beyond the noise. Coefficients take "
            "it up within their uncertainty, as they would for another specimen or for a fault of the rig."
        )


@dataclass(frozen=True, slots=True)
class ModelFittedFirst:
    """Without a given model or an earlier build, a model was fitted to the same points."""

    turn_slip: bool  #: whether the simulation computes turn slip

    @property
    def sentence(self) -> str:
        return (
            "The model was first fitted to these points, because there was no earlier build for simulations with turn slip "
            f"{'on' if self.turn_slip else 'off'}."
        )


@dataclass(frozen=True, slots=True)
class DirectMethodRedone:
    """eps_gamma before and after the rig's faults were removed from the readings; None if it could not be measured."""

    causes: tuple[str, ...]  #: names of the faults
    before: Quantity | None
    after: Quantity | None

    @property
    def sentence(self) -> str:
        names, before, after = listed(self.causes), self.before, self.after
        if before is None or after is None:
            return f"eps_gamma cannot be measured {'with' if after else 'even without'} {names}."
        now = _with_u(after.value, after.u)
        if to_uncertainty(before.value, after.u) == to_uncertainty(after.value, after.u):
            return f"eps_gamma stays {now} (k = 1) with {names} corrected: the direct method allows for it."
        within = abs(after.value - before.value) < after.u
        told = ", a change within its uncertainty" if within else ""
        return f"eps_gamma was {_with_u(before.value, before.u)} with {names}; corrected it is {now} (k = 1){told}."

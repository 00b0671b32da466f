"""Sentences about the influences that a fit models or not, and about the file at one temperature."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mffit.constants import NAMED_IN_SENTENCE
from mffit.fit.agreement import Agreement
from mffit.fit.influences.between_runs import BetweenRuns
from mffit.fit.influences.nuisance_choice import Gaps, Verdict
from mffit.fit.influences.nuisances import TEMPERATURE
from mffit.fit.influences.temperature import AtTemperature
from mffit.fit.influences.with_nuisances import NuisanceFit
from mffit.fit.written.files import name_at_temperature
from mffit.quantities import CHANNELS
from mffit.rig_errors import shown, unit_of, words_of
from mffit.rounding import ascii_only, number, rounded
from tir.errors import listed

SCALED = {
    "k_T_grip_per_K": "friction",
    "k_T_grip_per_K2": "its curvature",
    "k_T_stiffness_per_K": "cornering stiffness",
    "k_T_camber_per_K": "camber stiffness",
    "k_T_drive_grip_per_K": "longitudinal friction",
    "k_T_slip_stiffness_per_K": "slip stiffness",
    "run_grip": "friction",
    "run_stiffness": "cornering stiffness",
}
"""What a temperature term or a number of a run scales, in words."""


def nuisance_sentences(
    name: str,
    found: NuisanceFit,
    temperature: AtTemperature | None,
    runs: BetweenRuns | None,
    plain: Mapping[str, Agreement],
) -> list[str]:
    """Which file is for whom, what was modelled and what it did to the coefficients, the most important first.

    ``name`` is that of the tyre; ``plain`` the agreement of the plain file with the points, by channel.
    """
    out = []
    if temperature is not None:
        out += [_files_sentence(name, temperature, plain), _moved_sentence(name, temperature)]
    for verdict in found.choice.verdicts:
        if verdict.modelled and verdict.nuisance.key != TEMPERATURE:
            out.append(
                _runs_sentence(name, verdict, runs)
                if runs is not None and verdict.nuisance.per_run
                else _modelled_sentence(verdict, found.full.rig)
            )
    return out


def unmodelled_sentences(found: NuisanceFit) -> list[str]:
    """What was not modelled, and why."""
    out = []
    for verdict in found.choice.verdicts:
        if not verdict.modelled and _worth_telling(verdict, found):
            said = f"The {verdict.nuisance.name} is not modelled: {verdict.reason}"
            out.append(said + (f" ({_compared(verdict)})." if verdict.beside else "."))
    return out


def _files_sentence(name: str, found: AtTemperature, plain: Mapping[str, Agreement]) -> str:
    special, (low, high) = name_at_temperature(name), found.T_range
    each = [
        f"{SCALED[term]} {_percent(*value)} per {unit_of(term)[2:]}" for term, value in found.terms.items()
    ]
    terms = listed(each)
    warm = f"{found.T_ref:g}"
    return (
        f"{name}.tir is for simulations that do not know the temperature of the tyre: it leaves {_gaps(_rms(plain))} rms"
        f"{_of_left_out(found.left_out_plain)}. {special} is for simulations that do: it holds at {warm} degC and leaves "
        f"{_gaps(_rms(found.channels))}{_of_left_out(found.left_out)} with its temperature terms, which were measured from "
        f"{low:.0f} to {high:.0f} degC: {terms}. Without them it leaves {_gaps(_rms(found.alone))}, so take it to the "
        f"temperature of the simulation first, in Python by tyre.at_temperature({high:.0f})."
    )


def _moved_sentence(name: str, found: AtTemperature) -> str:
    if not found.moved:
        return f"The coefficients of {name}.tir do not depend on the warming beyond their uncertainty."
    named = list(found.moved.items())[:NAMED_IN_SENTENCE]
    changes = ", ".join(
        f"{name} {rounded(there, u)[0]} instead of {rounded(here, u)[0]} +- {rounded(here, u)[1]}"
        for name, (there, here, u) in named
    )
    more = f" and {len(found.moved) - len(named)} more" if len(found.moved) > len(named) else ""
    return ascii_only(
        f"The coefficients of {name}.tir contain the warming along these sweeps: {changes} at {found.T_ref:g} degC{more}. "
        "Their standard uncertainties include this difference."
    )


def _modelled_sentence(verdict: Verdict, rig: Mapping[str, tuple[float, float]]) -> str:
    numbers = ", ".join(f"{words_of(name)} {_stated(name, *rig[name])}" for name in verdict.nuisance.numbers)
    return ascii_only(
        f"The {verdict.nuisance.name} is modelled, {numbers}: {verdict.reason} ({_compared(verdict)}). The files are without it."
    )


def _runs_sentence(name: str, verdict: Verdict, found: BetweenRuns) -> str:
    sizes = " and ".join(f"{SCALED[number]} by {_percent(*value)}" for number, value in found.scatter.items())
    return (
        f"The {verdict.nuisance.name} is modelled: between {len(found.runs)} sweeps {sizes} (standard deviation); "
        f"{verdict.reason} ({_compared(verdict)}). {name}.tir holds for the mean of the runs and leaves "
        f"{_gaps(_rms(found.alone))} rms without their own numbers; standard uncertainties contain this scatter."
    )


def _worth_telling(verdict: Verdict, found: NuisanceFit) -> bool:
    """Whether it was tried, or the temperature was measured but could not be used."""
    T = found.full.problem.points.T
    moves = bool(np.any(np.isfinite(T))) and float(np.nanmax(T) - np.nanmin(T)) > 0.0
    return bool(verdict.beside) or (verdict.nuisance.id == TEMPERATURE and moves)


def _compared(verdict: Verdict) -> str:
    return f"errors of what is left out: {_gaps(verdict.beside)} with it, {_gaps(verdict.without)} without"


def _stated(name: str, value: float, u: float) -> str:
    value, u, unit = shown(name, value, u)
    return f"{' +- '.join(rounded(value, u))} {unit}".rstrip()


def _percent(value: float, u: float) -> str:
    text, spread = rounded(100.0 * value, 100.0 * u)
    return ascii_only(f"{text} +- {spread} %")


def _of_left_out(gaps: Gaps) -> str:
    return f" ({_gaps(gaps)} of left-out sweeps)" if gaps else ""


def _rms(channels: Mapping[str, Agreement]) -> dict[str, float]:
    return {name: found.rmse for name, found in channels.items() if found.n}


def _gaps(gaps: Gaps) -> str:
    """ "62 N and 4.1 Nm"; channels that share a unit are named, "80 N in Fx, 47 N in Fy and 12 Nm in Mz"."""
    units = [CHANNELS[name].unit for name in gaps]
    unclear = len(set(units)) < len(units)
    return listed(
        [
            f"{ascii_only(number(gap, digits=3))} {unit}" + (f" in {name}" if unclear else "")
            for (name, gap), unit in zip(gaps.items(), units, strict=True)
        ]
    )

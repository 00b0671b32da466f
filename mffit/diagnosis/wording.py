"""The sentences about a diagnosis, for page, terminal and ``diagnosis.json``: written here and nowhere else."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, assert_never

from mffit.diagnosis.noise import Noise, Origin
from mffit.diagnosis.notes import (
    DirectMethodRedone,
    HardlyThisTyre,
    ModelFittedFirst,
    ModelOfLastBuild,
    NoRepair,
    Note,
    NotVisible,
    OneSweep,
)
from mffit.diagnosis.ties import TELLING, Run, Separation
from mffit.effects import NEEDS
from mffit.quantities import CHANNELS, CONDITIONS
from mffit.suspicion import Misread, about

if TYPE_CHECKING:
    from mffit.diagnosis.result import Diagnosis, Found
    from mffit.diagnosis.unknown import Bump
    from mffit.diagnosis.validate import Validation
    from mffit.suspicion import Outlier

RUNS = {
    Run.BACKWARD: "a backward sideslip sweep at {load:.0f} N",
    Run.TURNED_ON_RIM: "a sideslip sweep at {load:.0f} N with the tyre turned on its rim",
    Run.OTHER_LOAD: "a sideslip sweep at {load:.0f} N",
    Run.CAMBER: "a camber sweep to 40 deg at {load:.0f} N",
    Run.BACKWARD_CAMBER: "a backward camber sweep at {load:.0f} N",
    Run.LEANED: "a sideslip sweep at 20 deg camber and {load:.0f} N",
    Run.LOW_PRESSURE: "a sideslip sweep at 0.8 of the pressure and {load:.0f} N",
    Run.FAST: "a sideslip sweep at twice the speed and {load:.0f} N",
    Run.WARM: "a repeated sideslip sweep at {load:.0f} N with the tyre 20 K warmer",
    Run.LATE: "a repeated sideslip sweep at {load:.0f} N at the end of the test",
    Run.STRAIGHT: "a sideslip sweep at {load:.0f} N on a straight path",
    Run.WIDE: "a sideslip sweep at {load:.0f} N on a path of twice the radius",
    Run.STRAIGHT_CAMBER: "a camber sweep at {load:.0f} N on a straight path",
}
LIKELY = 0.5
"""Confidence below which the answer is not stated as one."""
ORIGINS = {
    Origin.STATED: "stated uncertainties",
    Origin.SCATTER: "scatter between neighbouring points",
}


def headline(diagnosis: Diagnosis) -> str:
    """The whole answer in one sentence, and one more before it if a sweep was written down wrongly."""
    wrong = next((remark for remark in diagnosis.notes if isinstance(remark, Misread)), None)
    answer = _answer(diagnosis)
    return answer if wrong is None else f"{wrong.file} looks like {wrong.looks} and was left out. {answer}"


def _answer(diagnosis: Diagnosis) -> str:
    before, after, noise = diagnosis.gap_before, diagnosis.gap_after, diagnosis.noise
    bump = diagnosis.bump
    if not diagnosis.effects:
        numbers = f"side force misses by {before.Fy_rmse_N:.1f} N rms, the noise is {noise.Fy:.1f} N"
        if not diagnosis.unexplained:
            return f"No effect is missing that these data could show: {numbers}."
        if diagnosis.smooth is not None:
            return f"There is smooth structure that no effect of the library describes: {numbers}."
        if bump is None:
            return f"The model misses the data by more than their noise, and no effect of the library explains it: {numbers}."
        return (
            f"There is structure that no effect of the library describes: {bump.channel} is off by {bump.amplitude:.3g} "
            f"{CHANNELS[bump.channel].unit} around {_around(bump)}."
        )
    named, one = " and ".join(map(_named, diagnosis.effects)), len(diagnosis.effects) == 1
    said = f"The missing {'effect is' if one else 'effects are'} {named}"
    if min(_of_its_tie(found, diagnosis.alternatives) for found in diagnosis.effects) < LIKELY:
        said = f"The nearest explanation, not a sure one, is {named}"
    sentence = (
        f"{said}: with {'it' if one else 'them'} the side force misses by "
        f"{after.Fy_rmse_N:.1f} N rms instead of {before.Fy_rmse_N:.1f} N (noise {noise.Fy:.1f} N)"
    )
    if not diagnosis.unexplained:
        return f"{sentence}."
    rest = (
        f"{bump.channel} stays unexplained around {_around(bump)}" if bump else "the rest stays unexplained"
    )
    return f"{sentence}; {rest}."


def _of_its_tie(found: Found, alternatives: Mapping[str, float]) -> float:
    """Confidence that it is this effect or one of those it is tied with."""
    return found.confidence + sum(alternatives.get(other, 0.0) for other in found.tied_with)


def note(remark: Note) -> str:
    """A note as a sentence."""
    match remark:
        case OneSweep():
            return "One sweep cannot tell causes apart: add sweeps at another load, camber or direction."
        case Misread():
            return about(remark)
        case NotVisible(needs, effects):
            lack = " and ".join(NEEDS[need] for need in needs)
            return f"Not visible in these data, which lack {lack}: {', '.join(effects)}."
        case HardlyThisTyre(misfit, channel):
            return (
                f"Cannot tell: the model misses even the {CHANNELS[channel].word} by {misfit:.0f} times its noise even with the "
                "best effects added, so it is hardly a model of this tyre; fit it first (mffit build)."
            )
        case NoRepair(effects, validation):
            before, after = validation.gap_before, validation.gap_after
            tried = " and ".join(effects) or "other coefficients"
            return (
                f"No repair is written: {tried} would fit these points better, but on sweeps that were left out the side "
                f"force misses by {after.Fy_rmse_N:.3g} N instead of {before.Fy_rmse_N:.3g} N and the moment by "
                f"{after.Mz_rmse_Nm:.3g} instead of {before.Mz_rmse_Nm:.3g} Nm."
            )
        case ModelOfLastBuild(file):
            return f"The model is {file} of the last build."
        case ModelFittedFirst(turn_slip):
            return (
                "The model was fitted to these points first, as there was no earlier build for simulations with turn slip "
                f"{'on' if turn_slip else 'off'}."
            )
        case DirectMethodRedone():
            return _redone(remark)
        case _:
            assert_never(remark)


def _redone(found: DirectMethodRedone) -> str:
    """What the rig's faults do to the direct method."""
    names, before, after = " and ".join(found.causes), found.before, found.after
    if before is None or after is None:
        return f"eps_gamma cannot be measured {'with' if after else 'even without'} {names}."
    corrected = f"{after.value:.2f} +- {after.u:.2f}"
    if abs(after.value - before.value) < 0.5 * after.u:
        return f"eps_gamma stays {corrected} (k = 1) with {names} corrected: the direct method allows for it."
    return f"eps_gamma was {before.value:.2f} +- {before.u:.2f} with {names}; corrected it is {corrected} (k = 1)."


def source(noise: Noise) -> str:
    """Where the uncertainties of the readings come from; empty if Fy was not measured."""
    return "" if noise.origin is None else ORIGINS[noise.origin]


def notes(diagnosis: Diagnosis) -> list[str]:
    """All notes as sentences."""
    return [note(remark) for remark in diagnosis.notes]


def separation(found: Separation | None) -> str:
    """Which run would tell two explanations apart; empty if there is nothing to tell apart."""
    if found is None:
        return ""
    run = RUNS[found.run].format(load=found.load)
    if found.chi2 < TELLING:
        return (
            f"none of the usual runs separates them at this size; the best would be {run} "
            f"(expected chi2 {found.chi2:.1f})"
        )
    return f"{run} (expected chi2 {found.chi2:.0f})"


def method(validation: Validation) -> str:
    """How it was validated."""
    return f"{validation.folds} groups of whole sweeps left out in turn"


def scatter(noise: Noise) -> list[str]:
    """The noise that was found beside the one that was stated, a sentence per channel."""
    out = []
    for name, found in (("Fy", noise.Fy), ("Mz", noise.Mz)):
        if not math.isfinite(found):
            continue
        part, unit = noise.scatter[name], CHANNELS[name].unit
        sentence = (
            f"{name} scatters by {found:.3g} {unit}, stated were {noise.typically_stated(name):.3g} {unit}"
        )
        more = []
        if part.growth:
            more.append(f"it grows by {100.0 * part.growth:.2g} % of the reading")
        if part.memory:
            more.append(f"errors along a sweep are alike ({part.memory:.2f} from point to point)")
        if math.isfinite(part.tails):
            more.append("wild readings are more frequent than normal noise has them and lost their weight")
        out.append("; ".join([sentence, *more]) + ".")
    return out


def outlier(found: Outlier) -> str:
    """One wild reading."""
    place = f"{found.sweep}, line {found.line}" if found.line else found.sweep
    size = f"{found.measured - found.expected:.3g} {CHANNELS[found.channel].unit}"
    return f"{place}: {found.channel} off by {size}, {found.ratio:.0f} times its noise"


TO_DO = {
    "tyre": "nothing at the rig: the corrected property file has it",
    "environment": "keep it constant, or take it off the readings as the corrected points do; a property file cannot hold it",
}
"""What to do about effects that are none of the rig's."""


def remedy(found: Found, signs: Mapping[str, float]) -> str:
    """What to do about an effect; numbers in the rig's own axes."""
    effect = found.effect
    if effect.switches:
        return "switch the simulation's turn slip on"
    if not effect.remedy:
        return TO_DO.get(effect.kind, "")
    value, _ = found.parameters[effect.free[0].name]
    value *= math.prod(signs[axis] for axis in effect.axes)
    plus = "+" if effect.axes else ""
    return effect.remedy.format(value=f"{value:{plus}.3g}", opposite=f"{-value:{plus}.3g}")


def status(effect: str, before: float, stderr: float) -> str:
    """The reason of a coefficient, in the comments of the corrected property file."""
    return f"diagnosed, {effect}, was {before:.6g}, +- {stderr:.2g}"


def adjusted(before: float, stderr: float) -> str:
    """The reason of an inexact coefficient that was estimated beside the effects."""
    return f"adjusted with the diagnosis, was {before:.6g}, +- {stderr:.2g}"


def place(region: Mapping[str, tuple[float, float]]) -> list[str]:
    """The ranges of a region as an engineer says them; none if it is the whole programme."""
    return [_range(name, *limits) for name, limits in region.items()]


def _range(name: str, low: float, high: float) -> str:
    if name == "direction":
        return "backward runs" if high < 0 else "forward runs" if low > 0 else "both directions"
    word, _, unit = CONDITIONS[name]
    if low == high:
        return f"{word} {_short(low)} {unit}"
    return f"{word} {_short(low)} to {_short(high)} {unit}"


def _short(value: float) -> str:
    """Three digits, but never a power of ten."""
    return f"{value:.3g}" if abs(value) < 999.5 else f"{value:.0f}"


def _around(bump: Bump) -> str:
    return " and ".join(place(bump.region))


def _named(found: Found) -> str:
    if not found.tied_with:
        return found.effect.name
    return f"{found.effect.name} (or {' or '.join(found.tied_with)}, not separable here)"

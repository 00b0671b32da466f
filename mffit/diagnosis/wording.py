"""The sentences about a diagnosis, for page, terminal and ``diagnosis.json``."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise

from mffit.as_json import Json, document
from mffit.constants import MISFIT_AT_NOISE, MOST, NAMED_IN_SENTENCE, TWO_SIGMA
from mffit.diagnosis import constants, priors
from mffit.diagnosis.bumps import Bump
from mffit.diagnosis.noise import MemorySpan, Noise, Origin
from mffit.diagnosis.notes import AnotherTyre, CountsAsExact, MoreThanBuild, NoRepair, TakenOff, short
from mffit.diagnosis.odd_level import OddLevel
from mffit.diagnosis.remains import BestEffect
from mffit.diagnosis.rest import Answer, Rest, RestKind
from mffit.diagnosis.result import AcceptedEffect, Diagnosis
from mffit.diagnosis.ties import Separation
from mffit.diagnosis.validation import Validation
from mffit.effects import NAMES, Effect
from mffit.quantities import CHANNELS, CONDITIONS, column
from mffit.rig_errors import OF_RUN, error_of, shown, unit_of, words_of
from mffit.rounding import per_cent, to_uncertainty
from mffit.suspicion import Misread, Outlier
from tir.errors import begun, listed

TO_DO = {
    "tyre": "use {file}",
    "environment": "keep it constant, or use the corrected points, from which it is removed; a property file cannot contain it",
}
"""By kind of effect, what to do about effects of tyre and environment."""

NOT_REPAIRED = {
    "tyre": "{file} is as given; --repair-all corrects it",
    "environment": "keep it constant; the readings are as measured, and --repair-all corrects them",
}
"""By kind of effect, what to do about effects that are only suspected."""

THROUGH = {MemorySpan.SWEEP: "a sweep", MemorySpan.FILE: "a file", MemorySpan.PROGRAMME: "the programme"}
"""The chains of an autocorrelation in words."""


def headline(diagnosis: Diagnosis) -> str:
    """The answer in one sentence, preceded by a warning about another tyre and sentences on corrected or left-out readings."""
    other = next((remark for remark in diagnosis.notes if isinstance(remark, AnotherTyre)), None)
    warned = "" if other is None else f"Warning: {other.sentence} "
    wrong = next((remark for remark in diagnosis.notes if isinstance(remark, Misread)), None)
    left_out = "" if wrong is None else f"{wrong.file} looks like {wrong.looks} and was left out. "
    taken_off = "".join(f"{begun(said)}. " for said in _taken_off(diagnosis))
    answer = f"{verdict(diagnosis)}: {_misfit(diagnosis)}.{_suspicions(diagnosis)}"
    return warned + taken_off + left_out + answer


def verdict(diagnosis: Diagnosis) -> str:
    """The answer without numbers and without full stop."""
    effects = _explained_by(diagnosis)
    names, odd = listed([_with_ties(found) for found in effects]), _odd(diagnosis)
    match diagnosis.answer:
        case Answer.NOTHING:
            return "Nothing is missing as far as these data can show"
        case Answer.FOUND:
            return f"The missing {'effect is' if len(effects) == 1 else 'effects are'} {names}"
        case Answer.UNDECIDED if diagnosis.repaired:
            return f"The missing {'effect is' if len(effects) == 1 else 'effects are'} {names}"
        case Answer.UNDECIDED if effects:
            return f"These data cannot tell what is missing; the best explanation is {names}"
        case Answer.UNDECIDED if odd is not None:
            return f"{begun(odd.said)}, and no effect stands out"
        case Answer.UNDECIDED if any(isinstance(one, MoreThanBuild) for one in diagnosis.notes):
            return "Something may be missing: the model misses more than its build left, and no effect stands out"
        case Answer.UNDECIDED:
            likeliest, confidence = diagnosis.ranked_alternatives()[0]
            refused = any(isinstance(remark, NoRepair) for remark in diagnosis.notes)
            but = "left-out sweeps do not confirm it" if refused else "these data do not establish it"
            what = f"{NAMES.get(likeliest, likeliest)} is suspected (probability {per_cent(confidence)})"
            return f"Nothing is corrected; {what}, but {but}"
        case Answer.UNKNOWN if odd is not None:
            beside = f" in addition to {names}" if effects else ""
            return f"{begun(odd.said)}, which no effect of the library describes{beside}"
        case Answer.UNKNOWN:
            if diagnosis.suspected:
                return f"More is missing than effects of the library describe{f', beside {names}' if effects else ''}"
            also = f" in addition to {names}" if effects else ""
            return f"Something is missing that no effect of the library describes{also}"


def _odd(diagnosis: Diagnosis) -> OddLevel | None:
    """The runs that read a share more or less than simulated, if there are such."""
    return next((remark for remark in diagnosis.notes if isinstance(remark, OddLevel)), None)


def _explained_by(diagnosis: Diagnosis) -> tuple[AcceptedEffect, ...]:
    """The effects of which the answer speaks: the repaired ones, or the best explanation where none is certain enough."""
    undecided = diagnosis.effects if diagnosis.answer is Answer.UNDECIDED else ()
    return tuple(diagnosis.repaired or undecided)


def reasons(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Why the corrected model is not to be trusted, without full stop; empty if it is.

    The build states what a formula misses of the points of its own fit; that is not a reason.
    """
    if diagnosis.seen or not diagnosis.unexplained:
        return ()
    for remark in diagnosis.notes:
        if isinstance(remark, AnotherTyre):
            return (remark.sentence.rstrip("."),)
    first = diagnosis.rest[0]
    sweep = f", most in {first.sweep}" if first.sweep else ""
    if first.kind is RestKind.SCATTER:
        return (f"{_remains(first, diagnosis)}; {_cure(diagnosis)}",)
    missed = ", and ".join(
        f"{name} by {short(size)} {unit} where the noise is {short(noise)} {unit}"
        for name, unit, noise in _measured(diagnosis.noise)
        if (size := diagnosis.gap_after.rms(name)) > MISFIT_AT_NOISE * noise or name == first.channel
    )
    return (
        f"no effect of the library explains what remains: the model misses {missed}{sweep}; {_cure(diagnosis)}",
    )


def _cure(diagnosis: Diagnosis) -> str:
    """What to do about an unknown cause."""
    first, odd = diagnosis.rest[0], _odd(diagnosis)
    if first.sweep:
        return f"check {first.sweep} or repeat it"
    if odd is not None:
        return odd.cure
    if first.kind is RestKind.LOCAL and diagnosis.bump is not None:
        return f"repeat the points around {_around(diagnosis.bump)}"
    if first.kind is RestKind.SCATTER:
        return f"if all readings of the rig scatter so, state u_{column(first.channel)} as large as that"
    exact = [note.cure for note in diagnosis.notes if isinstance(note, CountsAsExact)]
    return "; ".join(
        ["no single sweep is at fault; give the model of this tyre, or fit it first (mffit build)", *exact]
    )


def advice(diagnosis: Diagnosis) -> list[str]:
    """What to do, in short sentences: which property file to use, what to mend at the rig, what to keep constant."""

    def names(*kinds: str, in_file: bool = False) -> str:
        found = [one.effect for one in diagnosis.repaired if one.effect.in_file or not in_file]
        return listed([effect.name for effect in found if effect.kind in kinds])

    file, rig, beside = diagnosis.file_said, names("rig"), names("environment")
    if diagnosis.delivers:
        holds = names("tyre", in_file=True)
        doubted = f"{file} contains {holds}, and is not to be trusted."
        found = [doubted if reasons(diagnosis) else f"Use {file}: it contains {holds}."]
    elif reasons(diagnosis):
        found = [f"Nothing in {file} is corrected."]
    else:
        found = [f"Keep {file}: nothing in it is corrected."]
    if rig:
        found.append(
            f"The rest is your rig: {rig}. Correct these readings, or mend the rig, as stated below."
        )
    if beside:
        found.append(f"Add {beside} as a term in addition to the file, or keep it constant.")
    if diagnosis.model_with_terms:
        found.append(
            f"{diagnosis.model_with_terms} is the given file with its coefficients estimated anew"
            f"{' in addition to these' if diagnosis.repaired else ''}."
        )
    tied = [one.separation for one in diagnosis.effects if one.separation is not None]
    runs = dict.fromkeys(separation(one) for one in tied if one.worthwhile)
    found += [f"To decide, add this run: {run}." for run in runs]
    if tied and not runs:
        found.append("No usual run decides between them at this size.")
    return found


def _taken_off(diagnosis: Diagnosis) -> list[str]:
    """Sentences, without full stop, about errors that were subtracted from the readings before the search for effects."""
    return [remark.said for remark in diagnosis.notes if isinstance(remark, TakenOff)]


def _misfit(diagnosis: Diagnosis) -> str:
    """The misfit before and after in words, and what remains."""
    given, effects = diagnosis.gap_examined, _explained_by(diagnosis)
    after = diagnosis.gap_after if diagnosis.repaired else diagnosis.gap_named
    parts = []
    for name, unit, noise in _measured(diagnosis.noise):
        was, is_ = short(given.rms(name)), short(after.rms(name))
        if effects and was == is_ and given.rms(name) < MISFIT_AT_NOISE * noise:
            continue
        now = f"{is_} {unit} instead of {was} {unit}" if effects and was != is_ else f"{was} {unit}"
        parts.append(
            f"{now} in {CHANNELS[name].word} ({_as_read(diagnosis, name)}noise {short(noise)} {unit}"
            f"{_times_stated(diagnosis.noise, name)})"
        )
    them = "it" if len(effects) == 1 else "them"
    lead = (
        f"with {them} the rms misfit {'is' if diagnosis.repaired else 'would be'}"
        if effects
        else "the rms misfit is"
    )
    said = f"{lead} {listed(parts)}"
    if not effects and diagnosis.coefficients:
        better = [
            f"{short(diagnosis.gap_after.rms(name))} {unit}" for name, unit, _ in _measured(diagnosis.noise)
        ]
        ours = "the coefficients" if diagnosis.anew else "the rig errors"
        what = "the zeros of every set-up" if zeros_of_setups(diagnosis) else ours
        said += f"; with {what}, estimated within their declared uncertainty, it is {listed(better)}"
    for rest in diagnosis.rest[:1]:
        said += f"; {_remains(rest, diagnosis)}"
    return said


def _remains(rest: Rest, diagnosis: Diagnosis) -> str:
    """What remains, in words."""
    match rest.kind:
        case RestKind.SMOOTH:
            return f"what remains changes smoothly with the conditions{f', most in {rest.channel}' if rest.channel else ''}"
        case RestKind.LOCAL if diagnosis.bump is not None:
            off = f"{short(diagnosis.bump.amplitude)} {CHANNELS[rest.channel].unit}"
            return f"{rest.channel} remains off by {off} around {_around(diagnosis.bump)}"
        case RestKind.SCATTER:
            most = f", most in {rest.sweep}" if rest.sweep else ""
            return f"{rest.channel} scatters by {short(rest.ratio)} times its stated noise{most}"
        case RestKind.COEFFICIENTS:
            return "its coefficients would have to leave the uncertainty of their build: the model hardly is one of this tyre"
        case RestKind.ALL:
            return (
                f"it is {rest.ratio:.0f} times the stated noise, so that the model hardly is one of this tyre"
            )
    return f"{rest.sweep} contradicts the other sweeps in {rest.channel}"


def _as_read(diagnosis: Diagnosis, channel: str) -> str:
    """The misfit of all uncorrected readings, for a sentence; empty if no reading was corrected or left out."""
    if not (_taken_off(diagnosis) or any(isinstance(remark, Misread) for remark in diagnosis.notes)):
        return ""
    return f"{short(diagnosis.gap_before.rms(channel))} {CHANNELS[channel].unit} as read, "


def zeros_of_setups(diagnosis: Diagnosis) -> dict[str, tuple[float, float]]:
    """By name, value and standard error of the zeros of every set-up, if there are several, estimated with the effects."""
    names = priors.zeros_of_setups(diagnosis.points, diagnosis.noise.channels)
    return {name: diagnosis.coefficients[name] for name in names if name in diagnosis.coefficients}


def _zeros(diagnosis: Diagnosis) -> list[str]:
    """A sentence with the zeros of every set-up; none if there is one set-up."""
    found = [
        f"{words_of(name)} {to_uncertainty(value, u)} +- {to_uncertainty(u, u)} {unit_of(name)}"
        for name, (value, u) in zeros_of_setups(diagnosis).items()
    ]
    return [f"Zeros of the set-ups as estimated here: {'; '.join(found)}."] if found else []


def _suspicions(diagnosis: Diagnosis) -> str:
    """A sentence on effects that are named but not repaired; empty if all are repaired."""
    found = diagnosis.suspected
    if not found or any(isinstance(remark, NoRepair) and remark.effects for remark in diagnosis.notes):
        return ""
    limit, names = per_cent(MOST), listed([_suspicion(one, diagnosis) for one in found])
    return f" Suspected but not repaired, at a confidence below {limit}: {names}."


def _suspicion(found: AcceptedEffect, diagnosis: Diagnosis) -> str:
    """An effect that is not repaired, with the channel that it, and those named before it, would bring closest to the model."""
    given, after = diagnosis.gap_examined, found.gap_after
    sizes = [(after.rms(n) / given.rms(n), n, unit) for n, unit, _ in _measured(diagnosis.noise)]
    share, name, unit = min(sizes)
    was, is_ = short(given.rms(name)), short(after.rms(name))
    takes = f", taking {CHANNELS[name].word} from {was} to {is_} {unit}" if share < 1.0 else ""
    return f"{found.effect.name} ({per_cent(found.confidence)}{takes})"


def _times_stated(noise: Noise, channel: str) -> str:
    """Words for readings that scatter by more than a usual factor beyond what is stated; else empty."""
    stated = noise.typically_stated(channel)
    ratio = noise.typical(channel) / stated
    if noise.origin is not Origin.STATED or ratio <= constants.STATED_NOISE_FACTOR:
        return ""
    return f", {short(ratio)} times the stated {short(stated)} {CHANNELS[channel].unit}"


def _measured(noise: Noise) -> Iterator[tuple[str, str, float]]:
    """Name, unit and typical noise of every measured channel."""
    for name in noise.channels:
        typical = noise.typical(name)
        if math.isfinite(typical):
            yield name, CHANNELS[name].unit, typical


def _with_ties(found: AcceptedEffect) -> str:
    if not found.tied:
        return found.effect.name
    return f"{found.effect.name} (or {' or '.join(e.name for e in found.tied)}, not separable here)"


def notes(diagnosis: Diagnosis) -> list[str]:
    """The zeros of set-ups, if there are several, a gap that grows, and all notes, as sentences."""
    return [*_grown(diagnosis), *_zeros(diagnosis), *(remark.sentence for remark in diagnosis.notes)]


def _grown(diagnosis: Diagnosis) -> list[str]:
    """A sentence on effects that widen the gap until the coefficients are estimated anew; none if no effect does."""
    steps = diagnosis.steps if diagnosis.anew else ()
    wider = [
        after.name
        for before, after in pairwise(steps[:-1])
        if after.gap.chi2_per_dof > before.gap.chi2_per_dof
    ]
    if not wider:
        return []
    return [
        f"The gap grows with {listed(wider)} alone, because the given coefficients make up for part of it; estimated anew, they "
        "no longer do."
    ]


def source(noise: Noise) -> str:
    """Origin of the uncertainties of the readings; empty if Fy was not measured."""
    return "" if noise.origin is None else noise.origin.value


def scatter(noise: Noise) -> list[str]:
    """Sentences on the estimated noise and the stated one, one per channel."""
    out = []
    for name, unit, found in _measured(noise):
        part = noise.scatter[name]
        parts = [
            f"The noise of {name} is {found:.3g} {unit} (stated {noise.typically_stated(name):.3g} {unit})"
        ]
        if part.growth:
            parts.append(f"it grows with the reading, by {100.0 * part.growth:.2g} % of it")
        if part.memory.correlation:
            beside = (
                f", {100.0 * part.memory.independent:.0f} % of their variance is not"
                if part.memory.independent
                else ""
            )
            parts.append(
                f"neighbouring errors of {THROUGH[part.span]} are correlated ({part.memory.correlation:.2f}){beside}"
            )
        if math.isfinite(part.tails):
            parts.append("outliers are more frequent than in normal noise and lost their weight")
        out.append("; ".join(parts) + ".")
    return out


def outlier(found: Outlier) -> str:
    """One outlying reading."""
    place = f"{found.sweep}, line {found.line}" if found.line else found.sweep
    size = f"{found.measured - found.expected:.3g} {CHANNELS[found.channel].unit}"
    return f"{place}: {found.channel} off by {size}, {found.ratio:.0f} times its noise"


def separation(found: Separation | None) -> str:
    """The run that separates two explanations, in words; empty without a tie."""
    if found is None:
        return ""
    if found.worthwhile:
        return f"{found.run} (expected chi2 {found.chi2:.0f})"
    return (
        f"none of the usual runs separates them at this size; the best would be {found.run} "
        f"(expected chi2 {found.chi2:.1f})"
    )


def method(validation: Validation) -> str:
    """The method of leaving sweeps out, in words."""
    if validation.within_runs:
        return f"{validation.folds} parts of every run left out in turn"
    return f"each of {validation.folds} sweeps left out in turn"


def separate_by(found: AcceptedEffect) -> str:
    """The run that would separate an accepted effect from those it is tied with."""
    return separation(found.separation)


def effects_with_remedies(found: Diagnosis) -> list[dict[str, Json]]:
    """The accepted effects for JSON, each with its remedy."""
    return [document(one) | {"to_do": remedy(one, found)} for one in found.effects]


def remedy(found: AcceptedEffect, diagnosis: Diagnosis) -> str:
    """What to do about an effect, in words; numbers are in the rig's own axes."""
    effect = found.effect
    if effect.switches:
        return "switch the simulation's turn slip on"
    if not effect.remedy:
        said = (TO_DO if found.repaired else NOT_REPAIRED).get(effect.kind, "")
        return said.format(file=diagnosis.file_said)
    signs = diagnosis.signs
    several = [free.name for free in effect.free if OF_RUN in free.name and not effect.runs_written_out]
    if not several:
        return _remedy_with(found, effect.free[0].name, signs)
    significant = [name for name in several if _is_significant(found, name)]
    return "; ".join(
        f"set-up {name.partition(OF_RUN)[2]}: {_remedy_with(found, name, signs)}"
        for name in significant or several
    )


def _is_significant(found: AcceptedEffect, name: str) -> bool:
    """Whether a number of an effect differs significantly from its value before."""
    value, u = found.parameters[name]
    return abs(value - found.before[name]) > TWO_SIGMA * u


def _remedy_with(found: AcceptedEffect, name: str, signs: Mapping[str, float]) -> str:
    """The remedy with one number of the effect."""
    effect = found.effect
    value, u = found.parameters[name]
    value *= math.prod(signs[axis] for axis in effect.axes)
    plus = "+" if effect.axes else ""
    return effect.remedy.format(
        value=to_uncertainty(value, u, plus), opposite=to_uncertainty(-value, u, plus)
    )


def status(effect: Effect, before: float, stderr: float) -> str:
    """The reason for a coefficient's value, for its comment in the corrected property file."""
    return f"diagnosed, {effect.name}, was {before:.6g}, +- {stderr:.2g}"


def adjusted(before: float, stderr: float) -> str:
    """The comment of a coefficient that was estimated together with the effects."""
    return f"adjusted with the diagnosis, was {before:.6g}, +- {stderr:.2g}"


def place(region: Mapping[str, tuple[float, float]]) -> list[str]:
    """The ranges of a region in words; empty for the whole programme."""
    return [_range(name, *limits) for name, limits in region.items()]


def _range(name: str, low: float, high: float) -> str:
    if name == "direction":
        return "backward runs" if high < 0 else "forward runs" if low > 0 else "both directions"
    quantity = CONDITIONS[name]
    if low == high:
        return f"{quantity.word} {short(low)} {quantity.unit_behind}".rstrip()
    digits = max(2 - math.floor(math.log10(high - low)), 0)  # a limit near zero has no more than the other
    values = " to ".join(short(round(limit, digits) + 0.0) for limit in (low, high))
    return f"{quantity.word} {values} {quantity.unit_behind}".rstrip()


def _around(bump: Bump) -> str:
    return " and ".join(place(bump.region))


def best_effect(found: BestEffect) -> str:
    """A clause on the effect that explains residuals best, with its numbers and its significance."""
    step = found.best
    numbers = [_number(name, value, u) for name, (value, u) in step.numbers.items()]
    listed = f" ({', '.join(numbers)})" if len(numbers) <= NAMED_IN_SENTENCE else ""
    rivals = f", as does {' or '.join(o.effect.name for o in found.rivals)}" if found.rivals else ""
    says = (
        "contradicts what was declared or expected"
        if step.known
        else f"would explain {100 * step.share:.0f} % of the misfit"
    )
    return f"{step.effect.name}{listed} {says}, {found.sigma:.1f} standard deviations with {found.tried} effects tried{rivals}"


def rival_of_formula(found: BestEffect | None) -> str:
    """A clause on the effect of rig or environment that explains most of the misfit, as model error would; empty if none does."""
    return best_effect(found) if found is not None and found.explains_most else ""


def _number(name: str, value: float, u: float) -> str:
    """A number of an effect in words; a rig number without its name, because the effect has the same name."""
    if error_of(name) is None:
        return f"{name} = {to_uncertainty(value, u)} +- {to_uncertainty(u, u)}"
    value, u, unit = shown(name, value, u)
    part = name.partition(OF_RUN)[2]
    return f"{part}{': ' if part else ''}{to_uncertainty(value, u)} +- {to_uncertainty(u, u)} {unit}".rstrip()

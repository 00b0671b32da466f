"""Sentences about a fit: its files and their uses, what was modelled, ranges, sources, bands; and its warnings."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from scipy.special import ndtri

from mffit.config import Config
from mffit.constants import NAMED_IN_SENTENCE, PREDICTION_FALSE_ALARM
from mffit.fit.agreement import Agreement
from mffit.fit.bands import BandBesideSweeps, Bands
from mffit.fit.by_hand import NO_HAND, Hand
from mffit.fit.coverage import why_held
from mffit.fit.fitted import Fitted
from mffit.fit.influences.modelled import AtTemperature, BetweenRuns
from mffit.fit.influences.nuisance_choice import Gaps, Verdict
from mffit.fit.influences.nuisances import TEMPERATURE
from mffit.fit.influences.with_nuisances import NuisanceFit
from mffit.fit.ranges import single_load, single_pressure
from mffit.fit.rig.rig_numbers import default_alignment
from mffit.fit.rig.zeros import TurningZeros
from mffit.fit.written.files import Files, file_names, name_at_temperature
from mffit.measured import Measured
from mffit.measured.wording import SOURCES
from mffit.points import Points
from mffit.points.levels import SPEED
from mffit.quantities import CHANNELS
from mffit.rig_errors import BESIDE, V_REF, ZEROS, RigError, error_of, shown, unit_of, words_of
from mffit.rounding import ascii_only, number, rounded, to_uncertainty
from mffit.suspicion import Doubt, Outlier, outliers_sentence
from mffit.suspicion.constants import DIFFERENCE_OF_ANOTHER_TYRE
from tir.errors import begun, listed
from tir.parameters import BY_NAME

RARE = "the range of usual tyres"
"""Name in sentences of the usual range in the table of parameters."""


def explanations(
    config: Config, files: Files, values: Mapping[str, Any], measured: Measured, hand: Hand = NO_HAND
) -> list[str]:
    """The report's sentences about the files, most important first."""
    names = file_names(config.tyre.name, config.spin.exact, config.rig.on_disc)
    out = file_sentences(files, names)
    if hand.names:
        said = "; ".join(hand.said(name) for name in hand.names)
        out.append(
            f"Set by hand in [coefficients]: {said}. Every file has held values, and uncertainties take them as exact."
        )
    carried = measured.carried
    if carried is not None and "PECP1" not in hand.held:
        out.append(f"PECP1 = {float(values['PECP1']):.4f} is eps_gamma {SOURCES[carried.source]}.")
    return out


def alignment_sentence(config: Config, measured: Measured) -> str:
    """The angle that the default of u_slip_alignment_N asserts for this tyre; empty if [rig] states the key."""
    assumed = default_alignment(config, measured)
    if assumed is None:
        return ""
    return (
        f"The sideslip axis is taken as aligned to {number(assumed.u, digits=2)} deg (k = 1), the default of u_slip_alignment_N "
        "over the cornering stiffness: if the rig is set up less well, state the key under [rig]."
    )


def file_sentences(files: Files, names: Mapping[str, str]) -> list[str]:
    """Sentences on each file (``names``, by use): its use, its misfit to the fitted model, and the tested ranges."""
    mode = {use: int(file.tyre["USE_MODE"]) for use, file in files.by_use.items()}
    normal = names["normal"]
    if not files.lacking:
        said = (
            f"Give {normal} to the simulator with turn slip off (USE_MODE {mode['normal']}): a straight path does not measure "
            "turn slip."
        )
        return [said, ranges_sentence(files)]
    out = []
    if "both" in files.by_use:
        misfit = files.by_use["both"].misfit
        places = ("straight", "straight_with_turn_slip", "disc")
        without, straight, disc = (misfit[place]["Fy"].weighted for place in places)
        out.append(
            f"Give {names['both']} to a simulator if you do not know whether it computes turn slip. It differs from the fitted "
            f"model by {disc:.0f} N on the disc and {straight:.0f} N on a straight path with turn slip (USE_MODE "
            f"{mode['both']}), and by {without:.0f} N on a straight path without turn slip (change the last digit of USE_MODE to "
            "4). Each of the other two files is better in its own use."
        )
    unsure = "" if out else f" If you do not know, use {normal}."
    Fy, Mz = files.by_use["normal"].straight["Fy"], files.by_use["normal"].straight["Mz"]
    less = "less" if files.stiffness_loss >= 0 else "more"
    lacking = ", ".join(f"{force:.0f} N at {radius:g} m" for radius, force in files.lacking.items())
    out += [
        f"Give {names['turn-slip']}, the fitted model itself, to a simulator that computes turn slip, the rotation of the wheel "
        f"about the vertical along a curved path (its USE_MODE ends in 5, here {mode['turn-slip']}). Give {normal} to every "
        f"other simulator (its USE_MODE ends in 4, here {mode['normal']}).{unsure} With the wrong file the "
        "camber forces are wrong.",
        f"{normal} reproduces the fitted model on a straight path to {Fy.ridden:.0f} N and {Mz.ridden:.1f} Nm rms where vehicles "
        "are ridden, much lean and much sideslip apart, because camber changes the grip through spin, for which the formula "
        "without spin has no term. For an upright wheel the two files are equal.",
        f"{normal} has {abs(files.stiffness_loss):.0%} {less} camber stiffness at zero camber than the fitted model, and "
        f"lacks the turn-slip force of curved roads (upright wheel, nominal load, by radius): {lacking}.",
    ]
    if files.wide_limit is not None:
        out.append(
            f"[normal] camber_max_deg = {np.degrees(files.wide_limit):.0f} has no effect, because the camber range of the files "
            f"ends at {np.degrees(files.written['CAMMAX']):.0f} deg."
        )
    return [*out, ranges_sentence(files)]


def ranges_sentence(files: Files) -> str:
    """A sentence on the tested ranges and the ranges of the files."""
    tested, written = files.tested, files.written
    low, high = (f"{tested[name] / 1e3:.0f}" for name in ("PRESMIN", "PRESMAX"))
    pressures = f"{low} kPa only" if single_pressure(tested) else f"{low} to {high} kPa"
    slip = (
        f", longitudinal slip {tested['KPUMIN']:.2f} to {tested['KPUMAX']:.2f} {_at_sideslips(files.sideslips_with_slip)}"
        if "KPUMAX" in tested
        else ""
    )
    one = single_load(tested)
    loads = f"{tested['FZMAX']:.0f} N only" if one else f"{tested['FZMIN']:.0f} to {tested['FZMAX']:.0f} N"
    return (
        f"Tested: {loads}, sideslip to {np.degrees(tested['ALPMAX']):.1f} deg, "
        f"camber to {np.degrees(tested['CAMMAX']):.1f} deg, {pressures}{slip}. The ranges in the file are wider where the model "
        "stays plausible, because simulators limit their inputs to them: "
        f"{written['FZMIN']:.0f} to {written['FZMAX']:.0f} N, {np.degrees(written['ALPMAX']):.0f} deg of sideslip, "
        f"{np.degrees(written['CAMMAX']):.0f} deg of camber, {written['PRESMIN'] / 1e3:.0f} to "
        f"{written['PRESMAX'] / 1e3:.0f} kPa. Beyond the tested conditions nothing was measured."
    )


def _at_sideslips(sideslips: Sequence[float]) -> str:
    """The sideslips [rad] at which longitudinal slip was run, in words."""
    degrees = [round(float(np.degrees(alpha)), 1) + 0.0 for alpha in sideslips]
    if not any(degrees):
        return "without sideslip"
    if len(degrees) > NAMED_IN_SENTENCE:
        return f"at sideslips of {degrees[0]:g} to {degrees[-1]:g} deg"
    *others, last = (f"{alpha:g}" for alpha in degrees)
    return f"at sideslips of {', '.join(others)} and {last} deg" if others else f"at {last} deg of sideslip"


def beside_sentence(band: BandBesideSweeps) -> str:
    """A sentence on a band outside the test plan and the run that would narrow it; empty if the band is not wider there."""
    at, beside = (round(float(np.degrees(alpha)), 1) for alpha in (band.sideslip, band.beside))
    what, unknown = "sideslip was run to one side only", "what only both sides show"
    if band.channel == "Fx":
        what, unknown = (
            f"longitudinal slip with sideslip was run at {at:.1f} deg only",
            "how Fx falls on the way there",
        )
    return (
        f"{what}, so that {unknown} is expected, not measured: the 95 % band of {band.channel} is +-{band.half_beside:.0f} N "
        f"at {beside:.1f} deg (rms), and +-{band.half_at:.0f} N at {at:.1f} deg; sweeps there would narrow it"
        if band.wider
        else ""
    )


def bands_sentence(bands: Bands, held: Mapping[str, float], values: Mapping[str, Any], why: str) -> str:
    """A sentence on bands that are wider at other pressures; empty if they are about equal.

    ``held`` has standard uncertainties of held coefficients; ``why`` states what the sweeps lack for the coefficient that widens.
    """
    if not bands.wider:
        return ""
    others = ", ".join(f"{p / 1e3:.0f}" for p in bands.others)
    nominal = float(values["NOMPRES"]) / 1e3
    at_nominal = ""
    if 1e3 * nominal in bands.others:
        at_nominal = f". Coefficients are values at the nominal {nominal:.0f} kPa: PKY1 and PKY2 share this uncertainty"
    return (
        f"the 95 % bands of the side force are +-{bands.half:.0f} N (rms over the tested angles and loads) at the "
        f"{bands.main / 1e3:.0f} kPa of most sweeps, and +-{bands.half_of_others:.0f} N at {others} kPa: {bands.share:.0%} of "
        f"that variance is {bands.unseen}, which keeps its expected value {float(values[bands.unseen]):.2g} with a standard "
        f"uncertainty of {held[bands.unseen]:.2g} ({why}){at_nominal}"
    )


def zeros_sentence(zeros: TurningZeros, fitted: Fitted, *, from_base: bool) -> tuple[str, bool]:
    """A sentence on the coefficients that the zeros changed, and whether the zeros contradict a base file (then a warning)."""
    contradicted = zeros.contradicted and from_base
    begins = "the base file contradicts the zeros: " if contradicted else ""
    source = "it gives" if contradicted else "the base file gives" if from_base else "the usual values give"
    moved = [
        f"{name} from {to_uncertainty(before, u)} to {to_uncertainty(fitted.values[name], u)} +- {to_uncertainty(u, u)}"
        for name, before in zeros.before.items()
        if name in fitted.values
        for u in [fitted.stderr[name]]
    ]
    force = zeros.force
    rest = (
        ""
        if zeros.camber
        else (
            ". Without camber sweeps the zeros determine only the ratio of camber stiffness to 1 - PECP1: a camber sweep "
            "separates the two"
        )
    )
    return (
        f"{begins}at {zeros.load:.0f} N {source} a turn-slip force of {zeros.expected:.0f} N on this path, and "
        f"{to_uncertainty(force.value, force.u)} +- {to_uncertainty(force.u, force.u)} N was measured; the fit moved "
        f"{' and '.join(moved)}{rest}"
    ), contradicted


def zeros_of_rig_sentence(zeros: Mapping[str, tuple[float, float]], bands: Bands) -> str:
    """A sentence on zeros of a flat track that the fit hardly separates from the tyre: their effect on the bands, the remedy."""
    band, exact = (to_uncertainty(half, half) for half in (bands.half, bands.half_of_exact_zeros))
    return (
        f"on a flat track with one set-up, zeros of the rig ({zeros_listed(zeros)}) look almost like the tyre's own asymmetries, "
        f"such as ply-steer, conicity and residual torque: the 95 % bands of Fy are +-{band} N (rms), and would be +-{exact} N "
        "with these known exactly. Turn the tyre on its rim (mount), repeat set-ups (setup), or state a better rig (u_ keys of "
        "[rig])"
    )


def held_asymmetries(held: Mapping[str, float]) -> str:
    """A sentence on asymmetries that a disc does not tell from turn slip, which are held; empty if its zeros are not held."""
    if not any(error_of(name) in ZEROS for name in held):
        return ""
    return (
        "the formula misses these readings, and they do not tell an asymmetry of the tyre or a zero of the rig "
        "from what it misses of turn slip: asymmetries are held at their expected values and zeros as declared, with their "
        "uncertainties, which brings the file nearer to the tyre on a straight road; more of the other side of the disc, or the "
        "tyre turned on its rim, would tell them"
    )


def nominal_pressure_sentences(files: Files) -> Iterator[str]:
    """A sentence if the nominal pressure, at which the coefficients hold, lies outside the tested pressures."""
    nominal = float(next(iter(files.by_use.values())).tyre["NOMPRES"])
    low, high = (files.tested[name] for name in ("PRESMIN", "PRESMAX"))
    share = DIFFERENCE_OF_ANOTHER_TYRE
    if not (1.0 - share) * low <= nominal <= (1.0 + share) * high:
        tested = f"{low / 1e3:.1f} to {high / 1e3:.1f} kPa were"
        if single_pressure(files.tested):
            tested = f"only {0.5 * (low + high) / 1e3:.1f} kPa was"
        yield (
            f"nominal_pressure, {nominal / 1e3:g} kPa, was not tested, {tested}: the coefficients of the file hold at it by the "
            "formula alone; run sweeps there or give a tested pressure"
        )


def warnings(
    fitted: Fitted,
    doubts: Sequence[Doubt],
    outlying: Sequence[Outlier],
    untested: Mapping[str, str],
) -> tuple[str, ...]:
    """All warnings of the fit with influences, most important first; ``untested`` as in :class:`Files`."""
    out = [
        f"the sweeps do not vary the {word}: the file's range of it is {origin}, and was not tested"
        for word, origin in untested.items()
    ]
    out += by_hand_warnings(fitted)
    out += [doubt.sentence for doubt in doubts]
    if outlying:
        out.append(outliers_sentence(outlying))
    return tuple(out)


def by_hand_warnings(fitted: Fitted) -> list[str]:
    """Warnings on [coefficients]: values at a bound, settings without effect, and priors that the points contradict."""
    hand, free = fitted.hand, {number.name for number in fitted.numbers}
    out = []
    for name in sorted(fitted.at_bound & hand.bounded.keys()):
        lower, upper = hand.bounded[name]
        out.append(f"{name} is at a limit: [coefficients] allows {lower:g} to {upper:g}")
    rare = [
        name for name, x in hand.held.items() if name not in hand.from_base and BY_NAME[name].rare(float(x))
    ]
    out += [f"{name} is held in [coefficients] outside {RARE}" for name in rare]
    for name in hand.names:
        if name in free or name in hand.held:
            continue
        given = (
            "its prior counts as its value and uncertainty" if name in hand.priors else "nothing was searched"
        )
        out.append(f"{name} is set in [coefficients], but the points do not free it: {given}")
    return [*out, *contradicted_priors(fitted)]


def contradicted_priors(fitted: Fitted) -> Iterator[str]:
    """Warnings on priors set by hand that differ significantly from the points.

    The posterior mean of a number is the mean of prior and points weighted by their precisions, so the estimate from the points
    alone follows from posterior and prior.
    """
    stderr = fitted.stderr
    far = float(-ndtri(PREDICTION_FALSE_ALARM / (2.0 * max(len(fitted.hand.priors), 1))))
    for name, prior in fitted.hand.priors.items():
        if name not in fitted.values or name in fitted.at_bound:
            continue
        both, own = stderr[name] ** -2.0, prior.spread**-2.0
        if not both > own:  # the points contain no information about it
            continue
        value, u = (both * fitted.values[name] - own * prior.expected) / (both - own), (both - own) ** -0.5
        apart = abs(value - prior.expected) / math.hypot(u, prior.spread)
        if apart > far:
            yield (
                f"the points alone give {name} = {value:.4g} +- {u:.2g}, {apart:.1f} standard deviations from the "
                f"{prior.expected:g} +- {prior.spread:g} of [coefficients]; check both"
            )


def at_limits(fitted: Fitted) -> tuple[str, ...]:
    """Coefficients at a bound, at a physical limit or outside the range of usual tyres; without bounds by hand."""
    rare = {
        n.name
        for n in fitted.numbers
        if n.name in BY_NAME
        and BY_NAME[n.name].rare(fitted.values[n.name])
        and not BY_NAME[n.name].rare(n.expected)
    }
    bound = fitted.at_bound & fitted.values.keys()
    return tuple(sorted((bound | rare) - fitted.hand.bounded.keys()))


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
"""By temperature term or random effect, the quantity that it scales, in words."""


def nuisance_sentences(
    name: str,
    found: NuisanceFit,
    temperature: AtTemperature | None,
    runs: BetweenRuns | None,
    plain: Mapping[str, Agreement],
) -> tuple[list[str], list[str]]:
    """Sentences on the files and the modelled influences; and sentences on influences that were not modelled, with reasons.

    ``name`` is the tyre's name; ``plain`` is the agreement of the plain file with the points, by channel.
    """
    first = [] if temperature is None else [_files_sentence(name, temperature, plain)]
    last, measured = [], bool(np.any(np.isfinite(found.full.problem.points.T)))
    for verdict in found.choice.verdicts:
        said = f"The {verdict.nuisance.name} is"
        compared = f" ({_compared(verdict)})" if verdict.beside else ""
        if not verdict.modelled and (verdict.beside or (verdict.nuisance.id == TEMPERATURE and measured)):
            last.append(f"{said} not modelled: {verdict.reason}{compared}.")
        elif verdict.modelled and verdict.nuisance.key != TEMPERATURE:
            first.append(f"{said} modelled: {_size(verdict, found, runs)}; {verdict.reason}{compared}.")
    return first, last


def _size(verdict: Verdict, found: NuisanceFit, runs: BetweenRuns | None) -> str:
    """The fitted size of an influence in words, with a note that the files do not contain it."""
    if runs is not None and verdict.nuisance.per_run:
        sizes = " and ".join(f"{SCALED[n]} by {_percent(*value)}" for n, value in runs.scatter.items())
        return (
            f"between {len(runs.runs)} sweeps {sizes} (standard deviation), contained in the standard uncertainties; the files "
            f"hold for the mean of the runs, and leave {_gaps(_rms(runs.alone))} rms"
        )
    stated = (f"{words_of(n)} {_stated(n, *found.full.rig[n])}" for n in verdict.nuisance.numbers)
    told = f"{', '.join(stated)}, and the files are without it"
    errors = [error for error in BESIDE if error.name in verdict.nuisance.numbers]
    for reference in dict.fromkeys(error.counts_from for error in errors):
        here = found.full.rig_stated[reference][0]
        told += (
            f": they hold at {here:g} {unit_of(reference)}, MF 6.2 has no term for it, and predict adds it"
        )
        if reference == V_REF:
            told += _at_other_speeds(found.full, here, errors)
    return ascii_only(told)


def _at_other_speeds(full: Fitted, here: float, terms: Sequence[RigError]) -> str:
    """What a simulation at the ends of the tested speeds sets in a file that holds ``here`` [m/s]."""
    V = full.problem.points.V
    ends = (
        end for end in (float(V.min()), float(V.max())) if not np.isclose(end, here, rtol=SPEED.tolerance)
    )
    return "".join(
        f"; at {end:.3g} m/s take "
        + listed(
            [f"{term.acts_on[0]} {1.0 + full.rig[term.name][0] * (end - here):.3f} times" for term in terms]
        )
        for end in ends
    )


def _files_sentence(name: str, found: AtTemperature, plain: Mapping[str, Agreement]) -> str:
    special, (low, high) = name_at_temperature(name), found.T_range
    terms = [f"{SCALED[n]} {_percent(*value)} per {unit_of(n)[2:]}" for n, value in found.terms.items()]
    return (
        f"{name}.tir is for simulations that do not know the temperature of the tyre: it leaves {_gaps(_rms(plain))} rms. "
        f"{special} is for simulations that do: it holds at {found.T_ref:g} degC and leaves {_gaps(_rms(found.channels))} with "
        f"its temperature terms, which were measured from {low:.0f} to {high:.0f} degC: {listed(terms)}. Without them it leaves "
        f"{_gaps(_rms(found.alone))}, so take it to the temperature of the simulation first, in Python by "
        f"tyre.at_temperature({high:.0f})."
    )


def _compared(verdict: Verdict) -> str:
    return f"errors of what is left out: {_gaps(verdict.beside)} with it, {_gaps(verdict.without)} without"


def _stated(name: str, value: float, u: float) -> str:
    value, u, unit = shown(name, value, u)
    return f"{' +- '.join(rounded(value, u))} {unit}".rstrip()


def _percent(value: float, u: float) -> str:
    text, spread = rounded(100.0 * value, 100.0 * u)
    return ascii_only(f"{text} +- {spread} %")


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


def remarks(
    config: Config, points: Points, fitted: Fitted, values: Mapping[str, Any], found: Bands
) -> list[str]:
    """Sentences on the widths of the fitted tyre's bands."""
    zeros = zeros_of_rig(fitted.zeros)
    said = [
        bands_sentence(found, fitted.held, values, why_held(found.unseen, points, config.tyre.side)),
        *(beside_sentence(band) for band in (found.combined, found.other_side) if band is not None),
        zeros_of_rig_sentence(zeros, found) if zeros and not config.rig.on_disc else "",
        held_asymmetries(fitted.held_rig) if config.rig.on_disc else "",
    ]
    return [f"{begun(text)}." for text in said if text]


def zeros_listed(rig: Mapping[str, tuple[float, float]]) -> str:
    """The fitted zeros of the rig in words, joined by commas."""
    return ", ".join(
        f"{words_of(name)} {to_uncertainty(value, u)} +- {to_uncertainty(u, u)} {unit_of(name)}"
        for name, (value, u) in zeros_of_rig(rig).items()
    )


def zeros_of_rig(rig: Mapping[str, tuple[float, float]]) -> dict[str, tuple[float, float]]:
    """The zeros among the numbers of a rig with one set-up, with standard uncertainties."""
    return {error.name: rig[error.name] for error in ZEROS if error.name in rig}

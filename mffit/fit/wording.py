"""Explanations of a fit in sentences (files, their uses and misfit, ranges, source of PECP1), and its warnings."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from scipy.special import ndtri

from mffit.config import Config
from mffit.constants import NAMED_IN_SENTENCE, PREDICTION_FALSE_ALARM
from mffit.fit.bands import BandOfCombined, BandOfOtherSide, BandsByPressure
from mffit.fit.by_hand import HELD_BY_HAND, NO_HAND, Hand
from mffit.fit.coverage import StageCoverage
from mffit.fit.fitted import Fitted
from mffit.fit.ranges import single_load, single_pressure
from mffit.fit.rig.zeros import TurningZeros
from mffit.fit.written.files import Files, file_names
from mffit.fit.written.misfit import FileFigures
from mffit.fit.written.normal import CAMBER_FORCE, CAMBER_MOMENT
from mffit.measured import Measured
from mffit.rig_errors import UNITS, WORDS
from mffit.rounding import to_uncertainty
from mffit.suspicion import Doubt, Outlier, outliers_sentence
from tir.parameters import BY_NAME

RARE = "the range of usual tyres"
"""How sentences call the usual range of the table of parameters."""


def explanations(
    config: Config, files: Files, values: Mapping[str, Any], measured: Measured, hand: Hand = NO_HAND
) -> list[str]:
    """Everything that the report explains about the files, the most important first."""
    names = file_names(config.tyre.name, config.spin.exact, config.rig.on_disc)
    out = file_sentences(files, names)
    if hand.names:
        out.append(by_hand_sentence(hand, names["normal"] if files.lacking else ""))
    if measured.epsilon_gamma is not None and "PECP1" in hand.held:
        out.append(
            f"PECP1 = {hand.held['PECP1']:.4f} is held by hand. The directly measured eps_gamma is "
            f"{measured.epsilon_gamma.value:.4f}."
        )
    elif measured.epsilon_gamma is not None:
        out.append(pecp1_sentence(config.spin.pecp1, float(values["PECP1"]), measured.epsilon_gamma.value))
    return out


def by_hand_sentence(hand: Hand, derived: str) -> str:
    """What the engineer set, and what it means for the uncertainties and for the file ``derived`` from the model, if any."""
    sentence = f"Set by hand in [coefficients]: {'; '.join(hand.said(name) for name in hand.names)}."
    if hand.held:
        sentence += " The uncertainties of the others take held values as exact, and every file has them."
    own = [name for name in hand.held if name in (*CAMBER_FORCE, *CAMBER_MOMENT)]
    if derived and own:
        sentence += (
            f" {derived} would imitate the fitted model better with values of its own for {', '.join(own)}."
        )
    return sentence


def file_sentences(files: Files, names: Mapping[str, str]) -> list[str]:
    """Which file (``names``, by use) is for which use, how far it is from the fitted model, and what was tested."""
    if not files.lacking:
        return [_flat_track_sentence(files, names["normal"]), ranges_sentence(files)]
    both = [_both_sentence(files.by_use["both"], names["both"])] if "both" in files.by_use else []
    return [
        *both,
        _use_sentence(files, names),
        f"{names['turn-slip']} is the fitted model itself.",
        _misfit_sentence(files.by_use["normal"], names["normal"], files.camber_limit),
        *_limit_sentences(files),
        _lacking_sentence(files, names["normal"]),
        ranges_sentence(files),
    ]


def _flat_track_sentence(files: Files, name: str) -> str:
    return (
        f"Give {name} to the simulator with turn slip off (USE_MODE {_mode(files.by_use['normal'])}): a straight path "
        "does not measure turn slip."
    )


def _use_sentence(files: Files, names: Mapping[str, str]) -> str:
    unsure = "" if "both" in files.by_use else f" If you do not know, use {names['normal']}."
    return (
        f"Give {names['turn-slip']} to a simulator that computes turn slip, the rotation of the wheel about the vertical "
        f"along a curved path (its USE_MODE ends in 5, here {_mode(files.by_use['turn-slip'])}). Give {names['normal']} to "
        f"every other simulator (its USE_MODE ends in 4, here {_mode(files.by_use['normal'])}).{unsure} With the wrong "
        "file the camber forces are wrong."
    )


def _misfit_sentence(normal: FileFigures, name: str, limit: float | None) -> str:
    Fy, Mz = normal.straight["Fy"], normal.straight["Mz"]
    everything = (
        "everything tested"
        if limit is None
        else f"everything tested to {np.degrees(limit):.0f} deg of camber"
    )
    return (
        f"{name} reproduces the fitted model on a straight path to {Fy.ridden:.0f} N and {Mz.ridden:.1f} Nm rms where "
        f"vehicles are ridden, much lean and much sideslip apart ({Fy.rms:.0f} N and {Mz.rms:.1f} Nm rms over {everything}, "
        f"{Fy.largest:.0f} N at most). The reason is that camber changes the grip through spin, for which the formula without "
        "spin has no term. For an upright wheel the two files are equal."
    )


def _limit_sentences(files: Files) -> list[str]:
    """What became of the camber to which [normal] holds a file."""
    if files.camber_limit is not None:
        return [
            f"CAMMAX of this file is {np.degrees(files.camber_limit):.0f} deg, as [normal] camber_max_deg asks."
        ]
    if files.wide_limit is None:
        return []
    return [
        f"[normal] camber_max_deg = {np.degrees(files.wide_limit):.0f} has no effect, because the camber range of the files "
        f"ends at {np.degrees(files.written['CAMMAX']):.0f} deg."
    ]


def _lacking_sentence(files: Files, name: str) -> str:
    compared = "less" if files.stiffness_loss >= 0 else "more"
    forces = ", ".join(f"{force:.0f} N at {radius:g} m" for radius, force in files.lacking.items())
    return (
        f"{name} has {abs(files.stiffness_loss):.0%} {compared} camber stiffness at zero camber than the fitted model, and lacks "
        f"the turn-slip force of curved roads (upright wheel, nominal load, by radius): {forces}."
    )


def _both_sentence(file: FileFigures, name: str) -> str:
    places = ("straight", "straight_with_turn_slip", "disc")
    without, straight, disc = (file.misfit[place]["Fy"].weighted for place in places)
    return (
        f"Give {name} to a simulator if you do not know whether it computes turn slip. It differs from the fitted model by "
        f"{disc:.0f} N on the disc and {straight:.0f} N on a straight path with turn slip (USE_MODE {_mode(file)}), and by "
        f"{without:.0f} N on a straight path without turn slip (change the last digit of USE_MODE to 4). Each of the other "
        "two files is better in its own use."
    )


def _mode(file: FileFigures) -> int:
    return int(file.tyre["USE_MODE"])


def ranges_sentence(files: Files) -> str:
    """What was tested and what the files allow."""
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
    """At which sideslips [rad] longitudinal slip was run, in words."""
    degrees = [round(float(np.degrees(alpha)), 1) + 0.0 for alpha in sideslips]
    if not any(degrees):
        return "without sideslip"
    if len(degrees) > NAMED_IN_SENTENCE:
        return f"at sideslips of {degrees[0]:g} to {degrees[-1]:g} deg"
    *others, last = (f"{alpha:g}" for alpha in degrees)
    return f"at sideslips of {', '.join(others)} and {last} deg" if others else f"at {last} deg of sideslip"


def other_side_sentence(band: BandOfOtherSide) -> str:
    """How well the side force is known on the side to which no sideslip was run, and what to run."""
    alpha = round(float(np.degrees(band.sideslip)), 1)
    return (
        "sideslip was run to one side only: the file takes the tyre as symmetric where only both sides would show more; "
        f"the 95 % band of Fy is +-{band.half:.0f} N at {alpha:.1f} deg (rms over load), and +-{band.half_opposite:.0f} N at "
        f"{-alpha:.1f} deg; sweeps of sideslip of the other sign would narrow it"
    )


def combined_sentence(band: BandOfCombined) -> str:
    """How far the fit interpolates where longitudinal slip was run at one sideslip only; empty where that is harmless."""
    if not band.wider:
        return ""
    alpha = float(np.degrees(band.sideslip))
    return (
        f"longitudinal slip with sideslip was run at {alpha:.1f} deg only, which does not show how Fx falls on the way there: "
        f"the 95 % band of Fx is +-{band.half_between:.0f} N at {alpha / 2:.1f} deg (rms over slip and load), and "
        f"+-{band.half_at:.0f} N at {alpha:.1f} deg; sweeps of slip at a second sideslip, such as {alpha / 2:.0f} deg, would "
        "narrow it"
    )


def pecp1_sentence(source: str, PECP1: float, epsilon_gamma: float) -> str:
    """Where PECP1 comes from; ``source`` is ``spin.pecp1`` of tyre.toml, ``epsilon_gamma`` the measured value."""
    if source == "debiased":
        return (
            f"PECP1 = {PECP1:.4f} is the measured eps_gamma {epsilon_gamma:.4f} less the bias that the finite spin of the "
            "disc adds to it."
        )
    if source == "direct":
        return (
            f"PECP1 = {PECP1:.4f} is the measured eps_gamma itself. Because the spin of the disc is not small, the model's "
            "turn-slip force differs slightly from the measured one."
        )
    return (
        f"PECP1 = {PECP1:.4f} is the joint estimate of tyre and rig, in which every point counts with its noise and every "
        f"rig error with its declared uncertainty. The directly measured eps_gamma is {epsilon_gamma:.4f}."
    )


def bands_sentence(
    bands: BandsByPressure, held: Mapping[str, float], values: Mapping[str, Any], why: str
) -> str:
    """Where the bands hold; ``held`` are standard uncertainties, ``why`` is what the sweeps lack for the widening coefficient.

    Empty where they are about as narrow at all pressures.
    """
    if not bands.wider:
        return ""
    nominal = float(values["NOMPRES"])
    others = ", ".join(f"{p / 1e3:.0f}" for p in bands.others)
    at_nominal = ""
    if nominal in bands.others:
        at_nominal = (
            f". Coefficients are values at the nominal {nominal / 1e3:.0f} kPa: PKY1 and PKY2 share this uncertainty, which "
            "cancels at the pressure of the sweeps"
        )
    return (
        f"the 95 % bands of the side force are +-{bands.half:.0f} N (rms over the tested angles and loads) at the "
        f"{bands.main / 1e3:.0f} kPa of most sweeps, and +-{bands.half_of_others:.0f} N at {others} kPa: {bands.share:.0%} of "
        f"that variance is {bands.unseen}, which keeps its expected value {float(values[bands.unseen]):.2g} with a standard "
        f"uncertainty of {held[bands.unseen]:.2g} ({why}){at_nominal}"
    )


def zeros_sentence(zeros: TurningZeros, fitted: Fitted, *, from_base: bool) -> str:
    """What zeros without a measured eps_gamma changed: the force before, the measured one, and which number was moved."""
    source = "the base file gives" if from_base else "the usual values give"
    begins = f"the base file contradicts the zeros: at {zeros.load:.0f} N it gives"
    if not (from_base and zeros.contradicted):
        begins = f"at {zeros.load:.0f} N {source}"
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
            ". Without camber sweeps the zeros determine only the ratio of camber stiffness to 1 - PECP1, and the stiffness is "
            "the one assumed before: a camber sweep separates the two"
        )
    )
    return (
        f"{begins} a turn-slip force of {zeros.expected:.0f} N on this path, and {to_uncertainty(force.value, force.u)} +- "
        f"{to_uncertainty(force.u, force.u)} N was measured; the fit moved {' and '.join(moved)}{rest}"
    )


def zeros_of_rig_sentence(zeros: Mapping[str, tuple[float, float]], bands: BandsByPressure) -> str:
    """What the zeros of the rig on a flat track share with the tyre, how much of the bands this is, and what helps.

    ``zeros`` are the fitted ones with their standard uncertainties.
    """
    found = ", ".join(
        f"{WORDS[name]} {to_uncertainty(value, u)} +- {to_uncertainty(u, u)} {UNITS[name]}"
        for name, (value, u) in zeros.items()
    )
    band, exact = (to_uncertainty(half, half) for half in (bands.half, bands.half_of_exact_zeros))
    return (
        f"on a flat track with one set-up, zeros of the rig ({found}) look almost like ply-steer, conicity and residual torque: "
        "the fit divides their sum by what [rig] declares, and the coefficients PHY, PVY, QHZ, QDZ6 and QDZ7 are uncertain by "
        f"the rest. The 95 % bands of Fy are +-{band} N (rms), and would be +-{exact} N with these known exactly; the camber "
        "zero is in the uncertainties as declared. Sweeps of the tyre turned on its rim (mount) separate conicity and residual "
        "torque from the zeros of camber, Fy and Mz; further set-ups (setup) average all zeros, and smaller u_ keys in [rig] "
        "state a better rig"
    )


def warnings(
    plain: Fitted,
    fitted: Fitted,
    doubts: Sequence[Doubt],
    outlying: Sequence[Outlier],
    untested: Mapping[str, str],
    coverage: Sequence[StageCoverage] = (),
) -> tuple[str, ...]:
    """All warnings of the fits without and with influences, the most important first; ``untested`` is that of the files."""
    out = [
        f"the sweeps do not vary the {word}: the file's range of it is {origin}, and was not tested"
        for word, origin in untested.items()
    ]
    out += _at_bounds(plain, fitted)
    out += by_hand_warnings(fitted, coverage)
    out += [doubt.sentence for doubt in doubts]
    if outlying:
        out.append(outliers_sentence(outlying))
    return tuple(out)


def by_hand_warnings(fitted: Fitted, coverage: Sequence[StageCoverage]) -> list[str]:
    """Bounds set by hand that the fit ends at, bounds and priors without effect, and priors that the points contradict."""
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
        reasons = [
            reason for row in coverage if name in row.held for reason in row.missing if reason != HELD_BY_HAND
        ]
        why = f" ({'; '.join(reasons)})" if reasons else ""
        given = (
            "its prior counts as its value and uncertainty" if name in hand.priors else "nothing was searched"
        )
        out.append(f"{name} is set in [coefficients], but the points do not free it{why}: {given}")
    return [*out, *contradicted_priors(fitted)]


def contradicted_priors(fitted: Fitted) -> Iterator[str]:
    """The priors set by hand that differ from the points by more than chance explains.

    The posterior of one number is the mean of prior and points, weighted by their information, so that the part of the points
    follows from posterior and prior.
    """
    stderr = fitted.posterior.stderr
    far = float(-ndtri(PREDICTION_FALSE_ALARM / (2.0 * max(len(fitted.hand.priors), 1))))
    for name, prior in fitted.hand.priors.items():
        if name not in fitted.values or name in fitted.at_bound:
            continue
        both, own = stderr[name] ** -2.0, prior.spread**-2.0
        if not both > own:  # the points say nothing
            continue
        value, u = (both * fitted.values[name] - own * prior.expected) / (both - own), (both - own) ** -0.5
        apart = abs(value - prior.expected) / math.hypot(u, prior.spread)
        if apart > far:
            yield (
                f"the points alone give {name} = {value:.4g} +- {u:.2g}, {apart:.1f} standard deviations from the "
                f"{prior.expected:g} +- {prior.spread:g} of [coefficients]; check both"
            )


def _at_bounds(plain: Fitted, full: Fitted) -> list[str]:
    """What bounds and physical limits hold in the plain file and, where it differs, in the file at temperature."""
    said, special = (_held_by_bounds(fit) for fit in (plain, full))
    if special == said:
        return [f"{said}; check the sweeps that determine them"] if said else []
    at_temperature = f"in the fit with temperature: {special or 'none'}"
    return [f"{said}; {at_temperature}" if said else at_temperature]


def _held_by_bounds(fitted: Fitted) -> str:
    """The coefficients at a limit of the table, rare ones, and those at a limit of the curves; bounds by hand do not count."""
    at_bound = fitted.at_bound - fitted.hand.bounded.keys()
    rare = {
        n.name
        for n in fitted.numbers
        if n.name in BY_NAME
        and n.name not in fitted.hand.bounded
        and BY_NAME[n.name].rare(fitted.values[n.name])
        and not BY_NAME[n.name].rare(n.expected)
    }
    words = (
        ("at the bound of plausible values", at_bound - fitted.at_limit),
        (f"outside {RARE}", rare - at_bound),
        (
            "at a limit of the curves, such as E <= 1",
            at_bound & fitted.at_limit,
        ),
    )
    return "; ".join(f"{word}: {', '.join(sorted(names))}" for word, names in words if names)

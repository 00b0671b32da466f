"""What the fit has to say, in words: comments of the files, which file is for what, and warnings."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mffit.fit.files import DECIDED, FileFigures, Files
from mffit.fit.result import Coefficient
from mffit.fit.staged import Fitted
from mffit.tested import words_on_tested
from tir.parameters import TABLE, Parameter

LONGEST = 66
"""Characters of a comment that fit on a line of the file."""
DERIVED = {
    "normal": "fitted to the model without path curvature",
    "both": "fitted to the model with and without turn slip",
}
TIED = "tied to its expected value"
FROM_DATA = ("measured", "fitted", "regularised")
"""Origins of values that these data decided."""
WORDS = {
    "base": "from base",
    "fleet": "as tyres of its fleet have it",
    "default": "default, not measured",
    "estimate": "estimate, not measured",
    "regularised": TIED,
    "range": "estimate, checked plausible",
    "given": "given in tyre.toml",
}


def file_comments(
    files: Files, origin: Mapping[str, str], coefficients: Mapping[str, Coefficient]
) -> dict[str, dict[str, str]]:
    """Comments of every value by use: where it comes from, how uncertain it is, what it is if that is no coefficient."""
    every = {row.name: _comment(row, origin[row.name], files.tested) for row in TABLE}
    every |= {name: status_comment(c) for name, c in coefficients.items() if c.status in FROM_DATA}
    return {
        use: {**every, **dict.fromkeys(files.changed.get(use, ()), DERIVED.get(use, ""))}
        for use in files.by_use
    }


def _comment(row: Parameter, origin: str, tested: Mapping[str, float]) -> str:
    words = "given by this build" if row.name in DECIDED else WORDS.get(origin, origin)
    if row.name in tested:
        words = f"{words}, {words_on_tested(tested[row.name], row.unit)}"
    elif not row.section.endswith("_COEFFICIENTS"):
        words = f"{words}: {row.description}"
    return whole_words(words)


def whole_words(text: str, longest: int = LONGEST) -> str:
    """The text, cut between words if it is too long for a line."""
    return text if len(text) <= longest else text[: longest + 1].rsplit(" ", 1)[0].rstrip(",:")


def sentences(files: Files, names: Mapping[str, str]) -> list[str]:
    """Which file is for what, first of all, and what the file for turn slip off costs."""
    if not files.lacking:
        return [
            f"Give {names['normal']} to the simulator with turn slip off (USE_MODE "
            f"{int(files.by_use['normal'].tyre['USE_MODE'])}): a straight path does not measure turn slip.",
            ranges_sentence(files),
        ]
    normal = files.by_use["normal"]
    fy, mz = normal.straight["Fy"], normal.straight["Mz"]
    modes = {use: int(f.tyre["USE_MODE"]) for use, f in files.by_use.items()}
    lacking = ", ".join(f"{force:.0f} N at {radius:g} m" for radius, force in files.lacking.items())
    first, doubt = [], " If you do not know, it is the second one."
    if "both" in files.by_use:
        first, doubt = [both_sentence(files.by_use["both"], names["both"])], ""
    return [
        *first,
        f"Give {names['turn-slip']} to a simulator that computes turn slip, which is the turning of the wheel about the "
        f"vertical along a curve (its USE_MODE ends in 5, here {modes['turn-slip']}); give {names['normal']} to every other "
        f"simulator (USE_MODE ends in 4, here {modes['normal']}).{doubt} Swapped, "
        "camber forces come out wrong.",
        f"{names['turn-slip']} is the fitted model itself.",
        f"{names['normal']} reproduces it on a straight path to {fy.weighted:.0f} N and {mz.weighted:.1f} Nm rms where "
        f"vehicles run ({fy.rms:.0f} N and {mz.rms:.1f} Nm over everything tested, {fy.largest:.0f} N at most): camber "
        "changes grip through spin, and without spin the formula has no term of that shape. Upright the two are equal.",
        f"{names['normal']} has {files.stiffness_loss:.0%} {'less' if files.stiffness_loss >= 0 else 'more'} camber "
        f"stiffness at zero camber than the model, and lacks the turn-slip force of curved roads (upright, nominal load; "
        f"by radius): {lacking}.",
        ranges_sentence(files),
    ]


def both_sentence(file: FileFigures, name: str) -> str:
    """What the one file for both uses is good for."""
    without, straight, disc = (
        file.misfit[p]["Fy"].weighted for p in ("straight", "straight_with_turn_slip", "disc")
    )
    return (
        f"Give {name} to a simulator of which you do not know whether it computes turn slip: it misses the fitted model by "
        f"{disc:.0f} N on the disc and {straight:.0f} N on a straight path with turn slip (USE_MODE "
        f"{int(file.tyre['USE_MODE'])}) "
        f"and by {without:.0f} N on a straight path without it (make the last digit of USE_MODE 4). Each of the other two "
        "files is better in its own use."
    )


def ranges_sentence(files: Files) -> str:
    """What was tested and what the files allow."""
    t, w = files.tested, files.written
    tested_pressure = (
        f"{t['PRESMIN'] / 1e3:.0f} kPa only"
        if t["PRESMAX"] - t["PRESMIN"] < 0.05 * t["PRESMAX"]
        else f"{t['PRESMIN'] / 1e3:.0f} to {t['PRESMAX'] / 1e3:.0f} kPa"
    )
    return (
        f"Tested: {t['FZMIN']:.0f} to {t['FZMAX']:.0f} N, sideslip to {np.degrees(t['ALPMAX']):.1f} deg, camber to "
        f"{np.degrees(t['CAMMAX']):.1f} deg, {tested_pressure}. The file allows more where its range is "
        "wider, as simulators clamp to it: "
        f"the model stays plausible, not measured, over {w['FZMIN']:.0f} to {w['FZMAX']:.0f} N, "
        f"{np.degrees(w['ALPMAX']):.0f} deg of sideslip, {np.degrees(w['CAMMAX']):.0f} deg of camber, "
        f"{w['PRESMIN'] / 1e3:.0f} to {w['PRESMAX'] / 1e3:.0f} kPa."
    )


def status_comment(coefficient: Coefficient) -> str:
    """How the file's comment states the origin of a value."""
    text = TIED if coefficient.status == "regularised" else coefficient.status
    if coefficient.stderr is not None and not coefficient.fixed:
        text += f" +- {coefficient.stderr:.2g}"
    return text + (", at bound" if coefficient.at_bound else "")


def pecp1_sentence(config, values, measured) -> str:
    if config.spin.pecp1 == "debiased":
        return (
            f"PECP1 = {values['PECP1']:.4f} is the measured eps_gamma {measured.epsilon_gamma.value:.4f} less what the "
            "finite spin of the disc adds to it."
        )
    if config.spin.pecp1 == "direct":
        return (
            f"PECP1 = {values['PECP1']:.4f} is the measured eps_gamma itself; the finite spin of the disc makes the "
            "model's turn-slip force differ slightly from the measured one."
        )
    return (
        f"PECP1 = {values['PECP1']:.4f} is the joint estimate of tyre and rig, in which every point counts with its noise "
        "and the rig's errors with the uncertainties declared for them; the directly measured eps_gamma is "
        f"{measured.epsilon_gamma.value:.4f}."
    )


def warnings(fitted: Fitted) -> list[str]:
    """What else a user must know of the fit."""
    out = []
    if fitted.attempts:
        out.append(f"the fit was started again from {', '.join(fitted.attempts)}; the best of all is kept")
    if fitted.at_bound:
        out.append(
            f"at the bound of plausible values: {', '.join(sorted(fitted.at_bound))}; check the sweeps that decide them"
        )
    return out

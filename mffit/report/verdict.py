"""What a user wants to know of a build first: whether to trust it, its main numbers, and which file is for whom."""

from __future__ import annotations

from typing import NamedTuple

from mffit.quantities import CHANNELS, DIRECT
from mffit.results import BuildResult
from mffit.rounding import number, stated, times

JUDGED = {
    "distrusted": "NOT TO BE TRUSTED",
    "doubted": "in doubt",
    "sound": "sound",
}
FOR = {
    "turn-slip": "simulators that compute turn slip (USE_MODE {mode:.0f})",
    "normal": "simulators without turn slip (USE_MODE {mode:.0f}); this one if you do not know",
    "both": "either use, each slightly less accurate (USE_MODE {mode:.0f})",
    "temperature": "simulators that know the tyre's temperature; holds at {T:.1f} degC",
}
"""Whom each file is for, by its use."""


class Headline(NamedTuple):
    """A number that a user came for."""

    name: str
    value: str
    note: str


def judged(result: BuildResult) -> str:
    """The judgement in a word."""
    return JUDGED["distrusted" if result.reasons else "doubted" if result.trust.doubts else "sound"]


def verdict(result: BuildResult) -> str:
    """The judgement and the misfit in a sentence."""
    fits = []
    for name, a in result.fit.channels.items():
        if a.n:
            ratio = result.trust.over_noise.get(name)
            noise = f" ({times(ratio, 1.0)} the noise)" if ratio and ratio == ratio else ""
            fits.append(f"{number(a.rmse, digits=3)} {CHANNELS[name].unit} in {name}{noise}")
    what = f"{len(result.points)} points are fitted to {', '.join(fits[:-1])}{' and ' * (len(fits) > 1)}{fits[-1]}"
    return f"{result.tir_path} is {judged(result)}: {what}."


def headlines(result: BuildResult) -> list[Headline]:
    """The four or five numbers that a user came for."""
    nominal = result.measured.nominal
    found = []
    if result.measured.epsilon_gamma is not None and nominal is not None:
        at = f"at {number(nominal.load, 0)} N; PECP1 in the file: {number(result.measured.pecp1, 4)}"
        for name, note in (
            ("epsilon_gamma", at),
            ("C_phit", "turn slip"),
            ("C_alpha_straight", "on a straight path"),
        ):
            known, value = DIRECT[name], getattr(nominal, name)
            if value is not None:
                found.append(
                    Headline(
                        f"{known.word[0].upper()}{known.word[1:]} {known.ascii}",
                        stated(value, known.unit_behind),
                        note,
                    )
                )
    for name, a in result.fit.channels.items():
        if a.n and len(found) < 5:
            ratio = times(result.trust.over_noise.get(name), 1.0)
            note = f"{a.n} points, R2 {number(a.r2, 5)}" + (
                f", {ratio} the noise" if ratio != times(None, 1.0) else ""
            )
            found.append(
                Headline(f"Misfit of {name}, rms", f"{number(a.rmse, digits=3)} {CHANNELS[name].unit}", note)
            )
    return found


def purposes(result: BuildResult) -> dict[str, str]:
    """Whom each written file is for, in words, by its name."""
    warm = result.fit.temperature
    found: dict[str, str] = {}
    for use, name in result.files.items():
        mode = result.tyres[use]["USE_MODE"] if use in result.tyres else 0.0
        text = FOR.get(use, use)
        if use == "normal" and "turn-slip" not in result.files:
            text = "simulators with turn slip off (USE_MODE {mode:.0f})"
        files = result.fit.files
        if use == "normal" and "turn-slip" in result.files and files is not None:
            off = [f"{m.ridden:.3g} {CHANNELS[name].unit}" for name, m in files.by_use[use].straight.items()]
            text += f"; {' and '.join(off)} off the model"
        found.setdefault(name, text.format(mode=mode, T=warm.T_ref if warm else 0.0))
    if result.correction is not None:
        found[result.correction_name] = (
            f"simulations that add what the formula misses to {result.files[result.fitted]}"
        )
    return found

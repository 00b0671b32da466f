"""The summary of a build, for the terminal: one screen, and the rest on request."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from mffit.diagnosis import wording
from mffit.fit import Coefficient, zeros_listed
from mffit.measured import wording as of_direct
from mffit.quantities import CHANNELS
from mffit.report import constants
from mffit.report.text.direct import MAIN, estimates, setups_table, spin_numbers
from mffit.report.text.layout import blocks, cut, paragraphs, table, wrapped
from mffit.report.verdict import headlines, purposes, verdict
from mffit.results import BuildResult
from mffit.rounding import number, times
from tir.errors import counted
from tir.parameters import BY_NAME


def build_summary(result: BuildResult, written: str = "") -> str:
    """What ``mffit build`` prints: the verdict, the files and whom they are for, the numbers, and what to do next."""
    files = [wrapped(f"{name}: for {text}", "  ", "    ") for name, text in purposes(result).items()]
    parts = [
        wrapped(verdict(result)),
        *(cut(f"NOT TO BE TRUSTED: {sentence}.", 2) for sentence in result.reasons[: constants.MOST_REASONS]),
        "\n".join([f"written to {written}", *files] if written else files),
        spin_numbers(result.measured, MAIN)
        if result.measured.epsilon_gamma is not None
        else _of_model(result),
        _misfits(result),
        wrapped(f"zeros of the rig: {zeros}") if (zeros := zeros_listed(result.fit.rig)) else "",
        _next(result),
    ]
    return blocks(parts)


def build_explained(result: BuildResult) -> str:
    """What ``mffit build --explain`` prints besides: what each file is and is not, limits, residuals, statuses."""
    fit, scatter = result.fit, result.measured.setup_scatter
    parts = [
        wrapped(f"NOT TO BE TRUSTED: {sentence}.") for sentence in result.reasons[constants.MOST_REASONS :]
    ]
    if result.measured.epsilon_gamma is not None:
        parts += [spin_numbers(result.measured), estimates(result.measured), setups_table(result.measured)]
        parts.append(wrapped(of_direct.setup_scatter(scatter)) if scatter else "")
    parts += [wrapped(f"Limit: {sentence}.") for sentence in result.trust.remarks]
    parts += [_residuals(result), _statuses(fit.coefficients), *map(wrapped, _by_hand(result))]
    return blocks([*parts, paragraphs(fit.explanations)])


def few(warnings: Iterable[str]) -> list[str]:
    """The first warnings, each cut to two lines, and how many there are."""
    every = list(warnings)
    shown = [cut(sentence, 2, " " * len("warning: ")) for sentence in every[: constants.MOST_REASONS]]
    more = len(every) - len(shown)
    return shown + ([f"{more} more: report.html, --explain or --quiet shows them"] if more > 0 else [])


def _of_model(result: BuildResult) -> str:
    """The numbers that a user came for, a line each."""
    found = headlines(result)
    width = max((len(one.name) for one in found), default=0)
    return "\n".join(f"{one.name:<{width}}  {one.value} {one.reached}".rstrip() for one in found)


def _misfits(result: BuildResult) -> str:
    """A line per fitted channel and radius."""
    fit = result.fit
    radii = fit.radii.agreement(fit.tyre.values)
    found = [(name, a, 1.0, CHANNELS[name].unit) for name, a in fit.channels.items() if a.n]
    found += [("RL" if name == "RL" else "R_e", a, 1e3, "mm") for name, a in radii.items()]
    rows = [
        (
            name,
            str(a.n),
            f"{number(scale * a.rmse, digits=3)} {unit}",
            times(result.trust.over_noise.get(name), 1.0),
            f"{number(scale * a.max_abs, digits=3)} {unit}",
            number(a.r2, 5),
        )
        for name, a, scale, unit in found
    ]
    return table(("fit", "points", "rms", "of noise", "largest", "R2"), rows)


def _next(result: BuildResult) -> str:
    """What to look at, or to do with a sound file."""
    counts = {
        "reading left out by hand": sum(row.count for row in result.left_out if row.by == "hand"),
        "reading without weight": len(result.fit.outliers),
        "sweep in doubt": len(result.fit.doubts),
        "limit of what the file can say": len(result.trust.remarks),
    }
    said = [counted(number, what) for what, number in counts.items() if number]
    look = f"{'; '.join(said)}. " if said else ""
    step = "mffit diagnose names what the model misses; " if result.reasons or result.trust.doubts else ""
    return wrapped(
        f"Next: {look}{step}report.html shows the fit, --explain prints what the files are and are not."
    )


def _residuals(result: BuildResult) -> str:
    """What explains the residuals best, if that is significant or the result is in doubt; and whether they are random."""
    effect, lines = result.remains.effect, []
    if not result.trust.remarks:  # they name it already
        if effect is not None and effect.significant:
            lines.append(wrapped(f"best known effect in the residuals: {wording.best_effect(effect)}"))
        elif result.reasons or result.trust.doubts:
            lines.append("best known effect in the residuals: none known")
    return "\n".join(lines)


def _by_hand(result: BuildResult) -> list[str]:
    """A sentence about the readings that [fit] exclude leaves out."""
    rows = [row for row in result.left_out if row.by == "hand"]
    if not rows:
        return []
    named = "; ".join(f"{row.file}:{row.lines} ({row.why})" for row in rows)
    return [f"left out by hand: {counted(sum(row.count for row in rows), 'reading')}: {named}"]


def _statuses(coefficients: Mapping[str, Coefficient]) -> str:
    counts: dict[str, int] = {}
    for name, c in coefficients.items():
        if BY_NAME[name].section.endswith("_COEFFICIENTS"):
            counts[c.status] = counts.get(c.status, 0) + 1
    text = "coefficients: " + ", ".join(f"{n} {status}" for status, n in counts.items())
    bound = [name for name, c in coefficients.items() if c.at_bound]
    return wrapped(text + (f"; at a bound or limit: {' '.join(bound)}" if bound else ""))

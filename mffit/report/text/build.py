"""The summary of a build, for the terminal."""

from __future__ import annotations

from collections.abc import Mapping

from mffit.diagnosis import wording
from mffit.fit import Coefficient
from mffit.measured import wording as of_direct
from mffit.quantities import CHANNELS
from mffit.report.text.direct import setups_table, spin_numbers
from mffit.report.text.layout import blocks, paragraphs, table, wrapped
from mffit.results import BuildResult
from mffit.rounding import number, times
from tir.errors import counted
from tir.parameters import BY_NAME


def build_summary(result: BuildResult) -> str:
    """The text that ``mffit build`` prints at its end."""
    fit = result.fit
    parts = [wrapped(f"NOT TO BE TRUSTED: {sentence}.") for sentence in result.reasons]
    parts += [wrapped(sentence) for sentence in fit.explanations[:1]]
    if result.measured.epsilon_gamma is not None:
        parts.append(spin_numbers(result.measured))
        parts.append(setups_table(result.measured))
        scatter = result.measured.setup_scatter
        parts.append(wrapped(of_direct.setup_scatter(scatter)) if scatter else "")
    rows = [
        (
            name,
            str(a.n),
            f"{number(a.rmse, digits=3)} {CHANNELS[name].unit}",
            times(result.trust.over_noise.get(name), 1.0),
            f"{number(a.max_abs, digits=3)} {CHANNELS[name].unit}",
            number(a.r2, 5),
        )
        for name, a in fit.channels.items()
        if a.n
    ]
    rows += [
        (
            "RL" if name == "RL" else "R_e",
            str(a.n),
            f"{number(1e3 * a.rmse, digits=3)} mm",
            "-",
            f"{number(1e3 * a.max_abs, digits=3)} mm",
            number(a.r2, 5),
        )
        for name, a in fit.radii.agreement(fit.tyre.values).items()
    ]
    parts.append(table(("fit", "points", "rms", "of noise", "largest", "R2"), rows))
    parts += [wrapped(f"Limit: {sentence}.") for sentence in result.trust.remarks]
    parts.append(_residuals(result))
    parts.append(_statuses(fit.coefficients))
    parts += [wrapped(sentence) for sentence in _by_hand(result)]
    if fit.outliers or fit.doubts:
        parts.append(
            f"readings without weight: {len(fit.outliers)}; doubtful sweeps: {len(fit.doubts)}; see the warnings"
        )
    parts.append(paragraphs(fit.explanations[1:]))
    return blocks(parts)


def _residuals(result: BuildResult) -> str:
    """What explains the residuals best, if that is significant or the result is in doubt; and whether they are random."""
    effect, lines = result.remains.effect, []
    in_doubt = bool(result.reasons or result.trust.doubts)
    if result.trust.remarks:  # they name it already
        pass
    elif effect is not None and effect.significant:
        lines.append(wrapped(f"best known effect in the residuals: {wording.best_effect(effect)}"))
    elif in_doubt:
        lines.append("best known effect in the residuals: none known")
    found = wording.structure(result.remains.structure)
    if found:
        lines.append(wrapped(f"residuals are not random: {found}; plots/structure.png"))
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
        if not BY_NAME[name].section.endswith("_COEFFICIENTS"):
            continue
        counts[c.status] = counts.get(c.status, 0) + 1
    text = "coefficients: " + ", ".join(f"{n} {status}" for status, n in counts.items())
    bound = [name for name, c in coefficients.items() if c.at_bound]
    return text + (f"; at a bound or limit: {' '.join(bound)}" if bound else "")

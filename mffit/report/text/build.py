"""The summary of a build, for the terminal."""

from __future__ import annotations

import math
import statistics
from collections.abc import Mapping

import numpy as np

from mffit.fit import Coefficient
from mffit.measured import setup_notes
from mffit.quantities import CHANNELS
from mffit.report.text.direct import setups_table, spin_numbers
from mffit.report.text.layout import blocks, paragraphs, table, wrapped
from mffit.results import BuildResult
from mffit.rounding import number, times
from tir.parameters import BY_NAME


def build_summary(result: BuildResult) -> str:
    """The text that ``mffit build`` prints at its end."""
    fit = result.fit
    parts = [wrapped(f"NOT TO BE TRUSTED: {sentence}.") for sentence in fit.distrusted]
    parts += [wrapped(sentence) for sentence in fit.explanations[:1]]
    if result.measured.epsilon_gamma is not None:
        parts.append(spin_numbers(result.measured))
        parts.append(setups_table(result.measured))
        scatter = result.measured.setup_scatter
        parts.append(wrapped(setup_notes.setup_scatter(scatter)) if scatter else "")
    noise = {"Fy": _typical(result.points.u_Fy), "Mz": _typical(result.points.u_Mz)}
    rows = [
        (
            name,
            str(a.n),
            f"{number(a.rmse, digits=3)} {channel.unit}",
            times(a.rmse, noise[name]),
            f"{number(a.max_abs, digits=3)} {channel.unit}",
            number(a.r2, 5),
        )
        for name, channel in CHANNELS.items()
        if (a := fit.channels.get(name)) is not None and a.n
    ]
    parts.append(table(("fit", "points", "rms", "of noise", "largest", "R2"), rows))
    parts.append(_statuses(fit.coefficients))
    if fit.outliers or fit.doubts:
        parts.append(
            f"readings without weight: {len(fit.outliers)}; doubtful sweeps: {len(fit.doubts)}; see the warnings"
        )
    parts.append(paragraphs(fit.explanations[1:]))
    return blocks(parts)


def _statuses(coefficients: Mapping[str, Coefficient]) -> str:
    counts: dict[str, int] = {}
    for name, c in coefficients.items():
        if not BY_NAME[name].section.endswith("_COEFFICIENTS"):
            continue
        counts[c.status] = counts.get(c.status, 0) + 1
    text = "coefficients: " + ", ".join(f"{n} {status}" for status, n in counts.items())
    bound = [name for name, c in coefficients.items() if c.at_bound]
    return text + (f"; at a bound: {' '.join(bound)}" if bound else "")


def _typical(u: np.ndarray) -> float:
    """Median of the known uncertainties, which a few doubtful points do not change."""
    known = [x for x in u if math.isfinite(x)]
    return statistics.median(known) if known else math.nan

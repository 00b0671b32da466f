"""What the present sweeps identify, and what they leave open."""

from __future__ import annotations

from collections.abc import Iterator

from mffit.diagnosis.needs import missing
from mffit.effects import CATALOG, Effect
from mffit.fit import FitResult
from mffit.measured import Measured, adding_to_camber
from mffit.planning.knowledge import Knowledge
from mffit.planning.record import Identified, Tie
from mffit.points import Points


def tied_pairs(points: Points) -> Iterator[tuple[Effect, Effect]]:
    """Pairs of effects that may be confused with each other and are visible in the data, each with a single number."""
    by_id = {e.id: e for e in CATALOG if len(e.free) == 1 and e.kind != "environment"}
    seen = set()
    for effect in by_id.values():
        for other in effect.confusable_with:
            pair = frozenset((effect.id, other))
            if (
                other in by_id
                and pair not in seen
                and not missing(effect, points)
                and not missing(by_id[other], points)
            ):
                seen.add(pair)
                yield effect, by_id[other]


def identified(knowledge: Knowledge, found: FitResult, measured: Measured) -> Identified:
    """Coverage, correlations, ties and budget of a build."""
    ties = [
        Tie(a.id, b.id, (knowledge.usual_size(a) / knowledge.u_of_effect([], a, [b])) ** 2)
        for a, b in tied_pairs(knowledge.points)
    ]
    staged = {name for row in found.coverage for name in row.free}
    pairs: dict[frozenset[str], tuple[str, str, float]] = {}
    for name, row in found.coefficients.items():
        if row.correlated_with and name in staged and row.correlated_with in staged:
            pairs.setdefault(
                frozenset((name, row.correlated_with)), (name, row.correlated_with, row.correlation)
            )
    return Identified(
        cover=found.coverage,
        from_prior=tuple(
            n for n, row in found.coefficients.items() if row.status == "regularised" and n in staged
        ),
        correlated=tuple(pairs.values()),
        ties=tuple(ties),
        budget=measured.budget,
        unseen_skew=_unseen_skew(measured),
    )


def _unseen_skew(measured: Measured) -> float | None:
    """Change of eps_gamma by 1 deg of camber skew; None if sweeps in both directions measure it."""
    sources = {declared.source for _, declared in adding_to_camber()}
    line = next((line for line in measured.budget if line.source in sources and line.u), None)
    if line is None or measured.camber_skew is not None:
        return None
    return abs(line.contribution / line.u)

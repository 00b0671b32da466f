"""JSON keys of the other commands' results: ``diagnosis.json``, ``plan.json``, ``compare.json``, ``fleet.json`` and others."""

from __future__ import annotations

import math

from mffit.comparison import Comparison, Difference
from mffit.comparison import wording as compared
from mffit.comparison.record import CurveGap
from mffit.conversion import Conversion, OldConversion
from mffit.conversion import wording as converted
from mffit.diagnosis import AcceptedEffect, Diagnosis, wording
from mffit.diagnosis.limits import Limit
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.result import Apart
from mffit.diagnosis.validation import Gap, Validation
from mffit.fleet import EPSILON, Fleet
from mffit.fleet.hierarchy import Hierarchy, Population
from mffit.fleet.record import FleetScatter, Row
from mffit.planning import Plan, PlannedRun, PlanStep
from mffit.planning import wording as planned
from mffit.planning.goals import Goal
from mffit.points.stretch import stretch_table
from mffit.quantities import column
from mffit.recordings import Sniffed
from mffit.recordings.recording import SniffedRecording
from mffit.recordings.summary import BadRun
from mffit.recordings.unstated import Guess
from mffit.results.as_json.of_build import estimates, of_rig
from mffit.results.campaign import Arrival, WatchedCampaign
from mffit.results.values import document, keys

keys(
    Diagnosis,
    "trusted reasons headline verdict gap_before gap_after gap_by_effect validation where effects alternatives limits "
    "unexplained unexplained_where "
    "noise_floor=noise outliers coefficients model_after model_with_terms advice apart notes lab left_out [made]",
    verdict=lambda found: found.answer.name.lower(),
    gap_by_effect=lambda found: [
        {"id": step.id, "gap": document(step.gap), "held_out": document(step.held_out)}
        for step in found.steps
    ],
    advice=wording.advice,
    effects=lambda found: [document(one) | {"to_do": wording.remedy(one, found)} for one in found.effects],
    alternatives=lambda found: [
        {"id": name, "confidence": weight} for name, weight in found.ranked_alternatives()
    ],
    coefficients=lambda found: estimates(found.coefficients),
    notes=wording.notes,
)
keys(Gap, "**rmse chi2_per_dof", rmse=lambda gap: {column(name, "rmse"): x for name, x in gap.rmse.items()})
keys(Validation, "method gap_before gap_after gap_given_file gain", method=wording.method)
keys(Apart, "where rms largest")
keys(Limit, "id=effect.id of_usual_size=share ruled_out")
keys(
    Noise,
    "**typical source **stated scatter",
    typical=lambda noise: {column(name): noise.typical(name) for name in noise.channels},
    source=wording.source,
    stated=lambda noise: {f"stated_{column(name)}": noise.typically_stated(name) for name in noise.channels},
)
keys(
    AcceptedEffect,
    "id=effect.id name=effect.name kind=effect.kind physics=effect.physics confidence repaired parameters to_do "
    "gap_after tied_with separate_by [T_ref_degC]",
    parameters=lambda found: {
        name: {"was": found.before[name], "value": value, "stderr": u}
        for name, (value, u) in found.parameters.items()
    },
    to_do=lambda _: None,  # by the signs of the rig, which the diagnosis has
    separate_by=lambda found: wording.separation(found.separation),
)

# Uncertainties of a plan are in the goal's unit, k = 1 except for bands; null if not measured.
keys(
    Plan,
    "goal headline promise identified u_now=now u_then=then runs=steps alone=trials",
    headline=planned.headline,
    promise=planned.promise,
    identified=lambda found: planned.identified(found.identified),
)
keys(Goal, "kind name label unit")
keys(PlanStep, "**run u_before=before u_after=after")
keys(PlannedRun, "name kind=addition.id title reason=addition.reason points=cost", title=planned.title)

keys(
    WatchedCampaign,
    "headline changed taken awaited points ±epsilon_gamma before=before.value alignment next spin=measured warnings problem?",
    next=lambda found: (
        found.next_run and {**document(found.next_run.step), "goal": found.next_run.goal.label}
    ),
)
keys(Arrival, "file state points why? sweep?")

keys(Comparison, "first second headline numbers coefficients curves sweeps notes", headline=compared.headline)
keys(Difference, "* change u_change=u in_u=z")
keys(
    CurveGap,
    "channel over load_N rms largest=largest.0 **at",
    at=lambda gap: (
        {"at_kappa": gap.largest[1]} if gap.over == "kappa" else {"at_deg": math.degrees(gap.largest[1])}
    ),
)

keys(Fleet, "tyres=rows scatter rigs notes", scatter=lambda found: _scatters(found))
keys(
    Row,
    "name=specimen.name folder=specimen.folder rig epsilon_gamma **numbers rmse=specimen.misfit strain "
    "warnings=specimen.warnings",
    rig=lambda row: row.rig + 1,
    epsilon_gamma=lambda row: {key: getattr(row, key) for key in EPSILON},
)
keys(FleetScatter, "* beyond")
keys(Hierarchy, "errors population", errors=lambda rig: of_rig(rig.rig))
keys(Population, "* assumed")


def _scatters(found: Fleet) -> dict[str, object]:
    """JSON of the scatter of every number that at least two tyres have."""
    names = {key: f"epsilon_gamma_{key}" for key in EPSILON} | {key: key for key in found.rows[0].numbers}
    return {name: scatter for key, name in names.items() if (scatter := found.scatter(key)) is not None}


# Conditions of recordings are in SI.
keys(
    Sniffed,
    "recordings axes conditions points bad_runs stretches warnings",
    points=lambda found: len(found.points),
    stretches=lambda found: stretch_table(found.reading.stretches).to_dict("records"),
    warnings=lambda found: [*found.reading.notes, *found.reading.warnings],
)
keys(
    SniffedRecording,
    "file=path format=kind samples rate_Hz seconds gaps units channels=guesses remarks",
    units=lambda row: dict(zip(row.headings, row.units, strict=True)),
)
keys(Guess, "* channel=channel.name")
keys(BadRun, "file=recording lines why")

keys(
    Conversion,
    "kind=old.kind trusted reasons ranges=reach fitted curvature_held_to_1=held misfit problems=old.problems",
    trusted=lambda found: not converted.reasons(found),
    reasons=converted.reasons,
)
keys(
    OldConversion,
    "kind trusted reasons ranges=reach fitted misfit",
    trusted=lambda found: not converted.reasons(found),
    reasons=converted.reasons,
)

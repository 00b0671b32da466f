"""All suspicions, in the order in which they are applied.

Each rule is made beside the function that finds its cases, and ``applying`` runs them. Two kinds of checks are elsewhere:
values outside the range of their column end the reading of a file (``sweeps``), and the fit decides the weight of single
readings.
"""

from __future__ import annotations

from mffit.points.faulty import FAULTS
from mffit.suspicion import (
    all_files,
    declarations,
    misread,
    other_tyre,
    others,
    outliers,
    single_files,
    slopes,
    trust,
)
from mffit.suspicion.rule import Outcome, Rule, Subject, When

SAMPLES = tuple(
    Rule(
        id=fault.id,
        when=(When.READING,),
        subject=Subject.SAMPLES,
        looks_at=fault.looks_at,
        limits=fault.limits,
        outcome=Outcome.LEFT_OUT,
        sentence=fault.reason,
        find=fault.find,
    )
    for fault in FAULTS
)
"""Applied by ``points.reduction``, which leaves these samples out of its means."""

RULES: tuple[Rule, ...] = (
    *SAMPLES,
    all_files.copied_sweep,
    other_tyre.two_tyres,
    other_tyre.other_radius,
    all_files.nominal_load_of_others,
    single_files.dead_channel,
    single_files.lone_load,
    single_files.wild_force,
    single_files.impossible_file,
    *slopes.NO_TYRE,
    declarations.contradicted,
    all_files.reversed_file,
    all_files.other_moment_point,
    all_files.one_sided_on_disc,
    all_files.no_zero_on_disc,
    all_files.lone_lean,
    all_files.moment_reversed,
    all_files.weak_turn_slip,
    all_files.nominal_load_above_all,
    all_files.hot_tread,
    others.known_mistake,
    others.implausible_sweep,
    others.doubtful_sweep,
    outliers.OUTLYING,
    *trust.OF_TRUST,
    misread.misread_sweep,
)

"""All rules of suspicion, in the order of their application.

Each rule is defined in the module of its finder. Two checks are elsewhere: ``sweeps`` refuses values outside the range of their
column when it reads a file, and the fit decides the weight of single readings.
"""

import numpy as np

from mffit.config import Config
from mffit.config.loading import as_declared
from mffit.points import Points
from mffit.points.faulty import FAULTS
from mffit.suspicion import all_files, declarations, mounts, other_tyre, others, single_files, slopes, trust
from mffit.suspicion.misread import misread_sweep
from mffit.suspicion.outliers import OUTLYING
from mffit.suspicion.reversals import TURNING
from mffit.suspicion.rule import Outcome, Rule, When

SAMPLES = tuple(
    Rule(
        id=fault.id,
        when=When.READING,
        looks_at=fault.looks_at,
        outcome=Outcome.LEFT_OUT,
        sentence=fault.reason,
        find=fault.find,
    )
    for fault in FAULTS
)
"""Rules for single samples, applied by ``points.reduction``, which leaves the found samples out of its means."""

RULES: tuple[Rule, ...] = (
    *SAMPLES,
    other_tyre.named_tyres,
    all_files.copied_sweep,
    single_files.repeated_rows,
    other_tyre.two_tyres,
    other_tyre.other_radius,
    single_files.dead_channel,
    single_files.lone_load,
    single_files.wild_force,
    single_files.unusual_file,
    *slopes.NO_TYRE,
    declarations.contradicted,
    declarations.other_frame,
    all_files.reversed_file,
    all_files.other_moment_point,
    all_files.one_sided_on_disc,
    all_files.no_zero_on_disc,
    all_files.moment_reversed,
    all_files.angles_exchanged,
    all_files.weak_turn_slip,
    all_files.nominal_load_of_others,
    all_files.hot_tread,
    all_files.angles_fit_exchanged,
    others.contradicting_sweep,
    others.doubtful_sweep,
    mounts.undeclared_mount,
    OUTLYING,
    TURNING,
    *trust.OF_TRUST,
    misread_sweep,
)


def before_the_fit(points: Points, config: Config) -> tuple[str, ...]:
    """Warnings about points that are implausible under their declaration.

    Driven and braked points are not judged if there are free-rolling ones, nor, on a disc, the samples of moving sweeps.

    Raises InputError if the points contradict every tyre or the declaration, or lack points that a disc needs.
    """
    judged = points.select(~points.continuous) if config.rig.on_disc else points
    if np.any(judged.free_rolling) and not np.all(judged.free_rolling):
        judged = judged.select(judged.free_rolling)
    warnings = []
    with as_declared(config):
        for rule in RULES:
            if rule.when is not When.BEFORE or rule.outcome is Outcome.CONTRADICTION:
                continue
            for facts in rule.find(points if rule.of_all else judged, config):
                found = rule.refusal(facts)
                if not rule.only_asks(facts):
                    raise found
                warnings.append(str(found))
    return tuple(warnings)

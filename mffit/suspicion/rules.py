"""All suspicions, in the order in which they are applied: what each looks at, when, its limits, outcome and sentence.

The functions named here find the cases, and ``applying`` runs them. Two kinds of checks are elsewhere: values outside the
range of their column end the reading of a file (``sweeps``), and the fit decides the weight of single readings.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from mffit.constants import EXPLAINED_SHARE, ZERO_CAMBER, ZERO_SIDESLIP
from mffit.points.faulty import FAULTS
from mffit.suspicion import all_files, constants, declarations, misread, others, outliers, single_files, trust
from mffit.suspicion.rule import Finding, Outcome, Rule, Subject, When
from mffit.suspicion.slopes import Signatures


def _where(holds: Callable[[Signatures], bool], column: str, **facts: Callable[[Signatures], float]):
    """A function that finds one case if something holds for the signatures."""

    def find(found: Signatures) -> Iterator[Finding]:
        if holds(found):
            yield Finding({name: fact(found) for name, fact in facts.items()}, column=column)

    return find


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

NO_TYRE = (
    Rule(
        id="force-rises-with-sideslip",
        subject=Subject.SIGN,
        looks_at="slope of Fy over sideslip, rolling forwards",
        limits=(constants.CHANCE_OF_OTHER_SIGN,),
        outcome=Outcome.CONTRADICTION,
        sentence="Fy_N rises with alpha_deg",
        find=_where(lambda found: found.cornering.sign > 0, "alpha_deg"),
    ),
    Rule(
        id="force-rises-with-camber",
        subject=Subject.SIGN,
        looks_at="slope of Fy over camber, rolling forwards",
        limits=(constants.CHANCE_OF_OTHER_SIGN,),
        outcome=Outcome.CONTRADICTION,
        sentence="Fy_N rises with gamma_deg",
        find=_where(lambda found: found.camber.sign > 0, "gamma_deg"),
    ),
    Rule(
        id="camber-force-too-steep",
        subject=Subject.SIZE,
        looks_at="slope of Fy per load over camber, plus two standard errors",
        limits=(constants.STEEPEST_CAMBER_STIFFNESS,),
        outcome=Outcome.CONTRADICTION,
        sentence="Fy_N falls by {slope:.1f} times the load per radian of gamma_deg",
        find=_where(
            lambda found: found.camber.value + 2.0 * found.camber.error < constants.STEEPEST_CAMBER_STIFFNESS,
            "gamma_deg",
            slope=lambda found: -found.camber.value,
        ),
    ),
    Rule(
        id="camber-thrust",
        subject=Subject.SIZE,
        looks_at="-Fy over Fz tan(gamma) at large camber of both signs",
        limits=(constants.SMALLEST_CAMBER_THRUST, constants.LARGEST_CAMBER_THRUST),
        outcome=Outcome.CONTRADICTION,
        sentence="Fy_N at large gamma_deg is {thrust:.2f} Fz tan(gamma)",
        find=_where(
            lambda found: (
                found.thrust < constants.SMALLEST_CAMBER_THRUST
                or found.thrust > constants.LARGEST_CAMBER_THRUST
            ),
            "gamma_deg",
            thrust=lambda found: -found.thrust,
        ),
    ),
    Rule(
        id="moment-falls-with-sideslip",
        subject=Subject.SIGN,
        looks_at="slope of Mz over sideslip, rolling forwards",
        limits=(constants.CHANCE_OF_OTHER_SIGN,),
        outcome=Outcome.CONTRADICTION,
        sentence="Mz_Nm falls with alpha_deg",
        find=_where(lambda found: found.aligning.sign < 0, "Mz_Nm"),
    ),
    Rule(
        id="force-falls-with-sideslip-backwards",
        subject=Subject.SIGN,
        looks_at="slope of Fy over sideslip, rolling backwards",
        limits=(constants.CHANCE_OF_OTHER_SIGN,),
        outcome=Outcome.CONTRADICTION,
        sentence="Fy_N falls with alpha_deg in backward runs",
        find=_where(lambda found: found.backward.sign < 0, "alpha_deg"),
    ),
    Rule(
        id="turn-slip-force-inwards",
        subject=Subject.SIZE,
        looks_at="Fy per load at alpha = gamma = 0, outwards, mean of both directions",
        limits=(constants.WEAK_TURN_SLIP_FORCE,),
        outcome=Outcome.CONTRADICTION,
        sentence="Fy_N at alpha = gamma = 0 points towards the declared centre of the path",
        find=_where(lambda found: found.outward < -constants.WEAK_TURN_SLIP_FORCE, "Fy_N"),
    ),
)
"""What no tyre does; ``declaration-contradicted`` joins these to one sentence."""
SIGNS = tuple(rule for rule in NO_TYRE if rule.subject is Subject.SIGN)

RULES: tuple[Rule, ...] = (
    *SAMPLES,
    Rule(
        id="copied-sweep",
        subject=Subject.ALL_FILES,
        looks_at="readings of a sweep that are all in another sweep",
        limits=(constants.FEWEST_ROWS_OF_A_COPY,),
        sentence="holds exactly the readings of {first}; remove one of the two, or correct the one that was copied by mistake",
        find=all_files.copied_sweep,
    ),
    Rule(
        id="angle-in-radians",
        subject=Subject.FILE,
        looks_at="slope of Fy per load over sideslip and over camber, forwards and backwards",
        limits=(constants.STEEPEST_OVER_SIDESLIP, constants.STEEPEST_OVER_CAMBER),
        sentence=(
            "reaches only {largest:.3g} deg, over which the side force changes by {steepness:.0f} times the load per radian; "
            'the angles look like radians: write degrees, or {column} = {{ column = "{column}", unit = "rad" }} under '
            "[sweep.columns]"
        ),
        find=single_files.angle_in_radians,
    ),
    Rule(
        id="dead-channel",
        subject=Subject.FILE,
        looks_at="Mz and Fy that are the same in every row although the angles change",
        limits=(constants.FEWEST_ROWS_OF_A_DEAD_CHANNEL,),
        sentence="is {reading:g} in every row, so the channel was dead; {remedy}",
        find=single_files.dead_channel,
    ),
    Rule(
        id="force-in-kilonewtons",
        subject=Subject.FILE,
        looks_at="largest Fy per load at angles that show a force",
        limits=(
            constants.SIDESLIP_THAT_SHOWS_FORCE,
            constants.CAMBER_THAT_SHOWS_FORCE,
            constants.SMALLEST_FRICTION,
        ),
        sentence=(
            "is at most {largest:.3g} N at loads of {load:.0f} N, which looks like kN; write newtons, or "
            'Fy_N = {{ column = "Fy_N", unit = "kN" }} under [sweep.columns]'
        ),
        find=single_files.force_too_small,
    ),
    Rule(
        id="lone-load",
        subject=Subject.FILE,
        looks_at="largest load over all others of the file",
        limits=(constants.LONE_LOAD, constants.FEWEST_ROWS_OF_A_LONE_LOAD),
        sentence=(
            "{load:.6g} N is far above all other loads of the file, which are at most {others:.6g} N; correct or remove the row"
        ),
        find=single_files.lone_load,
    ),
    Rule(
        id="wild-force",
        subject=Subject.FILE,
        looks_at="Fy per load of one or two rows",
        limits=(constants.LARGEST_FRICTION,),
        sentence="{force:.6g} N is {friction:.0f} times the load, which no tyre reaches; correct or remove the row",
        find=single_files.wild_force,
    ),
    Rule(
        id="load-in-another-unit",
        subject=Subject.FILE,
        looks_at="Fy per load of more rows",
        limits=(constants.LARGEST_FRICTION, constants.FEWEST_POINTS_OF_FRICTION),
        sentence=(
            "side forces reach {friction:.0f} times the load ({load:.0f} N), which no tyre does: the load looks like kgf, or "
            'the force like another unit; map it with its unit, Fz_N = {{ column = "Fz_N", unit = "kgf" }} in [sweep.columns]'
        ),
        find=single_files.load_in_another_unit,
    ),
    Rule(
        id="moment-in-newton-millimetres",
        subject=Subject.FILE,
        looks_at="|Mz| over load",
        limits=(constants.LONGEST_ARM,),
        sentence="reaches {arm:.0f} m times the load, which looks like N mm; name its unit under [sweep.columns]",
        find=single_files.arm_too_long,
    ),
    Rule(
        id="pressure-in-psi",
        subject=Subject.FILE,
        looks_at="median pressure over the nominal one, as it is and read as psi",
        limits=(constants.LOWEST_TESTED_PRESSURE,),
        sentence=(
            "is {pressure:.3g} kPa, far from the nominal {nominal:.3g} kPa, and looks like psi; write kPa, or "
            'p_kPa = {{ column = "p_kPa", unit = "psi" }} under [sweep.columns]'
        ),
        find=single_files.pressure_in_psi,
    ),
    *NO_TYRE,
    Rule(
        id="declaration-contradicted",
        subject=Subject.ALL_FILES,
        looks_at="the contradictions above, under the declared and under all other axes, frames and path centres",
        limits=(constants.WEAKEST_CAMBER_STIFFNESS,),
        sentence="with {declared}, {wrong} in ISO signs, which no tyre does; {remedy}",
        find=partial(declarations.contradicted, slope_rules=NO_TYRE),
    ),
    Rule(
        id="reversed-file",
        subject=Subject.ALL_FILES,
        looks_at="the signs of the slopes above, file by file, with the scatter of all files",
        limits=(constants.CHANCE_OF_OTHER_SIGN,),
        sentence=(
            "{what} {where}, against all the others: its sign or its direction of rolling looks reversed; correct the file, "
            'write direction = "backward" in its [[sweep]], or map {column} with scale = -1 under [sweep.columns]'
        ),
        find=partial(all_files.reversed_file, signs=SIGNS),
    ),
    Rule(
        id="moments-about-another-point",
        subject=Subject.ALL_FILES,
        looks_at="lever arm of Mx over Fy of the upright wheel, per unloaded radius",
        limits=(
            constants.LEVER_OF_OTHER_MOMENT_POINT,
            constants.UPRIGHT_FOR_MOMENT_POINT,
            constants.FORCE_RANGE_OF_MOMENT_POINT,
            constants.FEWEST_POINTS_OF_MOMENT_POINT,
        ),
        sentence=(
            'with moments = "{declared}", Mx_Nm changes by {lever:.2f} m times Fy_N, which is about the wheel\'s radius; about '
            'the contact point it hardly changes; the data agree with moments = "{other}"'
        ),
        find=all_files.other_moment_point,
    ),
    Rule(
        id="one-sided-on-a-disc",
        subject=Subject.ALL_FILES,
        looks_at="signs of the angles on a disc",
        limits=(ZERO_SIDESLIP, ZERO_CAMBER),
        sentence=(
            "runs only from {smallest:.3g} to {largest:.3g} deg in ISO signs, and on a disc both signs are needed to separate "
            "turn slip; add the mirrored points"
        ),
        find=all_files.one_sided_on_disc,
    ),
    Rule(
        id="no-zero-on-a-disc",
        subject=Subject.ALL_FILES,
        looks_at="forward points at alpha = gamma = 0 on a disc",
        limits=(ZERO_SIDESLIP, ZERO_CAMBER),
        sentence=(
            "no forward point has alpha_deg = 0 and gamma_deg = 0, where the turn-slip force is measured; add one per load"
        ),
        find=all_files.no_zero_on_disc,
    ),
    Rule(
        id="lone-lean",
        subject=Subject.ALL_FILES,
        looks_at="sign of camber, sweep by sweep",
        limits=(constants.LEANING, constants.FEWEST_LEANING_SWEEPS),
        outcome=Outcome.WARNED,
        sentence=(
            "{sweep} leans {degrees:.1f} deg to the other side than all {others} other sweeps with camber: if that was not "
            "intended, correct the sign of its gamma_deg"
        ),
        find=all_files.lone_lean,
    ),
    Rule(
        id="weak-turn-slip-force",
        subject=Subject.ALL_FILES,
        looks_at="Fy per load at alpha = gamma = 0, outwards, mean of both directions",
        limits=(constants.WEAK_TURN_SLIP_FORCE,),
        outcome=Outcome.WARNED,
        sentence=(
            "the force at alpha = gamma = 0 is {percent:.1f} % of the load along the turn slip, too little to measure turn "
            "slip; check the alignment of the sideslip axis"
        ),
        find=all_files.weak_turn_slip,
    ),
    Rule(
        id="known-mistake",
        when=(When.FIRST, When.AFTER),
        subject=Subject.SWEEP,
        looks_at="error of the prediction from all other sweeps, as it is and with each known mistake undone",
        limits=(
            constants.FALSE_ALARM_OF_SWEEPS,
            constants.GROSS_SHARE,
            EXPLAINED_SHARE,
            constants.MATCHED_SHARE,
        ),
        sentence=(
            "contradicts all other sweeps: predicted from them, {channel} is out by {rms:.3g} {unit}, at least {percent:.0f} % "
            "of its usual size{condition}; it looks like {looks}, which leaves {left:.2g} %: {remedy}"
        ),
        find=others.known_mistake,
    ),
    Rule(
        id="implausible-sweep",
        when=(When.AFTER,),
        subject=Subject.SWEEP,
        looks_at="error of the prediction from all other sweeps, and uncertainty of the prediction",
        limits=(constants.FALSE_ALARM_OF_SWEEPS, constants.IMPLAUSIBLE_SHARE, constants.GROSS_SHARE),
        sentence=(
            "contradicts all other sweeps: predicted from them, {channel} is out by {rms:.3g} {unit}, at least {percent:.0f} % "
            "of its usual size{condition}, and no reversed sign, exchanged column or unit explains it; check this "
            "file{perhaps}, or leave it out"
        ),
        find=others.implausible_sweep,
    ),
    Rule(
        id="doubtful-sweep",
        when=(When.AFTER,),
        subject=Subject.SWEEP,
        looks_at="error of the prediction from all other sweeps, beside the errors of the other sweeps",
        limits=(
            constants.FALSE_ALARM_OF_SWEEPS,
            constants.DOUBTFUL_SHARE,
            constants.EXPLAINED_BY_ONE_NUMBER,
        ),
        outcome=Outcome.WARNED,
        sentence=(
            "{sweep} does not fit the other sweeps: predicted from them, {channel} is out by {rms:.3g} {unit}, at least "
            "{percent:.0f} % of its usual size and {ratio:.1f} times what noise and model explain{explained}; check this sweep "
            "or repeat it"
        ),
        find=others.doubtful_sweep,
    ),
    Rule(
        id="outlying-reading",
        when=(When.AFTER,),
        subject=Subject.READINGS,
        looks_at="residual, and its distance from the neighbours' residuals in the sweep; the weights of the fit have the limits",
        outcome=Outcome.LEFT_OUT,
        sentence="readings that do not fit their sweep have no weight ({number}): {named}; correct or remove what is wrong",
        find=outliers.outliers,
    ),
    Rule(
        id="misfit-above-noise",
        when=(When.AFTER,),
        subject=Subject.MODEL,
        looks_at="misfit of the model over the stated uncertainty, channel by channel",
        limits=(constants.MISFIT_OVER_NOISE, constants.CARRIED_MISFIT),
        outcome=Outcome.DISTRUSTED,
        sentence=(
            "the file is not to be trusted: the model misses {channel} by {scale:.1f} times the stated uncertainty{carriers}; "
            "look at these sweeps, or run mffit diagnose"
        ),
        find=trust.above_noise,
    ),
    Rule(
        id="unexplained-variance",
        when=(When.AFTER,),
        subject=Subject.MODEL,
        looks_at="share of a channel's variance that the model explains",
        limits=(constants.EXPLAINED_VARIANCE,),
        outcome=Outcome.DISTRUSTED,
        sentence=(
            "the file is not to be trusted: the model explains {percent:.0f} % of the variance of {channel}; are these "
            "readings of free rolling at steady state, and their units and axes right?"
        ),
        find=trust.unexplained,
    ),
    Rule(
        id="misread-sweep",
        when=(When.DIAGNOSIS,),
        subject=Subject.SIMULATION,
        looks_at="median error of the simulation over the usual size of the channel, with each known mistake undone",
        limits=(
            constants.MISREAD_SHARE,
            constants.MISREAD_OVER_USUAL,
            constants.MISREAD_OVER_WORST,
            EXPLAINED_SHARE,
            constants.CORRECTED_OVER_USUAL,
        ),
        outcome=Outcome.LEFT_OUT,
        sentence=(
            "{file}: {sweep} misses the simulation by {percent:.0f} % of what sweeps usually read, as no other does; it looks "
            "like {looks}, which leaves {left:.2g} %. It was left out. In column {column}: {remedy}."
        ),
        find=misread.misread_sweep,
    ),
)

"""Limits of the suspicions, and what the checks behind them need."""

from __future__ import annotations

from tir.constant import Count, Real

# Slopes and forces whose sign and size all tyres share
SIDESLIP_OF_SLOPES = Real(4.0, "deg", "Up to this sideslip the side force is read as a straight line.")
CAMBER_OF_SLOPES = Real(25.0, "deg", "Up to this camber the camber force is read as a straight line.")
SIDESLIP_OF_MOMENT_SLOPE = Real(3.0, "deg", "The aligning moment turns back earlier than the side force.")
UPRIGHT_FOR_SLOPES = Real(5.0, "deg", "Up to this camber a sweep of sideslip counts as run upright.")
STRAIGHT_FOR_SLOPES = Real(1.5, "deg", "Up to this sideslip a sweep of camber counts as run straight.")
CAMBER_OF_THRUST = Real(20.0, "deg", "From this camber on, the camber force over tan(gamma) is compared.")
CHANCE_OF_OTHER_SIGN = Real(
    3e-5,
    "-",
    "A slope has a sign if Student's t leaves less than this to the other one: 4 standard errors of many points.",
)
SMALLEST_RANGE_OF_SLOPE = Real(0.02, "deg", "Angles that vary by less than this determine no slope.")
FEWEST_POINTS_OF_SLOPE = Count(4, "-", "Fewer points give no slope with a standard error.")
WEAK_TURN_SLIP_FORCE = Real(0.01, "-", "A turn-slip force below this share of the load has no direction.")
STEEPEST_CAMBER_STIFFNESS = Real(-1.9, "1/rad", "No tyre is steeper, per load; a wrong frame shifts it by 1.")
WEAKEST_CAMBER_STIFFNESS = Real(-0.2, "1/rad", "Per load; data must show it under a proposed declaration.")
SMALLEST_CAMBER_THRUST = Real(0.1, "-", "Every tyre has more, as Fy/Fz over tan(gamma); wrong frames take 1.")
LARGEST_CAMBER_THRUST = Real(1.5, "-", "No tyre reaches it, as Fy over Fz tan(gamma); a wrong frame adds 1.")
CONTRADICTIONS_IN_SENTENCE = Count(2, "-", "Contradictions of a declaration that the sentence names.")
UPRIGHT_FOR_MOMENT_POINT = Real(2.0, "deg", "Camber up to which the lever arm of Mx over Fy is read.")
FEWEST_POINTS_OF_MOMENT_POINT = Count(10, "-", "Points from which the lever arm of Mx over Fy is read.")
FORCE_RANGE_OF_MOMENT_POINT = Real(0.5, "-", "Range of Fy per load that the lever arm of Mx over Fy needs.")
LEVER_OF_OTHER_MOMENT_POINT = Real(0.5, "-", "Lever arm of Mx over Fy, per radius, about another point.")

# Single files
STEEPEST_OVER_SIDESLIP = Real(120.0, "1/rad", "No tyre comes near, per load; radians as degrees are 57-fold.")
STEEPEST_OVER_CAMBER = Real(12.0, "1/rad", "No tyre comes near, per load; radians as degrees are 57-fold.")
SIDESLIP_THAT_SHOWS_FORCE = Real(2.0, "deg", "Beyond this sideslip every tyre has a side force.")
CAMBER_THAT_SHOWS_FORCE = Real(5.0, "deg", "Beyond this camber every tyre has a side force.")
FEWEST_POINTS_OF_FRICTION = Count(3, "-", "Fewer points with an odd force per load are single wild readings.")
SMALLEST_FRICTION = Real(0.02, "-", "Side force per load that every tyre exceeds at those angles.")
LARGEST_FRICTION = Real(4.0, "-", "Side force per load that no tyre reaches.")
LONGEST_ARM = Real(1.0, "m", "|Mz| over load that no tyre reaches.")
LOWEST_TESTED_PRESSURE = Real(0.35, "-", "No tyre is tested below this share of its nominal pressure.")
FEWEST_ROWS_OF_A_DEAD_CHANNEL = Count(4, "-", "Rows of one and the same reading that mean a dead channel.")
FEWEST_ROWS_OF_A_LONE_LOAD = Count(4, "-", "Rows from which one load can be far from all others.")
LONE_LOAD = Real(5.0, "-", "A load this many times all others of its file is a wild reading.")

# All files together
FEWEST_ROWS_OF_A_COPY = Count(4, "-", "Equal rows that are no chance: two measurements scatter differently.")
LEANING = Real(0.5, "deg", "From this camber on a wheel leans to one side.")
FEWEST_LEANING_SWEEPS = Count(4, "-", "Sweeps with camber that are needed to call one of them the odd one.")

# Every sweep against all others; shares are errors of a prediction over the usual size of the channel
FALSE_ALARM_OF_SWEEPS = Real(0.01, "-", "Chance of any significant sweep in a sound campaign (Bonferroni).")
SHARE_OF_WORST_POINTS = Real(0.2, "-", "Worst points of a sweep that do not count, as wild readings do not.")
SURE_ERRORS = Real(3.0, "-", "Standard errors of a prediction that are subtracted before its error counts.")
DOUBTFUL_SHARE = Real(0.05, "-", "An error that the repeatability of a rig does not explain.")
GROSS_SHARE = Real(0.1, "-", "An error from which on known mistakes are tried.")
IMPLAUSIBLE_SHARE = Real(0.5, "-", "An error that is refused although no known mistake explains it.")
MATCHED_SHARE = Real(0.5, "-", "Largest misfit with a mistake undone, per size predicted and measured.")
MOST_SUSPECTS = Count(6, "-", "Suspected sweeps, worst first, for which the fit is repeated without them.")
FEWEST_POINTS_OF_A_SWEEP = Count(4, "-", "Points from which a sweep is predicted from all others.")
LARGEST_SWEEP = Real(0.5, "-", "Share of all points above which the others do not predict a sweep.")
FEWEST_SWEEPS_TO_COMPARE = Count(3, "-", "Sweeps from which each is predicted from all others.")
INFORMATION_OF_OTHERS = Real(
    1e-3,
    "-",
    "Smallest share of the information about a direction that the other sweeps must supply to predict it.",
)
MOST_POINTS_SHOWN = Count(300, "-", "Points at which a sweep is predicted; of more, some evenly spaced ones.")
EXPLAINED_BY_ONE_NUMBER = Real(0.8, "-", "Share of the sum of squares that the words for a doubt explain.")

# The fitted model
MISFIT_OVER_NOISE = Real(2.0, "-", "Misfit per stated noise above which a file is not to be trusted.")
EXPLAINED_VARIANCE = Real(0.5, "-", "Share of a channel's variance that a trusted model explains.")
CARRIED_MISFIT = Real(1.5, "-", "A sweep is named if its misfit is this many times that of all points.")
SWEEPS_NAMED_WITH_MISFIT = Count(3, "-", "Sweeps named with a misfit.")
OUTLIERS_IN_SENTENCE = Count(5, "-", "Outlying readings that the sentence names.")

# One sweep against a simulation; shares are median errors over the usual size of the channel
MISREAD_SHARE = Real(0.15, "-", "An error from which on a diagnosis looks at a sweep.")
MISREAD_OVER_USUAL = Real(3.0, "-", "Error of a misread sweep over the median error of all sweeps.")
MISREAD_OVER_WORST = Real(2.0, "-", "Error of a misread sweep over any other's; wrong models miss several.")
CORRECTED_OVER_USUAL = Real(1.5, "-", "Error of a misread sweep over the median, with its mistake undone.")
FEWEST_SWEEPS_FOR_MISREAD = Count(4, "-", "Sweeps from which one can be the misread one.")
FEWEST_POINTS_OF_A_MISREAD_SWEEP = Count(3, "-", "Points from which a sweep is compared with a simulation.")

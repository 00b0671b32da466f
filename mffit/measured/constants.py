"""Numbers of judgement of the direct method."""

from __future__ import annotations

from tir.constant import Count, Real

GUESSED_STIFFNESS_U = Real(
    0.5,
    "-",
    "Relative standard uncertainty of the usual cornering stiffness: tyres of cars and motorcycles have 5 to 25 1/rad.",
)
LARGEST_DIFFERENCE = Real(
    50.0,
    "N",
    "Difference of forward and backward zeros above which the axis counts as not aligned.",
    "Mottola and Massaro 2022, section 3",
)
AXIS_RESOLUTION = Real(0.01, "deg", "Smallest angle by which a sideslip axis can usually be turned.")
SAME_ZERO = Real(0.1, "N", "Zeros that differ by less are shown as one number.")

AVERAGED_ZEROS = Real(0.05, "deg", "Zeros whose sideslip differs by less are averaged.")
SMALLEST_SIDESLIP = Real(0.15, "deg", "Points of a sideslip sweep below this angle count as zeros.")
PARABOLA_SIDESLIP = Real(1.2, "deg", "Within this sideslip a parabola describes the side force to a newton.")
POINTS_FOR_PARABOLA = Count(
    5, "-", "Different angles near zero from which a parabola gives the zero better than the mean."
)
UNLIKE_ZEROS = Real(
    5.0, "-", "Standard uncertainties of the difference beyond which two zeros cannot come from one path."
)

CUBIC_CAMBER = Real(
    20.0,
    "deg",
    "Up to this camber a cubic describes the odd camber curve; to 50 deg it is as biased as the secant.",
    "docs/method.md",
)
CUBIC_SIDESLIP = Real(2.0, "deg", "Up to this sideslip a cubic describes the odd sideslip curve.")
SHORTEST_CAMBER_SWEEP = Real(10.0, "deg", "A camber sweep must reach this angle for its slope at zero.")
SLOPE_WITHOUT_CUBIC = Real(
    0.05,
    "-",
    "Relative difference of shapes assumed for a slope that no cubic can check, as too few points are near zero.",
)
SECANT_REACH = Real(
    0.02, "-", "Relative distance from the secant's angle at which a point still counts as measured there."
)

NEAREST_RADIUS_LOAD = Real(
    0.02, "-", "Relative difference of load up to which a measured effective radius is used as it was read."
)
LEAST_RADIUS_U = Real(
    1e-5, "m", "Smallest standard uncertainty of an effective radius as a reading of the fit."
)
LARGEST_EPSILON = Real(0.9, "-", "PECP2 is not written if eps_gamma would reach this within the loads.")
SIGNIFICANT_SLOPE = Real(
    2.0, "-", "Standard uncertainties that a slope of eps_gamma over load must exceed to be written."
)
CLEAR_MOMENT = Real(
    2.0, "-", "Standard uncertainties that the turn-slip moment must exceed for an eps_gamma of its own."
)

FINITE_SPIN_SHARE = Real(
    0.05,
    "m^2",
    "Standard uncertainty of the share by which C_phit falls per square of the turn slip.",
    "the sample tyres have 0.03",
)
CONTRADICTION_CHANCE = Real(
    1e-3, "-", "Probability below which the stiffnesses of the paths are said to contradict each other."
)
SHARED_ERROR_RIDGE = Real(
    1e-9,
    "-",
    "Share of the variances that keeps the weights of paths defined if all their errors are shared.",
)
MONTE_CARLO_DRAWS = Count(20_000, "-", "Random draws for u(eps_gamma): its own error is then below 1 %.")
EXACT_U = Real(1e-12, "-", "Replaces a standard uncertainty of zero, which the propagation does not accept.")
PLAUSIBLE_CONICITY = Real(0.002, "-", "Plausible conicity force over the load.")
PLAY_DOUBT_MOMENT = Real(
    1e3, "Nm", "Moment assumed for points without Mz, whose sign alone decides the side of the play."
)

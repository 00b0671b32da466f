"""Numbers of judgement of the direct method."""

from tir.constant import Count, Real, Series

GUESSED_STIFFNESS_U = Real(
    0.5, "-", "Relative standard uncertainty of the usual cornering stiffness: tyres have 5 to 25 1/rad."
)
USUAL_RELAXATION = Real(
    1.2,
    "-",
    "Usual lateral relaxation length over the unloaded radius: tyres have 0.5 of motorcycles to 2 of cars.",
)

PARABOLA_SIDESLIP = Real(1.2, "deg", "Sideslip within which a parabola describes the side force to a newton.")
POINTS_FOR_PARABOLA = Count(
    5, "-", "Fewest angles near zero from which a parabola gives the zero better than a mean."
)

CUBIC_SIDESLIP = Real(2.0, "deg", "Sideslip up to which a polynomial describes the odd curve.")
SLOPE_WITHOUT_CUBIC = Real(
    0.05, "-", "Relative difference of shapes assumed where too few points near zero allow a cubic."
)

SPIN_LOSS = Real(
    0.03,
    "m^2",
    "Bias of (17) on a disc over (1 - eps_gamma) phi_t^2: where a force saturates with spin, its slope falls three times as much "
    "as its secant.",
    "sample tyres with coefficients up to 10 % off: 0.018 to 0.036",
)
SPIN_BIAS_OF_MODEL = Real(
    0.3,
    "-",
    "Relative standard uncertainty of the bias of finite spin that a fitted model predicts.",
    "tests/studies/rigs_study.py --build",
)
SLOPE_SHAPE = Real(
    0.007,
    "-",
    "Relative standard uncertainty of a slope at zero beyond the difference of shapes, as terms in |gamma| bend the odd curve "
    "at zero.",
    "noise-free sample tyres are 0.1 to 1.3 % off",
)
SHAPE_OF_A_CURVE = Series(
    (1.2, 0.5), "-", "Expected shape factor C of a side force over an angle, and its standard deviation."
)
CURVATURE_SPREAD = Real(
    1.0, "-", "Prior standard deviation of the curvature E of a sideslip curve, whose prior mean is 0."
)
REST_OF_PLAY = Real(
    0.06,
    "-",
    "Standard uncertainty, over half the play, of sideslip zeros: where the moment changes sign, the wheel floats in the play.",
    "noise-free sample tyres with 0.17 deg of play",
)

"""Numbers of judgement of the page that evaluates tyres: ranges of its sliders, and the fan of its friction ellipse."""

from __future__ import annotations

from tir.constant import Count, Real, Series

SLIDER_STEPS = Count(
    200, "-", "Steps of a slider at least; each moves the curves by less than a line's width."
)
USUAL_LOAD_RANGE = Series((0.1, 2.0), "-", "Load over FNOMIN where a file states no range.")
WIDEST_LOAD_RANGE = Series((0.05, 3.0), "-", "Load over FNOMIN of a slider at most, whatever a file states.")
USUAL_PRESSURE_RANGE = Series((0.8, 1.2), "-", "Pressure over NOMPRES where a file states no range.")
WIDEST_PRESSURE_RANGE = Series(
    (0.5, 1.5), "-", "Pressure over NOMPRES of a slider at most, whatever a file states."
)
USUAL_CAMBER_END = Real(10.0, "deg", "Largest camber where a file states none; cars lean no further.")
WIDEST_CAMBER_END = Real(
    60.0, "deg", "Largest camber of a slider, whatever a file states; motorcycles lean no further."
)
USUAL_SIDESLIP_END = Real(
    15.0, "deg", "Largest sideslip where a file states none; it holds the peak of every tyre."
)
WIDEST_SIDESLIP_END = Real(20.0, "deg", "Largest sideslip of a slider, whatever a file states.")
USUAL_SLIP_END = Real(
    0.3, "-", "Largest longitudinal slip where a file states none; it holds the peak of every tyre."
)
WIDEST_SLIP_END = Real(0.4, "-", "Largest longitudinal slip of a slider, whatever a file states.")
PATH_CURVATURE_END = Real(1.0, "1/m", "Largest path curvature; rigs with a disc reach about 0.8 1/m.")
SPEED_RANGE = Series((-20.0, 60.0), "m/s", "Speeds of the slider, from reversing to a fast motorway.")
FRICTION_ELLIPSE_FAN = Series(
    (-12.0, -8.0, -4.0, -2.0, 2.0, 4.0, 8.0, 12.0),
    "deg",
    "Sideslip angles of the thin curves of the friction ellipse, from nearly straight to beyond the peak.",
)

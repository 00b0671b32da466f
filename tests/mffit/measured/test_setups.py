"""Set-ups of the rig: their zeros are independent, and repeated ones show how well the zeros are known."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from plain_tyre import NEWTON, Plain, settings, share

from mffit import config as configuration
from mffit.config import setup_names
from mffit.errors import InputError
from mffit.measured import align, at_the_axis, measure
from mffit.measured.setups import SCATTER
from mffit.parts import split
from mffit.points.points import concatenate

U_OFFSET = 10.0  # N, as declared


def in_setup(points, name, offset=0.0):
    """The points in a set-up whose load cell reads too much by the offset."""
    return points.replace(setup=0, setups=(name,), Fy=points.Fy + offset)


def zeros(points):
    return points.select(np.abs(points.alpha) + np.abs(points.gamma) < math.radians(0.2))


def found(*parts, **rig):
    points = concatenate(parts)
    rig = {"u_loadcell_offset_N": U_OFFSET, "u_slip_alignment_N": 20.0} | rig
    return measure(settings(**rig), points, split(points))


def of_budget(result, source):
    return next((row.contribution for row in result.budget if row.source == source), 0.0)


def repeated(*offsets):
    """Everything in a first set-up, and the zeros again in others."""
    whole = Plain().campaign()
    first = in_setup(whole, "1", offsets[0])
    return [first, *(in_setup(zeros(whole), str(k), x) for k, x in enumerate(offsets[1:], 2))]


def test_offsets_of_two_set_ups_average_and_of_one_set_up_cancel():
    """(C_left + C_right) / 2: a common offset drops out, independent ones leave u over the root of two."""
    left, right = Plain().campaign(), zeros(Plain(side=1).campaign())
    apart = found(in_setup(left, "left"), in_setup(right, "right"))
    shared = found(in_setup(left, "A"), in_setup(right, "A"))
    alone = found(left)
    both = of_budget(alone, "load-cell offset") / math.sqrt(2.0)
    assert of_budget(apart, "load-cell offset") == pytest.approx(both, rel=0.01)
    assert of_budget(shared, "load-cell offset") < 0.25 * both


def test_the_zeros_of_a_set_up_are_common_to_all_loads():
    """The slope of eps_gamma over load knows it: errors that are common to the loads hardly move it."""
    loads = (1000.0, 1500.0, 2000.0)
    parts = [
        in_setup(Plain().campaign(loads), "left"),
        in_setup(zeros(Plain(side=1).campaign(loads)), "right"),
    ]
    apart, one = found(*parts), found(Plain().campaign(loads))
    assert apart.carried.over_load.u_pecp2 == pytest.approx(
        one.carried.over_load.u_pecp2 / math.sqrt(2.0), rel=0.15
    )


def test_every_set_up_is_reported_by_itself():
    """An offset of +26 N weakens the turn-slip force -F of the left side and strengthens that of the right one."""
    tyre = Plain()
    right = in_setup(zeros(Plain(side=1).campaign()), "right", 26.0)
    result = found(in_setup(tyre.campaign(), "left", 26.0), right)
    rows = {row.name: row for row in result.nominal.setups}
    for name, sign in (("left", -1.0), ("right", 1.0)):
        assert rows[name].F_phit.value == pytest.approx(
            sign * abs(tyre.turn_slip_force(1500.0)) + 26.0, abs=0.5
        )
    assert result.epsilon_gamma.value == pytest.approx(tyre.epsilon, abs=0.01)
    assert result.nominal.paths == (rows["left"].phi_t, rows["right"].phi_t)


def test_an_axis_that_was_set_up_again_is_misaligned_in_that_set_up_only():
    turned = Plain(side=1, alpha_0=math.radians(0.4))
    result = found(in_setup(Plain().campaign(), "left"), in_setup(zeros(turned.campaign()), "right"))
    assert not result.misaligned
    assert [row.misaligned for row in result.nominal.setups] == [False, True]
    (warning,) = result.warnings
    assert "set-up right" in warning
    assert "0.4" in warning


def test_a_set_up_that_was_run_forwards_only_takes_the_sideslip_zero_of_the_next():
    turned = Plain(side=1, alpha_0=math.radians(0.4))
    left = Plain().campaign()
    forwards = in_setup(left.select(left.direction > 0), "left")
    result = found(forwards, in_setup(zeros(turned.campaign()), "right"))
    assert math.degrees(abs(result.alpha_M.value)) == pytest.approx(0.4, abs=0.05)


def test_repeated_set_ups_scatter_as_declared_and_the_declaration_counts():
    result = found(*repeated(5.0, -5.0, 0.0))
    scatter = result.setup_scatter
    assert scatter.degrees_of_freedom == 2
    assert math.sqrt(25.0 - NEWTON**2) < scatter.between < 5.0  # s of 5, -5, 0, less the noise of a mean
    assert scatter.declared == pytest.approx(U_OFFSET)
    assert scatter.excess == of_budget(result, SCATTER) == 0.0
    assert not result.warnings


def test_repeated_set_ups_that_scatter_more_count_by_their_scatter():
    """s = 30 N of three set-ups, 10 N declared: each is known to 30 N, their mean to 30 N over the root of three."""
    tyre, result = Plain(), found(*repeated(30.0, -30.0, 0.0))
    scatter = result.setup_scatter
    assert math.hypot(scatter.excess, U_OFFSET) == pytest.approx(scatter.between)
    whole = math.hypot(of_budget(result, SCATTER), of_budget(result, "load-cell offset"))
    assert whole == pytest.approx(share(scatter.between / math.sqrt(3.0), tyre), rel=0.02)
    # Student's distribution with the two degrees of freedom of three set-ups is wider than the normal one.
    assert 1.1 < result.nominal.expanded.k / 1.96 < 1.6
    assert result.nominal.expanded.dof < 10.0
    assert (
        math.exp(-900.0 / 100.0) < scatter.chance < math.exp(-900.0 / (100.0 + NEWTON**2))
    )  # chi2 of 2 is 2 s^2 / u^2
    assert any("Repeated set-ups (1, 2, 3)" in warning for warning in result.warnings)


def test_a_set_up_without_zeros_is_said_to_be_known_only_as_declared():
    whole = Plain().campaign()
    slip = whole.select((whole.sweep == 0) & (np.abs(whole.alpha) > math.radians(0.2)))
    result = found(in_setup(whole, "1"), in_setup(slip, "2"))
    (warning,) = [w for w in result.warnings if "set-up 2" in w]
    assert "known only as declared" in warning


def content(*sweeps, **rig):
    return {
        "tyre": {"name": "t", "unloaded_radius": 0.3, "nominal_load": 1500.0, "nominal_pressure": 250.0},
        "rig": {"path_radius": 1.3} | rig,
        "sweep": [{"file": f"{k}.csv"} | sweep for k, sweep in enumerate(sweeps)],
    }


RIGHT, NEAR = {"path_centre": "right"}, {"path_radius": 0.9}


@pytest.mark.parametrize(
    ("sweeps", "names"),
    [
        (({}, {}), ("", "")),
        (({}, RIGHT), ("left", "right")),
        (({}, NEAR, RIGHT), ("left-1.3m", "left-0.9m", "right")),
        (({"setup": "A"}, RIGHT | {"setup": "A"}), ("A", "A")),
        (({"setup": "A"}, {"setup": "2026-03-01 b"}), ("A", "2026-03-01 b")),
        (({"setup": "A"}, {}), ("A", "left")),
    ],
)
def test_a_path_is_a_set_up_unless_said_otherwise(sweeps, names):
    found = configuration.load(content(*sweeps))
    assert setup_names(found.rig, found.sweep) == names


@pytest.mark.parametrize(
    ("setup", "words"),
    [
        (1, "1 is not a text in quotes"),
        ("", "cannot name a set-up"),
        ("a@b", "cannot name a set-up"),
        ("0.csv", "name of a file"),
    ],
)
def test_a_wrong_name_is_refused_with_its_key(setup, words):
    with pytest.raises(InputError, match=re.escape(words)) as refused:
        configuration.load(content({"setup": setup}))
    assert "sweep" in refused.value.key
    assert refused.value.key.endswith("setup")


def test_of_several_set_ups_the_last_one_is_aligned():
    points = concatenate(
        [
            in_setup(Plain().campaign(), "1"),
            in_setup(zeros(Plain(alpha_0=math.radians(0.4)).campaign()), "2"),
        ]
    )
    found = align(points)
    assert found.correction_deg == pytest.approx(-0.4, rel=0.2)  # with the usual stiffness of 10 per load
    (said,) = [sentence for sentence in found.warnings if "set-ups" in sentence]
    assert said.endswith("the last one, 2")


def test_the_alignment_takes_the_zeros_and_the_stiffness_of_the_report():
    """With play, and a parabola through the angles near zero."""
    whole, config = Plain(alpha_0=math.radians(0.4)).campaign(), settings(backlash_deg=0.2)
    points, stiffness = at_the_axis(config, whole, split(whole))
    (step,) = (step for step in align(points, measured=stiffness).steps if step.load == 1500.0)
    row = measure(config, whole, split(whole)).nominal
    assert (step.F_forward, step.F_backward) == pytest.approx((row.F_forward, row.F_backward))
    assert step.F_forward != pytest.approx(align(whole).steps[-1].F_forward, abs=0.5)

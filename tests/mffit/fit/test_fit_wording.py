"""Every sentence about the files of a fit says its numbers."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from mffit.fit.wording import (
    explanations,
    file_sentences,
    nominal_pressure_sentences,
    ranges_sentence,
)
from mffit.fit.written.files import Files, file_names
from mffit.fit.written.misfit import FileFigures, Misfit

TESTED = {
    "PRESMIN": 200e3, "PRESMAX": 300e3, "FZMIN": 900.0, "FZMAX": 2100.0, "ALPMAX": 0.1396, "CAMMAX": 0.5236,
}  # fmt: skip
WRITTEN = TESTED | {
    "PRESMIN": 160e3,
    "PRESMAX": 360e3,
    "FZMIN": 90.0,
    "FZMAX": 3150.0,
    "ALPMAX": 0.3491,
    "CAMMAX": 0.7854,
}


def misfit(scale: float) -> dict[str, Misfit]:
    """Fy in newtons and Mz in tenths of them."""
    return {
        name: Misfit(rms=7.0 * k, weighted=3.0 * k, largest=31.0 * k, beyond=0.0, ridden=3.0 * k)
        for name, k in (("Fy", scale), ("Mz", 0.1 * scale))
    }


def file(mode: int, stiffness: float, **places: float) -> FileFigures:
    return FileFigures({"USE_MODE": mode}, {name: misfit(k) for name, k in places.items()}, stiffness)


def files(normal: float = -1140.0, **more: FileFigures) -> Files:
    """The files of a disc; the one for turn slip off with another camber stiffness than the model's -1200 N/rad."""
    return Files(
        by_use={
            "turn-slip": file(125, -1200.0, straight=0.0),
            "normal": file(124, normal, straight=1.0),
            **more,
        },
        tested=TESTED,
        written=WRITTEN,
        changed={},
        lacking={100.0: 2.2, 10.0: 22.4},
    )


BOTH = file(125, -1190.0, straight=10.0, straight_with_turn_slip=5.0, disc=2.0)


def test_the_files_of_a_disc_are_explained_with_their_use_and_misfit():
    use, misfit, lacking, _ = file_sentences(files(), file_names("small", "turn-slip", True))
    assert "Give small.tir, the fitted model itself, to a simulator that computes turn slip" in use
    assert "its USE_MODE ends in 5, here 125" in use
    assert "Give small-normal.tir to every other simulator (its USE_MODE ends in 4, here 124)." in use
    assert "If you do not know, use small-normal.tir." in use
    assert "to 3 N and 0.3 Nm rms where vehicles are ridden" in misfit
    assert "small-normal.tir has 5% less camber stiffness at zero camber than the fitted model" in lacking
    assert lacking.endswith("by radius): 2 N at 100 m, 22 N at 10 m.")


@pytest.mark.parametrize(
    ("stiffness", "words"), [(-1260.0, "has 5% more"), (-1140.0, "has 5% less"), (-1200.0, "has 0% less")]
)
def test_a_file_has_less_or_more_camber_stiffness(stiffness, words):
    said = file_sentences(files(stiffness), file_names("small", "turn-slip", True))[2]
    assert words in said


def test_the_file_for_both_uses_comes_first_with_its_three_misfits():
    both, use, *_ = file_sentences(files(both=BOTH), file_names("small", "both", True))
    assert "Give small.tir to a simulator if you do not know" in both
    assert "by 6 N on the disc and 15 N on a straight path with turn slip (USE_MODE 125)" in both
    assert "and by 30 N on a straight path without turn slip" in both
    assert "If you do not know" not in use
    assert "Give small-turn-slip.tir" in use


def test_a_flat_track_has_one_file():
    flat = Files({"normal": file(124, -1200.0, straight=0.0)}, TESTED, WRITTEN, {}, {})
    use, tested = file_sentences(flat, file_names("flat", "turn-slip", False))
    assert use.startswith("Give flat.tir to the simulator with turn slip off (USE_MODE 124)")
    assert tested == ranges_sentence(flat)


def test_tested_and_written_ranges_are_stated():
    assert ranges_sentence(files()) == (
        "Tested: 900 to 2100 N, sideslip to 8.0 deg, camber to 30.0 deg, 200 to 300 kPa. The ranges in the file are wider "
        "where the model stays plausible, because simulators limit their inputs to them: 90 to 3150 N, 20 deg of sideslip, "
        "45 deg of camber, 160 to 360 kPa. Beyond the tested conditions nothing was measured."
    )


@pytest.mark.parametrize(
    ("degrees", "words"),
    [
        ((-6.0, -2.04, 6.0), "0.20 at sideslips of -6, -2 and 6 deg. The"),
        ((-0.0, 4.0), "at sideslips of 0 and 4 deg"),
        ((4.0,), "at 4 deg of sideslip."),
        ((-0.01,), "without sideslip."),
        (tuple(range(-5, 6)), "at sideslips of -5 to 5 deg."),
    ],
)
def test_slip_is_stated_with_the_sideslips_at_which_it_was_run(degrees, words):
    tested = TESTED | {"KPUMIN": -0.2, "KPUMAX": 0.2}
    made = Files({}, tested, WRITTEN, {}, {}, sideslips_with_slip=tuple(np.radians(degrees)))
    assert words in ranges_sentence(made)


@pytest.mark.parametrize(("lowest", "words"), [(1950.0, "Tested: 2100 N only,"), (1940.0, "1940 to 2100 N")])
def test_loads_of_one_level_are_one(lowest, words):
    assert words in ranges_sentence(Files({}, TESTED | {"FZMIN": lowest}, WRITTEN, {}, {}))


@pytest.mark.parametrize(("lowest", "words"), [(291e3, "291 kPa only"), (289e3, "289 to 300 kPa")])
def test_pressures_of_one_level_are_one(lowest, words):
    assert words in ranges_sentence(Files({}, TESTED | {"PRESMIN": lowest}, WRITTEN, {}, {}))


@pytest.mark.parametrize(
    ("nominal", "lowest", "words"),
    [
        (250e3, 200e3, None),
        (301e3, 200e3, None),  # as a gauge reads
        (310e3, 200e3, "nominal_pressure, 310 kPa, was not tested, 200.0 to 300.0 kPa were"),
        (180e3, 200e3, "nominal_pressure, 180 kPa, was not tested"),
        (250e3, 299e3, "nominal_pressure, 250 kPa, was not tested, only 299.5 kPa was"),
    ],
)
def test_a_nominal_pressure_beside_the_tested_ones_is_said(nominal, lowest, words):
    tyre = file(124, -1200.0, straight=0.0)
    made = Files(
        {"normal": replace(tyre, tyre=tyre.tyre | {"NOMPRES": nominal})},
        TESTED | {"PRESMIN": lowest}, WRITTEN, {}, {},
    )  # fmt: skip
    said = list(nominal_pressure_sentences(made))
    assert not said if words is None else words in said[0]


@pytest.mark.parametrize("measured", [True, False])
def test_pecp1_is_explained_where_it_was_measured(measured):
    config = SimpleNamespace(
        tyre=SimpleNamespace(name="small"),
        spin=SimpleNamespace(exact="turn-slip", pecp1="model"),
        rig=SimpleNamespace(on_disc=True),
    )
    direct = SimpleNamespace(carried=SimpleNamespace(source="model") if measured else None)
    said = explanations(config, files(), {"PECP1": 0.1}, direct)
    assert said[-1].startswith("PECP1 = 0.1000 is eps_gamma by the joint estimate") == measured
    assert len(said) == 4 + measured


def test_a_limit_of_camber_beyond_the_range_is_said():
    names = file_names("small", "turn-slip", True)
    assert "= 60 has no effect" in file_sentences(replace(files(), wide_limit=np.radians(60.0)), names)[3]

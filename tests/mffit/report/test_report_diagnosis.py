"""The diagnosis page shows the effects found, the effects tried, and the structure that remains."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from plain_pages import without_pictures
from report_toys import TRUE, made_config, made_points, programme, read_page

import tir
from mffit.constants import TERMINAL_LINES, TERMINAL_WIDTH
from mffit.diagnosis import Asked, diagnose, wording
from mffit.diagnosis.constants import TIED_EVIDENCE
from mffit.diagnosis.rest import Answer
from mffit.diagnosis.ties import Separation
from mffit.effects import CATALOG
from mffit.report import constants, style, text, write_diagnosis
from mffit.report.curves import conditions
from mffit.report.figures import gap
from tests.browser import PAPER, PHONE, complaints, console_errors, look, opened

PICTURES = {"gap_by_effect", "curves", "evidence", "gap_maps"}
DENT = -80.0  # N, over 1 deg of sideslip


def diagnosed(**changes):
    """Diagnosis of the true tyre against its readings, some of them changed by functions of the points."""
    points = made_points(programme())
    changed = points.replace(**{name: change(points) for name, change in changes.items()})
    return diagnose(changed, tir.read(TRUE), made_config())


@pytest.fixture(scope="module")
def misaligned():
    """Readings 0.3 deg below the true sideslip."""
    return diagnosed(alpha=lambda points: points.alpha - np.radians(0.3))


@pytest.fixture(scope="module")
def unknown():
    """A dent in the side force that no effect has."""

    def dent(points):
        return DENT * np.exp(-0.5 * (np.degrees(points.alpha) + 4.0) ** 2)

    return diagnosed(Fy=lambda points: points.Fy + dent(points))


@pytest.fixture(scope="module")
def clean():
    return diagnosed()


def written(diagnosis, folder):
    write_diagnosis(diagnosis, folder)
    return read_page(folder / "diagnosis.html")


@pytest.fixture(scope="module")
def folder(misaligned, tmp_path_factory):
    """The page and the pictures of the misaligned axis."""
    place = tmp_path_factory.mktemp("misaligned")
    write_diagnosis(misaligned, place)
    return place


@pytest.fixture(scope="module")
def page(folder):
    return read_page(folder / "diagnosis.html")


def test_a_diagnosis_fits_a_screen_and_leads_with_its_headline(misaligned):
    lines = repr(misaligned).splitlines()
    assert len(lines) <= TERMINAL_LINES
    assert max(map(len, lines)) <= TERMINAL_WIDTH
    assert misaligned.headline[:60] in lines[0]


def test_a_found_effect_is_shown_with_its_size_and_pictures(misaligned, folder, page):
    assert {p.stem for p in (folder / "plots").iterdir()} == PICTURES
    assert set(page.tables) == PICTURES
    assert page.text.count("held out") >= 2
    assert "noise alone" in page.text
    verdict, rest = misaligned.headline.split(": ", 1)
    assert verdict in page.text
    assert rest[1:] in page.text
    assert "alpha_0_deg" not in page.text
    assert page.text.lower().count("sideslip axis misaligned") >= 3  # card, heading, number
    assert misaligned.effects[0].effect.physics in page.text


def test_page_needs_no_network(page):
    assert all(
        r.startswith(("data:text/csv", "data:application/zip", "data:image/png;base64,", "#"))
        for r in page.references
    )


def test_a_tie_is_stated_with_the_run_that_separates_it(misaligned, tmp_path):
    found = dataclasses.replace(
        misaligned.effects[0],
        tied=tuple(effect for effect in CATALOG if effect.id == "ply-steer"),
        separation=Separation("a sideslip sweep at 1400 N with the tyre turned on its rim", 50.0),
    )
    tied = dataclasses.replace(misaligned, effects=(found,))
    assert "these data cannot tell it from: ply-steer" in text.diagnosis_summary(tied)
    with without_pictures():
        page = written(tied, tmp_path)
    assert "these data cannot tell it from ply-steer" in page.text
    assert "a sideslip sweep at 1400 N with the tyre turned on its rim (expected χ² 50)" in page.text


def test_residuals_after_are_noise_where_the_effect_was_found(misaligned):
    for channel in gap.gap_channels(misaligned):
        # 115 draws: a standard deviation of 1 is met within 20 % in 3 cases of 1000 not
        assert np.nanstd(channel.after) == pytest.approx(1.0, abs=0.2)
    assert np.nanstd(gap.gap_channels(misaligned)[0].before) > 3.0


def test_maps_before_and_after_share_one_scale(misaligned):
    channels = gap.gap_channels(misaligned)
    sheet = gap.residuals_before_after(misaligned)
    assert len(sheet.panels) == 2 * len(channels) * len(conditions(misaligned.points))
    assert sheet.scale.limit == gap.colour_limit(channels)
    assert all(panel.series[0].shade is not None for panel in sheet.panels)


def test_evidence_ranks_the_named_effect_first(misaligned):
    panel = gap.evidence(misaligned).panels[0]
    assert panel.y.words[0] == misaligned.effects[0].effect.name
    lengths = list(panel.series[0].lengths)
    assert lengths == sorted(lengths, reverse=True)


def test_a_step_in_which_nothing_gains_has_no_picture(misaligned):
    step = misaligned.contests[0]
    worse = tuple(
        dataclasses.replace(trial, log_evidence=step.before.log_evidence - 1.0) for trial in step.trials
    )
    nothing = dataclasses.replace(misaligned, contests=(dataclasses.replace(step, trials=worse),))
    assert not gap.evidence(nothing).panels


@pytest.mark.parametrize(("share", "tied"), [(0.99, True), (1.01, False)])
def test_picture_and_verdict_call_the_same_distance_a_tie(misaligned, share, tied):
    gains = (50.0, 50.0 - share * TIED_EVIDENCE)
    step = misaligned.contests[0]
    before, trials = step.before, step.trials
    trials = tuple(
        dataclasses.replace(trial, log_evidence=before.log_evidence + gain)
        for trial, gain in zip(trials, gains, strict=False)
    )
    step = dataclasses.replace(step, trials=trials, threshold=5.0)
    panel = gap.evidence(dataclasses.replace(misaligned, contests=(step,))).panels[0]
    best, behind = panel.notes
    assert best.text == "best"
    assert behind.colour == (style.INK if tied else style.MUTED)


def test_the_page_states_the_margin_of_the_verdict(page):
    assert f"within {TIED_EVIDENCE:g} the data cannot separate them" in page.text


def test_colour_scale_never_blows_up_noise_nor_hides_what_is_left(clean, misaligned):
    assert gap.colour_limit(gap.gap_channels(clean)) == constants.RESIDUAL_SCALE
    loud = gap.GapChannel(name="Fy", before=np.full(9, 500.0), after=np.zeros(9))
    assert gap.colour_limit([loud]) == constants.LARGEST_GAP_SCALE


def test_a_complete_simulation_is_reported_as_such(clean, tmp_path):
    with without_pictures():
        page = written(clean, tmp_path)
    assert clean.effects == ()
    assert clean.headline.split(": ")[0] in page.text
    assert "No effect is named." in page.text
    assert "→" not in page.text
    assert "+ " not in page.text[page.text.index("Gap, rms") : page.text.index("noise alone")]
    assert "Blue lines" not in page.text


def test_unexplained_structure_is_at_the_top_with_its_place(unknown, tmp_path):
    page = written(unknown, tmp_path)
    assert unknown.unexplained
    assert unknown.answer is Answer.UNKNOWN
    alert = page.text.index("Something is missing that no effect of the library describes")
    assert alert < page.text.index("The gap, effect by effect")
    assert gap.framed(unknown, "Fy")[0] == unknown.unexplained_where[0]
    lists = page.text.count("significance z")
    assert lists == (2 if unknown.effects else 1)  # without an effect what remains is the misfit as given


def test_without_moment_only_side_force_is_shown(tmp_path):
    points = made_points(programme(), moment=False)
    few = CATALOG[:3]
    page = written(diagnose(points, tir.read(TRUE), made_config(), Asked(effects=few)), tmp_path)
    assert "Mz gap" not in page.text


def test_summary_for_the_terminal(misaligned, unknown, clean):
    summary = text.diagnosis_summary(misaligned)
    assert "(rig), confidence" in summary
    assert "sideslip axis misaligned = 0.3" in summary
    assert " deg, was 0" in summary
    assert "alpha_0_deg" not in summary
    assert "sideslip-misalignment" not in summary
    assert "unexplained:" in text.diagnosis_summary(unknown)
    nowhere = dataclasses.replace(unknown, unexplained_where=())
    assert "unexplained:" not in text.diagnosis_summary(nowhere)
    (noise,) = (line.split() for line in summary.splitlines() if line.startswith("noise "))
    assert float(noise[-1]) == 1.0  # of chi2 per degree of freedom
    for diagnosis in (misaligned, unknown, clean):
        said = text.diagnosis_summary(diagnosis)
        assert said.isascii()
        assert max(map(len, said.splitlines())) <= TERMINAL_WIDTH
        assert len(said.splitlines()) <= TERMINAL_LINES


def test_what_to_do_is_never_cut(misaligned):
    many = dataclasses.replace(misaligned, effects=misaligned.effects * 6)
    said = text.diagnosis_summary(many)
    assert said.count("(rig), confidence") == said.count("to do:") == 6
    assert "..." not in said


def test_the_gap_is_shown_effect_by_effect(misaligned):
    """As given, then with the axis turned: bars per channel that end at the noise, and left-out sweeps beside them."""
    sheet = gap.gap_by_effect(misaligned)
    for panel, name in zip(sheet.panels, ("Fy", "Mz"), strict=True):
        assert [*panel.y.words.values()] == ["as given", "+ sideslip axis misaligned"]
        bars, left_out = panel.series
        assert bars.lengths == pytest.approx(
            [misaligned.gap_examined.rms(name), misaligned.gap_after.rms(name)]
        )
        assert left_out.x == pytest.approx(
            [misaligned.validation.gap_before.rms(name), misaligned.validation.gap_after.rms(name)]
        )
        assert panel.guides[0].at == misaligned.noise.typical(name)


def test_the_table_starts_from_the_gap_of_the_headline(misaligned):
    """Readings without weight widen the gap of all readings, and have a row of their own."""
    wider = dataclasses.replace(misaligned.gap_before, rmse={"Fy": 999.0, "Mz": 99.0})
    for found, more in ((misaligned, 0), (dataclasses.replace(misaligned, gap_before=wider), 1)):
        said = text.diagnosis_summary(found)
        (row,) = (line.split() for line in said.splitlines() if line.startswith("before "))
        assert f"instead of {row[1]} N" in found.headline
        assert said.count("all readings, uncorrected") == said.count("999") == more


def test_a_gap_that_grows_is_explained(misaligned):
    (effect,) = misaligned.effects
    wide = dataclasses.replace(misaligned.gap_examined, chi2_per_dof=2 * misaligned.gap_examined.chi2_per_dof)
    anew = dataclasses.replace(misaligned, coefficients={"PKY1": (-20.0, 0.1)})
    grown = dataclasses.replace(anew, effects=(dataclasses.replace(effect, gap_after=wide),))
    assert "The gap grows with sideslip axis misaligned alone" in " ".join(wording.notes(grown))
    assert "The gap grows" not in " ".join(wording.notes(anew))


def test_one_box_has_the_verdict_and_pictures_follow_it(misaligned, unknown, clean, tmp_path):
    for k, found in enumerate((misaligned, unknown, clean)):
        (tmp_path / str(k)).mkdir()
        pictures = [*written(found, tmp_path / str(k)).tables]
        assert pictures[:2] == ["gap_by_effect", "curves"] if found.effects else pictures[0] == "curves"
        html = (tmp_path / str(k) / "diagnosis.html").read_text(encoding="utf-8")
        assert html.count('class="box ') == 1
        assert html.index('class="box ') < html.index("<figure") < html.index("<table")


def test_what_was_tried_is_a_table_that_a_click_sorts(misaligned, folder):
    def column(place: int) -> list[str]:
        return [
            cell.text for cell in browser.find_elements("css selector", f".sortable td:nth-child({place})")
        ]

    with opened(folder / "diagnosis.html") as browser:
        by_size = column(3)
        assert len(by_size) == len(misaligned.limits)
        heads = browser.find_elements("css selector", ".sortable .sort")
        heads[0].click()
        assert column(1) == sorted(column(1), key=str.lower)
        heads[2].click()
        assert column(3) == by_size
        heads[2].click()
        assert [float(text) for text in column(3)] == sorted(map(float, by_size), reverse=True)
        assert console_errors(browser) == []


def test_a_reader_sees_every_picture_on_screen_phone_and_paper(folder):
    with opened(folder / "diagnosis.html") as browser:
        assert complaints(browser) == []
        look(browser, PHONE)
        assert complaints(browser) == []
        look(browser, PAPER, media="print")
        assert complaints(browser) == []
        assert console_errors(browser) == []


def test_everything_is_printed_if_asked_for(folder):
    """The notes, with what the data cannot show, and the digests of the inputs."""
    seen = "return [...document.querySelectorAll('.folded')].map(one => one.checkVisibility())"
    with opened(folder / "diagnosis.html") as browser:
        look(browser, PAPER, media="print")
        assert not all(browser.execute_script(seen))
        browser.execute_script("document.getElementById('everything').click()")
        assert all(browser.execute_script(seen))
        assert complaints(browser) == []

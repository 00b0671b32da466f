"""Many tyres: a failure does not stop the others, current output is left unchanged, and a page compares the tyres."""

from __future__ import annotations

import contextlib
import io
import json
import os
import shutil
import signal
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from plain_pages import without_pictures
from small_rigs import LOADS, disc, simulated

from mffit import config, fleet, pipeline
from mffit.cli import main
from mffit.cli.building import _compare_built, _end
from mffit.cli.console import Voice
from mffit.errors import InputError
from mffit.fit.priors import of_fleet
from mffit.fleet.specimen import freed
from mffit.made import source
from mffit.output import RECORD, digest
from mffit.pipeline import many, workers
from mffit.pipeline.many import is_current
from mffit.results import BuildOutcome
from tests.browser import assert_readable
from tir import Quantity

HOSTILE = "a<img src=x onerror=alert(1)>b"


def mffit(*arguments: object) -> tuple[int, str, str]:
    out, err = io.StringIO(), io.StringIO()
    code = 0
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            main([str(argument) for argument in arguments])
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else 1
    return code, out.getvalue(), err.getvalue()


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """A small campaign of a simulated tyre at two loads, on a rig and in a set-up that other tyres share."""
    folder = tmp_path_factory.mktemp("many") / "sound"
    content = disc(LOADS[:2], rolling_radius=[{"load_N": 1400}])
    content["rig"] |= {"name": "disc"}
    content["sweep"] = [sweep | {"setup": "may"} for sweep in content["sweep"]]
    simulated(content, folder)
    return folder


@pytest.fixture(scope="module")
def built(project):
    """The only build of this module: one command for two tyres, one of which cannot be built."""
    broken = project.with_name("broken")
    shutil.copytree(project, broken)
    (broken / "camber_900.csv").unlink()
    (broken / "tyre.toml").write_text((broken / "tyre.toml").read_text().replace('"small"', '"broken"'))
    out = project.with_name("out")
    with without_pictures():
        return out, mffit("build", broken / "tyre.toml", project / "tyre.toml", "--out", out)


def test_a_failure_does_not_stop_the_others_and_sets_the_exit_code(built):
    out, (code, said, err) = built
    assert code == 2
    assert (out / "small" / "small.tir").is_file()
    assert not (out / "broken").exists()
    assert "[1/2] broken: refused\n[2/2] small: built in" in err
    row = next(line for line in said.splitlines() if line.startswith("small"))
    result = json.loads((out / "small" / "result.json").read_text())
    assert f"{result['spin']['epsilon_gamma']:.3f} +- {result['spin']['u_epsilon_gamma']:.3f}" in row
    assert row.endswith(str(out / "small" / "small.tir"))
    assert "broken: " in said
    assert "camber_900.csv" in said


def test_current_output_is_left_unchanged(built, project, monkeypatch):
    out, _ = built
    monkeypatch.setattr(many, "build", lambda *given, **keys: pytest.fail("built again"))
    before = {path: path.stat().st_mtime_ns for path in (out / "small").rglob("*")}
    (outcome,) = pipeline.build_many([project / "tyre.toml"], out)
    assert outcome.state == "unchanged"
    assert outcome.file == "small.tir"
    assert {path: path.stat().st_mtime_ns for path in (out / "small").rglob("*")} == before


def edited_sweep(project: Path, out: Path) -> None:
    path = project / "camber_900.csv"
    path.write_text(path.read_text().replace("900.0", "900.1", 1))


def edited_configuration(project: Path, out: Path) -> None:
    path = project / "tyre.toml"
    path.write_text(path.read_text().replace("1400", "1401", 1))


def edited_output(project: Path, out: Path) -> None:
    (out / "small.tir").write_text("edited")


def missing_output(project: Path, out: Path) -> None:
    (out / "report.html").unlink()


def _rewritten(out: Path, name: str, content: bytes) -> None:
    """Replace a file as if the build had written it."""
    record = json.loads((out / RECORD).read_text())
    (out / name).write_bytes(content)
    record["files"][name] = f"build:{digest(out / name)}"
    (out / RECORD).write_text(json.dumps(record))


def another_source(project: Path, out: Path) -> None:
    text = (out / "result.json").read_text()
    assert source() in text
    _rewritten(out, "result.json", text.replace(source(), "0" * 64).encode())


@pytest.mark.parametrize(
    "change",
    [None, edited_sweep, edited_configuration, edited_output, missing_output, another_source],
)
def test_changed_input_or_output_is_built_again(built, project, tmp_path, change):
    # resolved.toml depends on the relative position of both folders, which the copies keep.
    shutil.copytree(project, tmp_path / "sound")
    shutil.copytree(built[0] / "small", tmp_path / "out" / "small")
    toml, out = tmp_path / "sound" / "tyre.toml", tmp_path / "out" / "small"
    resolved = pipeline.build_output.resolved_text(config.load(toml), out)
    _rewritten(out, "resolved.toml", resolved)
    if change is not None:
        change(tmp_path / "sound", out)
    assert is_current(config.load(toml), out) == (change is None)


def test_output_with_another_number_of_drawn_files_is_built_again_only_if_a_number_is_asked_for(
    built, project, tmp_path
):
    shutil.copytree(project, tmp_path / "sound")
    shutil.copytree(built[0] / "small", tmp_path / "out" / "small")
    loaded, out = config.load(tmp_path / "sound" / "tyre.toml"), tmp_path / "out" / "small"
    _rewritten(out, "resolved.toml", pipeline.build_output.resolved_text(loaded, out))
    (out / "ensemble").mkdir()
    _rewritten(out, "ensemble/small-1.tir", b"")
    assert [is_current(loaded, out, ensemble=n) for n in (0, 1, 2)] == [True, True, False]


def dies_at_weak(job: workers.Job) -> BuildOutcome:
    """A worker that is killed at one of the tyres, as for lack of memory."""
    if job.name == "weak":
        os.kill(os.getpid(), signal.SIGKILL)
    return BuildOutcome(job.source, job.name, job.out, "built")


@pytest.mark.skipif(os.name == "nt", reason="processes are started and killed differently there")
def test_a_killed_worker_costs_only_its_own_tyre(tmp_path, monkeypatch):
    monkeypatch.setattr(workers, "START_METHOD", "fork")  # faster; this process has no threads
    jobs = [workers.Job(Path(name), name, tmp_path) for name in ("a", "weak", "b", "c", "d")]
    outcomes = list(workers.in_processes(jobs, 2, dies_at_weak))
    assert {o.name: o.state for o in outcomes} == dict.fromkeys("abcd", "built") | {"weak": "failed"}
    assert "its process ended early" in next(o.sentence for o in outcomes if o.name == "weak")


def counted(job: workers.Job) -> BuildOutcome:
    """A worker that leaves a mark for every start."""
    with (job.out / job.name).open("a") as file:
        file.write("started\n")
    return BuildOutcome(job.source, job.name, job.out, "built")


@pytest.mark.skipif(os.name == "nt", reason="processes are started and killed differently there")
def test_every_tyre_is_built_once(tmp_path, monkeypatch):
    monkeypatch.setattr(workers, "START_METHOD", "fork")
    jobs = [workers.Job(Path(name), name, tmp_path) for name in "abcde"]
    outcomes = list(workers.in_processes(jobs, 2, counted))
    assert sorted(o.name for o in outcomes) == list("abcde")
    assert [(tmp_path / name).read_text() for name in "abcde"] == ["started\n"] * 5


def test_two_tyres_are_not_built_into_one_folder(project):
    other = project / "other.toml"
    other.write_text((project / "tyre.toml").read_text())
    for keys, said in (({}, "--out"), ({"out": project / "all"}, "both are named")):
        with pytest.raises(InputError, match=said):
            pipeline.build_many([project / "tyre.toml", other], **keys)
    with pytest.raises(InputError, match="twice"):
        pipeline.build_many([other, other])
    other.unlink()


def test_an_interrupted_run_lists_the_finished_tyres(built, project, monkeypatch):
    out, _ = built
    second = project.with_name("second")
    if not second.exists():
        shutil.copytree(project, second)
        text = (second / "tyre.toml").read_text()
        (second / "tyre.toml").write_text(text.replace('"small"', '"second"'))

    def interrupted(*given, **keys):
        raise KeyboardInterrupt

    monkeypatch.setattr(many, "build", interrupted)
    code, said, err = mffit("build", project / "tyre.toml", second / "tyre.toml", "--out", out)
    assert code == 130
    assert "small" in said
    assert "second" not in said
    assert "finished tyres are complete" in err
    assert not (out / "second").exists()


@pytest.fixture(scope="module")
def folders(built, tmp_path_factory):
    """Five built tyres: the one of this module under other names, one of them hostile."""
    place = tmp_path_factory.mktemp("specimens")
    out = []
    for k in range(5):
        folder = place / str(k)
        shutil.copytree(built[0] / "small", folder)
        result = json.loads((folder / "result.json").read_text())
        result["tyre"]["name"] = f"tyre {k}" if k else HOSTILE
        (folder / "result.json").write_text(json.dumps(result))
        out.append(folder)
    return out


@pytest.fixture(scope="module")
def compared(folders):
    out = folders[0].parent / "fleet"
    return out, mffit("fleet", *folders, "--out", out)


def test_the_fleet_compares_and_reduces_uncertainties(compared, folders):
    out, (code, said, err) = compared
    assert (code, err) == (0, "")
    found = json.loads((out / "fleet.json").read_text())
    result = json.loads((folders[0] / "result.json").read_text())
    for tyre in found["tyres"]:
        epsilon = tyre["epsilon_gamma"]
        assert epsilon["direct"]["value"] == result["spin"]["epsilon_gamma"]
        assert epsilon["together"]["u"] < epsilon["alone"]["u"] < epsilon["direct"]["u"]
        assert tyre["C_alpha_N_per_rad"]["u"] > 0.0
        assert tyre["rig"] == 1  # counted from 1, as on the page
        assert tyre["rmse"] == {name: row["rmse"] for name, row in result["fit"]["channels"].items()}
        assert tyre["warnings"] == result["warnings"]
    assert set(found["rigs"][0]["errors"]) == {
        "F0_N",
        "gamma_0_deg",
        "alpha_0_deg",
        "camber_skew_deg",
        "path_radius_m",
    }
    assert found["scatter"]["epsilon_gamma_direct"]["tyres"] == 5
    assert found["scatter"]["epsilon_gamma_direct"]["beyond"] == 0.0  # five times the same tyre
    table = pd.read_csv(out / "fleet.csv")
    assert table.rig.tolist() == [1] * 5
    assert table.warnings.tolist() == [len(result["warnings"])] * 5
    assert table.rmse_Fy.to_numpy() == pytest.approx(result["fit"]["channels"]["Fy"]["rmse"])
    assert list(table.name) == [HOSTILE, "tyre 1", "tyre 2", "tyre 3", "tyre 4"]
    together = found["tyres"][0]["epsilon_gamma"]["together"]["value"]
    assert table.epsilon_gamma_together[0] == pytest.approx(
        together, rel=1e-14
    )  # old pandas read CSV inexactly
    assert "error of the rig" in said
    assert "load-cell zero of Fy" in said
    assert "F0_N" not in said + (out / "fleet.html").read_text()
    assert all("recordings in common" in note for note in found["notes"])  # it is one build, copied


def test_the_peaks_of_a_fleet_are_those_of_the_road_on_its_lesser_side(compared, folders, tmp_path):
    """Value, uncertainty and "at least" as in each build's result.json; whichever side is smaller."""
    (out, (_, said, _)), (raised, other) = compared, (tmp_path / "raised", folders[1])
    sides = json.loads((other / "result.json").read_text())["road"]["sides"]
    peaks = {"mu_y": "mu_y", "Mz_peak_Nm": "M_zmax_Nm"}
    first = json.loads((out / "fleet.json").read_text())["tyres"][1]
    for key, name in peaks.items():
        assert first[key] == min((side[name] for side in sides.values()), key=lambda one: one["value"])
    assert "mu_y of the lesser side" in said
    shutil.copytree(other, raised)
    for least in sides:
        result = json.loads((other / "result.json").read_text())
        for side, content in result["road"]["sides"].items():
            content["mu_y"] = {"value": 1.1, "u": 0.03} if side == least else {"value": 1.2, "u": 0.01}
        (raised / "result.json").write_text(json.dumps(result))
        grip = fleet.read(raised).on_road["mu_y"]
        assert (type(grip), grip.value, grip.u) == (Quantity, 1.1, 0.03)
    result["road"] = None
    (raised / "result.json").write_text(json.dumps(result))
    found = pipeline.fleet([other, raised])
    assert not peaks.keys() & found.rows[1].numbers.keys()


def test_a_stiffness_carries_the_uncertainty_of_its_coefficients(compared, folders):
    """About 40 points of 3 N determine the cornering stiffness to between one thousandth and two per cent."""
    row = json.loads((compared[0] / "fleet.json").read_text())["tyres"][0]["C_alpha_N_per_rad"]
    assert 1e-3 < abs(row["u"] / row["value"]) < 2e-2


def test_the_information_of_a_build_peaks_at_its_solution(built):
    """Together with the priors of the fit; eps_gamma has none but the result of the direct method, from the same points."""
    numbers = freed(fleet.read(built[0] / "small").numbers)
    k = numbers.names.index("PECP1")
    assert np.isinf(numbers.spread[k])
    assert numbers.expected[k] == numbers.values[k]  # the build held it there
    others = [i for i, name in enumerate(numbers.names) if name not in ("PECP1", "PECP2")]
    slope = (numbers.score - (numbers.values - numbers.expected) / numbers.spread**2)[others]
    u = np.sqrt(np.diag(numbers.covariance))[others]
    assert np.max(np.abs(slope * u)) < 0.3  # in units of its uncertainty, no number would move far


def test_a_fleet_on_a_disc_reads_the_file_with_turn_slip(folders, tmp_path):
    """With exact = "normal" the build lists the other file first."""
    shutil.copytree(folders[1], tmp_path / "normal")
    result = json.loads((folders[1] / "result.json").read_text())
    assert list(result["files"]) == ["turn-slip", "normal"]
    result["files"] = dict(reversed(result["files"].items()))
    (tmp_path / "normal" / "result.json").write_text(json.dumps(result))
    assert fleet.read(tmp_path / "normal").tyre["PECP1"] == fleet.read(folders[1]).tyre["PECP1"]
    assert fleet.read(tmp_path / "normal").tyre["USE_MODE"] % 10 == 5


@pytest.mark.parametrize(
    ("states", "code"), [(["built"], None), (["unchanged", "failed"], 1), (["failed", "refused", "built"], 2)]
)
def test_the_exit_code_is_that_of_the_worst_tyre(states, code):
    outcomes = [BuildOutcome(Path("a.toml"), "a", None, state) for state in states]
    with contextlib.nullcontext() if code is None else pytest.raises(SystemExit) as end:
        _end(outcomes, False, False, Voice(json=False, quiet=False))
    assert code is None or end.value.code == code


@pytest.mark.parametrize(("other", "code"), [("built", 3), ("failed", 1)])
def test_a_tyre_that_is_not_to_be_trusted_gives_3_unless_a_build_failed(other, code, capsys):
    doubtful = BuildOutcome(Path("a.toml"), "a", None, "built", reasons=("the model misses Fy",))
    with pytest.raises(SystemExit) as end:
        _end(
            [doubtful, BuildOutcome(Path("b.toml"), "b", None, other)],
            False,
            False,
            Voice(json=False, quiet=False),
        )
    assert end.value.code == code
    assert ("not to be trusted: a\n" in capsys.readouterr().err) == (code == 3)


@pytest.mark.parametrize(("tyres", "files"), [(1, []), (3, ["fleet.csv", "fleet.html", "fleet.json"])])
def test_tyres_built_by_one_command_are_compared(folders, tmp_path, capsys, tyres, files):
    outcomes = [
        BuildOutcome(folder / "tyre.toml", folder.name, folder, "built") for folder in folders[:tyres]
    ]
    lost = BuildOutcome(Path("lost.toml"), "lost", folders[4], "failed")
    _compare_built([*outcomes, lost], tmp_path, Voice(json=False, quiet=True))
    assert sorted(path.name for path in tmp_path.glob("fleet.*")) == files
    assert capsys.readouterr().err == ""


def test_the_page_shows_a_hostile_name_as_text(compared):
    html = (compared[0] / "fleet.html").read_text(encoding="utf-8")
    assert "<img src=x" not in html
    assert "a&lt;img src=x onerror=alert(1)&gt;b" in html


def test_the_page_is_readable(compared):
    assert_readable(compared[0] / "fleet.html")


def test_a_later_build_uses_the_priors_of_the_fleet(compared, project):
    out, _ = compared
    text = (project / "tyre.toml").read_text()

    def with_priors(path: Path, **changes: str):
        content = text.replace("[tyre]\n", f'[tyre]\npriors = "{path}"\n')
        for old, new in changes.values():
            content = content.replace(old, new)
        (project / "later.toml").write_text(content)
        return config.load(project / "later.toml")

    later = with_priors(out / "priors.json")
    known = of_fleet(later)
    population = json.loads((out / "fleet.json").read_text())["rigs"][0]["population"]["PKY6"]
    assert known["PKY6"].expected == population["mean"]
    assert known["PKY6"].spread == pytest.approx(
        (population["u_mean"] ** 2 + population["scatter"] ** 2) ** 0.5
    )
    assert pipeline.inputs.input_hashes(later)[str(out / "priors.json")]
    with pytest.raises(InputError, match="there is no file"):
        of_fleet(with_priors(out / "nowhere.json"))
    with pytest.raises(InputError, match=r"is not a priors\.json"):
        of_fleet(with_priors(out / "fleet.json"))
    with pytest.raises(InputError, match="FNOMIN 1400, but this tyre has 1800"):
        of_fleet(with_priors(out / "priors.json", load=("nominal_load = 1400", "nominal_load = 1800")))


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (
            lambda folder: (folder / "result.json").unlink(),
            "contains no result.json, so `mffit build` did not write it",
        ),
        (lambda folder: (folder / "result.json").write_text("{"), "cannot be read as JSON"),
        (
            lambda folder: (folder / "result.json").write_text("{}"),
            "is incomplete, or not written by `mffit build`",
        ),
        (lambda folder: (folder / "information.json").unlink(), "is missing"),
        (
            lambda folder: (folder / "information.json").write_text("[]"),
            "was not written by `mffit build`, or was changed",
        ),
    ],
)
def test_a_folder_that_is_not_a_build_is_named(folders, tmp_path, spoil, said):
    shutil.copytree(folders[1], tmp_path / "spoilt")
    spoil(tmp_path / "spoilt")
    with pytest.raises(InputError, match=said) as refused:
        fleet.read(tmp_path / "spoilt")
    assert str(tmp_path / "spoilt") in str(refused.value)


def test_tyres_of_one_name_are_called_by_their_folders(folders, tmp_path):
    shutil.copytree(folders[1], tmp_path / "again")
    found = pipeline.fleet([folders[0], folders[1], tmp_path / "again"])
    assert [row.specimen.name for row in found.rows] == [
        found.rows[0].specimen.name,
        folders[1].name,
        "again",
    ]


def test_a_fleet_needs_two_tyres(folders):
    with pytest.raises(InputError, match="two or more built tyres"):
        pipeline.fleet([folders[0]])
    with pytest.raises(InputError, match="each named once"):
        pipeline.fleet([folders[0], folders[0]])


@pytest.mark.slow
def test_a_cluster_continues_when_a_worker_is_killed(project, tmp_path):
    """Two workers of a real scheduler; when the first tyre is finished, a worker that is building is killed."""
    distributed = pytest.importorskip("distributed")
    sources = []
    for k in range(4):
        folder = tmp_path / str(k)
        shutil.copytree(project, folder)
        text = (folder / "tyre.toml").read_text().replace('"small"', f'"tyre-{k}"')
        (folder / "tyre.toml").write_text(text)
        sources.append(folder / "tyre.toml")
    killed: list[int] = []
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster:
        with distributed.Client(cluster.scheduler_address) as client:
            process_of = client.run(os.getpid)

        def kill_one(outcome: BuildOutcome) -> None:
            if not killed:
                with distributed.Client(cluster.scheduler_address) as client:
                    at_work = [address for address, tasks in client.processing().items() if tasks]
                killed.append(process_of[at_work[0]])
                os.kill(killed[0], signal.SIGKILL)

        outcomes = pipeline.build_many(
            sources,
            tmp_path / "out",
            jobs=cluster.scheduler_address,
            with_report=False,
            done=kill_one,
        )
    assert killed
    assert [outcome.state for outcome in outcomes] == ["built"] * 4
    for k in range(4):
        out = tmp_path / "out" / f"tyre-{k}"
        assert is_current(config.load(sources[k]), out, with_report=False)
        assert not (out / "report.html").exists()
    left = [path.name for path in (tmp_path / "out").iterdir() if path.name.startswith(".")]
    assert len(left) <= 1  # temporary folder of the killed worker, which the next run removes


def test_an_absent_scheduler_is_reported(project):
    pytest.importorskip("distributed")
    with pytest.raises(InputError, match=r"no Dask scheduler answers at ht tp://x"):
        pipeline.build_many([project / "tyre.toml"], project / "all", jobs="ht tp://x")

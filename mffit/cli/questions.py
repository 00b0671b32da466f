"""`mffit spin`, `align`, `diagnose`, `compare`, `plan` and `predict`: questions to points and builds."""

from pathlib import Path
from typing import Any

import click

from mffit.cli.console import Voice, told, voiced
from mffit.cli.options import PATH, given, out_option, path_centre, tyre_toml
from mffit.errors import InputError, check_readable


@click.command()
@tyre_toml
@out_option("Folder to write to", beside="out")
@voiced
def spin(tyre_toml: Path, out: Path, voice: Voice) -> None:
    """Measure eps_gamma directly.

    Checks the alignment and applies the direct method, without a fit; prints eps_gamma with its uncertainty budget. Exit code 3
    if the result is not to be trusted.
    """
    from mffit import pipeline
    from mffit.report import text

    with voice.progress() as show:
        show("measuring")
        measured = pipeline.spin(tyre_toml, out)
    voice.warn(measured.warnings)
    voice.answer(measured, text.spin_summary(measured), out, "spin.json")
    if not measured.trusted:
        voice.distrust("the measurement is not to be trusted: see above")


@click.command()
@click.argument("source", type=PATH, metavar="TYRE_TOML|FILE.csv")
@click.option(
    "--axes", type=click.Choice(["iso", "sae", "adapted-sae"]), help="Axes of a CSV file without a tyre.toml."
)
@path_centre
@click.option(
    "--resolution", "resolution_deg", type=float, metavar="DEG", help="Smallest step of the steering axis."
)
@voiced
def align(source: Path, voice: Voice, **asked: Any) -> None:
    """Compute the next steering correction.

    Uses forward and backward points at zero angles; the correction is in degrees of the rig's axis.
    """
    from mffit import pipeline
    from mffit.report import text

    if source.suffix != ".toml":
        check_readable(source)
        if asked["axes"] is None or asked["path_centre"] is None:
            raise InputError("a CSV file does not state axes and path centre; give --axes and --path-centre")
    alignment = pipeline.align(source, **{name: x for name, x in asked.items() if x is not None})
    voice.warn(alignment.warnings)
    voice.answer(alignment, text.alignment_table(alignment))


@click.command()
@tyre_toml
@click.option("--model", type=PATH, help="The simulation's .tir [default: that of the last build].")
@out_option("Folder to write to", beside="out/diagnosis")
@click.option(
    "--repair-all", is_flag=True, help="Correct the model for uncertain effects too (confidence below 50 %)."
)
@voiced
def diagnose(tyre_toml: Path, model: Path | None, out: Path, repair_all: bool, voice: Voice) -> None:
    """Find effects that a simulation lacks.

    Shows where simulation and measurement disagree, names the effects that explain it, and corrects the model.
    """
    from mffit import pipeline
    from mffit.report import text

    with voice.progress() as show:
        diagnosis = pipeline.diagnose(tyre_toml, model, out=out, repair_all=repair_all, progress=show)
    files = ("diagnosis.html", "diagnosis.json", *text.models_written(diagnosis))
    voice.answer(diagnosis, text.diagnosis_summary(diagnosis), out, *files)
    if not diagnosis.trusted:
        voice.distrust(f"{diagnosis.file_said} is not to be trusted: see above")


@click.command()
@click.argument("first", type=PATH, metavar="A.tir|FOLDER")
@click.argument("second", type=PATH, metavar="B.tir|FOLDER|TYRE_TOML")
@out_option("Folder for compare.html and compare.json [default: nothing is written].")
@click.option(
    "--turn-slip",
    type=click.Choice(["on", "off"]),
    callback=lambda context, option, word: None if word is None else word == "on",
    help="Evaluate both files with turn slip on or off [default: each as intended].",
)
@given
@voiced
def compare(first: Path, second: Path, out: Path | None, voice: Voice, **asked: Any) -> None:
    """Compare two property files, a file and data, or two builds.

    Ranks the differences of curves, stiffnesses, peaks, trail and eps_gamma.
    """
    import tir
    from mffit import pipeline
    from mffit.report import text

    for file in (first, second):
        if file.suffix == ".tir":
            voice.warn_of(file, tir.read(file, **asked["given"]))
    with voice.progress() as show:
        found = pipeline.compare(first, second, out=out, progress=show, **asked)
    voice.answer(found, text.comparison_table(found), out, "compare.html", "compare.json")


@click.command()
@tyre_toml
@click.option(
    "--goal",
    help="What to make more certain: eps_gamma, eps_gamma:joint, bands, bands:Mz, file or road "
    "[default: the source of PECP1].",
)
@click.option("--coefficient", metavar="NAME", help="Make this coefficient more certain instead.")
@click.option(
    "--runs", type=click.IntRange(1, 10), default=3, show_default=True, help="Largest number of runs."
)
@click.option(
    "--without", multiple=True, metavar="KIND", help="Kind of run that the rig cannot make; may be repeated."
)
@out_option("Folder to write to", beside="out/plan")
@voiced
def plan(
    tyre_toml: Path, goal: str | None, coefficient: str | None, out: Path, voice: Voice, **asked: Any
) -> None:
    """Plan the most informative further runs.

    Shows what the present sweeps identify, and the shortest list of runs that would add most.
    """
    from mffit import pipeline
    from mffit.report import text

    if goal and coefficient:
        raise InputError("--goal and --coefficient exclude each other; give only one")
    with voice.progress() as show:
        found = pipeline.plan(tyre_toml, coefficient or goal, out=out, progress=show, **asked)
    sheets = ["runs (sheets to fill in)"] if found.steps else []
    voice.answer(found, text.plan_summary(found), out, "plan.html", "plan.json", *sheets)


@click.command()
@click.argument("folder", type=PATH, metavar="DIR")
@click.argument("conditions", type=PATH, metavar="CONDITIONS.csv")
@out_option("File to write.", is_file=True, required=True)
@voiced
def predict(folder: Path, conditions: Path, out: Path, voice: Voice) -> None:
    """Predict forces at conditions, from the folder of a build.

    Writes the force of the property file and the best estimate, with the model error added; both with how far a new
    run may lie from them (k = 1). Conditions and forces are in ISO-W.
    """
    from mffit import pipeline
    from mffit.prediction import write_table
    from mffit.report import text

    with told(voice):
        found = pipeline.predict(folder, conditions)
    write_table(found, out, conditions)
    answer = {"written": [str(out)], "conditions": len(found)}
    voice.answer(answer, text.prediction_summary(found, out))

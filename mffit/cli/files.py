"""Commands on property files: `mffit check` and `mffit show`."""

from __future__ import annotations

from pathlib import Path

import click

from mffit.cli.console import Voice, out_option, voiced


@click.command()
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE.tir")
@click.option(
    "--for",
    "targets",
    default="",
    metavar="NAMES",
    help="Programs that must be able to read it: mftyre,simscape,...",
)
@voiced
def check(file: Path, targets: str, voice: Voice) -> None:
    """Check a property file.

    Looks at units, missing and unknown keys, and physics over the ranges of the file.
    """
    import tir
    from mffit.results import as_json
    from tir.errors import counted

    tyre = tir.read(file)
    names = [name.strip() for name in targets.split(",")]
    problems = [*tyre.problems, *tir.check(tyre, filter(None, names))]
    for problem in problems:
        voice.say(f"{problem.level}: {problem.sentence}")
    errors = sum(problem.level == "error" for problem in problems)
    voice.say(f"{file}: {counted(errors, 'error')}, {counted(len(problems) - errors, 'warning')}")
    voice.give(lambda: as_json.problems(file, problems))
    if errors:
        raise SystemExit(2)


@click.command()
@click.argument(
    "files", type=click.Path(path_type=Path), nargs=-1, required=True, metavar="FILE.tir... | tyre.toml"
)
@out_option("Page to write [default: FILE.html in the current folder].")
@click.option("--open", "open_it", is_flag=True, help="Open the page in a browser.")
@voiced
def show(files: tuple[Path, ...], out: Path | None, open_it: bool, voice: Voice) -> None:
    """Draw the curves of property files, or a project with its points.

    Writes a page with sliders for the conditions; several files are drawn in the same panels. The page of a tyre.toml has the
    measured points, and sliders for the coefficients.
    """
    import mffit

    with voice.progress() as say:
        page = mffit.show(files, out, progress=say)
    if out is None:
        stem = page.names[0] if files[0].suffix == ".toml" else files[0].stem
        out = page.write(Path(f"{stem}.html"))
    voice.say(f"written to {out}: {', '.join(page.names)}")
    voice.give(lambda: {"written": [str(out)]})
    if open_it:
        click.launch(str(out))

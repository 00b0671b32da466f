"""Commands on property files alone: `mffit check` and `mffit show`."""

from __future__ import annotations

from pathlib import Path

import click

from mffit.cli.console import Voice, voiced


@click.command()
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE.tir")
@click.option(
    "--for", "targets", default="", metavar="NAMES", help="Programs that are to read it: mftyre,simscape,..."
)
@voiced
def check(file: Path, targets: str, voice: Voice) -> None:
    """Check a .tir: units, missing and unknown keys, physics over the file's own ranges."""
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
    "files", type=click.Path(path_type=Path), nargs=-1, required=True, metavar="FILE.tir [MORE.tir]..."
)
@click.option(
    "--out", type=click.Path(path_type=Path), help="Page to write [default: FILE.html in this folder]."
)
@click.option("--open", "open_it", is_flag=True, help="Open the page in the browser.")
@voiced
def show(files: tuple[Path, ...], out: Path | None, open_it: bool, voice: Voice) -> None:
    """Curves of several .tir over one another, in a page with sliders."""
    import mffit

    out = out or Path(f"{files[0].stem}.html")
    page = mffit.show(files, out)
    voice.say(f"written to {out}: {', '.join(page.names)}")
    voice.give(lambda: {"written": [str(out)]})
    if open_it:
        click.launch(str(out))

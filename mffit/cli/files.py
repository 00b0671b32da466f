"""Commands on property files alone: `mffit check` and `mffit show`."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE.tir")
@click.option(
    "--for", "targets", default="", metavar="NAMES", help="Programs that are to read it: mftyre,simscape,..."
)
def check(file: Path, targets: str) -> None:
    """Check a .tir: units, missing and unknown keys, physics over the file's own ranges."""
    import tir
    from tir.check import check as problems_of

    tyre = tir.read(file)
    problems = [*tyre.problems, *problems_of(tyre, targets.split(",") if targets else ())]
    for problem in problems:
        click.echo(f"{problem.level}: {problem.sentence}")
    errors = sum(problem.level == "error" for problem in problems)
    click.echo(f"{file}: {errors} errors, {len(problems) - errors} warnings")
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
def show(files: tuple[Path, ...], out: Path | None, open_it: bool) -> None:
    """Curves of several .tir over one another, in a page with sliders."""
    import mffit

    out = out or Path(f"{files[0].stem}.html")
    page = mffit.show(files, out)
    click.echo(f"written to {out}: {', '.join(page.names)}")
    if open_it:
        click.launch(str(out))

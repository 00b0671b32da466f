"""Commands on property files alone: `mffit check`."""

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

"""Commands on property files and projects: `mffit check`, `show`, `open` and `convert`."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mffit.cli.console import NOT_TRUSTED, Voice, voiced
from mffit.cli.options import PATH, given, names_of_programs, out_option, tir_file

if TYPE_CHECKING:
    from tir import Problem


@click.command()
@tir_file
@names_of_programs("Programs that must be able to read it: mftyre,simscape,...", default="")
@given
@voiced
def check(file: Path, targets: list[str], given: dict[str, float], voice: Voice) -> None:
    """Check a property file.

    Looks at units, missing and unknown keys, and physics over the ranges of the file. A file of PAC2002 is checked for programs
    that read it (--for chrono).
    """
    import tir
    from tir.errors import counted

    of_old = _of_old(file, targets, given)
    problems = tir.check(tir.read(file, **given), targets) if of_old is None else of_old
    for problem in problems:
        voice.say(f"{problem.level}: {problem.sentence}")
    errors, warnings = (sum(p.level == level for p in problems) for level in ("error", "warning"))
    voice.say(f"{file}: {counted(errors, 'error')}, {counted(warnings, 'warning')}")
    voice.give({"file": file, "problems": problems})
    if errors:
        raise SystemExit(2)


def _of_old(file: Path, programs: list[str], given: dict[str, float]) -> list[Problem] | None:
    """Problems of an old file in programs that read it; None if another file, or another program, is asked about."""
    if not programs:
        return None
    from mffit import conversion

    if not set(programs) <= set(conversion.READERS) or not conversion.is_old(file):
        return None
    return conversion.check_old(file, programs, given)


@click.command()
@click.argument("files", type=PATH, nargs=-1, required=True, metavar="FILE.tir... | tyre.toml")
@out_option("Page to write [default: FILE.html in the current folder].", is_file=True)
@click.option("--open", "open_it", is_flag=True, help="Open the page in a browser.")
@given
@voiced
def show(
    files: tuple[Path, ...], out: Path | None, open_it: bool, given: dict[str, float], voice: Voice
) -> None:
    """Draw the curves of property files, or a project with its points.

    Writes a page with sliders for the conditions; several files are drawn in the same panels. The page of a tyre.toml has the
    measured points, and sliders for the coefficients.
    """
    import mffit
    import tir

    for file in files:
        if file.suffix == ".tir":
            voice.warn_of(file, tir.read(file, **given))
    with voice.progress() as say:
        page = mffit.show(files, out, given=given, progress=say)
    if out is None:
        stem = page.names[0] if files[0].suffix == ".toml" else files[0].stem
        out = page.write(Path(f"{stem}.html"))
    voice.answer({"written": [str(out)]}, f"written to {out}: {', '.join(page.names)}")
    if open_it:
        click.launch(str(out))


@click.command()
@click.argument("file", type=PATH, metavar="FILE.tir")
@out_option("File to write.", is_file=True, required=True)
@click.option(
    "--to", type=click.Choice(["mf52", "pac2002"]), help="Convert a file of MF 6.2 to an older formula."
)
@given
@click.option(
    "--fittyp",
    type=click.Choice(["5", "6", "21"]),
    callback=lambda context, option, word: None if word is None else int(word),
    help="Version of the file, if its own FITTYP is wrong or missing.",
)
@voiced
def convert(
    file: Path, out: Path, to: str | None, given: dict[str, float], fittyp: int | None, voice: Voice
) -> None:
    """Convert a property file of MF 5.2 or PAC2002 to MF 6.2, or with --to one of MF 6.2 back.

    Fits what means something else in the other formula to the forces of the file, and states the misfit.
    """
    from mffit import as_json, conversion
    from mffit.conversion import wording
    from mffit.report import text

    found = conversion.to_old(file, to, given) if to else conversion.convert(file, given, fittyp=fittyp)
    conversion.write(found, out)
    voice.warn(problem.sentence for problem in found.problems if problem.level != "error")
    answer = {"file": found.path, "written": out, **as_json.document(found)}
    voice.answer(answer, f"{text.conversion_summary(found)}\nwritten to {out}")
    if wording.reasons(found):
        raise SystemExit(NOT_TRUSTED)


@click.command("open")
@click.argument("paths", type=PATH, nargs=-1, required=True, metavar="tyre.toml|FOLDER|FILE.tir...")
@click.option(
    "--port", type=click.IntRange(0, 65535), default=0, help="Port on this machine [default: a free one]."
)
@click.option("--no-browser", is_flag=True, help="Only print the address.")
@voiced
def open_window(paths: tuple[Path, ...], port: int, no_browser: bool, voice: Voice) -> None:
    """Open a project in a local window in the browser.

    Shows measured points and curves, adjusts coefficients, leaves points out, and refits; every click is saved in tyre.toml.
    A folder of recordings is shown as a table to correct, then becomes a project. Ctrl-C ends it; other machines cannot reach
    it.
    """
    from mffit import window

    addresses: list[str] = []

    def opened(address: str) -> None:
        addresses.append(address)
        if len(addresses) > 1:
            return voice.say(f"another browser: {address}")
        voice.say(f"{paths[0]}: open at {address}\nCtrl-C ends it")
        voice.give({"address": address})

    def launch(page: Path) -> None:
        webbrowser.open(page.as_uri())

    window.open_path(paths, port=port, opened=opened, launch=None if no_browser else launch)

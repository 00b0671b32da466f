"""The command line: a thin shell over the Python API; a module per group of commands."""

from __future__ import annotations

import errno
import sys
from contextlib import redirect_stderr, redirect_stdout

import click

from mffit.cli import building, comparing, diagnosing, exporting, files, measuring, planning, projects, rigs
from mffit.cli.console import Unheard

CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 100}
COMMANDS = (
    building.build,
    building.fleet,
    measuring.spin,
    measuring.align,
    diagnosing.diagnose,
    comparing.compare,
    planning.plan,
    files.check,
    files.show,
    exporting.export,
    rigs.simulate,
    projects.sniff,
    projects.init,
)


@click.group(context_settings=CONTEXT)
@click.version_option(package_name="mffit", prog_name="mffit")
def commands() -> None:
    """From tyre-rig sweeps to an MF-6.2 property file with a measured camber reduction factor."""


for command in COMMANDS:
    commands.add_command(command)


def main(arguments: list[str] | None = None) -> None:
    """Entry point: exit 0 done, 2 bad input or usage with one sentence, 1 a bug."""
    with redirect_stdout(Unheard(sys.stdout)), redirect_stderr(Unheard(sys.stderr)):
        _run(arguments)


def _run(arguments: list[str] | None) -> None:
    from mffit.errors import InputError
    from tir.errors import TirError

    try:
        commands.main(arguments, standalone_mode=False)
        sys.stdout.flush()
    except (InputError, TirError) as error:
        click.echo(f"mffit: {error}", err=True)
        sys.exit(2)
    except OSError as error:
        if error.errno != errno.ENOSPC:
            raise
        click.echo(
            f"mffit: no room is left on the disk ({error.filename or 'what is printed'}); make some", err=True
        )
        sys.exit(2)
    except click.ClickException as error:
        error.show()
        sys.exit(2)
    except (click.Abort, KeyboardInterrupt):
        click.echo("mffit: interrupted; nothing was written", err=True)
        sys.exit(130)

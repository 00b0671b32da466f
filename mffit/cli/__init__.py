"""The command line, a thin layer over the Python API; one module per group of commands."""

import errno
import sys
from contextlib import redirect_stderr, redirect_stdout

import click

from mffit.cli import building, exporting, files, projects, questions, watching
from mffit.cli.console import PipeTolerant

CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 100}
COMMANDS = (
    building.build,
    building.fleet,
    questions.spin,
    questions.align,
    questions.diagnose,
    questions.compare,
    questions.plan,
    questions.predict,
    watching.watch,
    files.check,
    files.show,
    files.open_window,
    files.convert,
    exporting.export,
    projects.simulate,
    projects.sniff,
    projects.init,
)


@click.group(context_settings=CONTEXT)
@click.version_option(package_name="mffit", prog_name="mffit")
def commands() -> None:
    """Make MF-6.2 property files from tyre-rig sweeps, with a measured camber reduction factor."""


for command in COMMANDS:
    commands.add_command(command)


def main(arguments: list[str] | None = None) -> None:
    """Entry point; exits with 0 if done, with 2 and one sentence on bad input or usage, with 1 on a bug."""
    with redirect_stdout(PipeTolerant(sys.stdout)), redirect_stderr(PipeTolerant(sys.stderr)):
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
        place = error.filename or "standard output"
        click.echo(f"mffit: the disk is full ({place}); free some space and run again", err=True)
        sys.exit(2)
    except click.ClickException as error:
        error.show()
        sys.exit(2)
    except (click.Abort, KeyboardInterrupt):
        click.echo("mffit: interrupted; nothing was written", err=True)
        sys.exit(130)

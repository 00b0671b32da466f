"""``python -m mffit`` and the script ``mffit``: the command line, whose modules take some tenths of a second to import."""

import gc
import sys


def main() -> None:
    """Entry point; an interruption during the imports ends with the sentence and the exit code of a later one."""
    # The usual searches for garbage take an eighth of the time of a build.
    gc.set_threshold(100 * gc.get_threshold()[0])
    try:
        from mffit.cli import main as commands
    except KeyboardInterrupt:
        print("mffit: interrupted; nothing was written", file=sys.stderr)
        sys.exit(130)
    commands()


if __name__ == "__main__":
    main()

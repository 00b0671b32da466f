"""``python -m mffit``: the command line, where the script ``mffit`` is not on the path."""

from mffit.cli import main

if __name__ == "__main__":
    main()

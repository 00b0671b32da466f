"""Coverage-guided fuzzing of every reader: `python tests/studies/fuzz_readers.py csv -max_total_time=60`.

The first argument is the kind of file: csv, dat, xlsx, parquet, tdx (sweeps), tir or toml; the others are those of libFuzzer.
The run starts from the samples and stops at the first file that is neither read nor refused in one sentence; that file is kept
as crash-*. MATLAB files are read in a separate process, where coverage is not visible; hypothesis covers them in the tests.
Needs the extra ``studies``.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["mffit", "tir"]):
    import tir
    from mffit import config
    from mffit.errors import InputError
    from mffit.pipeline.exporting import write_tydex
    from mffit.recordings.guess import guesses
    from mffit.sweeps import formats
    from tir.checking import check
    from tir.errors import TirError

SAMPLE = Path(__file__).parents[2] / "samples" / "front-120-70"


def sweep(path: Path) -> None:
    guesses(formats.read(path))


def property_file(path: Path) -> None:
    check(tir.read(path))


READERS: dict[str, Callable[[Path], object]] = {
    "csv": sweep, "dat": sweep, "xlsx": sweep, "parquet": sweep, "tdx": sweep, "tir": property_file, "toml": config.load,
}  # fmt: skip


def corpus(kind: str, folder: Path) -> None:
    """Write small sound files to start from."""
    import pandas as pd

    table = pd.read_csv(SAMPLE / "camber_900N.csv").head(4)
    if kind in ("csv", "dat"):
        table.to_csv(folder / "a", index=False, sep="," if kind == "csv" else "\t")
    elif kind == "xlsx":
        table.to_excel(folder / "a.xlsx", index=False)
    elif kind == "parquet":
        table.to_parquet(folder / "a")
    elif kind == "tdx":
        for path in write_tydex(SAMPLE / "tyre.toml", folder / "out"):
            path.rename(folder / path.name)
    else:
        (folder / "a").write_bytes((SAMPLE / {"tir": "true.tir", "toml": "tyre.toml"}[kind]).read_bytes())


def main() -> None:
    kind = sys.argv[1]
    read = READERS[kind]
    seeds, place = Path(tempfile.mkdtemp()), Path(tempfile.mkdtemp()) / f"a.{kind}"
    corpus(kind, seeds)

    def tried(content: bytes) -> None:
        place.write_bytes(content)
        message = "nothing"
        try:
            read(place)
        except (InputError, TirError) as error:
            message = str(error)
        assert message.strip()
        assert "\n" not in message

    atheris.Setup([sys.argv[0], *sys.argv[2:], str(seeds)], tried)
    atheris.Fuzz()


if __name__ == "__main__":
    main()

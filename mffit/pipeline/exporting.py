"""``mffit export tydex``: the points of a project for other programs."""

from pathlib import Path

from mffit import config as configuration
from mffit.config import Config
from mffit.export.tydex import tydex_texts
from mffit.output import output_folder
from mffit.pipeline.inputs import inputs_of, read_points


def write_tydex(config: Config | str | Path, out: str | Path) -> list[Path]:
    """Write the points that ``mffit build`` would use as TYDEX 1.3, one file per sweep.

    Parameters
    ----------
    config : path of a ``tyre.toml``, or a loaded Config
    out : folder to write to

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    InputError
        The sweeps cannot be read, two have the same name, or the folder cannot be written to.
    """
    config, out = configuration.load(config), Path(out)
    texts = tydex_texts(read_points(config).points, config)
    with output_folder(out, by="export", protected=inputs_of(config)) as folder:
        for name, text in texts.items():
            (folder / f"{name}.tdx").write_text(text, encoding="latin-1", errors="replace", newline="\r\n")
    return [out / f"{name}.tdx" for name in texts]

"""A small file that holds far more than a recording is refused in every format, before it fills the memory."""

from __future__ import annotations

import gzip
import zipfile
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import scipy.io

from mffit.errors import InputError
from mffit.sweeps import constants, formats

LIMIT = 2_000_000
ROWS = 1_000_000
"""Of two columns of numbers: 16 MB."""


def packed_text(path: Path) -> None:
    with gzip.open(path, "wb") as file:
        file.write(b"alpha_deg,Fy_N\n" + b"0.00,00.0\n" * ROWS)


def packed_mat(path: Path) -> None:
    scipy.io.savemat(path, {"SA": np.zeros((ROWS, 1)), "FY": np.zeros((ROWS, 1))}, do_compression=True)


def claimed_mat73(path: Path) -> None:
    """Data sets of which no number is stored."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        for name in ("SA", "FY"):
            file.create_dataset(name, shape=(1, ROWS), dtype="f8", chunks=(1, 1000), fillvalue=0.0)


def repeated_parquet(path: Path) -> None:
    pytest.importorskip("pyarrow")
    pd.DataFrame({"SA": np.zeros(ROWS), "FY": np.zeros(ROWS)}).to_parquet(path, compression="zstd")


def packed_workbook(path: Path) -> None:
    pytest.importorskip("openpyxl")
    pd.DataFrame({"SA": [1.0], "FY": [2.0]}).to_excel(path, index=False)
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as file:
        file.writestr("xl/media/noise.bin", bytes(10 * LIMIT))


def packed_structure(path: Path) -> None:
    scipy.io.savemat(path, {"S": {"FY": np.zeros((LIMIT, 1))}}, do_compression=True)


def short_numbers(path: Path) -> None:
    """One byte a number in the file, eight once it is loaded."""
    zeros = np.zeros((LIMIT // 4, 1), np.int8)
    scipy.io.savemat(path, {"S": {"SA": zeros, "FY": zeros}}, do_compression=True)


def wide_workbook(path: Path) -> None:
    """Two rows that a cell in the last column pads to 16384 cells each, a hundred times."""
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    sheet = book.active
    sheet["A1"], sheet["B1"], sheet["XFD100"] = "SA", "FY", 1.0
    book.save(path)


BOMBS = {
    "a.csv.gz": packed_text,
    "a.tdx.gz": packed_text,
    "a.mat": packed_mat,
    "b.mat": claimed_mat73,
    "c.mat": packed_structure,
    "d.mat": short_numbers,
    "a.parquet": repeated_parquet,
    "a.xlsx": packed_workbook,
    "b.xlsx": wide_workbook,
}


@pytest.mark.parametrize("name", BOMBS)
def test_a_file_that_holds_too_much_is_refused_in_a_sentence(tmp_path, monkeypatch, name):
    monkeypatch.setattr(constants, "LARGEST_UNPACKED", LIMIT)
    BOMBS[name](tmp_path / name)
    assert (tmp_path / name).stat().st_size < LIMIT / 10
    with pytest.raises(InputError, match="holds more than 2 MB when unpacked") as caught:
        formats.read(tmp_path / name)
    assert name in str(caught.value)


def test_a_plain_text_has_the_same_limit(tmp_path, monkeypatch):
    (tmp_path / "a.csv").write_bytes(b"alpha_deg,Fy_N\n" + b"0.00,00.0\n" * 1000)
    assert len(formats.read(tmp_path / "a.csv")) == 1000
    monkeypatch.setattr(constants, "LARGEST_UNPACKED", 10_000)
    with pytest.raises(InputError, match="holds more than"):
        formats.read(tmp_path / "a.csv")


def test_a_packed_text_is_counted_no_further_than_the_limit(tmp_path, monkeypatch):
    """Behind the limit the file is damaged, which nobody sees."""
    monkeypatch.setattr(constants, "LARGEST_UNPACKED", LIMIT)
    packed_text(tmp_path / "a.csv.gz")
    content = (tmp_path / "a.csv.gz").read_bytes()
    (tmp_path / "a.csv.gz").write_bytes(content[:-8])
    with pytest.raises(InputError, match="holds more than"):
        formats.read(tmp_path / "a.csv.gz")


@pytest.mark.parametrize("order", ["<", ">"])
def test_what_is_below_the_limit_is_read(tmp_path, monkeypatch, order):
    monkeypatch.setattr(constants, "LARGEST_UNPACKED", LIMIT)
    alpha = np.random.default_rng(1).standard_normal(50_000).astype(f"{order}f8")
    scipy.io.savemat(tmp_path / "a.mat", {"SA": alpha[:, None], "FY": alpha[:, None]}, do_compression=True)
    np.testing.assert_array_equal(formats.read(tmp_path / "a.mat").column("SA"), alpha)


def test_a_small_file_holds_little(tmp_path):
    """Whatever the largest recording is: rows that are all alike, which no rig reads."""
    packed_text(tmp_path / "a.csv.gz")
    with pytest.raises(InputError, match="holds more than 4 MB when unpacked"):
        formats.read(tmp_path / "a.csv.gz")
    noise = np.random.default_rng(1).standard_normal((100_000, 2))
    pd.DataFrame(noise, columns=["alpha_deg", "Fy_N"]).round(3).to_csv(tmp_path / "b.csv.gz", index=False)
    assert len(formats.read(tmp_path / "b.csv.gz")) == 100_000


@pytest.mark.parametrize("kind", ["storage", "link", "view"])
def test_a_recording_takes_no_numbers_out_of_other_files(tmp_path, kind):
    """HDF5 would read any file that it names."""
    h5py = pytest.importorskip("h5py")
    path, other = tmp_path / "a.mat", tmp_path / "of_somebody_else.bin"
    np.arange(100.0).tofile(other)
    with h5py.File(tmp_path / "b.mat", "w") as file:
        file["FY"] = np.arange(100.0)
    with h5py.File(path, "w") as file:
        file["SA"] = np.linspace(-5.0, 5.0, 100)
        if kind == "storage":
            file.create_dataset("FY", (100,), dtype="f8", external=[(str(other), 0, 800)])
        elif kind == "link":
            file["deep/FY"] = h5py.ExternalLink(str(tmp_path / "b.mat"), "/FY")
        else:
            layout = h5py.VirtualLayout(shape=(100,), dtype="f8")
            layout[:] = h5py.VirtualSource(str(tmp_path / "b.mat"), "FY", shape=(100,))
            file.create_virtual_dataset("FY", layout)
    with pytest.raises(InputError, match="takes numbers out of other files"):
        formats.read(path)

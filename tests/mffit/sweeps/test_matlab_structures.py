"""Structures, arrays of structures, tables and matrices of MATLAB, in v5 and in v7.3."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
import scipy.io

from mffit.errors import InputError
from mffit.sweeps import formats

CHANNELS = {"ET": np.arange(6.0), "SA": np.linspace(-2.0, 2.0, 6), "FY": np.linspace(300.0, -300.0, 6)}
STRUCTURES = {
    "one": {"data": CHANNELS},
    "nested": {"test": {"info": {"tyre": "A"}, "data": CHANNELS}},
    "signals": {name: {"unit": "N", "values": values} for name, values in CHANNELS.items()},
    "runs": {
        f"run{k}": {name: values[3 * k : 3 * k + 3] for name, values in CHANNELS.items()} for k in (0, 1)
    },
    "array": {
        "run": [{name: values[3 * k : 3 * k + 3] for name, values in CHANNELS.items()} for k in (0, 1)]
    },
    "recorder": {  # as a dSPACE recorder saves it: two arrays of structures, each with name and unit next to its vector
        "rec1_001": {
            "X": [{"Name": "ET", "Data": CHANNELS["ET"], "Unit": "N"}],
            "Y": [{"Name": name, "Data": CHANNELS[name], "Unit": "N"} for name in ("SA", "FY")],
            "Capture": {"Name": "Rig"},
        }
    },
    "rows": {"table": [{name: values[k : k + 1] for name, values in CHANNELS.items()} for k in range(6)]},
}


def classic(value):
    """What scipy writes as the structure, vector or text."""
    if isinstance(value, dict):
        return {name: classic(one) for name, one in value.items()}
    if isinstance(value, list):
        return np.array(
            [tuple(classic(x) for x in one.values()) for one in value], [(n, object) for n in value[0]]
        )
    return value if isinstance(value, str) else value[:, None]


def into_hdf5(group, name, value, file):
    """Write as MATLAB does to v7.3: the elements of an array of structures are references.

    Their type is named, because an old h5py does not find it in an array of them.
    """
    import h5py

    if isinstance(value, dict):
        for key, one in value.items():
            into_hdf5(group.require_group(name), key, one, file)
    elif isinstance(value, list):
        for key in value[0]:
            for k, one in enumerate(value):
                into_hdf5(file.require_group("#refs#"), f"{name}{key}{k}", one[key], file)
            items = [file[f"#refs#/{name}{key}{k}"] for k in range(len(value))]
            references = group.require_group(name).create_dataset(key, (1, len(items)), h5py.ref_dtype)
            for k, item in enumerate(items):
                references[0, k] = item.ref
    else:
        codes = np.array([[ord(c)] for c in value], np.uint16) if isinstance(value, str) else value[None]
        group.create_dataset(name, data=codes).attrs["MATLAB_class"] = (
            np.bytes_("char") if isinstance(value, str) else np.bytes_("double")
        )


def write(path: Path, content, version: str) -> Path:
    if version == "5":
        scipy.io.savemat(path, {name: classic(value) for name, value in content.items()})
        return path
    with pytest.importorskip("h5py").File(path, "w") as file:
        for name, value in content.items():
            into_hdf5(file, name, value, file)
    return path


@pytest.mark.parametrize("version", ["5", "7.3"])
@pytest.mark.parametrize("kind", STRUCTURES)
def test_the_channels_within_structures_are_found(tmp_path, kind, version):
    raw = formats.read(write(tmp_path / "a.mat", STRUCTURES[kind], version))
    assert set(raw.headings) - {"run"} == set(CHANNELS)
    for name, values in CHANNELS.items():
        np.testing.assert_array_equal(raw.column(name), values)
    assert set(raw.units) == ({"N"} if kind in ("signals", "recorder") else {""})
    if kind in ("runs", "array"):
        assert len(set(raw.column("run")[:3])) == len(set(raw.column("run")[3:])) == 1
        assert len(set(raw.column("run"))) == 2


def element(kind: int, content: bytes) -> bytes:
    """An element of a MAT file of v5."""
    return struct.pack("<II", kind, len(content)) + content + bytes(-len(content) % 8)


def with_object(kind: str) -> bytes:
    """A MAT file with one object of MATLAB, called T, whose content is in a part that MATLAB alone reads."""
    numbers = element(6, struct.pack("<II", 13, 0)) + element(5, struct.pack("<ii", 2, 1)) + element(1, b"")
    words = b"".join(element(1, word.encode()) for word in ("T", "MCOS", kind))
    content = (
        element(6, struct.pack("<II", 17, 0))
        + words
        + element(14, numbers + element(6, struct.pack("<II", 1, 1)))
    )
    return b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x0100) + b"IM" + element(14, content)


def with_object_73(path: Path, kind: str) -> None:
    with pytest.importorskip("h5py").File(path, "w") as file:
        one = file.create_dataset("T", data=np.arange(6, dtype=np.uint32)[None])
        one.attrs["MATLAB_class"], one.attrs["MATLAB_object_decode"] = np.bytes_(kind), 3


@pytest.mark.parametrize("version", ["5", "7.3"])
@pytest.mark.parametrize(
    ("kind", "remedy"),
    [
        ("table", r'writetable\(T, "a.csv"\)'),
        ("timetable", r'writetable\(timetable2table\(T\), "a.csv"\)'),
        ("datetime", "save every channel as a vector"),
    ],
)
def test_an_object_is_refused_with_what_to_write_in_matlab(tmp_path, kind, remedy, version):
    if version == "5":
        (tmp_path / "a.mat").write_bytes(with_object(kind))
    else:
        with_object_73(tmp_path / "a.mat", kind)
    with pytest.raises(InputError, match=rf"a\.mat: holds T, an object of MATLAB \({kind}\) .*{remedy}"):
        formats.read(tmp_path / "a.mat")


def test_a_matrix_without_names_is_refused(tmp_path):
    scipy.io.savemat(tmp_path / "a.mat", {"data": np.ones((20, 3))})
    with pytest.raises(InputError, match=r"data, a matrix of 20 x 3, .*SA = data\(:, 1\)"):
        formats.read(tmp_path / "a.mat")


def test_a_cell_array_of_structures_is_read_as_runs(tmp_path):
    alpha = np.linspace(-8.0, 8.0, 12)
    runs = [{"SA": alpha + k, "FY": -1000.0 * alpha * (1 + k)} for k in range(3)]
    scipy.io.savemat(tmp_path / "a.mat", {"data": np.array(runs, dtype=object)})
    raw = formats.read(tmp_path / "a.mat")
    assert raw.headings == ("SA", "FY", "run")
    np.testing.assert_allclose(raw.column("SA"), np.concatenate([run["SA"] for run in runs]))
    np.testing.assert_allclose(raw.column("FY"), np.concatenate([run["FY"] for run in runs]))
    assert list(dict.fromkeys(raw.column("run"))) == ["data(1)", "data(2)", "data(3)"]


def cells_into_hdf5(path: Path, cells: list) -> Path:
    """Write a cell array of v7.3, whose cells are references."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        array = file.create_dataset("data", (len(cells), 1), h5py.ref_dtype)
        array.attrs["MATLAB_class"] = np.bytes_("cell")
        for k, cell in enumerate(cells):
            into_hdf5(file.require_group("#refs#"), f"c{k}", cell, file)
            array[k, 0] = file[f"#refs#/c{k}"].ref
    return path


def test_a_cell_array_of_structures_of_v73_is_read_as_runs(tmp_path):
    alpha = np.linspace(-8.0, 8.0, 12)
    runs = [{"SA": alpha + k, "FY": -1000.0 * alpha * (1 + k)} for k in range(3)]
    raw = formats.read(cells_into_hdf5(tmp_path / "a.mat", runs))
    np.testing.assert_allclose(raw.column("SA"), np.concatenate([run["SA"] for run in runs]))
    assert list(dict.fromkeys(raw.column("run"))) == ["data(1)", "data(2)", "data(3)"]


def test_a_cell_array_of_vectors_is_refused_with_the_cure(tmp_path):
    vectors = [np.linspace(0.0, 1.0, 9), np.linspace(2.0, 3.0, 9)]
    cells = np.empty((1, 2), dtype=object)
    cells[0, :] = vectors
    scipy.io.savemat(tmp_path / "five.mat", {"data": cells})
    cells_into_hdf5(tmp_path / "seven.mat", vectors)
    for name in ("five.mat", "seven.mat"):
        with pytest.raises(InputError, match=r"data, a cell array of vectors.*SA = data\{1\}"):
            formats.read(tmp_path / name)

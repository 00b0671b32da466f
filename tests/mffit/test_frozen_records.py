"""Arrays of frozen records are read-only, in every folder."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from dataclasses import fields, is_dataclass

import pytest

import mffit
import tir
from tir.frozen import ReadOnlyArrays


def records() -> Iterator[type]:
    """The frozen dataclasses with a field that is, or holds, an array."""
    for package in (mffit, tir):
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if found.name.endswith("__main__"):
                continue
            for record in vars(importlib.import_module(found.name)).values():
                own = isinstance(record, type) and record.__module__ == found.name and is_dataclass(record)
                if own and record.__dataclass_params__.frozen and any(map(_holds_array, fields(record))):
                    yield record


def _holds_array(field) -> bool:
    return "ndarray" in str(field.type) and "Callable" not in str(field.type)


RECORDS = list(records())


@pytest.mark.parametrize("record", RECORDS, ids=lambda record: record.__name__)
def test_the_record_makes_its_arrays_read_only(record):
    assert issubclass(record, ReadOnlyArrays)
    assert ReadOnlyArrays.__post_init__ is record.__post_init__ or record.__name__ == "RawTable"


def test_there_are_such_records():
    assert len(RECORDS) > 50

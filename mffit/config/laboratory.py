"""``[lab]``: the order, and the instruments with their calibrations."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import date
from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, model_validator

from mffit.config import quantities as q
from mffit.config.table import Table, list_of_tables


def _named(name: str) -> str:
    if not name.strip():
        raise q.wrong('is empty; write the instrument, such as "Fy load cell"')
    return name


class InstrumentTable(Table):
    """One entry of ``[lab] instruments``."""

    name: Annotated[str, AfterValidator(_named)]
    serial: str = ""
    certificate: str = ""  #: number of the calibration certificate
    calibrated: date | None = None
    due: date | None = None  #: of the next calibration

    @model_validator(mode="after")
    def _due_after_calibrated(self) -> InstrumentTable:
        if self.calibrated is not None and self.due is not None and self.due < self.calibrated:
            raise q.wrong(
                f"{self.due} is before the calibration of {self.calibrated}; correct one of the two", "due"
            )
        return self


class LabTable(Table):
    """[lab]: records of the laboratory, copied to the report and to ``result.json``."""

    order: str = ""
    operator: str = ""
    measured: date | None = None  #: date of the measurement; calibrations are judged by it
    instruments: Annotated[tuple[InstrumentTable, ...], BeforeValidator(list_of_tables)] = ()


def lab_warnings(lab: LabTable, today: date) -> tuple[str, ...]:
    """Sentences about instruments whose calibration does not cover the measurement, ``today`` if its date is not stated."""
    return tuple(_uncovered(lab, today))


def _uncovered(lab: LabTable, today: date) -> Iterator[str]:
    if lab.measured is not None and lab.measured > today:
        yield f"[lab] measured = {lab.measured} is later than today, {today}; correct the date"
    day = lab.measured or today
    what = f"the measurement on {day}" if lab.measured else f"today, {day}"
    valid = "name the certificate that was valid then"
    due = (
        valid
        if lab.measured
        else "have it calibrated, or state the date of the measurement as [lab] measured"
    )
    for one in lab.instruments:
        if one.due is not None and one.due < day:
            yield f'instrument "{one.name}": its calibration was due on {one.due}, before {what}; {due}'
        if one.calibrated is not None and one.calibrated > day:
            yield f'instrument "{one.name}": it was calibrated on {one.calibrated}, after {what}; {valid}'

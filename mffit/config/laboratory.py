"""``[lab]``: the order, and the instruments with their calibrations."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import date
from typing import Annotated, Literal

from pydantic import AfterValidator, BeforeValidator, PositiveFloat, model_validator

from mffit.config import quantities as q
from mffit.config.table import Table, list_of_tables
from mffit.rig_errors import CALIBRATED


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
    channel: Literal[*CALIBRATED] | None = None  # type: ignore[valid-type] #: that it reads
    expanded_uncertainty: PositiveFloat | None = None
    """U of the certificate, over the reading unless ``at`` is given."""
    at: PositiveFloat | None = None  #: reading at which U holds, in the unit of U
    k: PositiveFloat | None = None  #: coverage factor of U; 2 unless given

    @property
    def u_gain(self) -> float | None:
        """Relative standard uncertainty of its calibration; None if the certificate is not given."""
        if self.channel is None or self.expanded_uncertainty is None:
            return None
        return self.expanded_uncertainty / (self.at or 1.0) / (self.k or 2.0)

    @model_validator(mode="after")
    def _certificate_is_whole(self) -> InstrumentTable:
        if (self.channel is None) != (self.expanded_uncertainty is None):
            raise q.wrong("has only one of channel and expanded_uncertainty; give both, or none")
        u = self.u_gain
        if u is not None and u > 1.0:
            raise q.wrong(
                f"{self.expanded_uncertainty:g} is more than the reading; write 0.01 for 1 %, or the reading where it holds as "
                "at",
                "expanded_uncertainty",
            )
        return self

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


def lab_warnings(lab: LabTable, today: date) -> Iterator[str]:
    """Sentences about instruments whose calibration does not cover the measurement, ``today`` if its date is not stated."""
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

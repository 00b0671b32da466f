"""One self-contained HTML file: a filled template with its pictures."""

import base64
import io
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from mffit.made import COMPUTING, libraries, made
from mffit.report import constants, numbers, typeset
from mffit.report.drawing.records import Sheet, with_fewer_rows
from mffit.report.text.filling import templates

View = TypeVar("View")


@dataclass(frozen=True, slots=True, kw_only=True)
class PagePicture:
    """A picture in the page, whose template has its title and caption."""

    name: str  #: file stem of its PNG
    drawing: str  #: its panels as HTML
    table: str  #: the numbers behind it, CSV
    remark: str  #: part of the caption for these data only

    @property
    def link(self) -> str:
        """A ZIP archive of the table, as a data address; the same table gives the same bytes."""
        buffer = io.BytesIO()
        with zipfile.ZipFile(buffer, "w") as archive:
            archive.writestr(zipfile.ZipInfo(f"{self.name}.csv"), self.table, zipfile.ZIP_DEFLATED)
        return f"data:application/zip;base64,{base64.b64encode(buffer.getvalue()).decode('ascii')}"


def write(
    template: str, path: Path, drawn: Mapping[str, Callable[[View], Sheet]], view: View, **content: object
) -> None:
    """Draw the pictures of a view, fill a template of ``templates/`` with them and the content, and write the page as UTF-8.

    ``drawn`` has by name, the file stem of the PNG, what makes the sheet of a picture.
    """
    pictures = {name: picture(path.parent, name, sheet_of(view)) for name, sheet_of in drawn.items()}
    filled = templates(escaped=True).get_template(template)
    libraries_used = libraries((*COMPUTING, "matplotlib"))
    html = filled.render(made=made(), used=libraries_used, pictures=pictures, view=view, **content)
    path.write_text(typeset.page(html), encoding="utf-8")


def picture(folder: Path, name: str, whole: Sheet) -> PagePicture | None:
    """Draw a sheet into ``folder/plots/<name>.png``, and as it stands in the page; None if it has no panel."""
    from mffit.report.drawing import pictures

    if not whole.panels:
        return None
    (folder / "plots").mkdir(parents=True, exist_ok=True)
    sheet = with_fewer_rows(whole, int(constants.MOST_PANELS))
    drawing = pictures.draw(sheet)
    (folder / "plots" / f"{name}.png").write_bytes(drawing.png)
    return PagePicture(name=name, drawing=drawing.markup, table=numbers.table(whole), remark=sheet.remark)

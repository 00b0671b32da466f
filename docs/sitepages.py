"""Sphinx extension: navigation from the lists of the index, tables of parameters and constants, links to files outside docs,
MathML.
"""

from __future__ import annotations

import re
from itertools import groupby
from typing import Any

from docutils import nodes
from docutils.parsers.rst import Directive
from docutils.utils.math.latex2mathml import tex2mathml

from mffit import reference
from tir.parameters import TABLE, Parameter

SECTION = re.compile(r"^## (.+)$", re.MULTILINE)
PAGE = re.compile(r"\]\(([\w/-]+)\.(?:md|ipynb)\)")
OUTSIDE = re.compile(r"\[([^\]]+)\]\(\.\./([\w./-]+)\)")
COLUMNS = ("name", "unit", "default", "range", "stage", "seen in", "needs", "equation", "description")
WIDTHS = (11, 8, 9, 14, 8, 8, 14, 10, 40)


def adapted(app: Any, page: str, source: list[str]) -> None:
    """Change the Markdown of a page, ``source[0]``, in place before Sphinx parses it."""
    text = source[0]
    if page == "index":
        text = text + "\n" + navigation(text)
    elif page == "constants":
        text = text + reference.page("constants.md")
    if "/" not in page:
        # The site contains docs/ only; a link to another file of the repository becomes its path.
        text = OUTSIDE.sub(r"\1 (`\2` in the repository)", text)
    source[0] = text


def navigation(text: str) -> str:
    """Hidden tables of contents, one per section of the index, from the links in it."""
    seen: set[str] = set()
    trees = []
    _, *parts = SECTION.split(text)
    for title, body in zip(parts[::2], parts[1::2], strict=True):
        pages = [page for page in dict.fromkeys(PAGE.findall(body)) if page not in seen]
        seen.update(pages)
        trees.append(toctree(title, pages))
    return "\n".join(trees)


def toctree(caption: str, pages: list[str], *, glob: bool = False) -> str:
    options = [":hidden:", *([f":caption: {caption}"] if caption else []), *([":glob:"] if glob else [])]
    return "\n".join(["```{toctree}", *options, "", *pages, "```", ""])


class ParameterTable(Directive):
    """Directive ``parameter-table``: a table of parameters per section, from ``tir/parameters.csv``."""

    def run(self) -> list[nodes.Node]:
        out: list[nodes.Node] = []
        for section, rows in groupby(TABLE, key=lambda row: row.section):
            part = nodes.section(ids=[nodes.make_id(section)], names=[section.lower()])
            part += nodes.title(text=f"[{section}]")
            part += table([cells(row) for row in rows])
            out.append(part)
        return out


def cells(row: Parameter) -> tuple[str, ...]:
    bounds = "" if row.lower is None and row.upper is None else f"{bound(row.lower)} to {bound(row.upper)}"
    if row.bounds != row.usual:
        bounds += f" (limits {bound(row.least)} to {bound(row.most)})"
    values = (
        row.name,
        row.unit,
        row.default,
        bounds,
        row.stage,
        row.channel,
        row.needs,
        row.equation,
        row.description,
    )
    return tuple(cell_text(value) for value in values)


def bound(value: float | None) -> str:
    return "…" if value is None else f"{value:g}"


def cell_text(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:g}"
    return " ".join(map(str, value)) if isinstance(value, tuple | list | frozenset) else str(value or "")


def table(rows: list[tuple[str, ...]]) -> nodes.table:
    """Table with headings, without columns that are empty in all rows."""
    shown = [k for k in range(len(COLUMNS)) if any(row[k] for row in rows)]
    group = nodes.tgroup(cols=len(shown))
    group += [nodes.colspec(colwidth=WIDTHS[k]) for k in shown]
    group += nodes.thead("", line([nodes.paragraph(text=COLUMNS[k]) for k in shown]))
    group += nodes.tbody("", *(line([cell(k, row[k]) for k in shown]) for row in rows))
    return nodes.table("", group)


def line(content: list[nodes.Node]) -> nodes.row:
    return nodes.row("", *(nodes.entry("", part) for part in content))


def cell(column: int, text: str) -> nodes.paragraph:
    return nodes.paragraph("", "", nodes.literal(text=text)) if column == 0 else nodes.paragraph(text=text)


def formula(writer: Any, node: nodes.Element) -> None:
    """Write a formula as MathML, which browsers render without a script from the network."""
    block = isinstance(node, nodes.math_block)
    mathml = tex2mathml(node.astext(), as_block=block)
    writer.body.append(
        f'<div style="overflow: auto hidden; padding: 0.6em 0">{mathml}</div>' if block else mathml
    )
    raise nodes.SkipNode


def setup(app: Any) -> dict[str, Any]:
    app.add_html_math_renderer("mathml", (formula, None), (formula, None))
    app.add_directive("parameter-table", ParameterTable)
    app.connect("source-read", adapted)
    return {"parallel_read_safe": True}

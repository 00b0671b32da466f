"""Templates of pages and of exported files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jinja2 import Environment


def environment(package: str, **options: Any) -> Environment:
    """The templates in a package's folder ``templates``; content is escaped, and missing content is an error."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    given = {"autoescape": True, "trim_blocks": True, "lstrip_blocks": True, **options}
    return Environment(loader=PackageLoader(package), undefined=StrictUndefined, **given)

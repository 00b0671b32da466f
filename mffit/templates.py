"""How templates are filled, for pages and for exported files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jinja2 import Environment


def environment(package: str, **options: Any) -> Environment:
    """The templates of a package's folder ``templates``: what is from outside is escaped, what is not given is an error."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    given = {"autoescape": True, "trim_blocks": True, "lstrip_blocks": True, **options}
    return Environment(loader=PackageLoader(package), undefined=StrictUndefined, **given)

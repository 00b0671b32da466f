"""Templates of pages and of exported files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jinja2 import Environment


def environment(*packages: str, **options: Any) -> Environment:
    """The templates in the packages' folders ``templates``; content is escaped, and missing content is an error."""
    from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

    given = {"autoescape": True, "trim_blocks": True, "lstrip_blocks": True, **options}
    loader = ChoiceLoader([PackageLoader(package) for package in packages])
    return Environment(loader=loader, undefined=StrictUndefined, **given)

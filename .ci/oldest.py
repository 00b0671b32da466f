"""Prints the lower bounds of pyproject.toml as pins, one per line: the oldest versions that the project declares.

python .ci/oldest.py | pip install --requirement /dev/stdin
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path

PROJECT = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
NEEDED = ("dependencies", "test")
BESIDE = ("pyparsing<3.3",)
"""Not ours: the oldest matplotlib calls pyparsing by names that are deprecated since 3.3, and our tests allow no warning."""


def requirements(name: str) -> Iterator[str]:
    """The requirements of an extra, or of the project itself, with the project's own extras unfolded."""
    extras = PROJECT["optional-dependencies"]
    for line in PROJECT["dependencies"] if name == "dependencies" else extras[name]:
        own = re.fullmatch(rf"{PROJECT['name']}\[([\w,]+)\]", line)
        if own:
            for extra in own[1].split(","):
                yield from requirements(extra)
        else:
            yield line


def oldest(requirement: str) -> str:
    """The requirement with its lower bound as the only version."""
    named, _, _ = requirement.partition(";")
    found = re.fullmatch(r"([\w.-]+)>=([\d.]+)", named.strip())
    if not found:
        raise SystemExit(f"pyproject.toml requires {requirement!r}; write it as name>=version")
    return f"{found[1]}=={found[2]}"


if __name__ == "__main__":
    print(*(oldest(line) for name in NEEDED for line in requirements(name)), *BESIDE, sep="\n")

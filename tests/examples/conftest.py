"""Fixtures that load and run the examples of docs/examples."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def example():
    """Function that loads an example as a module by its name."""

    def load(name: str):
        spec = importlib.util.spec_from_file_location(
            f"example_{name}", ROOT / "docs" / "examples" / f"{name}.py"
        )
        module = importlib.util.module_from_spec(spec)
        sys.modules[spec.name] = module  # dataclasses look up their module there
        spec.loader.exec_module(module)
        return module

    return load


@pytest.fixture
def run(example, monkeypatch, capsys):
    """Function that runs an example as a script and returns its output."""

    def run(name: str, *arguments: str) -> str:
        monkeypatch.setattr(sys, "argv", [f"{name}.py", *map(str, arguments)])
        monkeypatch.setenv("MPLBACKEND", "agg")
        example(name).main()
        return capsys.readouterr().out

    return run

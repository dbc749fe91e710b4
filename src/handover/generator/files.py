"""The directed tests, which are files."""

from __future__ import annotations

from importlib import resources

from handover.generator.abstract_test import AbstractTest
from rvmon.cdv.files import from_json


def directed() -> tuple[AbstractTest, ...]:
    """The directed tests that come with the testbench, in order of name."""
    folder = resources.files("handover.generator") / "directed"
    files = sorted(
        (entry for entry in folder.iterdir() if entry.name.endswith(".json")),
        key=lambda entry: entry.name,
    )
    return tuple(from_json(entry.read_bytes(), AbstractTest, source=entry.name) for entry in files)

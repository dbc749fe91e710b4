"""What tests share: programs that may be missing on a developer's machine, never in CI."""

import os
import shutil

import pytest


def _program(name: str) -> str:
    path = shutil.which(name)
    if path is None:
        message = f"needs the program `{name}`"
        if os.environ.get("CI"):
            pytest.fail(message)
        pytest.skip(message)
    return path


@pytest.fixture
def chromium() -> str:
    """Path of a headless browser."""
    return _program("chromium")


@pytest.fixture
def gcc() -> str:
    """Path of a C compiler."""
    return _program("gcc")

"""What tests share: programs that CI always has, and golden files."""

import os
import shutil
import sysconfig
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

import pytest


def _program(name: str) -> str:
    path = shutil.which(name)
    if path is None:
        _do_without(f"needs the program `{name}`")
    return path


def _do_without(message: str) -> NoReturn:
    if os.environ.get("CI"):
        pytest.fail(message)
    pytest.skip(message)


@pytest.fixture
def chromium() -> str:
    """Path of a headless browser."""
    return _program("chromium")


@pytest.fixture
def graphviz() -> str:
    """Path of the program that lays out graphs."""
    return _program("dot")


@pytest.fixture
def gcc() -> str:
    """Path of a C compiler."""
    return _program("gcc")


@pytest.fixture(scope="session")
def extensions() -> None:
    """Extension modules can be compiled."""
    _program("gcc")
    if not Path(sysconfig.get_path("include"), "Python.h").is_file():
        _do_without("needs the headers of Python, `python3-dev`")


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Callable[[str, str], None]:
    """Compare a text with the file of that name in `golden/` beside the test.

    RVMON_UPDATE_GOLDEN=1 writes the files instead; read the difference before you commit it.
    """
    folder = request.path.parent / "golden"

    def compare(name: str, text: str) -> None:
        path = folder / name
        if os.environ.get("RVMON_UPDATE_GOLDEN"):
            folder.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8")
        assert text == path.read_text(encoding="utf-8")

    return compare

"""Abstract tests as files: JSON, decoded strictly."""

from __future__ import annotations

from pathlib import Path
from typing import TypeVar

import msgspec

from rvmon.cdv.abstract_test import Test
from rvmon.errors import RvmonError
from rvmon.writing import write_whole

_Test = TypeVar("_Test", bound=Test)


class TestError(RvmonError, ValueError):
    """A test cannot be made, read or played; the message says which, where and why."""

    __test__ = False


def to_json(test: Test) -> bytes:
    """A test as indented JSON, fields with their default left out.

    Raises:
        TestError: a field holds what JSON has no form for.

    >>> test = Test(name="a", strategy="random", seed=1)
    >>> from_json(to_json(test), Test) == test
    True
    """
    try:
        return msgspec.json.format(msgspec.json.encode(test), indent=2) + b"\n"
    except TypeError as error:
        raise TestError(f"test `{test.name}` cannot be written as JSON: {error}") from None


def from_json(text: bytes, kind: type[_Test], *, source: str = "<bytes>") -> _Test:
    """Read a test.

    Args:
        text: JSON, UTF-8.
        kind: of the test.
        source: where it came from, for messages.

    Raises:
        TestError: it is no JSON, or not that of such a test.
    """
    try:
        return msgspec.json.decode(text, type=kind)
    except msgspec.ValidationError as error:
        raise TestError(f"{source}: not an abstract test: {error}") from None
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise TestError(f"{source}: not JSON: {error}") from None


def load(path: str | Path, kind: type[_Test]) -> _Test:
    """Read a test file.

    Args:
        path: of the file.
        kind: of the test.

    Raises:
        TestError: the file cannot be read, or holds no such test.
    """
    try:
        text = Path(path).read_bytes()
    except OSError as error:
        raise TestError(f"{path}: {error.strerror}") from None
    return from_json(text, kind, source=str(path))


def save(test: Test, folder: str | Path) -> Path:
    """Write a test to `folder/<name>.json` and return that path."""
    path = Path(folder) / f"{test.name}.json"
    write_whole(path, to_json(test))
    return path

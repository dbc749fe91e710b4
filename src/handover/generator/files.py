"""Abstract tests as files: JSON, decoded strictly."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

import msgspec

from handover.generator.abstract_test import AbstractTest
from rvmon.errors import RvmonError
from rvmon.writing import write_whole


class AbstractTestError(RvmonError, ValueError):
    """A test cannot be read or played; the message says which, where and why."""


def to_json(test: AbstractTest) -> bytes:
    """A test as indented JSON, fields with their default left out.

    >>> from handover.generator.pseudorandom import pseudorandom
    >>> test = pseudorandom(1, seed=0)[0]
    >>> from_json(to_json(test)) == test
    True
    """
    return msgspec.json.format(msgspec.json.encode(test), indent=2) + b"\n"


def from_json(text: bytes, *, source: str = "<bytes>") -> AbstractTest:
    """Read a test.

    Args:
        text: JSON, UTF-8.
        source: where it came from, for messages.

    Raises:
        AbstractTestError: it is no JSON, or not that of a test.
    """
    try:
        return msgspec.json.decode(text, type=AbstractTest)
    except msgspec.ValidationError as error:
        raise AbstractTestError(f"{source}: not an abstract test: {error}") from None
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise AbstractTestError(f"{source}: not JSON: {error}") from None


def load(path: str | Path) -> AbstractTest:
    """Read a test file.

    Raises:
        AbstractTestError: the file cannot be read, or holds no test.
    """
    try:
        text = Path(path).read_bytes()
    except OSError as error:
        raise AbstractTestError(f"{path}: {error.strerror}") from None
    return from_json(text, source=str(path))


def save(test: AbstractTest, folder: str | Path) -> Path:
    """Write a test to `folder/<name>.json` and return that path."""
    path = Path(folder) / f"{test.name}.json"
    write_whole(path, to_json(test))
    return path


def directed() -> tuple[AbstractTest, ...]:
    """The directed tests that come with the testbench, in order of name."""
    folder = resources.files("handover.generator") / "directed"
    files = sorted(
        (entry for entry in folder.iterdir() if entry.name.endswith(".json")),
        key=lambda entry: entry.name,
    )
    return tuple(from_json(entry.read_bytes(), source=entry.name) for entry in files)

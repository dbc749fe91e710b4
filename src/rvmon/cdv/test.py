"""Tests as data that can be stored and replayed; their files are JSON, decoded strictly."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self, TypeVar

import msgspec

from rvmon.errors import RvmonError
from rvmon.files import write_whole

VerdictName = Literal["P", "F", "NT", "I"]


class Test(
    msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, omit_defaults=True
):
    """A test that can be replayed on its own; derive from it and add the fields your tests vary.

    Attributes:
        name: unique within a campaign; also the name of its file.
        strategy: the generator that made it.
        seed: of everything that a run draws at random.
        text: the purpose of the test.
        robot: the only robot of the campaign that it is written for; `None`: any.
        mutation: the fault planted into the robot; `None`: none.
        expected: verdicts by requirement, if they are known beforehand.
        reaches: items of the coverage model, by group, that the test must hit to serve its purpose.
        removable: names of sequence fields whose elements shrinking may remove, the most important
            field first.

    >>> class Walk(Test):
    ...     people: int
    >>> Walk(name="a", strategy="random", seed=1, people=3).mutation is None
    True
    """

    __test__: ClassVar[bool] = False  # pytest must not collect it
    removable: ClassVar[tuple[str, ...]] = ()

    name: Annotated[str, msgspec.Meta(min_length=1)]
    strategy: str
    seed: Annotated[int, msgspec.Meta(ge=0)]
    text: str = ""
    robot: str | None = None
    mutation: str | None = None
    expected: dict[str, VerdictName] = {}
    reaches: dict[str, tuple[str, ...]] = {}

    def simpler(self) -> Iterable[Self]:
        """Variants with one value simplified, for `rvmon.cdv.shrink`; the simplest first."""
        return ()

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as JSON: fields at their defaults stay left out, as in a file."""
        return partial(msgspec.json.decode, type=type(self)), (msgspec.json.encode(self),)


_Test = TypeVar("_Test", bound=Test)


class TestError(RvmonError, ValueError):
    """A test cannot be made, read or played; the message says which, where and why."""

    __test__ = False


@contextmanager
def blamed(what: str, kind: type[RvmonError] = TestError) -> Iterator[None]:
    """Raise an exception of users' code as a `kind` whose message starts with `what` failed.

    An `RvmonError` passes unchanged.
    """
    try:
        yield
    except RvmonError:
        raise
    except Exception as error:
        raise kind(f"{what}: {type(error).__name__}: {error}") from error


def to_json(test: Test) -> bytes:
    """A test as indented JSON, without fields at their defaults.

    Raises:
        TestError: a field holds a value that JSON cannot represent.

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
        kind: the type of the test.
        source: where the text comes from, for error messages.

    Raises:
        TestError: the text is not JSON, or does not describe such a test.
    """
    try:
        return msgspec.json.decode(text, type=kind)
    except msgspec.ValidationError as error:
        raise TestError(f"{source}: not an abstract test: {error}") from None
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise TestError(f"{source}: not JSON: {error}") from None


def load(path: str | Path, kind: type[_Test]) -> _Test:
    """Read a test file.

    Raises:
        TestError: the file cannot be read, or does not hold such a test.
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

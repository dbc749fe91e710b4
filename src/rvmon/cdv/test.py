"""Tests as data that can be kept and played again, and as files: JSON, decoded strictly."""

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
    """A test that can be played again alone; derive from it and add what your tests vary.

    Attributes:
        name: unique within a campaign; also the file's name.
        strategy: the generator that made it.
        seed: of everything that a run draws at random.
        text: the purpose of the test.
        robot: the only one of a campaign's robots that it is written for; `None`: any.
        mutation: the fault that is planted into the robot; `None`: it is as it is.
        expected: verdicts by requirement, for tests that know them.
        reaches: items of the coverage model, by group, that it is made to hit: else it is not what
            it says.
        removable: fields that are sequences whose parts a smaller test may lack, the one with the
            most to say first.

    >>> class Walk(Test):
    ...     people: int
    >>> Walk(name="a", strategy="random", seed=1, people=3).mutation is None
    True
    """

    __test__: ClassVar[bool] = False  # nothing that pytest should collect
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
        """Tests in which one value is simpler, for `rvmon.cdv.shrink`; the simplest first."""
        return ()

    def __reduce__(self) -> tuple[Any, ...]:
        """To other processes it goes as to files: what has its default stays left out."""
        return partial(msgspec.json.decode, type=type(self)), (msgspec.json.encode(self),)


_Test = TypeVar("_Test", bound=Test)


class TestError(RvmonError, ValueError):
    """A test cannot be made, read or played; the message says which, where and why."""

    __test__ = False


@contextmanager
def blamed(what: str, kind: type[RvmonError] = TestError) -> Iterator[None]:
    """Say of an exception of other people's code what it has prevented; ours pass as they are."""
    try:
        yield
    except RvmonError:
        raise
    except Exception as error:
        raise kind(f"{what}: {type(error).__name__}: {error}") from error


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
        source: its origin, for messages.

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

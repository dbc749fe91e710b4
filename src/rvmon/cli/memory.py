"""How much memory a command may take."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rvmon.cli.numbers import positive
from rvmon.errors import RvmonError

if TYPE_CHECKING:
    import argparse

_LEAST = 512
"""With less, libraries in C end the process as they are loaded, each in its own words."""


def add_max_memory(parser: argparse.ArgumentParser) -> None:
    """Declare `--max-memory`."""
    parser.add_argument(
        "--max-memory",
        dest="most_megabytes",
        metavar="MB",
        type=_megabytes,
        help="give up beyond, in each process (default: as much as there is)",
    )


def _megabytes(text: str) -> int:
    import argparse

    if (number := positive(text)) < _LEAST:
        message = f"expected at least {_LEAST} MB, which Python and its libraries take, not {text}"
        raise argparse.ArgumentTypeError(message)
    return number


@contextmanager
def at_most(megabytes: int | None) -> Iterator[None]:
    """Let this process, and those that it starts, take so much memory; `None`: any.

    Raises:
        RvmonError: the memory was not enough, or this system sets no limits.
    """
    try:
        with _limited(megabytes):
            yield
    except MemoryError:
        limit = "" if megabytes is None else f", of {megabytes:,} MB: raise --max-memory"
        raise RvmonError(f"the memory is not enough{limit}") from None


@contextmanager
def _limited(megabytes: int | None) -> Iterator[None]:
    if megabytes is None:
        yield
        return
    try:
        import resource
    except ImportError:
        raise RvmonError("--max-memory: this system sets no limits: leave it out") from None
    before = resource.getrlimit(resource.RLIMIT_AS)
    most = megabytes << 20
    if before[1] != resource.RLIM_INFINITY:
        most = min(most, before[1])
    resource.setrlimit(resource.RLIMIT_AS, (most, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)

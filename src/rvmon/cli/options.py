"""Options that several commands take."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rvmon.cli.parser import duration, positive
from rvmon.errors import RvmonError, UnknownNameError

if TYPE_CHECKING:
    import argparse

    from rvmon.session import Spec
    from rvmon.timed.search.outcome import Budget


def add_only(parser: argparse.ArgumentParser, what: str = "these requirements") -> None:
    """Declare `--only`, `--severity` and `--tag`."""
    add = parser.add_argument
    add("--only", metavar="IDS", help=f"{what}: R1,R3")
    add(
        "--severity", metavar="LEVELS", help="of these, those of one of the severities: high,medium"
    )
    add(
        "--tag",
        metavar="TAGS",
        action="append",
        default=[],
        help="of these, those with one of the tags: stop,arm; given twice: with one of each list",
    )


def asked_ids(arguments: argparse.Namespace, spec: Spec) -> tuple[str, ...] | None:
    """The requirements that what `add_only` declares leaves; `None`: all.

    Raises:
        UnknownNameError: there is no such requirement, severity or tag, or none that fits all.
    """
    from rvmon.spec.checked.names_read import labelled

    ids = ids_of(arguments.only, spec)
    severities = [] if arguments.severity is None else [_listed(arguments.severity)]
    tags = [_listed(one) for one in arguments.tag]
    return labelled(spec.checked, ids, severities, tags) if severities or tags else ids


def _listed(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def ids_of(listed: str | None, spec: Spec) -> tuple[str, ...] | None:
    """The requirements of a list with commas; `None`: all.

    Raises:
        UnknownNameError: the list is empty, or there is no such requirement.
    """
    from rvmon.spec.checked.names_read import requirements_asked

    if listed is None:
        return None
    ids = _listed(listed)
    if not ids:
        known = ", ".join(spec.requirements)
        raise UnknownNameError(f"the list of requirements is empty: there are {known}")
    return requirements_asked(spec.checked, ids)


def add_format(parser: argparse.ArgumentParser) -> None:
    """Declare `--format`."""
    parser.add_argument(
        "--format",
        choices=("text", "json"),
        default="text",
        help="for people (default), or as data",
    )


def add_dask(parser: argparse.ArgumentParser) -> None:
    """Declare `--dask`."""
    parser.add_argument(
        "--dask",
        metavar="ADDRESS",
        help="in the place of --jobs: do the work on the workers of this scheduler of Dask",
    )


def add_budget(parser: argparse.ArgumentParser) -> None:
    """Declare `--max-states`, `--max-seconds` and `--max-memory`."""
    add = parser.add_argument
    add("--max-states", metavar="N", type=positive, help="give up after N states")
    add("--max-seconds", metavar="S", type=duration, help="give up after S seconds")
    add(
        "--max-memory",
        metavar="MB",
        type=positive,
        default=2048,
        help="give up beyond (default: 2048)",
    )


def budget_of(arguments: argparse.Namespace) -> Budget:
    """When a search gives up."""
    from rvmon.timed.search.outcome import Budget

    return Budget(arguments.max_states, arguments.max_seconds, arguments.max_memory)


def add_const(parser: argparse.ArgumentParser) -> None:
    """Declare `--const`."""
    parser.add_argument(
        "--const", metavar="NAME=VALUE", action="append", default=[], help="override a constant"
    )


def constants_of(texts: Iterable[str]) -> dict[str, str]:
    """The values by name.

    Raises:
        RvmonError: a text has another form.

    >>> constants_of(["T=2 s"])
    {'T': '2 s'}
    """
    constants = {}
    for text in texts:
        name, sign, value = text.partition("=")
        if not sign or not name.strip() or not value.strip():
            raise RvmonError(f"--const {text}: expected NAME=VALUE, such as T=2s")
        constants[name.strip()] = value.strip()
    return constants


def refuse_over(written: Iterable[str | None], read: Iterable[str]) -> None:
    """Say before anything is done that it would write over what it reads.

    Raises:
        RvmonError: one is the same as another.
    """
    known = list(read)
    for one in written:
        if one is not None and any(_is_same_file(one, other) for other in known):
            raise RvmonError(f"cannot write {one}: it is an input: name another")


def _is_same_file(one: str, other: str) -> bool:
    try:
        return os.path.samefile(one, other)
    except (OSError, ValueError):
        return False


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
    except (MemoryError, ImportError) as error:
        if isinstance(error, ImportError) and "failed to map segment" not in str(error):
            raise  # else there is no room for a library
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

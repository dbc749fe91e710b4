"""Options that several commands take."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from rvmon.errors import RvmonError, UnknownNameError

if TYPE_CHECKING:
    import argparse

    from rvmon.session import Spec


def add_only(parser: argparse.ArgumentParser, what: str = "these requirements") -> None:
    """Declare `--only`."""
    parser.add_argument("--only", metavar="IDS", help=f"{what}: R1,R3")


def ids_of(listed: str | None, spec: Spec) -> tuple[str, ...] | None:
    """The requirements of a list with commas; `None`: all.

    Raises:
        UnknownNameError: the list is empty, or there is no such requirement.
    """
    from rvmon.spec.checked.selection import requirements_asked

    if listed is None:
        return None
    ids = tuple(name.strip() for name in listed.split(",") if name.strip())
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

"""`--const NAME=VALUE`, as several commands take it."""

from __future__ import annotations

from collections.abc import Iterable

from rvmon.errors import RvmonError


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

"""Templates of C and what is put into them."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.resources import files


def template(name: str) -> str:
    """The text of a file of this package's folder `c`."""
    return files("rvmon.codegen").joinpath("c", name).read_text(encoding="utf-8")


def filled(text: str, places: dict[str, str]) -> str:
    """A template with its `@PLACES@` filled, in the order given."""
    for name, part in places.items():
        text = text.replace(f"@{name}@", part)
    return text


def called(calls: str, library: str) -> Iterator[str]:
    """The lines of those functions of a library that some C calls; callers stand behind."""
    chosen: list[str] = []
    for block in reversed(library.split("\n\n")):
        name = block.split("(", 1)[0].rsplit(" ", 1)[-1]
        if f"{name}(" in calls:
            chosen.append(block)
            calls += block.split("{", 1)[1]
    for block in reversed(chosen):
        yield ""
        yield from block.strip("\n").split("\n")

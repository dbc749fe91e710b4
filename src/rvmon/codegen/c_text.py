"""Templates of C and what is put into them."""

from __future__ import annotations

from importlib.resources import files


def comment(text: str) -> str:
    """A text that cannot end a comment."""
    return ascii(text)[1:-1].replace("*/", "* /").replace("/*", "/ *").replace("\\", "/")


def template(name: str) -> str:
    """The text of a file of this package's folder `c`."""
    return files("rvmon.codegen").joinpath("c", name).read_text(encoding="utf-8")


def filled(text: str, places: dict[str, str]) -> str:
    """A template with its `@PLACES@` filled, in the order given."""
    for name, part in places.items():
        text = text.replace(f"@{name}@", part)
    return text


def without(text: str, part: str) -> str:
    """A text without what stands between the marks of a part."""
    before, rest = text.split(f"@{part}_BEGIN@\n", 1)
    return before + rest.split(f"@{part}_END@\n", 1)[1]


def without_function(text: str, start: str) -> str:
    """A text without the function that starts so."""
    if start not in text:
        return text
    before, rest = text.split(start, 1)
    return before + rest.split("\n}\n", 1)[1]

"""Amalgamates the native core into one header and one source file, for embedding.

The build hook runs this file alone: it imports nothing of rvmon.
"""

from __future__ import annotations

import os
import re

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "native")
HEADER = "core.h"
"""The public header, for programs that embed the core; the other headers are internal."""
BINDING = "python"
"""The folder of the Python binding, which is not amalgamated."""

_INCLUDE = re.compile(r'^#include (?:"(?P<own>[^"]+)"|<(?P<system>[^>]+)>).*\n', re.MULTILINE)
_PROTOTYPE = re.compile(
    r"^(?!typedef |static |extern |return )(?=[A-Za-z_][\w ]*[ *]+\w+\([^;{}]*\);)", re.MULTILINE
)


def core_header(folder: str = FOLDER) -> str:
    """The text of the public header of the core, which includes no other file of it."""
    return _text(folder, HEADER)


def core_files(folder: str = FOLDER) -> list[str]:
    """The sources of the core except the Python binding: paths relative to `folder`, sorted."""
    places = ["", *(name for name in os.listdir(folder) if "." not in name and name != BINDING)]
    names = [
        f"{place}/{name}" if place else name
        for place in places
        for name in os.listdir(os.path.join(folder, place))
        if name.endswith(".c")
    ]
    return sorted(names)


def core_source(header: str, folder: str = FOLDER, *, lines: bool = False) -> str:
    """All sources of the core except the Python binding, concatenated.

    Functions shared between files become static, so that only `rv_…` is visible outside.

    Args:
        header: the name by which the public header is included.
        folder: the folder of the sources.
        lines: whether `#line` directives name the original files in compiler messages.
    """
    names = core_files(folder)
    done = {HEADER}
    system: dict[str, None] = {}
    body = "".join(_body(folder, name, done, system, lines) for name in names)
    taken = {found["system"] for found in _INCLUDE.finditer(core_header(folder))}
    includes = "".join(f"#include <{name}>\n" for name in sorted(system) if name not in taken)
    return f'#include "{header}"\n\n{includes}{body}'


def _body(folder: str, name: str, done: set[str], system: dict[str, None], lines: bool) -> str:
    """A file without its includes, preceded by the headers it needs that are not in `done`."""
    done.add(name)
    text = _text(folder, name)
    needed = ""
    for found in _INCLUDE.finditer(text):
        if found["system"]:
            system[found["system"]] = None
        elif found["own"] not in done:
            needed += _body(folder, found["own"], done, system, lines)
    # With `#line` directives, the line numbers of the original have to be preserved.
    text = _INCLUDE.sub("\n" if lines else "", text)
    if name.endswith(".h"):
        text = _PROTOTYPE.sub("static ", text)
    start = f'#line 1 "{name}"\n' if lines else f"\n/* {f' {name} ':-^90} */\n\n"
    return needed + start + (text if lines else re.sub(r"\n{3,}", "\n\n", text))


def _text(folder: str, name: str) -> str:
    with open(os.path.join(folder, name), encoding="utf-8") as file:
        return file.read()

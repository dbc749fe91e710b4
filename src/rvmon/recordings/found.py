"""The recordings that a path, a folder or a pattern stands for."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from pathlib import Path

from rvmon.errors import TraceError
from rvmon.recordings.messages.forms import FORMATS, form_of_folder
from rvmon.recordings.places import JOINT, endings_of, is_address, matching_addresses

_MAGIC = frozenset("*?[")

_UNREAD = (".xz", ".bz2", ".lz4", ".zip", ".7z", ".zstd", ".active")
"""Endings behind that of a recording which is packed otherwise, or was not closed, as its recorder
was ended: nothing here reads it, but who reads it says so."""


def found_recordings(paths: Iterable[str]) -> Iterator[str]:
    """The recordings at paths, in their order.

    Args:
        paths: a file, a folder that is one recording, `-` or an address stands for itself; another
            folder for the recordings in it and in its folders, a pattern (`*`, `?`, `[…]`, `**`)
            for what is called so, both sorted.

    Raises:
        TraceError: a folder or pattern stands for none.
        RvmonError: what reads addresses is not installed.
    """
    for path in paths:
        if is_address(path):
            # Signed addresses have question marks.
            yield from _some(matching_addresses(path), path) if "*" in path else [path]
        elif os.path.isdir(path) and not form_of_folder(path):
            yield from _some(sorted(_recordings_at(path)), path)
        elif _MAGIC.isdisjoint(path) or os.path.lexists(path):
            yield path
        else:
            from glob import iglob

            # `**` stands for a folder and for what is in it.
            found = {one for match in iglob(path, recursive=True) for one in _recordings_at(match)}
            yield from _some(sorted(found), path)


def files_of(path: str) -> list[str]:
    """The files of which a recording is joined; what is one file, or folder, is itself."""
    is_joined = JOINT in path and not os.path.lexists(path)
    return list(found_recordings(filter(None, path.split(JOINT)))) if is_joined else [path]


def one_recording(path: str) -> str:
    """The recording at a path, or the only one in a folder, as of a bag that was not closed.

    Raises:
        TraceError: there are several.
    """
    if is_address(path) or not os.path.isdir(path) or form_of_folder(path):
        return path
    found = list(found_recordings([path]))
    if len(found) > 1:
        raise TraceError(
            f"{path}: holds {len(found)} recordings: evaluate each, or give a list of "
            "those that are one"
        )
    return found[0]


def _some(found: list[str], path: str) -> list[str]:
    if not found:
        raise TraceError(f"{path}: there is no recording: one ends in {', '.join(FORMATS)}")
    return found


def _recordings_at(path: str, above: frozenset[str] = frozenset()) -> Iterator[str]:
    """A recording, or those in a folder; none anew in one that links to a folder above it."""
    if form_of_folder(path):
        yield path
    elif os.path.isdir(path):
        if (real := os.path.realpath(path)) not in above:
            for name in os.listdir(path):
                yield from _recordings_at(str(Path(path, name)), above | {real})
    elif endings_of(path.removesuffix(_unread(path)))[0] in FORMATS:
        yield path


def _unread(path: str) -> str:
    ending = os.path.splitext(path)[1]
    return ending if ending.lower() in _UNREAD else ""

"""The places of recordings: files, compressed files, addresses, folders and patterns."""

from __future__ import annotations

import os
import re
import weakref
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, BinaryIO, TextIO

from rvmon.errors import RvmonError, TraceError, needed
from rvmon.recordings import FORMATS, form_of_folder
from rvmon.recordings.values import first_line
from rvmon.texts import cannot_read

PACKED = (".gz", ".zst")  # endings of compressed text

JOINT = " + "
"""Separates the paths (files or folders) that form one recording; a single path may end in it."""

_ADDRESS = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+://")


def is_address(path: str) -> bool:
    """Whether a path is an address such as `https://…` or `s3://…`.

    >>> is_address("s3://runs/monday.csv"), is_address("C:/runs/monday.csv")
    (True, False)
    """
    return "://" in path and _ADDRESS.match(path) is not None


def endings_of(path: str) -> tuple[str, str]:
    """The ending that tells the format, and that of the compression; each is "" if there is none.

    >>> endings_of("runs/Monday.CSV.gz"), endings_of("https://host/a.mcap?version=3")
    (('.csv', '.gz'), ('.mcap', ''))
    """
    stem, packed = os.path.splitext(_path_in(path) if is_address(path) else path)
    if packed.lower() not in PACKED:
        return packed.lower(), ""
    return os.path.splitext(stem)[1].lower(), packed.lower()


def name_of(path: str) -> str:
    """The name of a file or folder at a path or address.

    >>> name_of("runs/monday.csv"), name_of("https://host/a.mcap?version=3")
    ('monday.csv', 'a.mcap')
    """
    return Path(_path_in(path) if is_address(path) else path).name or "recording"


def _path_in(address: str) -> str:
    from urllib.parse import urlsplit

    return urlsplit(address).path


@contextmanager
def opened(path: str | Path) -> Iterator[tuple[BinaryIO, BinaryIO]]:
    """Open a file or address: its decompressed bytes, and the raw file.

    Raises:
        TraceError: an address cannot be read; or, during reading, compressed data is damaged.
        RvmonError: a package is not installed.
        OSError: a file cannot be opened.
    """
    path = str(path)
    with open(local_path(path) if is_address(path) else path, "rb") as raw:
        packed = endings_of(path)[1]
        if not packed:
            yield raw, raw
            return
        open_packed, damage = _packing(packed)
        try:
            with open_packed(raw, "rb") as plain:
                yield plain, raw
        except damage as error:
            cut = isinstance(error, EOFError)
            fix = "was it cut off? Copy it again" if cut else "is it packed as its ending says?"
            raise TraceError(f"cannot be unpacked ({first_line(error)}): {fix}") from None


@contextmanager
def named_errors(path: str | Path) -> Iterator[None]:
    """Put the name of a file in front of the errors raised inside, as `TraceError`.

    A message that starts with the path, or with one of several joined paths, is not changed.
    """
    try:
        yield
    except UnicodeDecodeError as error:
        raise TraceError(cannot_read(path, error)) from None
    except TraceError as error:
        message = str(error)
        starts = tuple(filter(None, str(path).split(JOINT)))
        placed = message if message.startswith(starts) else f"{path}: {message}"
        raise type(error)(placed) from None
    except OSError as error:
        raise TraceError(cannot_read(path, error)) from None


@contextmanager
def created(path: Path) -> Iterator[BinaryIO]:
    """Create a file for writing, compressed if its ending says so."""
    packed = endings_of(str(path))[1]
    with open(path, "wb") as raw:
        if not packed:
            yield raw
        else:
            with _packing(packed)[0](raw, "wb") as file:
                yield file


def _packing(packed: str) -> tuple[Callable[[BinaryIO, str], Any], tuple[type[Exception], ...]]:
    """The function that opens a compressed file, and the exceptions that it raises on damage."""
    if packed == ".gz":
        import gzip
        import zlib

        return gzip.open, (EOFError, gzip.BadGzipFile, zlib.error)
    try:
        from compression import zstd  # from Python 3.14 on
    except ImportError:
        with needed("Zstandard", "backports.zstd"):
            from backports import zstd
    return zstd.open, (EOFError, zstd.ZstdError)


def local_path(path: str) -> Path:
    """The path of a file, or that of a copy of an address; the copy is kept until the next one."""
    if not is_address(path):
        return Path(path)
    with _remote_errors(path):
        system, inner = _system(path)
        info = system.info(inner)
        # An old copy must not pass for a file that has changed at the address since.
        state = repr(sorted((key, str(value)) for key, value in info.items()))
        return _copy(path, state).path


@contextmanager
def without_copies() -> Iterator[None]:
    """Remove the copy of an address at the end."""
    try:
        yield
    finally:
        _copy.cache_clear()


class _Copy:
    """A temporary file that is removed with its last user, but not by a forked process."""

    def __init__(self, name: str) -> None:
        from tempfile import mkdtemp

        folder = mkdtemp(prefix="rvmon-")
        weakref.finalize(self, _remove, folder, os.getpid())
        self.path = Path(folder, name)


def _remove(folder: str, process: int) -> None:
    if os.getpid() == process:
        import shutil

        shutil.rmtree(folder, ignore_errors=True)


@lru_cache(maxsize=1)
def _copy(address: str, _state: str) -> _Copy:
    """Copy a file or a whole folder from an address; `_state` makes a changed one a new copy."""
    system, inner = _system(address)
    made = _Copy(name_of(address))
    system.get(inner, str(made.path), recursive=system.isdir(inner))
    return made


def matching_addresses(pattern: str) -> list[str]:
    """The addresses that match a pattern with `*`, sorted."""
    with _remote_errors(pattern):
        system, inner = _system(pattern)
        return sorted(system.unstrip_protocol(name) for name in system.glob(inner))


def _system(address: str) -> tuple[Any, str]:
    with needed("an address", "fsspec"):
        from fsspec.core import url_to_fs
    system, inner = url_to_fs(address)
    return system, str(inner)


@contextmanager
def _remote_errors(address: str) -> Iterator[None]:
    try:
        yield
    except (RvmonError, MemoryError):
        raise
    except FileNotFoundError:
        raise TraceError(f"{address}: there is nothing at this address") from None
    except ImportError as error:
        extra = {"s3": "s3", "http": "remote", "https": "remote"}.get(address.partition(":")[0])
        how = f": pip install 'rvmon[{extra}]'" if extra else ""
        raise RvmonError(f"{address}: {first_line(error)}{how}") from None
    except Exception as error:  # noqa: BLE001 - each kind of storage has its own errors
        raise TraceError(f"{address}: cannot be read ({first_line(error)})") from None


BLOCK = 1 << 20  # bytes that are read at a time


LONGEST_LINE = 1 << 26  # characters; a longer line is an error


def bounded_lines(text: TextIO, before: int = 0) -> Iterator[str]:
    """Yield the lines of a text; a line so long that it could fill the memory is an error.

    `before`: the number of lines before the text, for the error.
    """
    for number, line in enumerate(iter(partial(text.readline, LONGEST_LINE + 1), ""), 1 + before):
        if len(line) > LONGEST_LINE:
            raise TraceError(
                f"line {number}: longer than {LONGEST_LINE:,} characters: is this a recording? "
                "Put each sample on a line of its own"
            )
        yield line


def whole_pieces(file: BinaryIO, size: int) -> Iterator[bytes]:
    r"""Yield a file in pieces of whole lines; the last line may lack its end.

    Reading stops at a line that is too long, and yields its start: the caller refuses that line.
    """
    parts: list[bytes] = []
    length = 0
    while length <= LONGEST_LINE and (piece := file.read(size)):
        whole, newline, tail = piece.rpartition(b"\n")
        if newline:
            yield b"".join([*parts, whole, newline])
            parts, length = [], 0
        parts.append(tail)
        length += len(tail)
    if length:
        yield b"".join(parts)


def is_short_of_memory() -> bool:
    """Whether the address space is limited (`--max-memory`).

    Readers then start no threads: Arrow reserves far more address space than it uses, and a thread
    that gets none may end the process.
    """
    try:
        import resource
    except ImportError:
        return False
    return resource.getrlimit(resource.RLIMIT_AS)[0] != resource.RLIM_INFINITY


_MAGIC = frozenset("*?[")

_UNREAD = (".xz", ".bz2", ".lz4", ".zip", ".7z", ".zstd", ".active")
"""Endings, after that of a format, of recordings that cannot be read: compressed otherwise, or not
closed because the recorder was killed. They are found all the same, so that reading reports them.
"""


def found_recordings(paths: Iterable[str]) -> Iterator[str]:
    """Yield the recordings that paths stand for, in the order of the paths.

    Args:
        paths: a file, a folder that is one recording, `-` or an address stands for itself. Any
            other folder stands for the recordings in it and in its subfolders, a pattern (`*`, `?`,
            `[…]`, `**`; of an address: `*`) for the recordings that match it, both sorted.

    Raises:
        TraceError: a folder or pattern stands for no recording.
        RvmonError: the package that reads an address is not installed.
    """
    for path in paths:
        if is_address(path):
            # Signed addresses have question marks.
            yield from _at_least_one(matching_addresses(path), path) if "*" in path else [path]
        elif os.path.isdir(path) and not form_of_folder(path):
            yield from _at_least_one(sorted(_recordings_at(path)), path)
        elif _MAGIC.isdisjoint(path) or os.path.lexists(path):
            yield path
        else:
            from glob import iglob

            # The set removes duplicates: `**` matches a folder and everything in it.
            found = {one for match in iglob(path, recursive=True) for one in _recordings_at(match)}
            yield from _at_least_one(sorted(found), path)


def files_of(path: str) -> list[str]:
    """The files of a joined recording; any other recording is its own single file."""
    is_joined = JOINT in path and not os.path.lexists(path)
    return list(found_recordings(filter(None, path.split(JOINT)))) if is_joined else [path]


def one_recording(path: str) -> str:
    """The recording at a path; of a folder, the only one in it, as in a bag that was not closed.

    Raises:
        TraceError: a folder holds several recordings, or none.
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


def _at_least_one(found: list[str], path: str) -> list[str]:
    if not found:
        raise TraceError(f"{path}: there is no recording: one ends in {', '.join(FORMATS)}")
    return found


def _recordings_at(path: str, above: frozenset[str] = frozenset()) -> Iterator[str]:
    """Yield a recording, or those in a folder; links to a folder in `above` are not followed."""
    if form_of_folder(path):
        yield path
    elif os.path.isdir(path):
        if (real := os.path.realpath(path)) not in above:
            try:
                names = os.listdir(path)
            except OSError:
                yield path  # reading it reports why
                return
            for name in names:
                yield from _recordings_at(str(Path(path, name)), above | {real})
    else:
        stem, ending = os.path.splitext(path)
        if endings_of(stem if ending.lower() in _UNREAD else path)[0] in FORMATS:
            yield path

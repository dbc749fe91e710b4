"""Compiling generated C, once for each content, in a cache that any process may share or delete."""

from __future__ import annotations

import hashlib
import os
import platform
import shlex
import shutil
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from rvmon.cache import is_ours, is_whole, keep, keep_binary, made_folder, read_kept
from rvmon.errors import RvmonError
from rvmon.execute.command import run
from rvmon.writing import PREFIX, SUFFIX

if TYPE_CHECKING:
    from subprocess import CompletedProcess

Loaded = TypeVar("Loaded")

FLAGS = ("-std=c99", "-O2", "-Wall", "-Wextra", "-pedantic", "-ffp-contract=off")
"""Of every build: numbers are computed as the specification says, product and sum apart."""

NATIVE = "-march=native"
"""Has the compiler use all that this machine's processor can do."""


def compiler() -> list[str]:
    """The command of the C compiler: `$CC`, be it with options, or the first of cc, gcc, clang.

    Raises:
        RvmonError: there is none.
    """
    named = os.environ.get("CC", "")
    try:
        words = shlex.split(named)
    except ValueError:  # a quotation that does not end
        words = [named]
    for name, *options in [words] if words else [["cc"], ["gcc"], ["clang"]]:
        found = shutil.which(name)
        if found:
            return [found, *options]
    raise RvmonError(
        f"no C compiler found ({named or 'cc, gcc, clang'}): install one, or name it with CC=…"
    )


def cache_directory() -> Path:
    """Where compiled monitors are kept: only this user can write there.

    Raises:
        RvmonError: the place belongs to someone else, or others may write there.
    """
    try:
        path = made_folder()
        ours = is_ours(path)
    except OSError as error:
        raise _not_kept(error.filename, error) from None
    if not ours:
        raise RvmonError(f"{path} can be written by others: `chmod 700` it, or set XDG_CACHE_HOME")
    return path


def _not_kept(folder: object, error: OSError) -> RvmonError:
    return RvmonError(
        f"cannot keep compiled monitors in {folder}: {error.strerror}: name another place with "
        "XDG_CACHE_HOME"
    )


def processor() -> str:
    """What distinguishes this machine's processor from others that share the cache."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return repr(platform.uname())
    marks = ("model name", "flags", "Features", "CPU part", "isa")
    return "\n".join(dict.fromkeys(line for line in lines if line.startswith(marks)))


@dataclass(frozen=True, slots=True)
class Build:
    """What a compiler is to make.

    Attributes:
        texts: files by name.
        sources: those of them that are compiled.
        suffix: of the result.
        flags: for the compiler, beside `FLAGS`.
        headers: a folder with Python's headers that it needs as well; `None`: none.
    """

    texts: Mapping[str, str]
    sources: Sequence[str]
    suffix: str
    flags: Sequence[str]
    headers: str | None = None


def built(build: Build) -> Path:
    """The path of what the compiler makes of some files; it is made if it is not in the cache.

    Without a compiler, what any compiler has made of them is taken.

    Raises:
        RvmonError: there is no compiler, or no header; it failed, or the cache takes no files.
    """
    machine = processor() if NATIVE in build.flags else sys.platform
    inputs = (sorted(build.texts.items()), *FLAGS, *build.flags, machine)
    folder = cache_directory()
    by_any = _record(folder, inputs)
    try:
        command = [*compiler(), *FLAGS, *build.flags]
    except RvmonError:
        if found := _recorded(by_any):
            return found
        raise
    record = _record(folder, (*inputs, command))
    if found := _recorded(record):
        return found
    if build.headers is not None:
        command += ["-I", _with_headers(build.headers)]
    try:
        made = _made(folder, build.texts, [*command, *build.sources])
        path = keep_binary(record.with_name(f"{record.stem.partition('-')[2]}{build.suffix}"), made)
    except OSError as error:
        raise _not_kept(folder, error) from None
    for place in (record, by_any):
        keep(place, path.name.encode())
    return path


def _record(folder: Path, inputs: object) -> Path:
    """Where it stands which file was made of something."""
    return folder / f"built-{hashlib.sha256(repr(inputs).encode()).hexdigest()[:40]}.json"


def _recorded(record: Path) -> Path | None:
    """The file that was made, if it is still what it was."""
    name = read_kept(record)
    path = None if name is None else record.with_name(name.decode())
    return path if path is not None and is_whole(path) else None


def _with_headers(folder: str) -> str:
    """The folder of Python's headers, if they are there.

    Raises:
        RvmonError: they are not; the message names how to get them.
    """
    if not (Path(folder) / "Python.h").is_file():
        raise RvmonError(
            f"no Python.h in {folder}, which a compiled monitor needs to be stepped from Python: "
            "install the package python3-dev, or use the engine `auto`"
        )
    return folder


def loaded(build: Build, load: Callable[[Path], Loaded]) -> Loaded:
    """What is in a shared library, as `built` makes it; one that cannot be loaded is made anew.

    Args:
        build: what it is made of.
        load: loads it.

    Raises:
        RvmonError: it cannot be made, or not be loaded.
    """
    path = built(build)
    try:
        return load(path)
    except (OSError, ImportError):  # cut off, or of another machine that shares the folder
        path.unlink(missing_ok=True)
    path = built(build)
    try:
        return load(path)
    except (OSError, ImportError) as error:
        raise RvmonError(
            f"cannot load a compiled monitor: {error}: name a cache on a disk that programs may "
            "run from with XDG_CACHE_HOME"
        ) from None


def _made(folder: Path, texts: Mapping[str, str], command: Sequence[str]) -> bytes:
    """What the compiler makes, in a folder of its own within another."""
    with tempfile.TemporaryDirectory(suffix=SUFFIX, prefix=PREFIX, dir=folder) as scratch:
        for name, text in texts.items():
            (Path(scratch) / name).write_text(text, encoding="utf-8")
        made = Path(scratch) / "made"
        words = [*command, "-o", str(made), "-lm"]
        done = _run(words, scratch)
        fewer = [word for word in words if word != NATIVE]
        if done.returncode and fewer != words:  # not every compiler has it for every processor
            words = fewer
            done = _run(words, scratch)
        if done.returncode:
            raise RvmonError(f"the C compiler failed: {' '.join(words)}\n{done.stderr}")
        return made.read_bytes()


def _run(words: Sequence[str], folder: str) -> CompletedProcess[str]:
    """Have the compiler work in a folder, where it also has what it deletes at its end."""
    return run(words, cwd=folder, env={**os.environ, "TMPDIR": folder})

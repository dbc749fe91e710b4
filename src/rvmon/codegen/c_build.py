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
    """What tells this machine's processor from others that share the cache."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return repr(platform.uname())
    marks = ("model name", "flags", "Features", "CPU part", "isa")
    return "\n".join(dict.fromkeys(line for line in lines if line.startswith(marks)))


def built(
    texts: Mapping[str, str],
    sources: Sequence[str],
    suffix: str,
    flags: Sequence[str],
) -> Path:
    """The path of what the compiler makes of some files; it is made if it is not in the cache.

    Args:
        texts: by file name.
        sources: those of them that are compiled.
        suffix: of the result.
        flags: for the compiler, beside `FLAGS`.

    Raises:
        RvmonError: there is no compiler, it failed, or the cache takes no files.
    """
    command = [*compiler(), *FLAGS, *flags]
    machine = processor() if NATIVE in flags else sys.platform
    key = hashlib.sha256(repr((sorted(texts.items()), command, machine)).encode()).hexdigest()
    folder = cache_directory()
    record = folder / f"built-{key[:40]}.json"
    known = read_kept(record)
    if known is not None and is_whole(path := folder / known.decode()):
        return path
    try:
        made = _made(folder, texts, [*command, *sources])
        path = keep_binary(folder / f"{key[:40]}{suffix}", made)
    except OSError as error:
        raise _not_kept(folder, error) from None
    keep(record, path.name.encode())
    return path


def loaded(
    texts: Mapping[str, str],
    sources: Sequence[str],
    suffix: str,
    flags: Sequence[str],
    load: Callable[[Path], Loaded],
) -> Loaded:
    """What is in a shared library, as `built` makes it; one that cannot be loaded is made anew.

    Args:
        texts: as for `built`; so are the next three.
        sources: those that are compiled.
        suffix: of the library.
        flags: for the compiler.
        load: loads it.

    Raises:
        RvmonError: it cannot be made, or not be loaded.
    """
    path = built(texts, sources, suffix, flags)
    try:
        return load(path)
    except (OSError, ImportError):  # cut off, or of another machine that shares the folder
        path.unlink(missing_ok=True)
    path = built(texts, sources, suffix, flags)
    try:
        return load(path)
    except (OSError, ImportError) as error:
        raise RvmonError(
            f"cannot load a compiled monitor: {error}: name a cache on a disk that programs may "
            "run from with XDG_CACHE_HOME"
        ) from None


def _made(
    folder: Path,
    texts: Mapping[str, str],
    command: Sequence[str],
) -> bytes:
    """What the compiler makes, in a folder of its own within another."""
    with tempfile.TemporaryDirectory(suffix=SUFFIX, prefix=PREFIX, dir=folder) as scratch:
        for name, text in texts.items():
            (Path(scratch) / name).write_text(text, encoding="utf-8")
        made = Path(scratch) / "made"
        words = [*command, "-o", str(made), "-lm"]
        done = _run(words, scratch)
        if done.returncode and NATIVE in words:  # not every compiler has it for every processor
            words.remove(NATIVE)
            done = _run(words, scratch)
        if done.returncode:
            raise RvmonError(f"the C compiler failed: {' '.join(words)}\n{done.stderr}")
        return made.read_bytes()


def _run(words: Sequence[str], folder: str) -> CompletedProcess[str]:
    """Have the compiler work in a folder, where it also has what it deletes at its end."""
    return run(words, cwd=folder, env={**os.environ, "TMPDIR": folder})

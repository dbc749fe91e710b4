"""One recording judged by a compiled program: sooner than all that arrays need is imported.

The program is that of `rvmon build`, made once for a specification. It judges a plain CSV file, or
leaves it: what there is more to say of a recording (quotes, equal stamps, numbers that doubles
cannot hold, faults) it leaves to others.
"""

from __future__ import annotations

import hashlib
import json
import os
import signal
import stat
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from rvmon.cache import cache_folder, file_stamps, is_whole, keep, read_kept
from rvmon.monitor.inputs.missing import names_read
from rvmon.readers.blocks import NotPlainError
from rvmon.readers.recording import FileRecording
from rvmon.spec.checked.plain_data import to_plain
from rvmon.verdict.report import Report

if TYPE_CHECKING:
    from rvmon.monitor.compiled.specification import CompiledSpec
    from rvmon.readers.source import Source
    from rvmon.spec.checked.specification import CheckedSpec

_MOST_BYTES = 1 << 17
"""Of larger files the arrays cost less than to read what the program prints."""

_JUDGED = (0, 1)
"""Exit codes of the program if it has printed a report."""


def judged_by_program(compiled: CompiledSpec, source: Source, only: Sequence[str] | None) -> Report:
    """Judge a recording; the program is compiled if it is not in the cache.

    Args:
        compiled: the specification; not compiled any further if the program is there.
        source: the recording.
        only: ids of the requirements; default all.

    Raises:
        NotPlainError: the recording, or the place, is none for a program.
        RvmonError: there is no compiler, or a requirement is beyond generated code.
    """
    path = _plain_path(compiled.checked, source, only)
    # What was noticed while reading, whoever reads the recording's head says as well.
    return replace(
        Report.from_json(_printed(program_of(compiled, only), path)), trace="", health=()
    )


def program_of(compiled: CompiledSpec, only: Sequence[str] | None) -> Path:
    """The program of some requirements; it is compiled if it is not in the cache.

    Args:
        compiled: the specification; not compiled any further if the program is there.
        only: ids of the requirements; default all.

    Raises:
        NotPlainError: there is no cache.
        RvmonError: there is no compiler, or a requirement is beyond generated code.
    """
    folder = cache_folder()
    if folder is None:
        raise NotPlainError("there is no cache to keep a program in")
    package = Path(__file__).parents[2]
    content = [*file_stamps(str(package)), to_plain(compiled.checked), only]
    key = hashlib.sha256(json.dumps([content, os.environ.get("CC", "")]).encode()).hexdigest()
    record = folder / f"run-{key}.json"
    program = folder / (read_kept(record) or b"none").decode()
    if not is_whole(program):
        from rvmon.codegen.c_build import built
        from rvmon.codegen.c_program import program_build
        from rvmon.monitor.compiled.code_plan import plan_alone

        program = built(program_build(plan_alone(compiled, only)))
        keep(record, program.name.encode())
    return program


def _plain_path(checked: CheckedSpec, source: Source, only: Sequence[str] | None) -> str:
    """The path of a recording that says all that is read, as the program reads it."""
    recording = source.recording
    if not isinstance(recording, FileRecording) or recording.is_configured:
        raise NotPlainError("it has another form than the program reads")
    if source.row_by_row or source.until is not None or not hasattr(os, "posix_spawn"):
        raise NotPlainError("it is read by this process")
    if not names_read(checked, only).keys() <= (recording.names or frozenset()):
        raise NotPlainError("it lacks names")
    path = recording.path
    if not (path.endswith(".csv") and path.isascii() and path.isprintable()):
        raise NotPlainError("it is no CSV file")
    try:
        found = os.stat(path)
    except OSError:
        raise NotPlainError("it cannot be read") from None
    if not stat.S_ISREG(found.st_mode) or found.st_size > _MOST_BYTES:
        raise NotPlainError("it is no file, or a long one")
    return path


def _printed(program: Path, path: str) -> bytes:
    """What the program prints of a recording; it does not outlive this process."""
    reading, writing = os.pipe()
    actions = [
        (os.POSIX_SPAWN_DUP2, writing, 1),
        (os.POSIX_SPAWN_OPEN, 2, os.devnull, os.O_WRONLY, 0),
    ]
    words = [str(program), "--exactly", str(os.getpid()), path]
    try:
        child = os.posix_spawn(program, words, os.environ, file_actions=actions)
    except OSError:  # it is gone, or of another machine that shares the folder
        os.close(reading)
        raise NotPlainError("the program cannot be run") from None
    finally:
        os.close(writing)
    try:
        with open(reading, "rb") as pipe:
            printed = pipe.read()
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    except KeyboardInterrupt:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        raise
    if code not in _JUDGED:
        raise NotPlainError("the program has left it")
    return printed

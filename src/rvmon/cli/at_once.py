"""`rvmon run SPEC TRACE.csv --engine c --format json` by a program that was compiled before.

The program is that of `rvmon build`, asked for exactly what `rvmon run` prints. What it leaves, and
every other command line, goes the ordinary way: this one only saves the imports. Nothing heavy is
imported here.
"""

from __future__ import annotations

import hashlib
import json
import os
import signal
import stat
import sys
from collections.abc import Sequence
from itertools import islice
from pathlib import Path

from rvmon import __version__
from rvmon.cache import cache_folder, files_told, is_whole, keep, read_kept
from rvmon.diagnostics.text_file import text_of_file
from rvmon.readers.steps import FEWEST, LONG_STEP, LOOKED_AT, median_step

_VALUED = ("--only", "--const", "--engine", "--format")
_JUDGED = (0, 1)
"""Exit codes of the program if it has printed a report."""

_Found = tuple[Path, str, list[list[str]]]
"""The program, what there is to warn of, and for each name that is read its columns."""


def judged_at_once(words: Sequence[str]) -> int | None:
    """Run the command line, if this way leads to the end.

    Returns:
        The exit code; `None` if nothing has been done.
    """
    options = _options(words)
    if options is None or not hasattr(os, "posix_spawn"):
        return None
    spec, trace = options.pop("")
    folder = cache_folder()
    if folder is None or not _is_plain_file(trace):
        return None
    try:
        text = text_of_file(spec)
    except (OSError, UnicodeDecodeError):
        return None
    if "import" in text:  # of what is imported, too, it would depend
        return None
    rvmon = os.path.dirname(os.path.dirname(__file__))
    said = [__version__, *files_told(rvmon), spec, text, options, os.environ.get("CC", "")]
    key = hashlib.sha256(json.dumps(said).encode()).hexdigest()
    path = folder / f"run-{key}.json"
    found = _known(path) or _made(path, spec, text, options)
    if found is None:
        return None
    program, warnings, read = found
    return None if _is_doubtful(trace, read) else _judged(program, warnings, trace)


def _options(words: Sequence[str]) -> dict[str, list[str]] | None:
    """The values by option, and without one by the empty text; `None` if there are others."""
    if words[:1] != ["run"]:
        return None
    found: dict[str, list[str]] = {"": []}
    rest = iter(words[1:])
    for word in rest:
        name, is_joined, value = word.partition("=")
        if not word.startswith("-"):
            found[""].append(word)
        elif name in _VALUED:
            following = value if is_joined else next(rest, None)
            if following is None or (not is_joined and following.startswith("-")):
                return None
            found.setdefault(name, []).append(following)
        else:
            return None
    wanted = (found.pop("--engine", []), found.pop("--format", []), len(found[""]))
    return found if wanted == (["c"], ["json"], 2) and len(found.get("--only", [])) < 2 else None


def _is_plain_file(trace: str) -> bool:
    """Whether it is a CSV file that can be read twice, and its name reads the same in JSON."""
    if not (trace.endswith(".csv") and trace.isascii() and trace.isprintable()):
        return False
    try:
        return stat.S_ISREG(os.stat(trace).st_mode)
    except OSError:
        return False


def _is_doubtful(trace: str, read: list[list[str]]) -> bool:
    """Whether there is something to say of what the file's head holds, or nobody can tell here.

    Args:
        trace: the file.
        read: for each name that is read, the columns of which it needs one.
    """
    try:
        with open(trace, encoding="utf-8") as file:
            rows = [line.strip("\n") for line in islice(file, LOOKED_AT + 1)]
    except (OSError, UnicodeDecodeError):
        return True
    header = [name.strip() for name in rows[0].split(",")] if rows else []
    if any('"' in row for row in rows) or not all(set(header) & set(one) for one in read):
        return True
    if "t" not in header:
        return False
    try:
        place = header.index("t")
        times = [float(row.split(",")[place]) for row in rows[1:] if row.strip()]
    except (ValueError, IndexError):
        return True
    return len(times) >= FEWEST and median_step(times) > 0.99 * LONG_STEP


def _known(path: Path) -> _Found | None:
    """The program that was compiled before, what there is to warn of, and what is read."""
    body = read_kept(path)
    if body is None:
        return None
    try:
        name, warnings, read = json.loads(body)
        program = path.parent / name
        return (program, warnings, read) if is_whole(program) else None
    except (ValueError, TypeError):
        return None


def _made(path: Path, spec: str, text: str, options: dict[str, list[str]]) -> _Found | None:
    """The same, compiled now from the text; `None` if there is something to say against it."""
    from rvmon.cli.constants import constants_of
    from rvmon.codegen.c_program import built_program
    from rvmon.errors import RvmonError
    from rvmon.loading import loads

    only = options.get("--only")
    try:
        loaded = loads(text, name=spec, const=constants_of(options.get("--const", [])))
        if loaded.checked.covers:  # the samples are asked once more whether they show the goals
            return None
        ids = None if only is None else [name.strip() for name in only[0].split(",")]
        program = built_program(loaded.plan(only=ids))
        read = [
            [name, *(f"{name}.{field}" for field in loaded.schema.events.get(name, ()))]
            for name in loaded.names_read(only=ids)
        ]
    except RvmonError:
        return None
    warnings = ""
    if loaded.warnings:
        from rvmon.diagnostics.render import render_full

        warnings = render_full(loaded.warnings)
    keep(path, json.dumps([program.name, warnings, read]).encode())
    return program, warnings, read


def _judged(program: Path, warnings: str, trace: str) -> int | None:
    """Have the program judge; it does not outlive this process."""
    quiet = [(os.POSIX_SPAWN_OPEN, 2, os.devnull, os.O_WRONLY, 0)]
    words = [str(program), "--exactly", str(os.getpid()), trace]
    try:
        child = os.posix_spawn(program, words, os.environ, file_actions=quiet)
    except OSError:  # it is gone, or of another machine that shares the folder
        return None
    try:
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    except KeyboardInterrupt:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        raise
    if code not in _JUDGED:
        return None
    if warnings:
        print(warnings, file=sys.stderr)
    return code

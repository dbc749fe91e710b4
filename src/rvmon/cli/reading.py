"""Shared options for reading recordings, naming attempts, and opening reproducers."""

from __future__ import annotations

import argparse
import os
import re
import stat
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rvmon.cli.options import named_values, names_in
from rvmon.cli.output import warn
from rvmon.errors import RvmonError, UnknownNameError

if TYPE_CHECKING:
    import argparse

    from rvmon.recordings.recording import FileRecording
    from rvmon.recordings.source import SchemaArguments
    from rvmon.reproducer import Case
    from rvmon.session import Spec
    from rvmon.verdicts.attempt import Attempt
    from rvmon.verdicts.report import Report


OPTIONAL_VALUES = ("--allow-missing", "--require-triggered")
"""Options with an optional value, which must be written after `=`."""

OPTIONAL_OF_COVER = ("--bins",)  # such options of `rvmon cover`


def with_values(words: Sequence[str]) -> list[str]:
    """The words of a command line, with an empty value added to options that have none.

    Otherwise argparse would take the next word as the value.

    >>> with_values(["run", "--allow-missing", "a.rv", "--allow-missing=p"])
    ['run', '--allow-missing=', 'a.rv', '--allow-missing=p']
    """
    optional = OPTIONAL_OF_COVER if words[:1] == ["cover"] else OPTIONAL_VALUES
    completed: list[str] = []
    for place, word in enumerate(words):
        if word == "--":
            return [*completed, *words[place:]]
        short = len(word) > 2 and any(name.startswith(word) for name in optional)
        completed.append(f"{word}=" if short else word)
    return completed


def allowed_names(text: str | None) -> bool | tuple[str, ...]:
    """The value of `--allow-missing`: `False` if it is absent, `True` if empty, else the names.

    >>> allowed_names(None), allowed_names(""), allowed_names("a, b")
    (False, True, ('a', 'b'))
    """
    if not text:
        return text is not None
    return (*names_in(text),)


def mapped_names(texts: Sequence[str]) -> dict[str, str]:
    """The values of `--map`: columns by declared name.

    >>> mapped_names(["speed=Speed [m/s]"])
    {'speed': 'Speed [m/s]'}
    """
    columns: dict[str, str] = {}
    for name, column in named_values("--map", texts, "NAME=COLUMN, such as speed=v_mean"):
        if name in columns:
            raise RvmonError(f"--map {name}={column}: `{name}` is mapped twice")
        columns[name] = column
    return columns


def time_words(arguments: argparse.Namespace) -> list[str]:
    """The option `--time`, as words for another command line."""
    return [] if arguments.time is None else ["--time", arguments.time]


def reading_words(arguments: argparse.Namespace) -> list[str]:
    """The options for reading recordings, as words for another command line."""
    words = time_words(arguments)
    for text in arguments.map:
        words += ["--map", text]
    for name in ("nan", "binding", "clock"):
        if (value := getattr(arguments, name)) is not None:
            words += [f"--{name}", value]
    if arguments.allow_missing is not None:
        words.append(f"--allow-missing={arguments.allow_missing}".rstrip("="))
    return words


def reading_arguments(arguments: argparse.Namespace) -> SchemaArguments:
    """The options for reading recordings, as arguments of `Spec.reading`."""
    nan = None if arguments.nan is None else arguments.nan.replace("-", " ")
    return {
        "time": arguments.time,
        "columns": mapped_names(arguments.map),
        "nan": nan,
        "binding": arguments.binding,
        "clock": arguments.clock,
    }


def reading_spec(spec: Spec, arguments: argparse.Namespace) -> Spec:
    """The specification with the options for reading recordings applied."""
    given = reading_arguments(arguments)
    return spec if all(one in (None, {}) for one in given.values()) else spec.reading(**given)


def refuse_empty(spec: Spec) -> None:
    """Refuse a specification with nothing to check, such as a truncated file.

    Raises:
        RvmonError: it has no requirement, cover goal or coverpoint.
    """
    checked = spec.checked
    if not (spec.requirements or checked.covers or checked.coverpoints):
        raise RvmonError(f"{checked.name} has no requirement: there is nothing to check")


def opened(spec: Spec, trace: str, *, only: Collection[str] | None = None) -> FileRecording:
    """The recording at a path, as a specification reads it; `only`: the names to read."""
    from rvmon.recordings.recording import FileRecording

    schema = spec.schema
    if only is not None:
        from dataclasses import replace  # imported late: help does not need it

        schema = replace(
            schema,
            signals={name: kind for name, kind in schema.signals.items() if name in only},
            events={name: fields for name, fields in schema.events.items() if name in only},
        )
    return FileRecording(trace, schema, ordered=spec.checked.max_delay is None)


@contextmanager
def noticing_changes(traces: Iterable[str]) -> Iterator[None]:
    """Warn of recordings that change meanwhile: a command may read them several times."""
    from rvmon.recordings.places import files_of

    states = {file: _state(file) for trace in traces for file in files_of(trace)}
    yield
    for file, state in states.items():
        if _state(file) != state:
            warn(f"{file} changed while it was read: verdicts and values may not belong together")


def _state(file: str) -> tuple[int, ...] | None:
    """Device, inode, size and modification time; `None` if there is no such regular file."""
    try:
        status = os.stat(file)
    except OSError:
        return None
    state = status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns
    return state if stat.S_ISREG(status.st_mode) else None


ATTEMPT_HELP = (
    "an attempt such as R1#3, or R1?2 if its trigger was not known for certain; R1 alone names "
    "its first failed attempt, else its first open one, else its first"
)
"""The help text of arguments that name an attempt."""


def named_attempt(text: str, spec: Spec) -> tuple[str, str | None]:
    """Parse the name of an attempt or a requirement.

    Returns:
        The requirement's id, and the name of the attempt, `None` if only a requirement is named.

    Raises:
        RvmonError: the text has another form.
        UnknownNameError: there is no such requirement.
    """
    match = re.fullmatch(r"(?P<name>[^#?]+)((?P<mark>[#?])(?P<number>\d{1,9}))?", text)
    if match is None:
        raise RvmonError(
            f"error: `{text}` names no attempt: write R1#3, R1?2 if its trigger is uncertain, or "
            "R1 for the first failed attempt"
        )
    name, mark, number = match["name"], match["mark"], match["number"]
    from rvmon.language.checked.names_read import requirement_ids

    requirement_ids(spec.checked, [name])
    return name, f"{name}{mark}{int(number)}" if number else None


def chosen_attempt(report: Report, name: str, exact: str | None) -> Attempt:
    """The attempt named `exact`; if that is `None`, the first failed, else open, else any.

    Raises:
        RvmonError: the requirement has no attempt.
        UnknownNameError: there is no attempt of that name.
    """
    from rvmon.report.wording import without_attempts

    attempts = sorted(report.attempts, key=lambda attempt: (attempt.in_doubt, attempt.number))
    if not attempts:
        why = without_attempts(report.verdicts[name], report.misses.get(name, ""))
        raise RvmonError(f"error: {name} has no attempt in this recording: {why}")
    if exact is None:
        return min(attempts, key=lambda one: {"F": 0, "I": 1}.get(one.verdict.value, 2))
    for attempt in attempts:
        if attempt.name == exact:
            return attempt
    first, last = attempts[0].name, attempts[-1].name
    listed = f"there are {first} to {last}" if last != first else f"there is {first} only"
    raise UnknownNameError(f"error: no attempt {exact}: {listed}")


ENDING = ".rvcase"  # the suffix of reproducers


def relax(parser: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Make all positional arguments but the first optional if `words` name a reproducer.

    Otherwise they stay required, because argparse would treat an optional argument that follows an
    option as missing.
    """
    if any(word.endswith(ENDING) for word in words):
        for action in parser._get_positional_actions()[1:]:
            action.nargs, action.required = "*" if action.nargs == "+" else "?", False


@contextmanager
def unpacked(arguments: argparse.Namespace) -> Iterator[Case | None]:
    """Open the reproducer named as the specification, and set the arguments from it.

    Yields:
        The reproducer; `None` if the specification is a `.rv` file.

    Raises:
        RvmonError: the reproducer cannot be read, or options for reading are given as well.
    """
    if not arguments.spec.endswith(ENDING):
        yield None
        return
    from rvmon.reproducer import opened_case
    from rvmon.verdicts import LAW

    if arguments.const or reading_words(arguments):
        raise RvmonError(f"{arguments.spec} defines how it is read: leave out these options")
    with opened_case(arguments.spec) as case:
        if case.law != LAW:
            laws = f"made under law {case.law}, and this rvmon has law {LAW}"
            warn(f"warning: {arguments.spec} was {laws}: verdicts may differ")
        arguments.spec = case.spec
        arguments.const = list(case.const)
        arguments.time, arguments.map, arguments.nan = case.time, list(case.map), case.nan
        arguments.binding, arguments.clock = case.binding, case.clock
        arguments.allow_missing = case.allow_missing
        yield case

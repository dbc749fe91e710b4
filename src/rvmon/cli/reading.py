"""Options of several commands: the names in recordings, what these may lack; reproducers."""

from __future__ import annotations

import argparse
import re
from collections.abc import Collection, Iterator, Sequence
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
"""Options whose value can be left out, and otherwise follows a `=`."""

OPTIONAL_OF_COVER = ("--bins",)  # the options of `rvmon cover` whose value can be left out


def with_values(words: Sequence[str]) -> list[str]:
    """The words of a command line, with an empty value for options that may go without one.

    Otherwise they would take the next word for it.

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
    """The value of `--allow-missing`: none, these, or with an empty one all.

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
    """The words that say on another command line where the stamps are."""
    return [] if arguments.time is None else ["--time", arguments.time]


def reading_words(arguments: argparse.Namespace) -> list[str]:
    """The words that say the same on another command line."""
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
    """The options of the command line, as `Spec.reading` takes them."""
    nan = None if arguments.nan is None else arguments.nan.replace("-", " ")
    return {
        "time": arguments.time,
        "columns": mapped_names(arguments.map),
        "nan": nan,
        "binding": arguments.binding,
        "clock": arguments.clock,
    }


def reading_spec(spec: Spec, arguments: argparse.Namespace) -> Spec:
    """The specification for recordings read as the command line says."""
    given = reading_arguments(arguments)
    return spec if all(one in (None, {}) for one in given.values()) else spec.reading(**given)


def refuse_empty(spec: Spec) -> None:
    """Refuse a specification by which everything is fine, such as one that was cut off."""
    checked = spec.checked
    if not (spec.requirements or checked.covers or checked.coverpoints):
        raise RvmonError(f"{checked.name} has no requirement: there is nothing to check")


def opened(spec: Spec, trace: str, *, only: Collection[str] | None = None) -> FileRecording:
    """The recording at a path, as a specification reads it, with all names or only some."""
    from rvmon.recordings.recording import FileRecording

    schema = spec.schema
    if only is not None:
        from dataclasses import replace  # which help has no need of

        schema = replace(
            schema,
            signals={name: kind for name, kind in schema.signals.items() if name in only},
            events={name: fields for name, fields in schema.events.items() if name in only},
        )
    return FileRecording(trace, schema, ordered=spec.checked.max_delay is None)


ATTEMPT_HELP = (
    "an attempt such as R1#3, or R1?2 if its trigger was not known for certain; R1 alone names "
    "its first failed attempt, else its first open one, else its first"
)
"""The help of options that take an attempt."""


def named_attempt(text: str, spec: Spec) -> tuple[str, str | None]:
    """The requirement that is meant, and the name of the attempt if one is."""
    match = re.fullmatch(r"(?P<name>[^#?]+)((?P<mark>[#?])(?P<number>\d{1,9}))?", text)
    if match is None:
        raise RvmonError(
            f"error: `{text}` names no attempt: write R1#3, R1?2 if its trigger is uncertain, or "
            "R1 for the first failed attempt"
        )
    name, mark, number = match["name"], match["mark"], match["number"]
    from rvmon.language.checked.names_read import requirements_asked

    requirements_asked(spec.checked, [name])
    return name, f"{name}{mark}{int(number)}" if number else None


def chosen_attempt(report: Report, name: str, exact: str | None) -> Attempt:
    """The attempt that is meant: without a name the first failed, else open, else any."""
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
    """Let all but the first argument be left out if a reproducer is named, which brings them along.

    Without one they stay as they are: argparse would take what may be left out for left out where
    an option stands before it.
    """
    if any(word.endswith(ENDING) for word in words):
        for action in parser._get_positional_actions()[1:]:
            action.nargs, action.required = "*" if action.nargs == "+" else "?", False


@contextmanager
def unpacked(arguments: argparse.Namespace) -> Iterator[Case | None]:
    """The reproducer that is named as the specification; the arguments then say what it says."""
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

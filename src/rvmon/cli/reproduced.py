"""Reproducers in place of a specification and a recording on the command line."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from rvmon.cli.output import warn
from rvmon.cli.reading import reading_words
from rvmon.errors import RvmonError

if TYPE_CHECKING:
    from rvmon.cli.judging import Judged
    from rvmon.reproducer import Case

ENDING = ".rvcase"
"""The suffix of reproducers."""


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
    """The reproducer that is named as the specification; the arguments then say what it says.

    Args:
        arguments: with `spec`, and the options `READING`, `--const` and `--allow-missing`.

    Raises:
        RvmonError: it cannot be read, or they say otherwise.
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


def shown_name(path: str) -> str:
    """The name by which people know a file of a reproducer, which is unpacked only for a moment."""
    return Path(path).name


def as_known(judged: Judged, case: Case) -> Judged:
    """The judged reproducer, with the name by which people know its recording."""
    name = shown_name(case.recording)
    report = None if judged.report is None else replace(judged.report, trace=name)
    return replace(
        judged, trace=name, report=report, error=judged.error.replace(case.recording, name)
    )


def compare_expected(judged: Judged, case: Case) -> None:
    """Say whether the attempt has the verdict that it had."""
    attempts = [] if judged.report is None else judged.report.attempts
    found = next((attempt for attempt in attempts if attempt.name == case.attempt), None)
    if found is None or (found.verdict, found.decided) != (case.verdict, case.decided):
        now = "there is none now" if found is None else f"it is {found.verdict} now"
        made = f"as rvmon {case.rvmon} (law {case.law}) decided"
        warn(f"warning: {case.attempt} was {case.verdict}, {made}: {now}")
    else:
        warn(f"{case.attempt} is {case.verdict}, as when this was recorded")

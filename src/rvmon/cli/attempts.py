"""Attempts as people name them on the command line."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rvmon.errors import RvmonError, UnknownNameError

if TYPE_CHECKING:
    from rvmon.session import Spec
    from rvmon.verdict.attempt import Attempt
    from rvmon.verdict.report import Report

ATTEMPT_HELP = (
    "an attempt such as R1#3, or R1?2 for one in doubt; R1 alone means its first failed one, else "
    "its first open one, else its first"
)
"""What options that take one say."""


def named_attempt(text: str, spec: Spec) -> tuple[str, str | None]:
    """The requirement that is meant, and the name of the attempt if one is.

    Raises:
        RvmonError: the text is no such name.
        UnknownNameError: there is no such requirement.
    """
    found = re.fullmatch(r"(?P<name>[^#?]+)((?P<mark>[#?])(?P<number>\d{1,9}))?", text)
    if found is None:
        raise RvmonError(
            f"error: `{text}` names no attempt: write R1#3, R1?2 for one in doubt, or R1 for the "
            "first failed"
        )
    name, mark, number = found["name"], found["mark"], found["number"]
    from rvmon.spec.checked.selection import requirements_asked

    requirements_asked(spec.checked, [name])
    return name, f"{name}{mark}{int(number)}" if number else None


def chosen_attempt(report: Report, name: str, exact: str | None) -> Attempt:
    """The attempt that is meant: without a name the first failed, else open, else any.

    Raises:
        RvmonError: the requirement has no attempt.
        UnknownNameError: it has others.
    """
    from rvmon.report.afterword import without_attempts

    attempts = sorted(report.attempts, key=lambda attempt: (attempt.in_doubt, attempt.number))
    if not attempts:
        why = without_attempts(report.verdicts[name], report.misses.get(name, ""))
        raise RvmonError(f"error: {name} has no attempt in this recording: {why}")
    if exact is None:
        return _most_telling(attempts)
    for attempt in attempts:
        if attempt.name == exact:
            return attempt
    first, last = attempts[0].name, attempts[-1].name
    there = f"there are {first} to {last}" if last != first else f"there is {first} only"
    raise UnknownNameError(f"error: no attempt {exact}: {there}")


def _most_telling(attempts: Sequence[Attempt]) -> Attempt:
    for verdict in ("F", "I"):
        for attempt in attempts:
            if attempt.verdict.value == verdict:
                return attempt
    return attempts[0]

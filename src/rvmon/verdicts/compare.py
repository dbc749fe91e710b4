"""Comparison of two files of verdicts."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from enum import StrEnum

from msgspec import Struct, field

from rvmon.verdicts import Verdict, fold
from rvmon.verdicts.serialise import VerdictRow


class Change(StrEnum):
    """The kinds of changes of a requirement in a recording, the most important first."""

    BROKE = "fails now"
    UNREADABLE = "can no longer be evaluated"
    NO_LONGER_SHOWN = "no longer shown to hold"
    FIXED = "fixed"
    NO_LONGER_FAILS = "no longer fails, and is not shown to hold"
    NEWLY_SHOWN = "newly shown to hold"
    READABLE = "can be evaluated again"
    OTHERWISE = "otherwise not shown"

    @property
    def is_loss(self) -> bool:
        """Whether it is a regression."""
        return self in (Change.BROKE, Change.UNREADABLE, Change.NO_LONGER_SHOWN)

    @property
    def is_gain(self) -> bool:
        """Whether it is an improvement."""
        return self in (Change.FIXED, Change.NEWLY_SHOWN, Change.READABLE)


class Difference(Struct, frozen=True):
    """A changed verdict of a requirement in a recording, or a change of the whole recording."""

    change: Change  # the kind of change
    recording: str  # its name in the newer file
    requirement: str = ""  # its id; "" if the change is about the recording
    before: Verdict | None = None  # the older verdict; `None` if the change is about the recording
    after: Verdict | None = None  # the newer verdict; likewise
    failures: tuple[int, int] = (0, 0)  # the numbers of failed attempts before and now
    reason: str = ""  # the reason of the first failure, or the error of the recording


class Comparison(Struct, frozen=True):
    """The comparison of two files of verdicts."""

    # of recordings and requirements in both files; regressions first
    differences: Sequence[Difference]
    # by recording, the requirements that fail in both files
    failing: Mapping[str, Sequence[str]] = field(default_factory=dict)
    only_before: Sequence[str] = ()  # recordings and requirements in the older file only, in words
    only_after: Sequence[str] = ()  # the requirements in the newer file only
    same: int = 0  # the number of equal verdicts


class _Run(Struct):
    """The verdicts on one recording in a file."""

    error: str = ""
    verdicts: dict[str, list[Verdict]] = field(default_factory=dict)
    failures: dict[str, list[str]] = field(default_factory=dict)


def compare(before: Iterable[VerdictRow], after: Iterable[VerdictRow]) -> Comparison:
    """Compare two files of verdicts, by recording and requirement.

    Recordings are matched by name. If the files have no name in common, the recordings are taken to
    have been moved, and names are matched relative to the common folder of each file.

    >>> old = VerdictRow("a.csv", "R1", "R1#1", verdict="P")
    >>> compare([old], [old._replace(verdict="F", reason="late")]).differences[0].change.value
    'fails now'
    """
    old, new = _runs(before), _runs(after)
    if not old.keys() & new.keys():
        old, new = _moved(old), _moved(new)
    differences: list[Difference] = []
    failing: dict[str, list[str]] = {}
    both = [name for name in old if name in new]
    only = [name for name in old if name not in new], [name for name in new if name not in old]
    same = 0
    for name in both:
        was, now = old[name], new[name]
        if was.error or now.error:
            if not was.error:
                differences.append(Difference(Change.UNREADABLE, name, reason=now.error))
            elif not now.error:
                differences.append(Difference(Change.READABLE, name))
            continue
        only[0].extend(f"{one} in {name}" for one in was.verdicts if one not in now.verdicts)
        only[1].extend(f"{one} in {name}" for one in now.verdicts if one not in was.verdicts)
        for requirement in [one for one in was.verdicts if one in now.verdicts]:
            change = _difference(name, requirement, was, now)
            if change is not None:
                differences.append(change)
                continue
            same += 1
            if fold(now.verdicts[requirement]) is Verdict.FAIL:
                failing.setdefault(name, []).append(requirement)
    order = list(Change)
    differences.sort(key=lambda one: (order.index(one.change), one.recording, one.requirement))
    return Comparison(differences, failing, *only, same)


def _difference(name: str, requirement: str, was: _Run, now: _Run) -> Difference | None:
    before, after = fold(was.verdicts[requirement]), fold(now.verdicts[requirement])
    if before is after:
        return None
    failures = was.failures.get(requirement, []), now.failures.get(requirement, [])
    counts = len(failures[0]), len(failures[1])
    reason = (failures[1] or failures[0] or [""])[0]
    change = _change(before, after)
    return Difference(change, name, requirement, before, after, counts, reason)


def _change(before: Verdict, after: Verdict) -> Change:
    match before, after:
        case _, Verdict.FAIL:
            return Change.BROKE
        case Verdict.FAIL, Verdict.PASS:
            return Change.FIXED
        case Verdict.FAIL, _:
            return Change.NO_LONGER_FAILS
        case Verdict.PASS, _:
            return Change.NO_LONGER_SHOWN
        case _, Verdict.PASS:
            return Change.NEWLY_SHOWN
        case _:
            return Change.OTHERWISE


def _runs(rows: Iterable[VerdictRow]) -> dict[str, _Run]:
    runs: dict[str, _Run] = {}
    for row in rows:
        run = runs.setdefault(row.recording, _Run())
        run.error = run.error or row.error
        if row.requirement is None or row.verdict is None:
            continue
        verdict = Verdict(row.verdict)
        run.verdicts.setdefault(row.requirement, []).append(verdict)
        if verdict is Verdict.FAIL:
            failure = f"{row.attempt}: {row.reason}" if row.reason else str(row.attempt)
            run.failures.setdefault(row.requirement, []).append(failure)
    return runs


def _moved(runs: Mapping[str, _Run]) -> dict[str, _Run]:
    """The runs by recording name relative to the common folder of all recordings."""
    folders = {os.path.dirname(name) for name in runs}
    try:
        common = os.path.commonpath(folders)
    except ValueError:  # there are none, or some are absolute and some are not
        return dict(runs)
    return {os.path.relpath(name, common) if common else name: run for name, run in runs.items()}

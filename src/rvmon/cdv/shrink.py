"""Shrink a failing test to a smallest one with the same failure, and save a regression test."""

from __future__ import annotations

import json
import os
import re
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Generic, TypeVar

from msgspec import structs

from rvmon.cdv.campaign import Campaign
from rvmon.cdv.campaign_plan import Job, Outcome
from rvmon.cdv.test import Test, TestError, VerdictName, from_json, save, to_json
from rvmon.coverage import Ending
from rvmon.errors import UnknownNameError
from rvmon.execute import parallel
from rvmon.files import write_whole
from rvmon.verdicts import Verdict

MOST = 2_000
"""The most tests that are played to shrink one."""

_ENDS = {
    Ending.COMPLETED: "completes",
    Ending.CRASHED: "crashes",
    Ending.HUNG: "hangs",
    Ending.LOST: "is lost",
}

_Test = TypeVar("_Test", bound=Test)


@dataclass(frozen=True, slots=True)
class Failure:
    """The failure of a run, which the run of a smaller test must show as well."""

    requirement: str  # the failed requirement; empty: the run does not complete
    ending: Ending = Ending.COMPLETED  # how the run ends, if no requirement is named
    error: str = ""  # the type of exception that the code raised, if it crashed

    def is_of(self, outcome: Outcome) -> bool:
        """Whether a run has this failure."""
        if self.requirement:
            return outcome.verdicts.get(self.requirement) is Verdict.FAIL
        return outcome.ending is self.ending and _kind(outcome) == self.error

    def __str__(self) -> str:
        if self.requirement:
            return f"{self.requirement} fails"
        return f"the run {_ENDS[self.ending]}" + (f": {self.error}" if self.error else "")


@dataclass(frozen=True, slots=True)
class Shrunk(Generic[_Test]):
    """A test that was shrunk."""

    test: _Test  # the smallest one that was found
    outcome: Outcome  # of its run
    failure: Failure  # the failure it shares with the original test
    tried: int  # number of played tests
    seconds: float  # wall time
    # Whether every single removal, and every variant from `Test.simpler`, loses the failure;
    # `False` if the search was interrupted or took too many tests.
    is_minimal: bool


def shrink(
    test: _Test,
    outcome: Outcome,
    play: Callable[[_Test], Outcome],
    requirement: str | None = None,
    *,
    most: int = MOST,
) -> Shrunk[_Test] | None:
    """Shrink a test; `None` if its run does not fail.

    A run that does not complete is shrunk to one that ends in the same way; any other run to one
    that fails the same requirement, at any instant. Ctrl-C ends the search with the smallest test
    found so far. Typically about as many tests are played as the test has parts and values.

    Args:
        test: the failing test; its type defines `removable` and `simpler`.
        outcome: of its run.
        play: plays a test; the same test must give the same run.
        requirement: the requirement that must fail. Default: the ending if the run did not
            complete, else the first failed requirement, preferring those that the test expects to
            fail.
        most: the most tests that are played.

    Raises:
        UnknownNameError: the requirement, or a field in the type's `removable`, does not exist.
    """
    if requirement is not None and requirement not in outcome.verdicts:
        there_are = ", ".join(outcome.verdicts)
        raise UnknownNameError(f"no requirement `{requirement}`: there are {there_are}")
    known = [name for name, verdict in test.expected.items() if verdict == "F"]
    failure = failure_of(outcome, requirement, known)
    if failure is None:
        return None
    started = time.perf_counter()
    search = _Search(test, outcome, play, failure, most)
    is_minimal = search.run()
    seconds = time.perf_counter() - started
    return Shrunk(search.test, search.outcome, failure, search.tried, seconds, is_minimal)


def failure_of(
    outcome: Outcome, requirement: str | None = None, known: Sequence[str] = ()
) -> Failure | None:
    """The failure of a run, or of a requirement in it; `None` if there is none.

    By default it is the ending if the run did not complete, else the first failed requirement,
    those in `known` first.
    """
    if requirement is None and outcome.ending is not Ending.COMPLETED:
        return Failure("", outcome.ending, _kind(outcome))
    names = (*known, *outcome.verdicts) if requirement is None else (requirement,)
    failures = (Failure(name) for name in names)
    return next((failure for failure in failures if failure.is_of(outcome)), None)


@dataclass(slots=True)
class _Search(Generic[_Test]):
    """Removes large pieces first, then single elements, then simplifies values.

    Source: Zeller and Hildebrandt, Simplifying and Isolating Failure-Inducing Input, IEEE TSE
    28(2), 2002, section 3 (`ddmin`; of the two tests of a halving one is the other's complement,
    so only complements are played).
    """

    test: _Test  # the smallest so far
    outcome: Outcome  # of its run
    play: Callable[[_Test], Outcome]
    failure: Failure
    most: int  # the most tests to play
    tried: int = 0  # number of played tests
    seen: set[bytes] = field(default_factory=set)  # tests considered so far, as JSON

    def __post_init__(self) -> None:
        self.seen.add(to_json(self.test))
        known = {own.name for own in structs.fields(self.test)}
        for name in self.test.removable:
            if name not in known:
                raise UnknownNameError(
                    f"`{type(self.test).__name__}.removable` names `{name}`, which is not one of "
                    f"its fields: there are {', '.join(sorted(known))}"
                )

    def run(self) -> bool:
        """Search until nothing more can be removed or simplified; `False` if cut short."""
        try:
            while True:
                for name in self.test.removable:
                    self._remove(name)
                if not self._simplify():
                    return True
        except (_EnoughError, KeyboardInterrupt):
            return False

    def _remove(self, name: str) -> None:
        """Remove elements of a sequence field until no single one can be removed."""
        size = len(getattr(self.test, name))
        while size:
            start = 0
            is_smaller = False
            while start < len(parts := getattr(self.test, name)):
                rest = (*parts[:start], *parts[start + size :])
                if self._fails(structs.replace(self.test, **{name: rest})):
                    is_smaller = True
                else:
                    start += size
            # Try single elements again as long as one was removed: others may depend on it.
            size = (size + 1) // 2 if size > 1 else int(is_smaller)

    def _simplify(self) -> bool:
        """Simplify values until no single one can be simplified; return whether any was."""
        is_simpler = False
        while any(self._fails(candidate) for candidate in self.test.simpler()):
            is_simpler = True
        return is_simpler

    def _fails(self, test: _Test) -> bool:
        """Whether a test not tried before has the failure; if so, continue from it."""
        text = to_json(test)
        if text in self.seen:
            return False
        self.seen.add(text)
        if self.tried >= self.most:
            raise _EnoughError
        try:
            checked = from_json(text, type(test))
            self.tried += 1
            outcome = self.play(checked)
        except TestError:  # the candidate is not valid, or cannot be played
            return False
        if self.failure.is_of(outcome):
            self.test, self.outcome = checked, outcome
            return True
        return False


class _EnoughError(Exception):
    """The budget of tests is used up."""


def _kind(outcome: Outcome) -> str:
    """The type of exception that the code raised: the part of the error before the colon."""
    if outcome.ending is not Ending.CRASHED:
        return ""
    return (outcome.error or "").partition(":")[0]


_FILE = '''"""{found}"""

import subprocess
import sys
from pathlib import Path

TEST = Path(__file__).with_name({test})


def test_{function}():
    """{law}."""
    command = [{command}, "replay", TEST, "--expected"]
    assert subprocess.run(command, timeout={timeout}).returncode == 0
'''


def regression_test(campaign: Campaign, job: Job, shrunk: Shrunk[Test]) -> Test:
    """The smallest test, with a name of its own and its expected verdicts.

    If the original test was made to fail, or has a planted fault, the regression test expects the
    failure again, as it must find the fault. Any other expects a pass, so it fails until the robot
    is fixed.
    """
    test, failure = job.test, shrunk.failure
    finds = test.mutation is not None or test.expected.get(failure.requirement) == "F"
    expected: dict[str, VerdictName] = {}
    if failure.requirement:
        expected = {failure.requirement: "F" if finds else "P"}
    elif finds:
        expected = {name: verdict.value for name, verdict in shrunk.outcome.verdicts.items()}
    only = job.robot if len(campaign.robots) > 1 else test.robot
    return structs.replace(
        shrunk.test,
        name=f"{test.name}-small",
        text=f"the smallest test in which {failure}, as in {test.name}",
        robot=only,
        expected=expected,
        reaches={},
    )


def save_regression(campaign: Campaign, test: Test, folder: Path) -> tuple[Path, Path]:
    """Write a regression test as `NAME.json` and `test_NAME.py`, and return these paths."""
    function = re.sub(r"\W", "_", test.name)
    text = _FILE.format(
        found=f"Replays {test.name} and checks that it comes out as expected.",
        test=json.dumps(f"{test.name}.json"),
        function=function,
        law=", ".join(f"{name} is {verdict}" for name, verdict in test.expected.items())
        or "It completes",
        command=_command(campaign.program, folder),
        timeout=None if campaign.timeout_s is None else campaign.timeout_s + parallel.START_S,
    )
    path = folder / f"test_{function}.py"
    write_whole(path, text)
    return save(test, folder), path


def removed(before: Test, after: Test) -> str:
    """How many elements of each removable field are left after shrinking, in words."""
    fields = ((name, getattr(before, name), getattr(after, name)) for name in before.removable)
    return ", ".join(f"{len(new)} of {len(old)} {name}" for name, old, new in fields)


def _command(program: str, folder: Path) -> str:
    """The campaign's program as a Python expression, for a file in that folder."""
    if program:
        return f"Path(sys.executable).with_name({json.dumps(program)})"
    script = os.path.relpath(sys.argv[0], folder)
    return f"sys.executable, Path(__file__).parent / {json.dumps(script)}"

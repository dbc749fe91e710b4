"""A campaign as data: which robots, which tests, what is measured, what is known to fail."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rvmon.cdv.abstract_test import Test
from rvmon.cdv.closing import Closing
from rvmon.cdv.code import Code
from rvmon.cdv.presentation import Presentation
from rvmon.cdv.system import System

Strategy = Callable[[int, int], Sequence[Test]]
"""Makes tests from `(count, seed)`: the same arguments, the same tests."""


@dataclass(frozen=True, slots=True)
class Robot:
    """A system under test, and what judges it.

    Attributes:
        system: makes what plays its tests, once in each process.
        spec: file of its requirements; `None` judges nothing.
        coverage: files of further specifications: what their coverpoints, crosses and goals show is
            gathered, beside what those of `spec` do and what its requirements are seen to do.
        title: what tables and pages call it; default: its name in the campaign.
        spec_name: what they call its requirements; default: the path.
    """

    system: Callable[[], System[Any]]
    spec: str | Path | None
    coverage: Sequence[str | Path] = ()
    title: str = ""
    spec_name: str = ""


@dataclass(frozen=True, slots=True)
class Control:
    """A test without what its strategy, or chance, adds to it: played right after it.

    Its outcome is kept beside that of the test, and is shown in a table of its own.

    Attributes:
        name: heads that table, such as `without wind`.
        make: the control of a test, `None` if it has none.
    """

    name: str
    make: Callable[[Any], Test | None]


@dataclass(frozen=True, slots=True)
class ExpectedFailure:
    """A failure that is known, and is not to fail a campaign.

    That it fails no more is wrong as well: the entry is to go.

    Attributes:
        requirement: that fails.
        reason: why that is accepted, for people.
        strategy: in tests of this strategy only; empty: of any.
        test: in this test only; empty: in any.
        robot: of this robot only; empty: of any.
        seldom: no test need fail: it is a risk that remains, and is accepted.
    """

    requirement: str
    reason: str
    strategy: str = ""
    test: str = ""
    robot: str = ""
    seldom: bool = False


@dataclass(frozen=True, slots=True)
class Gate:
    """What the tests of a strategy have to bring together, for `--strict`.

    Attributes:
        untriggered: requirements that need not be triggered; every other one is to pass or fail.
        inconclusive: requirements that a test may leave open.
        coverage: percent of the coverage model that the tests have to cover.
    """

    untriggered: Collection[str] = ()
    inconclusive: Collection[str] = ()
    coverage: float = 0.0


@dataclass(frozen=True, slots=True)
class Campaign:
    """All that a campaign consists of but how many tests there are.

    Attributes:
        name: what people call it; the page's title.
        test: the type of its tests.
        strategies: by name, in the order of the columns of a table.
        robots: by name.
        code: whose coverage is measured.
        states: that the robot has; what is not listed is counted, and is no goal.
        transitions: that its code allows, likewise, and with them every pair of two that follow
            each other; default: from each of `states` to each other one, where those that cannot be
            are for `Closing.unreachable`.
        control: what is played beside a test.
        expected_failures: that do not fail it.
        gates: by strategy, what its tests have to bring; those of all strategies without one are
            held against that of the name "" together, and without that against `Gate()`.
        timeout_s: seconds that a test may take before it is ended; `None`: any.
        sources: files and folders that runs depend on, beside those that define tests, strategies
            and systems: where one has changed, an unfinished campaign is not gone on with.
        packages: whose versions runs depend on, likewise.
        program: the installed program that runs it; empty: the script that was started.
        presentation: how its figures are shown.
        closing: how its holes are closed.
    """

    name: str
    test: type[Test]
    strategies: Mapping[str, Strategy]
    robots: Mapping[str, Robot]
    code: Code | None = None
    states: Sequence[str] = ()
    transitions: Sequence[tuple[str, str]] | None = None
    control: Control | None = None
    expected_failures: Sequence[ExpectedFailure] = ()
    gates: Mapping[str, Gate] = field(default_factory=dict)
    timeout_s: float | None = 600.0
    sources: Sequence[str | Path] = ()
    packages: Sequence[str] = ()
    program: str = ""
    presentation: Presentation = field(default_factory=Presentation)
    closing: Closing = field(default_factory=Closing)

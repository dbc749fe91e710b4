"""A campaign as data: robots, strategies, measured code, expected failures, unreachable items."""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from rvmon.cdv.system import Code, System
from rvmon.cdv.tables import Presentation
from rvmon.cdv.template import Edge, Template
from rvmon.cdv.test import Test
from rvmon.coverage import Model, Subject
from rvmon.errors import RvmonError, UnknownNameError
from rvmon.session import load
from rvmon.texts import did_you_mean

if TYPE_CHECKING:
    from rvmon.coverage.monitor import SpecCoverage
    from rvmon.models.network import Network
    from rvmon.session import Spec


STRATEGY = "closed"
"""The strategy of all tests that `close` makes."""

_Option = TypeVar("_Option", bound=Hashable)


@dataclass(frozen=True, slots=True)
class Unreachable:
    """An item of the coverage model that no test can hit, with the reason; a hit is an error.

    Attributes:
        group: the group of the item; empty: any group of the measured code.
        item: its name. In code, the text of a line stands for its statement and all branches that
            lead there, and `text → text` for the branch between two lines.
        reason: for people.
        robot: the only robot this applies to; empty: all.
        by_model: `close` does not trust the reason but asks the model for a proof, and keeps the
            item open if there is none.
    """

    group: str
    item: str
    reason: str
    robot: str = ""
    by_model: bool = False


@dataclass(frozen=True, slots=True)
class ClosingModel:
    """A timed model of the system under test and of what tests do to it.

    Attributes:
        network: makes the model.
        automata: names of the automata that tests control, such as people and sensors.
        actions: the action of a test for each edge of these automata; other edges need no action.
        make: makes a test from a template and a seed.
        query: maps an item's group and name to the query that decides whether it can be reached;
            empty: none. A witness (for an `A` query, a counterexample) becomes a test; if there is
            none, the item is proved unreachable.
        automaton: name of the automaton of the system under test.
        states: the system's state for each location of that automaton; locations left out are
            ignored. A test shows the edges of a run of the model if the system enters the states
            of that run first, in the same order.
        robots: the robots that the model describes; default: all. For other robots it proves
            nothing, though its runs may still be good tests.
    """

    network: Callable[[], Network]
    automata: Collection[str]
    actions: Mapping[Edge, Any]
    make: Callable[[Template[Any], int], Test]
    query: Callable[[str, str], str]
    automaton: str
    states: Mapping[str, str]
    robots: Collection[str] = ()


class Choose(Protocol):
    """Draws one of several options; an option that paid off before is more likely."""

    def __call__(self, name: str, options: Sequence[_Option], /) -> _Option:
        """Draw an option.

        Args:
            name: identifies the choice, so that its past results can be weighed.
            options: to draw from.
        """
        ...


@dataclass(frozen=True, slots=True)
class Closing:
    """How a campaign closes its holes; by default only with its strategies and changes of tests.

    Attributes:
        strategies: the strategies that tests are drawn from; default: all. Tests with a planted
            fault are skipped.
        written: strategies whose tests are written by people; each of these tests is played once,
            before any test is made at random.
        fixed: fields of tests that are never changed, such as `horizon_s` or `faults.noise_m`.
        biased: makes a test from a `Choose`, which draws its choices biased towards open goals, and
            a seed for everything else.
        model: of the system.
        unreachable: the items that no test can hit.
    """

    strategies: Sequence[str] = ()
    written: Sequence[str] = ()
    fixed: Collection[str] = ()
    biased: Callable[[Choose, int], Test] | None = None
    model: ClosingModel | None = None
    unreachable: Sequence[Unreachable] = ()


Strategy = Callable[[int, int], Sequence[Test]]
"""Makes tests from `(count, seed)`; the same arguments give the same tests."""


@dataclass(frozen=True)
class Robot:
    """A system under test with its specifications.

    Attributes:
        system: makes the `System` that plays its tests, once in each process.
        spec: the file of its requirements; `None` judges nothing.
        coverage: further specification files, whose coverpoints, crosses and goals are covered in
            addition to those of `spec` and to the behaviour of its requirements.
        title: its name in tables and pages; default: its name in the campaign.
        spec_name: the name of its requirements in tables and pages; default: the path.
    """

    system: Callable[[], System[Any]]
    spec: str | Path | None
    coverage: Sequence[str | Path] = ()
    title: str = ""
    spec_name: str = ""

    @cached_property
    def requirements(self) -> Spec | None:
        """The specification that judges it; the file is read once.

        Raises:
            SpecError: the file is wrong.
        """
        return None if self.spec is None else load(self.spec)

    @cached_property
    def coverages(self) -> list[SpecCoverage]:
        """The coverage models of its specifications, `spec` first; their files are read once.

        Raises:
            RvmonError: one of the files is wrong.
        """
        specs = [self.requirements, *map(load, self.coverage)]
        return [spec.coverage_model for spec in specs if spec is not None]


@dataclass(frozen=True, slots=True)
class Control:
    """A variant of each test without the disturbances of its strategy, played right after the test.

    The outcome of the control is stored with that of the test, and is shown in its own table.

    Attributes:
        name: the heading of that table, such as `without wind`.
        make: makes the control of a test; returns `None` if the test has none.
    """

    name: str
    make: Callable[[Any], Test | None]


@dataclass(frozen=True, slots=True)
class ExpectedFailure:
    """A known failure, which does not fail the campaign.

    If it no longer occurs, the campaign fails until the entry is removed.

    Attributes:
        requirement: the requirement that fails.
        reason: why the failure is accepted, for people.
        strategy: only in tests of this strategy; empty: of any.
        test: only in this test; empty: in any.
        robot: only on this robot; empty: on any.
        seldom: the failure need not occur in any test: it is an accepted remaining risk.
    """

    requirement: str
    reason: str
    strategy: str = ""
    test: str = ""
    robot: str = ""
    seldom: bool = False


@dataclass(frozen=True, slots=True)
class Gate:
    """Conditions that `--strict` puts on all tests of a strategy together.

    Attributes:
        untriggered: requirements that need not be triggered; every other one must pass or fail in
            some test.
        inconclusive: requirements that a test may leave inconclusive.
        coverage: percentage of the coverage model that the tests have to cover.
    """

    untriggered: Collection[str] = ()
    inconclusive: Collection[str] = ()
    coverage: float = 0.0


@dataclass(frozen=True, slots=True)
class Campaign:
    """A campaign without its number of tests.

    Attributes:
        name: its name for people; the default title of its page.
        test: the type of its tests.
        strategies: by name, in the order of the table's columns.
        robots: by name.
        code: the code whose coverage is measured.
        states: the robot's states to cover; other states are counted, but are not goals.
        transitions: the transitions to cover, together with every pair of consecutive ones; others
            are counted, but are not goals. Default: from each of `states` to every other, without
            the pairs; list the impossible ones in `Closing.unreachable`.
        control: a variant played with each test.
        expected_failures: failures that do not fail the campaign.
        gates: by strategy. The tests of all strategies without a gate are judged together by the
            gate named "", or by `Gate()` if there is none.
        timeout_s: seconds after which a test is killed; `None`: never.
        sources: further files and folders that runs depend on, besides the definitions of tests,
            strategies and systems: if one has changed, an unfinished campaign is not continued.
        packages: Python packages whose versions runs depend on, with the same effect.
        program: the installed program that runs the campaign; empty: the script that was started.
        presentation: how its figures are presented.
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

    @property
    def requirements(self) -> dict[str, Spec]:
        """The specification of each robot that has one, by robot.

        Raises:
            SpecError: one of the files is wrong.
        """
        judging = ((name, robot.requirements) for name, robot in self.robots.items())
        return {name: spec for name, spec in judging if spec is not None}

    def requirements_of(self, robot: str) -> Spec:
        """The specification that judges a robot.

        Raises:
            RvmonError: the robot has no specification, or the file is wrong.
        """
        spec = self.robots[robot].requirements
        if spec is None:
            raise RvmonError(f"robot `{robot}` has no requirements: name some by --spec")
        return spec


_CODE = (Subject.STATEMENTS, Subject.BRANCHES)
_ARROW = " → "


def unreachable_items(
    campaign: Campaign, robot: str, model: Model, *, closing: bool = False
) -> dict[tuple[str, str], str]:
    """The items of a model that a campaign declares unreachable, each with the reason.

    Args:
        campaign: the campaign.
        robot: name of the robot.
        model: its coverage model.
        closing: the model is complete, as in `close`. Only then is an unknown item an error: other
            models lack, for example, the edges that `close` measures. Items `by_model` are left
            out, as `close` asks the model to prove them.

    Raises:
        UnknownNameError: when closing, the model has no such item.
    """
    reasons: dict[tuple[str, str], str] = {}
    for unreachable in campaign.closing.unreachable:
        if unreachable.robot not in ("", robot):
            continue
        items = [*_named(unreachable, model)]
        if not items and closing:
            place = f"code `{unreachable.item}`"
            if unreachable.group:
                place = f"{unreachable.group}: {unreachable.item}"
            known = [
                f"{name}: {item}" for name, group in model.groups.items() for item in group.items
            ]
            fix = did_you_mean(place, known, "take it out of `Closing.unreachable`")
            raise UnknownNameError(
                f"the campaign declares unreachable an item that does not exist: {place}; {fix}"
            )
        if not (closing and unreachable.by_model):
            reasons |= dict.fromkeys(items, unreachable.reason)
    return reasons


def _named(unreachable: Unreachable, model: Model) -> Iterable[tuple[str, str]]:
    if unreachable.item in getattr(model.groups.get(unreachable.group), "items", ()):
        yield unreachable.group, unreachable.item
        return
    for group in model.groups.values():
        if group.subject in _CODE and unreachable.group in ("", group.name):
            for item in group.items.values():
                targets = [item.text]
                if group.subject is Subject.BRANCHES:
                    targets.append(item.text.rpartition(_ARROW)[2])
                if unreachable.item in targets:
                    yield group.name, item.name

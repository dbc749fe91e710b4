"""A campaign as data: robots, tests, what is measured, what fails or cannot be reached."""

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
"""The strategy of all tests made to close holes."""

_Option = TypeVar("_Option", bound=Hashable)


@dataclass(frozen=True, slots=True)
class Unreachable:
    """An item of the coverage model that no test can hit, and why; a hit is an error.

    Attributes:
        group: of the item; empty: any of the measured code.
        item: its name; in code, the text of a line stands for its statement and all branches that
            lead there, `text → text` for the branch between two.
        reason: for people.
        robot: of this robot only; empty: of any.
        by_model: `close` asks the model for the proof; without it the item is open there.
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
        automata: names of those that tests stand for, such as people and sensors.
        actions: of a test, for their edges; those left out need no action.
        make: makes a test from a template, with a seed.
        query: from an item's group and name the query whose answer shows or excludes it; empty:
            none. A run that shows it (of `A`, that contradicts it) becomes a test; if there is
            none, the item is proved to be unreachable.
        automaton: of the system under test.
        states: the states of the system by the locations of that automaton; those left out are
            passed over. A test shows the edges of a run of the model if the system enters the
            states of that run first, in their order.
        robots: those of the campaign that the model describes; default: all. Of the others it
            proves nothing, though its runs may be good tests of them.
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
    """Draws one of some options, those more often that have paid; the choice is known by a name."""

    def __call__(self, name: str, options: Sequence[_Option], /) -> _Option:
        """Draw."""
        ...


@dataclass(frozen=True, slots=True)
class Closing:
    """The way a campaign closes its holes; by default from its strategies and its tests alone.

    Attributes:
        strategies: the strategies that tests are drawn from; default: all. Tests with a planted
            fault are passed over.
        written: strategies whose tests people have written: each is played once, before any is
            made by chance.
        fixed: fields of tests that are never changed, such as `horizon_s` or `faults.noise_m`.
        biased: makes a test whose choices are drawn by what is given to it, with a seed for the
            rest: so they can be biased towards what is open.
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
"""Makes tests from `(count, seed)`: the same arguments, the same tests."""


@dataclass(frozen=True)
class Robot:
    """A system under test, and what judges it.

    Attributes:
        system: makes what plays its tests, once in each process.
        spec: the file of its requirements; `None` judges nothing.
        coverage: files of further specifications, whose coverpoints, crosses and goals are covered
            in addition to those of `spec` and to the behaviour of its requirements.
        title: its name in tables and pages; default: its name in the campaign.
        spec_name: the name of its requirements there; default: the path.
    """

    system: Callable[[], System[Any]]
    spec: str | Path | None
    coverage: Sequence[str | Path] = ()
    title: str = ""
    spec_name: str = ""

    @cached_property
    def requirements(self) -> Spec | None:
        """The specification that judges it, read once.

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
    """A test without what its strategy, or chance, adds to it: played right after it.

    Its outcome is kept with that of the test, and is shown in a table of its own.

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
        requirement: the failed requirement.
        reason: the reason for accepting that, for people.
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
    """The conditions that the tests of a strategy have to meet together, for `--strict`.

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
        name: its name for people; the page's title.
        test: the type of its tests.
        strategies: by name, in the order of the columns of a table.
        robots: by name.
        code: the code whose coverage is measured.
        states: of the robot; others are counted, and are no goals.
        transitions: of its code, likewise, and with them every pair of two that follow
            each other; default: from each of `states` to each other one, where those that cannot be
            are for `Closing.unreachable`.
        control: a variant played with each test.
        expected_failures: failures that do not fail the campaign.
        gates: by strategy, what its tests have to bring; those of all strategies without one are
            compared with that of the name "" together, and without that with `Gate()`.
        timeout_s: seconds that a test may take before it is ended; `None`: any.
        sources: further files and folders that runs depend on, besides the definitions of tests,
            strategies and systems: if one has changed, an unfinished campaign is not continued.
        packages: Python packages on whose versions runs depend, likewise.
        program: the installed program that runs it; empty: the script that was started.
        presentation: of its figures.
        closing: the way to close its holes.
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
        """By robot that is judged, the specification that judges it.

        Raises:
            SpecError: one of the files is wrong.
        """
        judging = ((name, robot.requirements) for name, robot in self.robots.items())
        return {name: spec for name, spec in judging if spec is not None}

    def requirements_of(self, robot: str) -> Spec:
        """The specification that judges a robot.

        Raises:
            RvmonError: nothing does, or it is wrong.
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
    """The items of a model that a campaign calls unreachable, each with the reason.

    When `closing`, the model has all that is ever measured: what it lacks there is not; and what is
    to be proved is left out, as closing asks for that. Any other, such as one without the edges
    that closing measures, may lack what is named.

    Raises:
        UnknownNameError: nothing in the model is called so.
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
                f"the campaign calls unreachable what there is not: {place}: nothing that is "
                f"measured is called so; {fix}"
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

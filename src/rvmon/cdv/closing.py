"""What a campaign knows of its own holes: which no test can fill, and what a model says of them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from rvmon.cdv.abstract_test import Test
from rvmon.cdv.template import Template
from rvmon.cdv.witness_templates import Edge

if TYPE_CHECKING:
    from rvmon.timed.model.network import Network

STRATEGY = "closed"
"""That of all tests that are made to close holes."""

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
    """

    group: str
    item: str
    reason: str
    robot: str = ""


@dataclass(frozen=True, slots=True)
class ClosingModel:
    """A timed model of the system under test and of what tests do to it.

    Attributes:
        network: makes the model.
        automata: names of those that tests stand for, such as people and sensors.
        actions: what a test does for their edges; those left out need no action.
        make: makes a test from a template, with a seed.
        query: what is asked of the model about an item, by its group and name; empty: nothing. A
            run that shows it (of `A`, that contradicts it) becomes a test; if there is none, the
            item is proved to be unreachable.
        automaton: that of the system under test.
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
    """How a campaign closes its holes; by default from its strategies and its tests alone.

    Attributes:
        strategies: those that tests are drawn from; default: all. Tests with a planted fault are
            passed over.
        written: strategies whose tests people have written: each is played once, before any is
            made by chance.
        fixed: fields of tests that are never changed, such as `horizon_s` or `faults.noise_m`.
        biased: makes a test whose choices are drawn by what is given to it, with a seed for the
            rest: so they can be biased towards what is open.
        model: of the system.
        unreachable: what no test can hit.
    """

    strategies: Sequence[str] = ()
    written: Sequence[str] = ()
    fixed: Collection[str] = ()
    biased: Callable[[Choose, int], Test] | None = None
    model: ClosingModel | None = None
    unreachable: Sequence[Unreachable] = ()

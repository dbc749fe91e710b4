"""What all judges of open attempts have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Protocol

from rvmon.automaton.machine import INFINITY, Token
from rvmon.dataflow.flow import Flow
from rvmon.dataflow.outages import Outage
from rvmon.formula.state import UNKNOWN
from rvmon.monitor.compiled import CompiledRequirement
from rvmon.monitor.doubt import Doubt
from rvmon.trace.sample import Scalar
from rvmon.trace.time import TIME_LIMIT

if TYPE_CHECKING:
    from rvmon.monitor.episode import Episode


class Open:
    """One undecided attempt.

    Attributes:
        number: of the attempt; 0 until it is numbered.
        triggered: the instant of its trigger.
        token: of the run that takes the unknown for the worse.
        better: of the run that takes it for the better; `None` as long as both are the same.
        seen: the values of the judge's leaves at the trigger.
        doubt: when and why the two runs parted; `None` if they did not.
        sure: whether its trigger was TRUE; else it is in doubt.
        doubtful_number: as `number`, if its trigger was not TRUE at first.
        clouded: whether its trigger was unknown while it ran.
        void: whether it cannot pass, since its episode was over before all was born.
    """

    __slots__ = (
        "better",
        "clouded",
        "doubt",
        "doubtful_number",
        "number",
        "seen",
        "sure",
        "token",
        "triggered",
        "void",
    )

    STATE = __slots__

    def __init__(self, triggered: int, token: Token, seen: tuple[int, ...]) -> None:
        self.number = 0
        self.triggered = triggered
        self.token = token
        self.better: Token | None = None
        self.seen = seen
        self.doubt: Doubt | None = None
        self.sure = False
        self.doubtful_number = 0
        self.clouded = False
        self.void = False

    def unsplit(self) -> Open:
        """The same, as if only the run that takes the unknown for the worse were there."""
        made = Open(self.triggered, self.token, self.seen)
        made.number, made.doubtful_number = self.number, self.doubtful_number
        made.doubt = self.doubt
        return made


class Holder(Protocol):
    """What has open attempts that are driven one by one: a judge, or a rule of generated code."""

    attempts: list[Open]


class Clerk(Protocol):
    """Keeps the records."""

    def decided(
        self, judge: AttemptJudge, attempt: Open, verdict: bool, t: int, before: Token
    ) -> None:
        """Take a decision at `t`; `before` is the token of the run that brought it, before that.

        Between the position of `before` and `t` the letters were as the judge has them.
        """


class AttemptJudge(ABC):
    """The open attempts of one requirement, driven through positions and time.

    Attributes:
        compiled: the requirement.
        flow: gives the truth of the propositions.
        clerk: hears of decisions.
        captured: values of `let` and `for each`.
        places: of the propositions in the flow.
        leaves: place and text of what is read of the input.
        attempts: the undecided ones, oldest first; also those that only the end can settle.
        due: an instant before which, the letters staying, no attempt can be decided.
        restless: whether attempts may move at the next position though the letters stay.
        position: the one visited last.
        episode: follows its attempts, one after the other, if they are episodes.
    """

    STATE: tuple[str, ...] = ("attempts", "due", "restless", "position")

    def __init__(
        self,
        compiled: CompiledRequirement,
        flow: Flow,
        clerk: Clerk,
        captured: Mapping[str, Scalar],
    ) -> None:
        self.compiled = compiled
        self.flow = flow
        self.clerk = clerk
        self.captured = captured
        index = flow.graph.index
        self.places = tuple(index[state] for state in compiled.alphabet.propositions)
        self.leaves = leaves_in(flow, compiled)
        self.attempts: list[Open] = []
        self.due = INFINITY
        self.restless = False
        self.position = -TIME_LIMIT
        self.episode: Episode | None = None

    @abstractmethod
    def new_attempt(self, t: int, triggered: int, /) -> Open:
        """An attempt at the position `t`, which the flow is at; it is not driven yet."""

    @abstractmethod
    def begin(self, attempt: Open, t: int) -> None:
        """Drive an attempt from the position `t` on, which the flow is at."""

    @abstractmethod
    def visit(self, t: int) -> None:
        """Take all attempts to the position `t`, which the flow is at."""

    @abstractmethod
    def pass_to(self, t: int) -> None:
        """Let time come to `t` with the letters as they are; positions up to there are stepped."""

    @abstractmethod
    def reach(self, t: int) -> None:
        """Let time come to `t`, of which the letter is not known, from the instant before."""

    @property
    @abstractmethod
    def next_due(self) -> int:
        """The next instant at which time alone can decide an attempt, as far as is known now."""

    @abstractmethod
    def held_at_end(self, attempt: Open, end: int, reached: int) -> bool:
        """Whether the rule for the end of a trace makes an undecided attempt true.

        Args:
            attempt: one of these.
            end: the last instant of the trace.
            reached: the instant that time has come to.
        """

    @property
    def seen(self) -> tuple[int, ...]:
        """The values of the leaves now."""
        values = self.flow.values
        return tuple([values[place] for place, _ in self.leaves])

    def _doubt(self) -> Doubt:
        """What is not known at this position of all that is read of the input."""
        return doubt_in(self.flow, self.leaves, self.position)


def leaves_in(flow: Flow, compiled: CompiledRequirement) -> tuple[tuple[int, str], ...]:
    """What a requirement reads of the input, as far as a flow has it."""
    index = flow.graph.index
    return tuple((index[leaf], text) for leaf, text in compiled.leaves if leaf in index)


def doubt_in(flow: Flow, leaves: Sequence[tuple[int, str]], position: int) -> Doubt:
    """What a flow does not know of some leaves.

    Args:
        flow: at the position.
        leaves: place and text of each.
        position: its instant.
    """
    values, reads, outages = flow.values, flow.graph.reads, flow.outages
    found: dict[str, Outage] = {}
    texts = []
    for place, text in leaves:
        if values[place] == UNKNOWN:
            own = {name: outages[name] for name in sorted(reads[place].names & outages.keys())}
            found |= own
            texts += [] if own else [text]
    return Doubt(position, tuple(found.values()), tuple(texts))


def held_by(judge: AttemptJudge) -> tuple[str, Holder, Open | None]:
    """The requirement of a judge, the judge, and the attempt of an episode that runs."""
    running = None if judge.episode is None else judge.episode.current
    return judge.compiled.requirement.id, judge, running

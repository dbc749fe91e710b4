"""The open attempts of one requirement, with what is reported of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any, Protocol

from rvmon.automaton.location import Token
from rvmon.formula.state import TRUE, UNKNOWN, State
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.reasons.doubt import Doubt
from rvmon.plan.graph import Graph
from rvmon.plan.outages import Outage
from rvmon.plan.standing import Standing
from rvmon.runtime.rule import Rule
from rvmon.spec.checked.specification import Mode
from rvmon.trace.sample import Scalar


class Open:
    """One undecided attempt.

    Attributes:
        number: of the attempt; 0 until it is numbered.
        triggered: the instant of its trigger.
        token: of the run that takes the unknown for the worse.
        better: of the run that takes it for the better; `None` as long as both are the same.
        seen: the values of what is read of the input at the trigger.
        doubt: when and why the two runs parted, `None` if both are the same; of an attempt in
            doubt of an `upon`, when and why it is not known whether there was a trigger.
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


class Clerk(Protocol):
    """Makes attempts, and keeps the records."""

    def opened(self, judge: Any, triggered: int, token: Token, sure: bool) -> Open:
        """A new attempt; `sure`: its trigger was true."""

    def assured(self, judge: Any, attempt: Open) -> None:
        """Hear that the trigger of an attempt was true, which was unknown before."""

    def parted(self, judge: Any, attempt: Open, apart: bool) -> None:
        """Hear that unknown input made the two runs of an attempt part, or that they met."""

    def decided(self, judge: Any, attempt: Open, verdict: bool, t: int, before: Token, /) -> None:
        """Take a decision at `t`; `before` is the token of the run that brought it, before that.

        Between the position of `before` and `t` the letters were as the judge has them.
        """


class AttemptJudge(Rule):
    """A rule that knows its requirement.

    Args:
        compiled: the requirement, or what judges its attempts in doubt.
        machine: judges the attempts; `None`: a subclass does.
        flow: gives the truth of the propositions.
        clerk: makes attempts and hears of decisions.
        captured: values of `let` and `for each`.
        index: of the rule in a unit of generated code.
        rank: of its instance.
        hidden: whether these are the attempts in doubt.
        doubted: whether it is not known that there is such an instance.
        started_elsewhere: whether something else starts its attempts.

    Attributes:
        leaves: place and text of what is read of the input.
    """

    def __init__(
        self,
        compiled: CompiledRequirement,
        machine: Any,
        flow: Standing,
        clerk: Clerk,
        captured: Mapping[str, Scalar],
        *,
        index: int = 0,
        rank: int = 0,
        hidden: bool = False,
        doubted: bool = False,
        started_elsewhere: bool = False,
    ) -> None:
        self.compiled = compiled
        self.flow = flow
        self.captured = captured
        self.rank = rank
        self.doubted = doubted
        self.started_elsewhere = started_elsewhere
        obligation, requirement = compiled.obligation, compiled.requirement
        # With captured values, what is FALSE where an episode is over is more than its trigger.
        self._asked = self._place_of(obligation.trigger)
        trigger = self._place_of(obligation.running) if requirement.captures else self._asked
        super().__init__(
            index,
            machine,
            None,
            trigger,
            requirement.pulse,
            trigger >= 0 and (hidden or requirement.mode is Mode.WHENEVER),
            hidden,
            -1 if doubted else self._place_of(obligation.again),
            self._place_of(obligation.unborn),
            flow.gap,
            flow.values,
            clerk,
        )

    def _place_of(self, state: State | None) -> int:
        return -1 if state is None else self.flow.graph.index.get(state, -1)

    @cached_property
    def places(self) -> tuple[int, ...]:
        """Of the propositions in the flow."""
        index = self.flow.graph.index
        return tuple(index[state] for state in self.compiled.alphabet.propositions)

    @cached_property
    def leaves(self) -> tuple[tuple[int, str], ...]:
        """See the class."""
        return leaves_in(self.flow.graph, self.compiled)

    def starts(self, truth: int) -> bool:
        """See `Rule`."""
        return (self.running or not self.started_elsewhere) and super().starts(truth)

    @property
    def is_sure(self) -> bool:
        """See `Rule`."""
        return not (self.doubted or (self.episodic and self.values[self._asked] != TRUE))

    def settle_flags(self) -> None:
        """See `Rule`; where it is not known what was captured, all flags are set already."""
        if not self.flow.is_cut:
            super().settle_flags()

    @property
    def next_due(self) -> int:
        """The next instant at which time alone can decide an attempt, as far as is known now."""
        return self.due

    def held_at_end(self, attempt: Open, end: int, reached: int) -> bool:
        """Whether the rule for the end of a trace makes an undecided attempt true.

        Args:
            attempt: one of these.
            end: the last instant of the trace.
            reached: the instant that time has come to.
        """
        raise NotImplementedError

    @property
    def seen(self) -> tuple[int, ...]:
        """The values of the leaves now."""
        values = self.flow.values
        return tuple([values[place] for place, _ in self.leaves])

    @property
    def doubt(self) -> Doubt:
        """What is not known at this position of all that is read of the input."""
        return doubt_in(self.flow, self.leaves, self.position)


def leaves_in(graph: Graph, compiled: CompiledRequirement) -> tuple[tuple[int, str], ...]:
    """Place and text of what a requirement reads of the input, as far as a graph has it."""
    index = graph.index
    return tuple((index[leaf], text) for leaf, text in compiled.leaves if leaf in index)


def doubt_in(flow: Standing, leaves: Sequence[tuple[int, str]], position: int) -> Doubt:
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

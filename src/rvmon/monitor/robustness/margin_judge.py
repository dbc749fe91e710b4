"""Attempts whose robustness is followed, beside a judge that follows their truth."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol

from rvmon.dataflow.margin_end import End, Rest
from rvmon.dataflow.margins import INFINITE, OF_TRUTH, Margin, margin_reader
from rvmon.dataflow.nodes import NetworkPlan
from rvmon.dataflow.piecewise import FAR
from rvmon.dataflow.robust import Gauge, Letter
from rvmon.formula.core import Constant, Literal, Sense
from rvmon.formula.state import FALSE, TRUE
from rvmon.monitor.attempts.attempt_judge import AttemptJudge, Clerk, Open
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.robustness.values import Robustness
from rvmon.plan.leaves import reads
from rvmon.plan.standing import Standing
from rvmon.runtime.expressions import Input
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Scalar

_SIDES = {Rest.LEAST: 0, Rest.GREATEST: 1, Rest.END: 0}


ODD = (LookupError, TypeError, OverflowError)
"""What reading a leaf raises that is no plain number."""


class Flow(Standing, Input, Protocol):
    """What leaves are read of."""

    @property
    def absent(self) -> frozenset[str]:
        """The names without a source."""


class Gauger(Clerk, Protocol):
    """Keeps the figures.

    Attributes:
        heard: the instant of the sample that came last.
    """

    heard: int

    def settled(self, judge: MarginJudge, attempt: Open, found: Robustness) -> None:
        """Take the figure of an attempt that nothing can change any more."""

    def passed(self, judge: MarginJudge, t: int, found: Robustness) -> None:
        """Take the figure of a position that nothing can change any more."""


class MarginJudge(AttemptJudge):
    """Follows the robustness of attempts: its least value, and its greatest if that differs.

    The attempts are those of another judge, which knows what becomes of them.

    Args:
        compiled: the requirement.
        plan: of the nodes of what it owes.
        flow: gives what is read.
        clerk: takes the figures.
        captured: values of `let` and `for each`.
        spec: gives the units.
        every: whether each position of a sample is measured, and not those of attempts alone.
        known: gives the robustness of the leaves, or raises one of `ODD` where one is no plain
            number; `None`: there is no such function.

    Attributes:
        positions: of its attempts, where each of them begins.

    Memory: what is not settled of the formula's operators; nothing while nothing is asked for.
    """

    def __init__(
        self,
        compiled: CompiledRequirement,
        plan: NetworkPlan,
        flow: Flow,
        clerk: Gauger,
        captured: Mapping[str, Scalar],
        spec: CheckedSpec,
        *,
        every: bool,
        known: Callable[[], Sequence[float]] | None = None,
    ) -> None:
        super().__init__(compiled, None, flow, clerk, captured)
        self.trigger = self.again = -1  # the other judge starts them
        self.watches = True
        self._inputs = flow
        self.restless = True
        self.gauger = clerk
        self.every = every
        self.positions: dict[Open, int] = {}
        self._gap = flow.gap or 1
        self._plan = plan
        self._readers = [self._reader(core, spec) for _, core in plan.leaves]
        self._passing = flow.gap is not None and any(then for _, then in self._readers)
        """Whether some leaf is another behind a position at which it is read."""
        self._gauge = compiled.gauge
        # Elsewhere a sample is not all that there is to be known up to its instant.
        self._goes_straight = not self._passing and compiled.obligation.trigger is not None
        self._plain = known
        self._least: Gauge | None = None
        self._greatest: Gauge | None = None
        self._waiting: list[tuple[Letter, Letter]] = []
        """What the leaves are from a position on, at least and at most, which the gauges do not
        know yet."""
        self._known = -FAR - 1
        """The integer up to which the gauges know the leaves."""
        self._lows: dict[int, float] = {}
        self._highs: dict[int, float] = {}

    def _reader(
        self, core: Literal | Constant, spec: CheckedSpec
    ) -> tuple[Callable[[], Margin], Margin | None]:
        """Reads a leaf; and what it is at the next position, if that is not the same."""
        if isinstance(core, Constant):
            fixed = OF_TRUTH[TRUE if core.value else FALSE]
            return (lambda: fixed), None
        inputs, state = self._inputs, core.proposition
        place, values = inputs.graph.index[state], inputs.values

        def truth() -> int:
            found: int = values[place]
            return found

        leaf, later = state.leaf, None
        if leaf is not None:
            about = reads(leaf)
            if about.momentary and not about.names & inputs.absent:
                later = OF_TRUTH[FALSE]
        if core.sense is Sense.KNOWN_FALSE:
            known = None if later is None else OF_TRUTH[TRUE]
            return (lambda: OF_TRUTH[TRUE if truth() == FALSE else FALSE]), known
        read: Callable[[], Margin] = lambda: OF_TRUTH[truth()]  # noqa: E731
        if leaf is not None:
            read = margin_reader(leaf, truth, inputs, self.captured, spec)
        if core.sense is Sense.TRUE:
            return read, later
        return (lambda: _negated(read())), None if later is None else _negated(later)

    def measure(self, attempt: Open, t: int) -> None:
        """Measure an attempt of the other judge from the position `t` on."""
        if self.position < t or self._least is None:
            self.position = t
            self._enter(t // self._gap)
        self._ask(t // self._gap)
        self.attempts.append(attempt)
        self.positions[attempt] = t // self._gap * self._gap

    def visit(self, t: int) -> None:
        """Note what all leaves are at the position `t`, which the flow is at."""
        self.position = t
        position = t // self._gap
        if self.every or self._plan.looks_back or self._least is not None:
            self._enter(position)
        if self.every and t - self._gap < self.gauger.heard:
            self._ask(position)

    def follow(self, t: int) -> None:
        """Note what all leaves are at a sample, the flow being at `t`; report what is settled."""
        if self.position < t:
            if self._least is None and not (self.every or self._plan.looks_back):
                self.position = t
                return
            if self._measured_plainly(t):
                return
            self.visit(t)
        if self.every:
            self._ask(t)
        self.settle(t)

    def _measured_plainly(self, t: int) -> bool:
        """Measure the position `t` if all leaves are plain numbers and all before it is known."""
        gauge = self._least
        if gauge is None or self._greatest or self._waiting or self._lows:
            return False
        values = self._plain_values() if self._goes_straight else None
        if values is None:
            return False
        self.position = self._known = t
        if self.every:
            gauge.ask(t)
        found = gauge.step(t, values, t, t)
        if found:
            for position, value in found:
                self._report(position, self._figure(value, value, value))
            self._rest()
        return True

    def _plain_values(self) -> Sequence[float] | None:
        """What the leaves are now; `None` if one of them is no plain number."""
        if self._plain is None:
            return None
        try:
            return self._plain()
        except ODD:
            return None

    def _read(self, position: int) -> tuple[Letter, Letter]:
        """What the leaves are from a position on, at least and at most."""
        values = self._plain_values()
        if values is None:
            return _letters(position, [read() for read, _ in self._readers])
        return (position, values), (position, values)

    def _enter(self, position: int) -> None:
        """Read the leaves at a position; up to the one before it, they are known."""
        if self._waiting and self._waiting[0][0][0] < position:
            self._pass(position - 1, position * self._gap)
        self._waiting = [self._read(position)]
        if self._passing:
            later = [read() if then is None else then for read, then in self._readers]
            self._waiting.append(_letters(position + 1, later))
        if self._least is None:
            self._least = self._gauge(position)
            self._known = -FAR - 1
        if self._greatest is None:
            low, high = self._waiting[0]
            if low[1] != high[1]:
                self._greatest = self._least.copy()

    @property
    def _gauges(self) -> list[Gauge]:
        return [gauge for gauge in (self._least, self._greatest) if gauge is not None]

    def _ask(self, position: int) -> None:
        for gauge in self._gauges:
            gauge.ask(position)

    def settle(self, reached: int) -> None:
        """Tell what has become known, all positions up to an instant having been visited."""
        if self.compiled.obligation.trigger is None:
            return  # The last position may be asked for when all is over.
        seen = reached if self.position == reached else reached - 1
        self._pass(seen // self._gap, reached)

    def _pass(self, now: int, reached: int) -> None:
        """Let the leaves be known up to an integer."""
        if self._least is None or now < self._known:
            return
        lows, highs = self._letters(now)
        found = self._least.take(lows, now, reached)
        self._known = now
        self._waiting = self._waiting[len(lows) :]
        if self._greatest is None and not self._lows:
            for position, value in found:
                self._report(position * self._gap, self._figure(value, value, value))
        else:
            self._lows.update(found)
            self._highs.update(
                found if self._greatest is None else self._greatest.take(highs, now, reached)
            )
            for position in sorted(self._lows.keys() & self._highs.keys()):
                low, high = self._lows.pop(position), self._highs.pop(position)
                self._report(position * self._gap, self._figure(low, high, low))
        self._rest()

    def _rest(self) -> None:
        """Let go of what nobody asks for."""
        if not (self.attempts or self.every or self._plan.looks_back):
            self._least = self._greatest = None

    def _report(self, t: int, found: Robustness) -> None:
        while self.attempts and self.positions[self.attempts[0]] == t:
            attempt = self.attempts.pop(0)
            del self.positions[attempt]
            self.gauger.settled(self, attempt, found)
        if self.every:
            self.gauger.passed(self, t, found)

    def _letters(self, last: int) -> tuple[list[Letter], list[Letter]]:
        """What the gauges do not know yet of the leaves, up to an integer."""
        ready = [letters for letters in self._waiting if letters[0][0] <= last]
        return [low for low, _ in ready], [high for _, high in ready]

    def figures(self, end: int, reached: int) -> dict[int, Robustness]:
        """The robustness at each instant that is asked for, if the trace has ended.

        Args:
            end: the last instant of the trace.
            reached: the instant that time has come to.
        """
        if self._least is None:
            return {}
        letters = self._letters(end // self._gap)
        last = FAR if self.flow.gap is None else end // self._gap
        found: dict[Rest, dict[int, float]] = {}
        for rest, side in _SIDES.items():
            gauge = self._least if self._greatest is None or not side else self._greatest
            bounds = self._highs if side else self._lows
            copied = gauge.copy()
            values = copied.take(letters[side], last, reached)
            found[rest] = {
                **bounds,
                **dict(values),
                **dict(copied.end(End(end, last, rest), reached)),
            }
        return {
            position * self._gap: self._figure(low, found[Rest.GREATEST][position], kept)
            for (position, low), kept in zip(
                sorted(found[Rest.LEAST].items()), _in_order(found[Rest.END]), strict=True
            )
        }

    def _figure(self, low: float, high: float, kept: float) -> Robustness:
        # Behind the cut it is owed with values that nobody knows.
        if self.flow.is_cut:
            return Robustness(-INFINITE, high, -INFINITE)
        return Robustness(low, high, kept)

    def pass_to(self, t: int) -> None:
        """Nothing is decided by time here."""

    def reach(self, t: int) -> None:
        """Nothing is decided by time here."""


def _in_order(values: Mapping[int, float]) -> list[float]:
    return [value for _, value in sorted(values.items())]


def _negated(margin: Margin) -> Margin:
    return -margin[1], -margin[0]


def _letters(position: int, margins: Sequence[Margin]) -> tuple[Letter, Letter]:
    """What leaves are from a position on, at least and at most."""
    return (position, [low for low, _ in margins]), (position, [high for _, high in margins])

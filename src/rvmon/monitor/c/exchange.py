"""The state of generated Python as numbers that its compiled counterpart goes on from, and back.

The two evaluate the same state formulas and step the same automata. What is lent is known, and
without attempts in doubt: so one reading of each operator is enough, and nothing is to be
reported of what was not known. `pass_state` of `rvmon/codegen/c/beside.c.in` has the
order of the numbers.
"""

from __future__ import annotations

import struct
from array import array
from collections.abc import Iterator, Sequence
from typing import Any

from rvmon.codegen.c_names import Memory, Names, memory_of
from rvmon.codegen.c_nodes import group_count, group_of
from rvmon.codegen.c_online import NEVER as C_NEVER
from rvmon.codegen.c_online import NOT_YET, OnlineLibrary, largest_taken
from rvmon.formula.state import COMBINING, FALSE, TRUE, UNKNOWN, State, StateOp
from rvmon.monitor.c.exchange_rules import (
    begins_with_letters,
    bounded,
    instant,
    is_plain,
    rule_words,
    take_rule,
)
from rvmon.monitor.online.forms import Forms
from rvmon.monitor.online.generated import GeneratedEvaluators
from rvmon.runtime.past import History
from rvmon.runtime.unit import Unit
from rvmon.runtime.values import NEVER
from rvmon.trace.schema import Kind

MOST_STRETCHES = 64
"""So many stretches of time a past operator of compiled code can remember."""


class Exchange:
    """Turns the state of monitors into numbers, and numbers into their state.

    Args:
        forms: what was generated in Python.
        library: the same compiled.
    """

    def __init__(self, forms: Forms, library: OnlineLibrary) -> None:
        self._forms = forms
        self._plan = plan = library.plan
        self._names = names = Names(plan)
        self._limits = library.limits
        self._largest = largest_taken(plan)
        graph, index = plan.graph, forms.plan.graph.index
        self._nodes = graph.nodes
        self._places = [index[state] for state in graph.nodes]
        """Of each node of the compiled plan, in the other."""
        self._timed = [self._places[place] for place in names.timers]
        own = set(self._places)
        kept = forms.unit.KEPT
        self._rest = [
            (place, state)
            for place, state in enumerate(forms.plan.graph.nodes)
            if place not in own and kept >> place & 1
        ]
        """The nodes that the compiled plan has not; they say what is not known."""
        self._operands = forms.plan.graph.operands
        self._read = [n for n, name in enumerate(plan.signals) if name in graph.by_name]
        self._names_read = frozenset(graph.by_name)
        self._asked = {
            index[state]
            for rule in plan.rules
            for state in (*rule.states, *(rule.noted or ()))
            if state is not rule.unborn
        }
        self._unborn = [index[rule.unborn] for rule in plan.rules if rule.unborn is not None]
        self._is_clocked = plan.gap not in (None, 1)
        self._texts = {number: text for text, number in names.labels.items()}

    # Lending.

    def lent(self, evaluators: GeneratedEvaluators, last: int, reached: int) -> bytes | None:
        """The state of a monitor between two calls; `None` if it cannot be lent now.

        Args:
            evaluators: of the monitor.
            last: the instant of the last sample, ticks.
            reached: the instant that time has come to.
        """
        unit = evaluators.unit
        if not self._names_read.isdisjoint(evaluators.outages.now):
            return None
        if not self._is_known(unit) or not all(map(is_plain, unit.rules)):
            return None
        rules = zip(unit.rules, self._plan.rules, strict=False)
        if not all(begins_with_letters(rule) for rule, planned in rules if planned.is_lettered):
            return None
        if unit.gathered and not self._is_clocked:
            unit.leave()  # what nobody reads has occurred
        times = (max(last, reached - 1), reached, last)
        try:
            return array("q", self._words(unit, evaluators.numbered, times)).tobytes()
        except OverflowError:  # no instant of a run, but of a snapshot that was forged
            return None

    def _is_known(self, unit: Unit) -> bool:
        """Whether all that matters is known, and will be if all that comes is."""
        v, w = unit.v, unit.w
        if unit.origin is None or unit.news or unit.looking:
            return False
        if self._is_clocked:
            if UNKNOWN in unit.o or UNKNOWN in unit.c.values():
                return False
        elif unit.dirty:
            return False
        if any(v[place] == UNKNOWN for place in self._asked):
            return False
        if any(v[place] == TRUE for place in self._unborn):
            return False
        if any(unit.b[place] != w[place] for place, _ in self._remembering(Memory.EDGE)):
            return False
        if any(one.better is not None for one in unit.marked.values()):
            return False
        if any(len(one.runs) > MOST_STRETCHES for one in unit.marked.values()):
            return False
        if not all(0 <= truth <= TRUE for truth in v):
            return False
        for place, state in self._rest:
            if state.op is StateOp.DOUBT and (v[place] != FALSE or w[place] == UNKNOWN):
                return False
            if state.op is StateOp.SINCE and v[place] != TRUE:
                return False  # whether a trigger was ever true or false
        return all(self._is_held(unit, signal) for signal in self._read)

    def _is_held(self, unit: Unit, signal: int) -> bool:
        """Whether the value of a signal is one that the compiled monitor takes."""
        history: History | None = unit.h[signal]
        values = [unit.s[signal]]
        if history is not None:
            if history.updates < 2:
                return False
            values += [history.last, history.before]
        name = self._plan.signals[signal]
        uses, limit = self._plan.uses[name], self._limits[name]
        if unit.births[signal] == 1 and (uses.history or uses.marked):
            return False  # an update more may say something
        return all(
            value is not None
            and (isinstance(value, str) or self._largest is None or abs(value) <= self._largest)
            and (type(value) is not int or abs(value) <= limit)
            for value in values
        )

    def _words(
        self, unit: Unit, counts: Sequence[int], times: tuple[int, int, int]
    ) -> Iterator[int]:
        yield from (0, unit.origin or 0, unit.position, unit.before)
        yield from (*times, int(unit.fading != 0))
        for place, truth in zip(self._places, self._truths(unit.v), strict=True):
            yield truth
            yield unit.since[place]
            yield from (_or_not_yet(one) for one in unit.until[3 * place : 3 * place + 3])
        fading = {group_of(n) for n, p in enumerate(self._places) if unit.fading >> p & 1}
        yield from (int(group in fading) for group in range(group_count(self._plan)))
        yield from (bounded(unit.wakes[place]) for place in self._timed)
        for signal in range(len(self._plan.signals)):
            history = unit.h[signal] or History()
            yield self._bits(unit.s[signal])
            yield 2
            yield bounded(unit.stale_at[signal])
            yield from (history.updates, history.at, history.before_at)
            yield self._bits(history.last)
            yield self._bits(history.before)
        for place, state in self._remembering(Memory.SEEN):
            yield unit.v[place] if state.op is StateOp.SINCE else unit.w[place] or FALSE
        for place, state in self._remembering(Memory.EDGE):
            yield from _edge(unit.w[place], ends=state.high is not None)
        for place, _ in self._remembering(Memory.PAST):
            one = unit.marked[place]
            yield from (int(one.left), int(one.right), int(one.growing), len(one.runs))
            yield from (bounded(bound) for stretch in one.runs for bound in stretch)
        if self._is_clocked:
            yield from self._awaited_words(unit)
        for rule, count in zip(unit.rules, counts, strict=False):
            yield from rule_words(rule, count)

    def _awaited_words(self, unit: Unit) -> Iterator[int]:
        """What samples brought that no position has seen yet."""
        plan = self._plan
        yield from (int(unit.gathered), bounded(unit.awaited))
        # Which nodes are parts of which is not the same: if one is to be worked out, all are.
        yield from [int(unit.dirty != 0)] * group_count(plan)
        yield from (int(name in unit.u) for name in (*plan.signals, *plan.events))
        yield from (unit.c.get(signal, FALSE) for signal in range(len(plan.signals)))
        yield from unit.o

    def _take_awaited(self, unit: Unit, words: Iterator[int], last: int) -> int:
        """Go on with that; returns the position at which it will show."""
        plan, gap = self._plan, unit.GAP or 1
        unit.gathered = bool(next(words))
        next(words)
        soiled = [next(words) for _ in range(group_count(plan))]
        unit.dirty = unit.KEPT if any(soiled) else 0
        unit.u = {name for name in (*plan.signals, *plan.events) if next(words)}
        changed = [next(words) for _ in plan.signals]
        unit.c = {signal: truth for signal, truth in enumerate(changed) if truth}
        unit.o[:] = [next(words) for _ in plan.events]
        unit.p = [[{}] if truth == TRUE else [] for truth in unit.o]
        awaited = -(-last // gap) * gap
        return awaited if awaited > unit.position else NEVER

    def _remembering(self, kind: Memory) -> Iterator[tuple[int, State]]:
        """The nodes that remember something of a kind; their places in Python's plan."""
        for place, state in zip(self._places, self._nodes, strict=True):
            if memory_of(state) is kind:
                yield place, state

    def _truths(self, v: Sequence[int]) -> list[int]:
        """The truths of all nodes; some are but a part of another in Python."""
        kept = self._forms.unit.KEPT
        found: list[int] = []
        for place, state, own in zip(
            self._places, self._nodes, self._plan.graph.operands, strict=True
        ):
            if kept >> place & 1 or state.op not in COMBINING:
                found.append(v[place])
            else:
                found.append(_combined(state.op, [found[operand] for operand in own]))
        return found

    def _bits(self, value: Any) -> int:
        if isinstance(value, str):
            value = self._names.label(value)
        number = float("nan") if value is None else float(value)
        (bits,) = struct.unpack("=q", struct.pack("=d", number))
        return int(bits)

    # Taking back.

    def take_back(self, evaluators: GeneratedEvaluators, state: bytes) -> int:
        """Have a monitor go on from a state; returns how many samples were taken meanwhile."""
        unit = evaluators.unit
        words = iter(array("q", state))
        taken, _, unit.position, unit.before = (next(words) for _ in range(4))
        after, reached, last, _ = (next(words) for _ in range(4))
        limit = 2 * reached + (after == reached)
        v, since, until = unit.v, unit.since, unit.until
        for place in self._places:
            truth = next(words)
            if unit.KEPT >> place & 1:
                v[place] = truth
            since[place] = next(words)
            until[3 * place : 3 * place + 3] = [_unless_not_yet(next(words)) for _ in range(3)]
        for _ in range(group_count(self._plan)):
            next(words)
        self._set_timers(unit, [instant(next(words)) for _ in self._timed])
        self._take_values(unit, words)
        self._take_memories(unit, words)
        awaited = self._take_awaited(unit, words, last) if self._is_clocked else NEVER
        for place, state_ in self._rest:
            self._see(unit, place, state_)
        unit.fading = sum(
            1 << place for place in self._places if v[place] and unit.momentary >> place & 1
        )
        for index, rule in enumerate(unit.rules[: len(self._plan.rules)]):
            evaluators.number_from(index, take_rule(rule, words, reached, limit))
        unit.resume()
        unit.awaited = awaited
        unit.set_alarm()
        return taken

    def _set_timers(self, unit: Unit, wakes: Sequence[int]) -> None:
        count = len(unit.wakes)
        unit.wakes[:] = unit.queued[:] = [NEVER] * count
        unit.timers.clear()
        for place, wake in zip(self._timed, wakes, strict=True):
            if wake < NEVER:
                unit.set_wake(place, wake)

    def _take_values(self, unit: Unit, words: Iterator[int]) -> None:
        for signal, name in enumerate(self._plan.signals):
            value = self._value(name, next(words))
            _, stale_at = next(words), instant(next(words))
            if stale_at < NEVER:
                unit.set_stale(signal, stale_at)
            updates, at, before_at = (next(words) for _ in range(3))
            last, before = (self._value(name, next(words)) for _ in range(2))
            if signal in self._read:
                unit.s[signal] = value
                setattr(unit, f"last{signal}", value)
            history = unit.h[signal]
            if history is not None:
                history.updates, history.at, history.before_at = updates, at, before_at
                history.last, history.before = last, before

    def _value(self, name: str, bits: int) -> Any:
        (number,) = struct.unpack("=d", struct.pack("=q", bits))
        if number != number:
            return None
        match self._plan.spec.signals[name].type.kind:
            case Kind.BOOL:
                return bool(number)
            case Kind.INT:
                return int(number)
            case Kind.LABEL:
                return self._texts[int(number)]
            case _:
                return number

    def _take_memories(self, unit: Unit, words: Iterator[int]) -> None:
        for place, state in self._remembering(Memory.SEEN):
            seen = next(words)
            if state.op is not StateOp.SINCE:
                unit.w[place] = unit.b[place] = seen
        for place, state in self._remembering(Memory.EDGE):
            at, left, right = (next(words) for _ in range(3))
            ends = state.high is not None
            unit.w[place] = unit.b[place] = _from_edge(at, left, right, ends=ends)
        for place, _ in self._remembering(Memory.PAST):
            one = unit.marked[place]
            one.left, one.right, one.growing = (bool(next(words)) for _ in range(3))
            one.runs.clear()
            for _ in range(next(words)):
                one.runs.append([instant(next(words)), instant(next(words))])

    def _see(self, unit: Unit, place: int, state: State) -> None:
        """Give a node that says what is not known its value: all was."""
        if state.op is StateOp.DOUBT:
            (operand,) = self._operands[place]
            unit.w[place] = unit.b[place] = unit.v[operand]
        elif state.leaf is not None or state.op in COMBINING:
            function: Any = unit.EVALUATE[place]
            unit.v[place] = function(unit, unit.position)


def _edge(memory: Any, *, ends: bool) -> tuple[int, int, int]:
    """The instant, and the operands as they were; see `step_edge` of the C library."""
    if ends:
        return (NOT_YET, 1, 1) if memory is None else (memory, 1, 0)
    if memory is True:
        return C_NEVER, 0, 1
    return (C_NEVER if memory is None else memory), 1, 0


def _from_edge(at: int, left: int, right: int, *, ends: bool) -> Any:
    if ends:
        return None if right else at if left else -NEVER
    if not left:
        return True if right else None
    return None if at == C_NEVER else at


def _combined(op: StateOp, truths: Sequence[int]) -> int:
    match op:
        case StateOp.NOT:
            return 2 - truths[0]
        case StateOp.SURE:
            return TRUE if truths[0] == TRUE else FALSE
        case StateOp.AND:
            return min(truths)
        case _:
            return max(truths)


def _or_not_yet(instant: int | None) -> int:
    return NOT_YET if instant is None else instant


def _unless_not_yet(word: int) -> int | None:
    return None if word == NOT_YET else word

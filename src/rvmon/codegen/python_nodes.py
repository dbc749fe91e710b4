"""State formulas as Python statements over the arrays of a generated monitor."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from rvmon.codegen.python_leaves import leaf_expression
from rvmon.formula.state import COMBINING, Elapsed, State, StateOp
from rvmon.plan.plan import Plan
from rvmon.runtime.values import NEVER
from rvmon.spec.checked.formula import Constant

BEFORE = "self.before"
"""What statements call the position before."""

_WATCHED = 4
"""So few nodes that change by time alone are looked at one by one; more stand in a queue."""

_DEEPEST = 12
"""So many operators at most stand in one expression."""


_TRUTHS = ("0", "2")

_DENIED = {"0": "2", "2": "0"}


@dataclass(frozen=True, slots=True)
class Roles:
    """What the nodes of a plan are for.

    Attributes:
        letters: per node, a bit for each requirement whose letter it is part of.
        triggers: per node, a bit for each requirement that it triggers, and behind these one for
            each whose episodes may go on with it after a failure.
        kept: a bit for each node that has a value of its own; the others are parts of one other.
        parents: per node, a bit for each kept node whose value depends on it directly.
    """

    letters: tuple[int, ...]
    triggers: tuple[int, ...]
    kept: int
    parents: tuple[int, ...]


def bits(places: tuple[int, ...]) -> int:
    """A set of places as a number."""
    return sum(1 << place for place in places)


def roles_alike(plan: Plan) -> Roles:
    """All nodes have a value of their own; whom they concern is decided elsewhere."""
    graph = plan.graph
    none = tuple(0 for _ in graph.nodes)
    return Roles(none, none, (1 << len(graph.nodes)) - 1, tuple(map(bits, graph.parents)))


def roles_of(plan: Plan, last: Mapping[int, int], before: Roles | None = None) -> Roles:
    """See which nodes are read by requirements, and which need no value of their own.

    Args:
        plan: has the nodes.
        last: the values that nodes keep for ever: what then is needed by nobody has none, either.
        before: what they were for until they kept these: no other has a value by then.
    """
    graph = plan.graph
    letters = [0 for _ in graph.nodes]
    triggers = [0 for _ in graph.nodes]
    asked = 0
    judged = plan.judged
    for index, rule in enumerate(judged):
        for state in rule.alphabet.propositions:
            letters[graph.index[state]] |= 1 << index
        if rule.trigger is not None:
            triggers[graph.index[rule.trigger]] |= 1 << index
        if rule.again is not None:
            triggers[graph.index[rule.again]] |= 1 << index + len(judged)
        for named in (rule.unborn, rule.determined, *rule.asked):
            asked |= 0 if named is None else 1 << graph.index[named]
    wanted = [letters[n] or triggers[n] or asked >> n & 1 for n in range(len(graph.nodes))]
    operands = [
        () if place in last else tuple(one for one in graph.operands[place] if one not in last)
        for place in range(len(graph.nodes))
    ]
    above = _above(graph.nodes, operands, wanted)
    kept = 0
    depths = [0 for _ in graph.nodes]
    for place, state in enumerate(graph.nodes):
        if place in last or not (wanted[place] or above[place] or state.leaf):
            continue
        depth = 1 + max((depths[operand] for operand in operands[place]), default=0)
        # A denial costs less than to keep it.
        is_cheap = state.op is StateOp.NOT and depth == 1
        is_part = state.op in COMBINING and (is_cheap or len(above[place]) == 1)
        is_part = is_part and not wanted[place] and depth < _DEEPEST
        if before is not None:
            is_part = not before.kept >> place & 1
        if is_part:
            depths[place] = depth
        else:
            kept |= 1 << place
    parents = [0 for _ in graph.nodes]
    for place in reversed(range(len(graph.nodes))):
        for parent in above[place]:
            parents[place] |= 1 << parent if kept >> parent & 1 else parents[parent]
    return Roles(tuple(letters), tuple(triggers), kept, tuple(parents))


def _above(
    nodes: Sequence[State], operands: Sequence[tuple[int, ...]], wanted: Sequence[int]
) -> list[list[int]]:
    """Per node those that it is an operand of, but for such as nobody needs."""
    found: list[list[int]] = [[] for _ in nodes]
    for place in reversed(range(len(nodes))):
        if wanted[place] or found[place]:
            for operand in dict.fromkeys(operands[place]):
                found[operand].append(place)
    return found


def value_before(state: State) -> int:
    """The value of a node before the first position: unknown, but for what looks at it there."""
    return 0 if _is_latch(state) else 1


def memory_before(state: State) -> int | None:
    """What a node remembers before the first position."""
    if state.op is not StateOp.SINCE:
        return 0
    return None if state.high is None else -NEVER


def keeps_stretches(state: State) -> bool:
    """Whether a node needs all the stretches of time in which it holds."""
    return state.op is StateOp.SINCE and state.low > 0 and state.high is not None


def sparse_nodes(plan: Plan) -> int:
    """The nodes that have to see every sample where samples are far apart, a bit for each."""
    nodes = enumerate(plan.graph.nodes)
    return 0 if plan.gap is not None else bits(tuple(n for n, s in nodes if keeps_stretches(s)))


def sparse_span(plan: Plan) -> int:
    """So far apart samples can be without leaving a hole in a stretch of time."""
    lasting = filter(keeps_stretches, plan.graph.nodes)
    return min(((state.high or 0) - state.low + 1 for state in lasting), default=NEVER)


def _is_latch(state: State) -> bool:
    return state.op is StateOp.SINCE and state.low == 0 and state.high is None


def timed_nodes(plan: Plan, roles: Roles) -> tuple[int, ...]:
    """The nodes with a value of their own that can change by time alone."""
    return tuple(
        place
        for place, state in enumerate(plan.graph.nodes)
        if roles.kept >> place & 1 and is_timed(state)
    )


def is_timed(state: State) -> bool:
    """Whether a node can change by time alone."""
    if state.op is StateOp.SINCE:
        return not _is_latch(state)
    return state.op in (StateOp.PREVIOUS, StateOp.DOUBT) or isinstance(state.leaf, Elapsed)


def is_queued(plan: Plan, roles: Roles) -> bool:
    """Whether the nodes that change by time alone are too many to look at each."""
    stale = any(signal.stale_after is not None for signal in plan.spec.signals.values())
    return stale or len(timed_nodes(plan, roles)) > _WATCHED


class NodeWriter:
    """Writes what gives the nodes of a plan their values.

    Args:
        plan: has the nodes.
        roles: of the nodes.
        last: the values that nodes are taken to keep, by place.
        queued: whether the nodes that change by time alone stand in a queue.

    Attributes:
        kept: the nodes that have a value of their own.
        used: the nodes of which it was made use that they keep their value.
    """

    def __init__(self, plan: Plan, roles: Roles, last: Mapping[int, int], *, queued: bool) -> None:
        self.plan = plan
        self.roles = roles
        self.last = last
        self.kept = [place for place in range(len(plan.graph.nodes)) if roles.kept >> place & 1]
        self.used: set[int] = set()
        self.watched = None if queued else timed_nodes(plan, roles)
        """The nodes that change by time alone, if each is looked at; `None`: they are queued."""
        self.settled: dict[int, str] = {}
        """The values that are known as something is written."""
        self.before = BEFORE
        """The position before, as an expression."""

    def statements(self, place: int) -> Iterator[str]:
        """Put the value of a node at `t` into `n`, in a method of the monitor."""
        state = self.plan.graph.nodes[place]
        made = self.expression(place)
        if made is not None:
            yield f"n = {made}"
            return
        match state.op:
            case StateOp.DOUBT:
                (operand,) = self.plan.graph.operands[place]
                yield f"m = {self.value(operand)}"
                found = f"self.doubt_({place}, t, m, {state.pulse}, {state.every})"
                if state.every:
                    yield f"n = {found}"
                else:
                    yield f"if m != 1 and self.w[{place}] != 1 and not self.v[{place}]:"
                    yield "    n = 0"
                    yield "else:"
                    yield f"    n = {found}"
                yield f"self.w[{place}] = m"
            case StateOp.PREVIOUS:
                (operand,) = self.plan.graph.operands[place]
                yield f"n = self.w[{place}]"
                yield f"m = self.w[{place}] = {self.value(operand)}"
                yield "if m != n:"
                yield from self._wake(place, f"t + {self.plan.gap or 1}", "    ")
                yield "else:"
                yield f"    self.wakes[{place}] = {NEVER}"
            case _:
                yield from self._since(place, state)

    def pending(self, place: int) -> str:
        """The condition under which a node may change at all; empty if there is none."""
        lasts = _is_latch(self.plan.graph.nodes[place])
        lasts = lasts and self.value(self.plan.graph.operands[place][0]) == "2"
        return f"self.v[{place}] != 2" if lasts else ""

    def value(self, place: int) -> str:
        """A node as an operand."""
        if place in self.last:
            self.used.add(place)
            return str(self.last[place])
        if place in self.settled:
            return self.settled[place]
        state = self.plan.graph.nodes[place]
        if isinstance(state.leaf, Constant):
            return leaf_expression(self.plan, place, state.leaf)
        if self.roles.kept >> place & 1:
            return f"self.v[{place}]"
        made = self.formula(place)
        return made if made in _TRUTHS else f"({made})"

    def settling(self, place: int, value: str) -> bool:
        """Take it that a node has this value, where that settles it; returns whether it does."""
        if value in _TRUTHS:
            self.settled[place] = value
        return value in _TRUTHS

    def expression(self, place: int) -> str | None:
        """The value of a node as an expression; `None` if it takes statements."""
        state = self.plan.graph.nodes[place]
        if _is_latch(state):
            left, right = (self.value(operand) for operand in self.plan.graph.operands[place])
            return right if right == "2" or left == "0" else None
        is_plain = state.leaf is not None or state.op in COMBINING
        return self.formula(place) if is_plain else None

    def formula(self, place: int) -> str:
        """The value of a node that combines others, or reads the input, as an expression."""
        state = self.plan.graph.nodes[place]
        if state.leaf is not None:
            return leaf_expression(self.plan, place, state.leaf)
        operands = [self.value(operand) for operand in self.plan.graph.operands[place]]
        if state.op is StateOp.SURE:
            return operands[0] if operands[0] in _TRUTHS else f"2 if {operands[0]} == 2 else 0"
        if state.op is StateOp.NOT:
            return _DENIED.get(operands[0], f"2 - {operands[0]}")
        sign, decisive = ("<", "0") if state.op is StateOp.AND else (">", "2")
        if decisive in operands:
            return decisive
        open_ones = [operand for operand in operands if operand not in _TRUTHS]
        made = open_ones[0] if open_ones else _DENIED[decisive]
        for number, operand in enumerate(open_ones[1:]):
            first, second = f"a{place}_{number}", f"b{place}_{number}"
            made = f"({first} if ({first} := {made}) {sign} ({second} := {operand}) else {second})"
        return made

    def _since(self, place: int, state: State) -> Iterator[str]:
        operands = self.plan.graph.operands[place]
        left, right = (self.value(operand) for operand in operands)
        low, high = state.low, state.high
        if _is_latch(state):
            yield from self._latched(place, left, right)
            return
        given = []
        for name, own in (("l", left), ("r", right)):
            given.append(own if own in _TRUTHS else name)
            if own not in _TRUTHS:
                yield f"{name} = {own}"
        operands_now = ", ".join(given)
        if keeps_stretches(state):
            yield f"n, e = self.marked[{place}].step(t, {self.before}, {operands_now})"
            yield from self._wake(place, "e", "")
            return
        yield f"e = self.w[{place}]"
        unknown = [f"{name} == 1" for name in given if name not in _TRUTHS]
        # Both readings are the same object while they are equal: that is the cheaper question.
        yield f"if {' or '.join([*unknown, f'self.b[{place}] is not e'])}:"
        slow = "beyond_" if high is None else "within_"
        bound = low if high is None else high
        yield f"    n = self.{slow}({place}, t, {self.before}, {operands_now}, {bound})"
        if high is None:
            yield from self._beyond(place, low, left, right)
        else:
            yield from self._within(place, high, left, right)

    def _latched(self, place: int, left: str, right: str) -> Iterator[str]:
        """The greater of the right operand, and the lesser of the left one and the value before."""
        yield f"n = self.v[{place}]"
        for operand, sign, idle in ((left, "<", "2"), (right, ">", "0")):
            if operand != idle:
                yield f"m = {operand}"
                yield f"if m {sign} n:"
                yield "    n = m"

    def _within(self, place: int, high: int, left: str, right: str) -> Iterator[str]:
        """As `rvmon.runtime.past.within`, both readings at once."""
        if right != "0":
            yield "elif r:" if right != "2" else "else:"
            yield f"    self.w[{place}] = self.b[{place}] = None"
            yield f"    self.wakes[{place}] = {NEVER}"
            yield "    n = 2"
        if right == "2":
            return
        if left != "2":
            yield "elif not l:" if left != "0" else "else:"
            yield f"    self.w[{place}] = self.b[{place}] = -{NEVER}"
            yield f"    self.wakes[{place}] = {NEVER}"
            yield "    n = 0"
        if left == "0":
            return
        yield "else:"
        yield "    if e is None:"
        yield f"        e = self.w[{place}] = self.b[{place}] = {self.before} + {high}"
        yield "    n = 0"
        yield "    if e >= t:"
        yield "        n = 2"
        yield from self._wake(place, "e + 1", "        ")

    def _beyond(self, place: int, low: int, left: str, right: str) -> Iterator[str]:
        """As `rvmon.runtime.past.beyond`, both readings at once."""
        if left != "2":
            yield "elif not l:" if left != "0" else "else:"
            ended = {"0": "None", "2": "True"}.get(right, "True if r else None")
            yield f"    self.w[{place}] = self.b[{place}] = {ended}"
            yield f"    self.wakes[{place}] = {NEVER}"
            yield "    n = 0"
        if left == "0":
            return
        yield "else:"
        yield "    n = 0"
        yield "    if e is True:"
        yield f"        e = self.w[{place}] = self.b[{place}] = {self.before} + {low}"
        yield "        if e <= t:"
        yield "            n = 2"
        yield "        else:"
        yield from self._wake(place, "e", "            ")
        if right != "0":
            yield "    elif e is None:"
            inner = "        "
            if right != "2":
                yield "        if r:"
                inner += "    "
            yield f"{inner}e = self.w[{place}] = self.b[{place}] = t + {low}"
            yield from self._wake(place, "e", inner)
        # Else time wakes it at `e` already.
        yield f"    elif {'' if right != '0' else 'e is not None and '}e <= t:"
        yield "        n = 2"

    def _wake(self, place: int, instant: str, indent: str) -> Iterator[str]:
        if self.watched is not None:
            yield f"{indent}self.wakes[{place}] = {instant}"
            return
        yield f"{indent}m = {instant}"
        yield f"{indent}self.wakes[{place}] = m"
        yield f"{indent}if m < self.queued[{place}]:"
        yield f"{indent}    self.queued[{place}] = m"
        yield f"{indent}    heappush(self.timers, (m, {place}))"

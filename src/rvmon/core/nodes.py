"""Packs state formulas as nodes: operators, memory slots, timers, and when they are needed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from enum import IntEnum, auto

from msgspec import Struct

from rvmon.core.atoms import Atoms, Names
from rvmon.core.obligations import is_followed
from rvmon.language.checked.formula import (
    Amount,
    Captured,
    Compare,
    Constant,
    Measured,
    Passed,
    SignalAtom,
)
from rvmon.language.checked.formula import Literal as Number
from rvmon.logic.formula import Literal, literals
from rvmon.logic.network_plan import plan_of
from rvmon.logic.plan import Plan, PlannedRule
from rvmon.logic.state_formula import (
    FALSE,
    TRUE,
    UNKNOWN,
    Elapsed,
    Lapsed,
    Lost,
    State,
    StateOp,
    Unborn,
    signals_of,
)
from rvmon.logic.state_graph import lasting, start_capture

NEVER = (1 << 63) - 1  # no instant, or no bound


class NodeOp(IntEnum):
    """Kinds of nodes."""

    LEAF = 0
    CONSTANT = auto()
    UNBORN = auto()
    LAPSED = auto()
    ELAPSED = auto()
    NOT = auto()
    AND = auto()
    OR = auto()
    SURE = auto()
    DOUBT = auto()
    PREVIOUS = auto()
    EVER = auto()
    EDGE = auto()
    STRETCH = auto()
    WINDOW = auto()
    PASSED = auto()
    COMPARED = auto()


SEEN = (NodeOp.PREVIOUS, NodeOp.DOUBT, NodeOp.EVER)  # the nodes that remember a truth value
STRETCHED = (NodeOp.STRETCH, NodeOp.WINDOW)  # the nodes that remember stretches of time

TIMED = (
    *(NodeOp.ELAPSED, NodeOp.PREVIOUS, NodeOp.DOUBT, NodeOp.EDGE),
    *(*STRETCHED, NodeOp.PASSED),
)
"""The nodes that time alone can change."""

_FOLDS = {measured: number for number, measured in enumerate(Measured)}
"""The fold over the members of a window, by its number in plan.h."""
_TALLIED = (Measured.SUM, Measured.MEAN, Measured.INTEGRAL, Measured.VARIANCE)
_STRICT, _COUNTED, _NUMBER = 16, 32, 64


class Node(Struct):
    """A state formula; see `node_plan` in plan.h."""

    op: NodeOp  # its kind
    a: int = 0
    b: int = 0
    low: int = 0
    high: int = 0
    # indices of nodes; for leaves and births, 2 × signal, plus 1 if an update after the first value
    # is required
    operands: Sequence[int] = ()
    slot: int = -1  # index of its memory among nodes with the same kind of memory; −1 if none
    timer: int = -1  # index of its timer; −1 if time alone cannot change it
    # of a window that adds numbers, the index of its exact sum; −1 of any other window
    tally: int = 0
    most: int = 0  # of a window over the last n updates, n; 0 for any number
    chosen: int = 0  # of a window, the first operand that is evaluated per occurrence
    since: int = -1  # of a window, the index of the captured instant at which it begins; −1 if none
    reads: tuple[int, ...] = ()  # the atoms whose numbers, not only truth values, it reads


class Nodes:
    """The nodes of a part.

    Args:
        plan: the plan of the part.
        names: the names of the part.
        atoms: the atoms of the part; those of leaves are added.

    Attributes:
        all: the nodes, operands first.
        seen: the number of nodes that remember a truth value.
        edges: the number that remember an instant.
        stretches: the number that remember stretches of time.
        tallies: the number of windows that add numbers.
        timers: the number that time alone can change.
        needed: places of the nodes needed once all signals are born and triggers determined.
    """

    def __init__(self, plan: Plan, names: Names, atoms: Atoms) -> None:
        self._names = names
        self._atoms = atoms
        self.graph = plan.graph
        self.all = [
            self._node(state, operands)
            for state, operands in zip(plan.graph.nodes, plan.graph.operands, strict=True)
        ]
        self.seen = self._numbered(SEEN, "slot")
        self.edges = self._numbered([NodeOp.EDGE], "slot")
        self.stretches = self._numbered(STRETCHED, "slot")
        # Until here `tally` marks the windows that add numbers (0) and the others (−1).
        self.tallies = self._numbered([NodeOp.WINDOW], "tally", but=-1)
        self.timers = self._numbered(TIMED, "timer")
        self.needed = _needed(plan)

    def _numbered(self, kinds: Sequence[NodeOp], index: str, but: int | None = None) -> int:
        """Number the nodes of some kinds, except those whose index is `but`; returns how many."""
        count = 0
        for node in self.all:
            if node.op in kinds and getattr(node, index) != but:
                setattr(node, index, count)
                count += 1
        return count

    def leaves(self, live: bool) -> list[list[int]]:
        """Per atom, the places of the nodes that read its truth value or its number.

        Args:
            live: only the nodes needed once signals are born and triggers determined.
        """
        found: list[list[int]] = [[] for _ in self._atoms.all]
        for place, node in enumerate(self.all):
            # Tracking births and undetermined triggers costs time at each row, but most streams are
            # soon past them. From then on the core follows the second set of lists, which leaves
            # out the nodes that serve only this tracking.
            if not live or place in self.needed:
                for atom in (node.a,) if node.op is NodeOp.LEAF else node.reads:
                    found[atom].append(place)
        return found

    @property
    def read_as_numbers(self) -> frozenset[int]:
        """The atoms whose numbers, not only truth values, are read."""
        return frozenset(atom for node in self.all for atom in node.reads)

    def parents(self, place: int) -> tuple[Sequence[int], Sequence[int]]:
        """The parents of a node: at first, and once signals are born and triggers determined."""
        found = self.graph.parents[place]
        if place not in self.needed:
            return found, ()
        return found, [parent for parent in found if parent in self.needed]

    def born_with(self) -> Iterator[tuple[int, int, bool]]:
        """The nodes that a birth changes: place, signal, whether a further update is needed."""
        for place, node in enumerate(self.all):
            if node.op in (NodeOp.LEAF, NodeOp.UNBORN):
                for operand in node.operands:
                    yield place, operand // 2, operand % 2 == 1

    def stateful(self) -> list[int]:
        """In sampled time, the nodes to be evaluated at every sample."""
        lasting = (NodeOp.DOUBT, NodeOp.EVER, NodeOp.ELAPSED)  # `ELAPSED` has a timer
        return [place for place in self.graph.stateful if self.all[place].op not in lasting]

    def _births(self, signals: Iterable[tuple[str, bool]]) -> list[int]:
        return [2 * self._names.signals[name] + moved for name, moved in signals]

    def _node(self, state: State, operands: Sequence[int]) -> Node:
        match state.op:
            case StateOp.LEAF:
                return self._leaf(state)
            case StateOp.DOUBT:
                return Node(NodeOp.DOUBT, state.pulse, state.every, operands=operands)
            case StateOp.SINCE:
                high = NEVER if state.high is None else state.high
                return Node(_since(state), low=state.low, high=high, operands=operands)
            case StateOp.AMOUNT:
                return self._window(state, operands)
            case StateOp.COMPARED if state.compared is not None:
                atom = self._atoms.comparison(state.compared)
                return Node(NodeOp.COMPARED, atom, operands=operands, reads=(atom,))
            case StateOp.PASSED if state.passed is not None:
                return self._passed(state.passed, operands)
            case _:
                return Node(NodeOp[state.op.name], operands=operands)

    def _window(self, state: State, operands: Sequence[int]) -> Node:
        amount = state.amount
        if amount is None:
            raise AssertionError("an AMOUNT state has an amount")
        of = amount.of if isinstance(amount, Amount) else amount
        reads = [] if of.value is None else [self._atoms.itself(of.value)]
        if isinstance(amount, Amount):
            limit = self._atoms.itself(amount.limit)
            place, marks = self._atoms.all[limit].left, _STRICT * amount.strict
            value, reads = (reads or [-1])[0], [*reads, limit]
        else:
            value, place, marks = (reads or [-1])[0], self._names.windows[amount], _NUMBER
        marks += _COUNTED * (of.value is None and of.counted is not None)
        return Node(
            NodeOp.WINDOW,
            value,
            _FOLDS[of.measured] + marks,
            place,
            NEVER if of.window is None else of.window,
            operands,
            tally=0 if of.measured in _TALLIED else -1,
            most=of.most or 0,
            chosen=len(operands) - len(of.chosen),
            since=self._names.captured.get(start_capture(state) or "", -1),
            reads=tuple(reads),
        )

    def _passed(self, passed: Passed, operands: Sequence[int]) -> Node:
        after = self._atoms.itself(passed.after)
        since = self._atoms.itself(Captured(passed.since) if passed.since else Number(0))
        place = self._atoms.all[since].left
        return Node(
            NodeOp.PASSED, after, passed.strict, place, operands=operands, reads=(after, since)
        )

    def _leaf(self, state: State) -> Node:
        leaf = state.leaf
        match leaf:
            case None:
                raise ValueError("a LEAF state has a leaf")
            case Constant(value=value):
                return Node(NodeOp.CONSTANT, TRUE if value else FALSE)
            case Lost():
                return Node(NodeOp.CONSTANT, UNKNOWN)
            case Lapsed():
                return Node(NodeOp.LAPSED)
            case Elapsed(duration=duration):
                return Node(NodeOp.ELAPSED, low=duration)
            case Unborn(signals=signals):
                return Node(NodeOp.UNBORN, operands=self._births(signals))
            case SignalAtom() | Compare() if state.unborn != UNKNOWN:
                births = self._births(signals_of(leaf).items())
                unborn = state.unborn if births else UNKNOWN
                return Node(NodeOp.LEAF, self._atoms.number(leaf), unborn, operands=births)
            case _:
                return Node(NodeOp.LEAF, self._atoms.number(leaf), UNKNOWN)


def _since(state: State) -> NodeOp:
    """The kind of a `since` node, by what it has to remember."""
    # Without a lower bound, the last instant at which both sides allowed it decides. With both
    # bounds, several stretches may still come to lie in the window, so all of them are kept.
    if state.low == 0:
        return NodeOp.EVER if state.high is None else NodeOp.EDGE
    return NodeOp.EDGE if state.high is None else NodeOp.STRETCH


def _needed(plan: Plan) -> frozenset[int]:
    """The nodes needed once every signal is born and every trigger was TRUE or FALSE."""
    states = [state for _, rule in plan.judges for state in _needed_states(rule, plan)]
    states += (literal.proposition for core in plan.truths for literal in literals(core))
    states += (watch.state for watch in plan.watches)
    determined = {rule.determined for rule in plan.rules if rule.determined is not None}
    return lasting(plan.graph, states, determined)


def _needed_states(rule: PlannedRule, plan: Plan) -> Iterator[State]:
    """The state formulas of a rule that are needed beyond birth and `determined`."""
    named = (rule.trigger, rule.again, rule.unborn, rule.running, rule.blurs)
    yield from (state for state in named if state is not None)
    yield from rule.alphabet.propositions
    yield from rule.noted
    yield from rule.captures_known
    # Robustness reads nodes of its own, which no verdict needs.
    leaves = () if rule.measured is None else plan_of(rule.measured, plan.gap).leaves
    for _, core in leaves:
        if isinstance(core, Literal) and is_followed(core, plan.spec, rule.requirement):
            yield core.proposition

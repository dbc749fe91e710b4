"""Decides timed CTL on the region graph of a small network, by plain fixpoints.

The set of regions in which a formula holds is computed from the inside out. Bounds are checked on
a second graph, whose regions have an additional timer that starts at 0.

Source: Alur, Courcoubetis, Dill, Model-Checking in Dense Real-Time, 1993, section 4.
"""

import networkx as nx
from tests.tools.timed_regions import Region, RegionGraph, Steps, truth_of

from rvmon.models.network import LeadsToFormula, Network, Query, ValueQuery
from rvmon.models.network.expressions import (
    BinaryOp,
    BinaryOperation,
    Deadlock,
    Expression,
    PathFormula,
    PathOp,
    UnaryOp,
    UnaryOperation,
)
from rvmon.models.network.guards import is_plain, parts_of

Regions = frozenset[Region]


def holds_at_start(
    network: Network, query: Query, limit: int = 2_000, steps: Steps | None = None
) -> bool:
    """Whether a query holds initially, with any operators of CTL."""
    formula = query.formula
    assert not isinstance(formula, ValueQuery)
    if isinstance(formula, LeadsToFormula):
        answered = PathFormula(PathOp.EVENTUALLY, formula.right, formula.bound)
        implied = BinaryOperation(BinaryOp.IMPLY, formula.left, answered)
        formula = PathFormula(PathOp.INVARIANTLY, implied)
    truth = _Truth(network, formula, limit, steps)
    return truth.start in truth.where(formula)


class _Truth:
    """Computes the regions in which formulas hold."""

    def __init__(
        self, network: Network, formula: Expression, limit: int, steps: Steps | None
    ) -> None:
        bounds = [p.bound for p in parts_of(formula) if isinstance(p, PathFormula)]
        known = [bound for bound in bounds if bound is not None]
        self._regions = RegionGraph(network, [formula], None, limit, steps)
        self.start = self._regions.start()
        self._plain = _Steps(self._regions, self._regions.reachable([self.start]))
        if known:
            timed = RegionGraph(network, [formula], max(known), 4 * limit, steps)
            # If only the outermost operator has a bound, the timer starts only at the start.
            is_outermost = isinstance(formula, PathFormula) and formula.bound and len(known) == 1
            starts = [self.start] if is_outermost else self._plain.nodes
            self._timed = _Steps(timed, timed.reachable(map(timed.restarted, starts)))
            self._restart = timed.restarted

    def where(self, formula: Expression) -> Regions:
        """The regions where a formula holds."""
        everywhere = self._plain.nodes
        if is_plain(formula):
            holds = truth_of(formula)
            return frozenset(r for r in everywhere if holds(r.now))
        match formula:
            case Deadlock():
                return frozenset(filter(self._regions.is_dead, everywhere))
            case UnaryOperation(UnaryOp.NOT, operand):
                return everywhere - self.where(operand)
            case BinaryOperation(BinaryOp.AND, left, right):
                return self.where(left) & self.where(right)
            case BinaryOperation(BinaryOp.OR, left, right):
                return self.where(left) | self.where(right)
            case BinaryOperation(BinaryOp.IMPLY, left, right):
                return (everywhere - self.where(left)) | self.where(right)
            case PathFormula(op, body, bound, left):
                return self._path(op, self.where(body), bound, self.where(left))
            case _:
                raise AssertionError(f"{formula} is not decided here")

    def _path(self, op: PathOp, body: Regions, bound: int | None, left: Regions) -> Regions:
        everywhere = self._plain.nodes
        match op:
            case PathOp.POSSIBLY:
                return self._until(body, bound, left, every=False)
            case PathOp.EVENTUALLY:
                return self._until(body, bound, left, every=True)
            case PathOp.INVARIANTLY:
                return everywhere - self._until(everywhere - body, bound, left, every=False)
            case PathOp.POTENTIALLY_ALWAYS:
                return everywhere - self._until(everywhere - body, bound, left, every=True)
            case PathOp.SOME_NEXT:
                return self._plain.before_actions(body)
            case PathOp.EVERY_NEXT:
                return everywhere - self._plain.before_actions(everywhere - body)
            case _:
                raise AssertionError(f"{op} speaks of one run")

    def _until(self, body: Regions, bound: int | None, left: Regions, *, every: bool) -> Regions:
        if bound is None:
            return self._plain.until(body, left, every=every)
        lifted = {r: self._regions.region_of(r.now) for r in self._timed.nodes}
        reached = frozenset(r for r, low in lifted.items() if low in body and r.timer <= bound)
        before = frozenset(r for r, low in lifted.items() if low in left or low in body)
        found = self._timed.until(reached, before, every=every)
        return frozenset(r for r in self._plain.nodes if self._restart(r) in found)


class _Steps:
    """Regions and the actions and delays between them."""

    def __init__(self, graph: RegionGraph, nodes: set[Region]) -> None:
        self.nodes = frozenset(nodes)
        self._actions = nx.DiGraph()
        self._delays = nx.DiGraph()
        for node in nodes:
            self._actions.add_edges_from((node, after) for after in graph.actions(node))
            later = graph.later(node)
            if later is not None:
                self._delays.add_edge(node, later)
        self._all = nx.compose(self._actions, self._delays)
        self._all.add_nodes_from(nodes)

    def until(self, body: Regions, left: Regions, *, every: bool) -> Regions:
        """The regions from which some path, or every one, stays in `left` until it is in `body`."""
        found, pending = set(body), list(body)
        while pending:
            for node in self._all.predecessors(pending.pop()):
                if node in found or node not in left:
                    continue
                if every and not all(after in found for after in self._all.successors(node)):
                    continue
                found.add(node)
                pending.append(node)
        return frozenset(found)

    def before_actions(self, body: Regions) -> Regions:
        """The regions from which the next action, perhaps after a delay, can lead to `body`."""
        found = {a for a, b in self._actions.edges if b in body}
        for node in list(found):
            if node in self._delays:
                found |= nx.ancestors(self._delays, node)
        return frozenset(found)

"""LTL formulas on the regions of a small network, by an explicit tableau.

A node is a region with the set of temporal formulas that must hold from there. An edge must respect
what these formulas require now and next. A component is accepting if no promise waits in all of it.

Source: Clarke, Grumberg, Hamaguchi, Another Look at LTL Model Checking, 1997.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import product

import networkx as nx
from tests.tools.timed_regions import JOINED, Region, RegionGraph, TooManyRegionsError, truth_of

from rvmon.models.network import Network
from rvmon.models.network import expressions as ex
from rvmon.models.network.guards import is_linear, parts_of
from rvmon.models.runs import Run
from rvmon.models.runs.exact_times import Rules, initial_configuration

_Node = tuple[Region, frozenset[ex.PathFormula]]


class LinearTruth:
    """Whether some run from the start satisfies a formula.

    Args:
        network: a small network.
        formula: an LTL formula.
        progress: whether only runs count on which time grows without bound.
        limit: the maximum number of nodes.

    Raises:
        TooManyRegionsError: there are more nodes.
    """

    def __init__(
        self, network: Network, formula: ex.Expression, progress: bool, limit: int
    ) -> None:
        self._regions = RegionGraph(network, [formula], 1 if progress else None, limit)
        self._formula, self._progress, self._limit = formula, progress, limit
        temporal = [p for p in parts_of(formula) if isinstance(p, ex.PathFormula)]
        plain = [p for p in parts_of(formula) if not is_linear(p)]
        self._plain = {id(part): truth_of(part) for part in plain}
        self._temporal = list(dict.fromkeys(temporal))
        sets = product((False, True), repeat=len(self._temporal))
        self._sets = [
            frozenset(p for p, on in zip(self._temporal, chosen, strict=True) if on)
            for chosen in sets
        ]

    def some_run(self) -> bool:
        """Whether some run satisfies the formula."""
        start = self._regions.start()
        starts = [(start, held) for held in self._sets if self._holds(self._formula, (start, held))]
        graph = self._graph(starts)
        for component in nx.strongly_connected_components(graph):
            inner = graph.subgraph(component)
            if (
                inner.number_of_edges()
                and (not self._progress or any(tick for *_, tick in inner.edges.data("tick")))
                and all(any(self._is_kept(p, node) for node in component) for p in self._temporal)
            ):
                return True
        return False

    def _is_kept(self, promise: ex.PathFormula, node: _Node) -> bool:
        # A node in which `G p` does not hold promises that p will fail.
        final = promise.op is ex.PathOp.FINALLY
        waits = (promise in node[1]) == final
        return not waits or self._holds(promise.body, node) == final

    def _holds(self, formula: ex.Expression, node: _Node) -> bool:
        region, held = node
        if not is_linear(formula):
            return self._plain[id(formula)](region.now)
        match formula:
            case ex.PathFormula():
                return formula in held
            case ex.UnaryOperation(ex.UnaryOp.NOT, operand):
                return not self._holds(operand, node)
            case ex.BinaryOperation(op, left, right):
                return JOINED[op](self._holds(left, node), self._holds(right, node))
            case _:
                raise AssertionError(f"{formula} is none of LTL")

    def _agree(self, node: _Node, after: _Node) -> bool:
        for formula in self._temporal:
            body, left = self._holds(formula.body, node), self._holds(formula.left, node)
            following = formula in after[1]
            if formula.op is ex.PathOp.FINALLY:
                expected = body or (left and following)
            else:
                expected = body and (not left or following)
            if (formula in node[1]) != expected:
                return False
        return True

    def _graph(self, starts: Sequence[_Node]) -> nx.DiGraph:
        graph, pending = nx.DiGraph(), list(starts)
        graph.add_nodes_from(starts)
        while pending:
            node = pending.pop()
            for region, tick in self._steps(node[0]):
                for held in self._sets:
                    after = (region, held)
                    if not self._agree(node, after):
                        continue
                    if after not in graph:
                        pending.append(after)
                    tick = tick or graph.get_edge_data(node, after, {}).get("tick", False)
                    graph.add_edge(node, after, tick=tick)
            if len(graph) > self._limit:
                raise TooManyRegionsError
        return graph

    def _steps(self, region: Region) -> Iterator[tuple[Region, bool]]:
        if self._progress and region.timer >= Fraction(1):
            later = self._regions.later(region)
            yield self._regions.restarted(region), True
            if later == region:
                yield region, True
            return
        actions, later = list(self._regions.actions(region)), self._regions.later(region)
        for after in actions:
            yield after, False
        if later is not None:
            yield later, False
        elif not actions and not self._progress:
            yield region, False


def satisfied_by(network: Network, run: Run, formula: ex.Expression) -> bool:
    """Whether a run that ends in a loop, or at rest, satisfies a formula without clocks."""
    rules, letters, back = Rules(network), [initial_configuration(network)], 0
    for number, step in enumerate(run.steps):
        if number == run.loop:
            back = len(letters)
        letters.append(rules.wait(letters[-1], step.delay))
        if step.action is not None:
            letters.append(rules.act(letters[-1], step.action))
    last = len(letters) - 1
    following = [*range(1, last + 1), last if run.loop is None else back]

    def where(part: ex.Expression) -> list[bool]:
        if not is_linear(part):
            return [*map(truth_of(part), letters)]
        match part:
            case ex.PathFormula(op, body, _, left):
                final = op is ex.PathOp.FINALLY
                now, until = [held == final for held in where(body)], where(left)
                for _ in letters:
                    now = [held or (until[n] and now[following[n]]) for n, held in enumerate(now)]
                return [held == final for held in now]
            case ex.UnaryOperation(ex.UnaryOp.NOT, operand):
                return [not held for held in where(operand)]
            case ex.BinaryOperation(op, one, other):
                pairs = zip(where(one), where(other), strict=True)
                return [JOINED[op](*pair) for pair in pairs]
            case _:
                raise AssertionError(f"{part} is none of LTL")

    return where(formula)[0]

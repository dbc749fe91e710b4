"""The model's section of the page: claims about all of its runs, and runs compared with it."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

from markupsafe import Markup

from handover.campaign.closing import UNREACHABLE, closing
from handover.campaign.system import Handover
from handover.campaign.table1 import witness_test
from handover.checker.conformance import check_run
from handover.driver import run_test
from handover.generator.abstract_test import AbstractTest
from handover.model import handover_network
from rvmon.cdv import Observer, Test
from rvmon.cdv.close.goals import EDGES, Witness, Witnesses
from rvmon.cdv.code_coverage import hits_of_states
from rvmon.cdv.tables import RobotTest
from rvmon.confidence import interval_text
from rvmon.execute import parallel
from rvmon.report.html import component
from rvmon.report.verdict_table import checked_text

if TYPE_CHECKING:
    from rvmon.models.conform import Conformance

SUFFIX = "_all"
"""Suffix of the queries that state a requirement about all runs of the model."""

ROBOT = "correct"
"""The robot that the model describes."""

SIMULATED, SIMULATED_UNITS = 1000, 1200
"""Random runs of the model per query, and their length in units: a handover ends within 60 s."""

Addresses = Mapping[RobotTest, str]
"""Addresses of the pages of tests."""


Row = tuple[str | Markup, ...]

_SECTION = Markup(
    "<section><h2>The model</h2>{}<p class=soft>Random runs choose among edges by the weights of "
    "the model, {:,} of {:g} s for each, with the 95 % interval.</p><h3>The model and the code</h3>"
    "<p class=soft>Tests follow runs of the model that together take all edges which any run can "
    "take, and the correct robot plays them. The first {} runs of each strategy are compared with "
    "the model, for which the instant of the human's readiness is an input.</p>{}</section>"
)
_WITNESS = Markup('{}<a href="{}" title="the robot plays it"> (witness)</a>')


def model_sections(
    tests: Mapping[RobotTest, Test], addresses: Addresses, count: int
) -> list[Markup]:
    """The section of a campaign's page; empty if no run can be compared with the model.

    Args:
        tests: the played tests.
        addresses: addresses of their pages.
        count: the number of runs of each strategy that are compared with the model.
    """
    strategies: dict[str, list[AbstractTest]] = {}
    for (robot, _), test in tests.items():
        if robot == ROBOT and test.mutation is None and isinstance(test, AbstractTest):
            own = strategies.setdefault(test.strategy, [])
            own += [test] if len(own) < count else []
    if not count or not strategies:
        return []
    jobs = os.cpu_count() or 1
    edges = parallel.execute(edge_tests(), _follower, jobs=jobs, what="run of the model")
    code = _edge_rows(frozenset().union(*edges))
    claimed = []
    for row in parallel.execute(claims(), _verifier, jobs=jobs, what="query"):
        address = addresses.get((ROBOT, witness_test(str(row[0]))))
        some = row[1] if address is None else _WITNESS.format(row[1], address)
        claimed.append((row[0], some, *row[2:]))
    chosen = [test for own in strategies.values() for test in own]
    found = parallel.execute(chosen, _conformer, jobs=jobs, what="run")
    for own in strategies.values():
        code.append(_strategy_row([(test, next(found)) for test in own], addresses))
    titles = ("", "some run shows it", "random runs that do", "all runs keep to it", "in words")
    tables = [
        component("named_rows", head, rows)
        for head, rows in ((titles, claimed), (("", "in all", "as expected", "the others"), code))
    ]
    return [_SECTION.format(tables[0], SIMULATED, SIMULATED_UNITS * 0.05, count, tables[1])]


def claims() -> list[str]:
    """The names of the queries about all runs.

    >>> claims()
    ['R1_all', 'R2_all', 'R3_all', 'R4_all']
    """
    return [query.id for query in handover_network().queries if query.id.endswith(SUFFIX)]


def _verifier() -> Callable[[str], Row]:
    from rvmon.models.network import Chance
    from rvmon.models.network.expressions import PathFormula, PathOp
    from rvmon.models.runs.statistics import sample
    from rvmon.models.search.verify import verify

    network = handover_network()
    queries = {query.id: query for query in network.queries}

    def row(name: str) -> Row:
        requirement = name.removesuffix(SUFFIX)
        some, every = (verify(network, queries[query]).holds for query in (requirement, name))
        claim, query = queries[name], queries[requirement]
        goal = query.formula
        assert isinstance(goal, PathFormula), "`E<>` with or without a bound"
        horizon = SIMULATED_UNITS if goal.bound is None else goal.bound
        chance = Chance(PathOp.FINALLY, goal.body, horizon, SIMULATED, sign=None, level=0.0)
        share = sample(network, replace(query, formula=chance), seed=1)
        interval = interval_text(round(share.value * share.runs), share.runs)
        remark = Markup('<span title="{}">{}</span>').format(claim.text, claim.remark)
        shown = f"{100 * share.value:.1f} % ({interval})"
        return requirement, checked_text(some), shown, checked_text(every), remark

    return row


def _conformer() -> Callable[[AbstractTest], Conformance]:
    network = handover_network()
    return lambda test: check_run(network, run_test(test, robot=ROBOT))


def edge_tests() -> list[str]:
    """Names of edges whose witnesses together cover all edges that any run can take."""
    witnesses = _witnesses()
    answers = {name: witnesses.answer((EDGES, name)) for name in witnesses.groups[0].items}
    runs = {id(answer.run): name for name, answer in answers.items() if isinstance(answer, Witness)}
    return [*runs.values()]


@cache
def _witnesses() -> Witnesses:
    model = closing().model
    assert model is not None, "it has one"
    return Witnesses(model, describes=True)


def _follower() -> Callable[[str], frozenset[str]]:
    """Make a function that plays the test of an edge's witness and returns the edges it shows."""
    witnesses = _witnesses()

    def shown(edge: str) -> frozenset[str]:
        witness = witnesses.answer((EDGES, edge))
        assert isinstance(witness, Witness), "it is one of `edge_tests`"
        test = witnesses.test(witness, edge, 1)
        assert isinstance(test, AbstractTest), "the campaign's model makes no other"
        run = Handover(ROBOT).play(test, Observer(()))
        return frozenset(witnesses.shown(witness, edge, hits_of_states(run)).get(EDGES, ()))

    return shown


def _edge_rows(shown: frozenset[str]) -> list[Row]:
    """A row per automaton: the number of edges that the robot's runs show, and the other edges."""
    argued = {
        unreachable.item: unreachable.reason
        for unreachable in UNREACHABLE
        if unreachable.group == EDGES
    }
    edges: dict[str, list[str]] = {}
    for name in _witnesses().groups[0].items:
        edges.setdefault(name.partition(":")[0], []).append(name)
    rows: list[Row] = []
    for automaton, names in edges.items():
        others = [
            f"{name.partition(': ')[2]} ({argued.get(name, 'not shown')})"
            for name in names
            if name not in shown
        ]
        played = f"{len(names) - len(others)} played"
        rows.append((f"edges of {automaton}", str(len(names)), played, "; ".join(others)))
    return rows


def _strategy_row(pairs: Sequence[tuple[AbstractTest, Conformance]], addresses: Addresses) -> Row:
    """The row of a strategy: how many of its runs conform, and where the others diverge."""
    others = []
    for test, found in pairs:
        if found.conforms is not True:
            address = addresses.get((ROBOT, test.name))
            link = Markup('<a href="{}">{}</a>').format(address, test.name)
            who = link if address else test.name
            others.append(Markup("{} does not: {}").format(who, _where(found)))
    conforming = f"{len(pairs) - len(others)} conform"
    strategy = pairs[0][0].strategy
    return f"runs, {strategy}", str(len(pairs)), conforming, Markup("; ").join(others)


def _where(found: Conformance) -> str:
    if found.divergence is None:
        return f"not decided, {found.undecided}"
    what = f"`{found.divergence.label}`" if found.divergence.label else "nothing more"
    return f"at {found.divergence.at / 1e9:.2f} s the model has no run with {what}"

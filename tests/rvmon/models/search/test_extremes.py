"""The largest and least value over all reachable states, each shown by a run."""

import json
from math import ceil, floor

import pytest
from tests.tools.timed_generate import random_model
from tests.tools.timed_regions import RegionGraph, TooManyRegionsError, truth_of

from rvmon.cli import main
from rvmon.errors import ModelError
from rvmon.models.language.elaborate import query_on
from rvmon.models.language.load import loads_network
from rvmon.models.network.expressions import ClockCompare, ClockOp, Constant
from rvmon.models.runs.exact_times import Rules
from rvmon.models.search.budget import Budget
from rvmon.models.search.extremes import FARTHEST, extremes

LAMP = """
clock x, y
int[0,100] n
automaton A {
  location a invariant x <= 10
  location b
  start a
  edge a -> a when x >= 3 and n < 17 do x = 0, n += 2
  edge a -> b when x > 4 and x < 7
}
"""


def asked(text, query, **options):
    network = loads_network(text)
    return list(extremes(network, query_on(network, query)[1], **options))


@pytest.mark.parametrize(
    ("query", "expected"),
    [
        ("sup: n", [(18, True)]),
        ("inf: n, 3 - n", [(0, True), (-15, True)]),
        ("sup{A.a}: x", [(10, True)]),
        ("inf{A.b}: x", [(4, False)]),
        ("inf{A.a and n == 2}: y", [(3, True)]),
        ("sup{A.a}: y", [(100, True)]),
        ("bounds: n, A.b ? n : 50", [(0, True), (18, True), (0, True), (50, True)]),
        ("sup{A.b and x < 9}: x", [(9, False)]),
    ],
)
def test_bounds_are_exact_and_shown_by_a_run(query, expected):
    found = asked(LAMP, query)
    assert [(one.value, one.attained) for one in found] == expected
    assert all(one.exact and one.run is not None for one in found)


def test_a_clock_may_grow_without_bound():
    (idle,) = asked(LAMP, "sup: x")
    assert (idle.value, idle.exact) == (None, True)
    assert "without bound" in idle.remark
    loop = "clock x, y automaton A { location a invariant x <= 99999 start a edge a -> a do x = 0 }"
    (round_,) = asked(loop, "sup: y")
    assert (round_.value, round_.exact) == (FARTHEST, False)


def test_an_unmet_condition_or_an_exhausted_budget_is_remarked():
    (none,) = asked(LAMP, "sup{n == 3}: n")
    assert (none.value, none.exact, none.remark) == (None, True, "no state meets the condition")
    (cut,) = asked(LAMP, "sup: n", budget=Budget(states=4))
    assert not cut.exact
    assert "4 states were visited" in cut.remark


@pytest.mark.parametrize("first", range(0, 20, 10))
@pytest.mark.law
def test_random_bounds_agree_with_the_region_graph(first):
    for seed in range(first, first + 10):
        network = loads_network(random_model(seed))
        clocks = range(len(network.clocks))
        fence = [ClockCompare(clock, ClockOp.LE, Constant(7)) for clock in clocks]
        try:
            graph = RegionGraph(network, fence, limit=2_000)
            states = [region.now for region in graph.reachable([graph.start()])]
        except TooManyRegionsError:
            continue
        where = " and ".join(f"{clock.name} <= 7" for clock in network.clocks)
        terms = ", ".join(one.name for one in (network.variables[0], *network.clocks))
        query = query_on(network, f"bounds{{{where}}}: {terms}")[1]
        inside = [now for now in states if all(truth_of(one)(now) for one in fence)]
        values = [
            [now.values[0] for now in inside],
            *([now.clocks[clock] for now in inside] for clock in clocks),
        ]
        found = list(extremes(network, query))
        for own, least, largest in zip(values, found[::2], found[1::2], strict=True):
            assert (least.value, least.attained) == (floor(min(own)), min(own) == floor(min(own)))
            assert (largest.value, largest.attained) == (ceil(max(own)), max(own) == ceil(max(own)))
        for one in found:
            assert truth_of(query.formula.where)(Rules(network).replay(one.run)[-1])


@pytest.mark.parametrize(
    ("query", "message"),
    [
        ("sup{AF A.b}: n", "a condition on runs"),
        ("sup: x > 3", "the value of a clock"),
        ("A[] (sup: n)", "expected"),
    ],
)
def test_a_query_without_a_bound_is_refused(query, message):
    with pytest.raises(ModelError, match=message):
        asked(LAMP, query)


def test_the_command_reports_bounds(tmp_path, capsys, says):
    model = tmp_path / "lamp.ta"
    model.write_text(LAMP + 'query most "the count ends": sup: n\n', "utf-8")
    told = says(0, "verify", model).out
    assert "most: answered: sup: n" in told
    assert "n is at most 18" in told
    assert main(["verify", str(model), "--query", "inf{A.b}: x", "--format", "json"]) == 0
    (answer,) = json.loads(capsys.readouterr().out)["extremes"]
    assert (answer["end"], answer["value"], answer["attained"]) == ("inf", 4, False)
    assert main(["verify", str(model), "--query", "sup: n", "--max-states", "9"]) == 1

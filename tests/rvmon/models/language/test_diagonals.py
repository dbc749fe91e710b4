"""Guards, invariants and queries may compare the difference of two clocks."""

import re
from fractions import Fraction
from random import Random

import pytest
from tests.tools.each import each
from tests.tools.timed_generate import random_model
from tests.tools.timed_regions import RegionGraph, TooManyRegionsError

from rvmon.errors import ModelError
from rvmon.models.language.elaborate import query_on, signal_on
from rvmon.models.language.load import loads_network
from rvmon.models.runs.exact_times import Configuration, Rules
from rvmon.models.runs.statistics import sample
from rvmon.models.search.verify import verify

MODEL = """
clock x, y
automaton A {{
  location a invariant x <= 5
  location b invariant x - y <= 1
  location c
  start a
  edge a -> a when x >= 2 do x = 0
  edge a -> b when y - x > 3 do y = 0
  edge b -> c when x - y == 1
}}
query: {}
"""


@each(
    ("query", "expected"),
    [
        ("E<> A.c", True),
        ("A[] (A.c imply x > y)", True),
        ("E<> A.b and x < y", False),
        ("E<> A.b and x == y + 1", True),
        ("A[] x - y <= 1", True),
        ("E<> A.a and y - x == 5", True),
        ("E<> A.a and 5 < y - x and y <= 6", True),
        ("E<> A.a and y - x > 5 and y <= 5", False),
        ("A[] x - y != 1 or A.b or A.c", True),
        ("A[] (deadlock imply A.c or x - y > 0)", False),
        ("A[] (deadlock imply A.c or x - y < 1)", True),
        ("A<> A.c", False),
        ("E<> x - y > 3 and y - x >= -4", False),
        ("E<> x + 2 <= 5 and A.c", True),
    ],
)
def test_queries_about_differences(query, expected):
    """The query may be part of the model or be asked later, which leaves the model unchanged."""
    network, plain = (loads_network(MODEL.format(text)) for text in (query, "E<> A.c"))
    assert verify(network, network.queries[0]).holds is expected
    assert verify(plain, query).holds is expected
    assert plain == loads_network(MODEL.format("E<> A.c"))


_COMPARE = re.compile(r"(when|and) ([xyz]) ([<>=]+) (\d)")


def with_differences(seed):
    """A random model in which some guards compare the difference of two clocks."""
    random = Random(seed)

    def changed(found):
        other = random.choice([one for one in "xy" if one != found[2]])
        number = random.randint(-2, 2)
        return f"{found[1]} {found[2]} - {other} {found[3]} {number}"

    text, _, _ = random_model(seed).partition("query:")
    return _COMPARE.sub(lambda m: changed(m) if random.random() < 0.6 else m[0], text)


@pytest.mark.law
def test_the_variable_kept_for_a_difference_has_its_truth_in_every_region():
    seen = 0
    for seed in range(40):
        text = with_differences(seed)
        if "clock x\n" in text or " - " not in text:
            continue
        try:
            network = loads_network(text)
            graph = RegionGraph(network, limit=1_500)
            regions = graph.reachable([graph.start()])
        except (ModelError, TooManyRegionsError):
            continue
        names = [clock.name for clock in network.clocks]
        kept = [
            (place, re.fullmatch(r"(\w) - (\w) (<=?) (-?\d+)", variable.name))
            for place, variable in enumerate(network.variables)
            if " - " in variable.name
        ]
        largest = graph._largest
        for region in regions:
            clocks = dict(zip(names, region.now.clocks, strict=True))
            for place, (first, second, op, number) in ((p, m.groups()) for p, m in kept):
                if max(clocks[first], clocks[second]) <= largest:
                    difference, limit = clocks[first] - clocks[second], int(number)
                    truth = difference < limit if op == "<" else difference <= limit
                    assert region.now.values[place] == truth, (seed, network.variables[place])
                    seen += 1
    assert seen > 600


SYNC = """
clock x, y
chan c
automaton A {{ location a start a edge a -> a when {} on c! do x = 0 }}
automaton B {{ location b start b edge b -> b on c? do {} }}
"""


@each(
    ("text", "message"),
    [
        (SYNC.format("x - y > 1", "y = 0"), "set by edges that synchronise"),
        ("clock x, y int[0,3] n automaton A { location a start a "
         "edge a -> a when x - y > 1 do x = n }", "set to a computed value"),
        ("clock x, y void f() { x = 0; } automaton A { location a start a "
         "edge a -> a when x - y > 1 do f() }", "set to a computed value"),
        ("clock x, y automaton A { location a start a edge a -> a when x + y > 1 }",
         "a sum of clocks"),
        ("clock x, y int[0,3] n automaton A { location a start a edge a -> a when x - y > n }",
         "not constant"),
        ("clock x, y bool b automaton A { location a start a edge a -> a do b = x < y }",
         "a clock's state is written"),
    ],
)  # fmt: skip
def test_a_difference_that_cannot_be_tracked_is_refused(text, message):
    with pytest.raises(ModelError, match=message):
        loads_network(text)


def test_a_disjunction_of_clocks_splits_an_edge_into_disjoint_ones():
    text = """
    clock x, y
    int[0,3] v
    automaton A {{
      location a invariant x <= 9 location b start a
      edge a -> b when (x < 2 or y > 5) and (v == 0 or x == 7) do y = 0
    }}
    query: {}
    """
    for query, expected in (
        ("A[] not deadlock or A.b", True),
        ("E<> A.b and y == 0 and x == 1", True),
        ("E<> A.b and y == 0 and x == 5", False),
        ("E<> A.b and y == 0 and x > 5 and x < 6", True),
    ):
        network = loads_network(text.format(query))
        assert verify(network, network.queries[0]).holds is expected, query
    edges, rules = network.automata[0].edges, Rules(network)
    assert len(edges) == 4
    for x, y, v in ((0, 0, 0), (1, 6, 1), (7, 7, 1), (8, 8, 0), (8, 8, 1), (3, 3, 0), (1, 1, 2)):
        now = Configuration((0,), (v,), (Fraction(x), Fraction(y)))
        fitting = sum(
            rules.is_ready(now, 0, edge) and all(rules.compares(now, c) for c in edge.guard.clocks)
            for edge in edges
        )
        assert fitting == int((x < 2 or y > 5) and (v == 0 or x == 7))


def test_edges_that_set_the_same_clock_may_synchronise():
    network = loads_network(SYNC.format("x - y < 1", "x = 1") + "query: E<> x - y >= 1 and y == 0")
    assert verify(network, network.queries[0]).holds


def test_signals_and_probabilities_are_refused_where_edges_are_split():
    network = loads_network(MODEL.format("E<> A.c"))
    with pytest.raises(ModelError, match="keep track of their difference"):
        signal_on(network, "far", "x - y > 3")
    with pytest.raises(ModelError, match="probabilities are undefined"):
        sample(network, query_on(network, "Pr[<=9](<> A.c)")[1])

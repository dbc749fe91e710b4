"""Simulated shares are near the true ones, bounds hold, and nothing hangs."""

from math import comb

import pytest

from rvmon.confidence import interval
from rvmon.errors import ModelError
from rvmon.timed.language.elaborate import asked_on
from rvmon.timed.language.load import loads_network
from rvmon.timed.runs.statistics import sample

COIN = """
automaton A {
  location a location b location c
  start a
  edge a -> b weight 0.75
  edge a -> c weight 0.25
}
"""


def share(text, asked, runs=500, seed=7):
    """The estimate of a probability on a model given as text."""
    network = loads_network(text)
    query = asked_on(network, asked.replace("Pr[", "Pr[<=").replace("]", f"; {runs}]", 1))[1]
    return sample(network, query, seed=seed)


def test_weights_are_shares():
    """Of two edges of one automaton each is taken as often as its weight says."""
    result = share(COIN, "Pr[1000](<> A.b)", runs=2000)
    assert result.low < 0.75 < result.high
    assert result.high - result.low < 0.05


def test_a_share_and_its_opposite_add_up():
    """Who never meets p is who meets it not, run by run."""
    meets = share(COIN, "Pr[1000](<> A.b)")
    never = share(COIN, "Pr[1000]([] not A.b)")
    assert meets.value + never.value == pytest.approx(1)


@pytest.mark.slow
def test_delays_are_uniform_in_their_window():
    """A bound in the middle of a window is met by half of the runs."""
    text = """
    clock x
    automaton A { location a invariant x <= 10 location b start a edge a -> b when x >= 2 }
    """
    result = share(text, "Pr[6](<> A.b)", runs=2000)
    assert result.low < 0.5 < result.high
    assert share(text, "Pr[10](<> A.b)").value == 1
    assert share(text, "Pr[1](<> A.b)").value == 0


def test_clocks_in_the_formula_are_met_while_time_passes():
    """A formula that holds only in the middle of a wait is met."""
    text = "clock x automaton A { location a invariant x <= 9 start a edge a -> a do x = 0 }"
    assert share(text, "Pr[50](<> x == 3 and A.a)").value > 0.5


def test_the_same_seed_gives_the_same_figure():
    assert share(COIN, "Pr[9](<> A.b)") == share(COIN, "Pr[9](<> A.b)")
    assert share(COIN, "Pr[9](<> A.b)") != share(COIN, "Pr[9](<> A.b)", seed=8)


@pytest.mark.parametrize(("successes", "runs"), [(0, 20), (1, 20), (10, 20), (20, 20)])
def test_bounds_are_clopper_and_pearsons(successes, runs):
    """At each bound the observed count is just as improbable as the confidence allows."""
    low, high = interval(successes, runs, 0.9)
    at_least = sum(
        comb(runs, k) * low**k * (1 - low) ** (runs - k) for k in range(successes, runs + 1)
    )
    at_most = sum(comb(runs, k) * high**k * (1 - high) ** (runs - k) for k in range(successes + 1))
    assert low == 0 if successes == 0 else at_least == pytest.approx(0.05)
    assert high == 1 if successes == runs else at_most == pytest.approx(0.05)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "query", "message"),
    [
        (COIN, "Pr[5](<> EF A.b)", "cannot be evaluated on one run"),
        (COIN, "Pr[5](<> deadlock)", "cannot be evaluated on one run"),
        (
            "clock x automaton A { location a invariant x <= 0 start a edge a -> a }",
            "Pr[5](<> x > 3)",
            "moves in 0 units of time",
        ),
    ],
)
def test_what_cannot_be_simulated_is_refused(text, query, message):
    with pytest.raises(ModelError, match=message):
        share(text, query)

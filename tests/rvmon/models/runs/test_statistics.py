"""Probabilities and expected values are estimated with the stated errors."""

import json
from math import comb, exp

import pytest
from tests.tools.each import each

from rvmon.cli import main
from rvmon.confidence import interval
from rvmon.errors import ModelError
from rvmon.models.language.elaborate import query_on
from rvmon.models.language.load import loads_network
from rvmon.models.runs.statistics import MARGIN, sample, trajectories
from rvmon.models.search.extremes import extremes
from rvmon.models.search.verify import verify
from rvmon.models.uppaal_xml import uppaal_xml

COIN = """
clock x
int[0,3] n
automaton A {
  location toss invariant x <= 1
  location heads
  location tails
  start toss
  edge toss -> heads when x >= 1 do n = 3 weight 0.3
  edge toss -> tails when x >= 1 do n = 1 weight 0.7
}
"""


WINDOW = """
clock x
automaton A { location a invariant x <= 10 location b start a edge a -> b when x >= 2 }
"""
STOPPED = """
clock x, used, cost
bool left
automaton A {
  location a invariant x <= 10 and used' == 0
  location b invariant x <= 10 and used' == 2 and cost' == 3
  location c rate 1:4
  location d
  start a
  edge a -> b when x == 4
  edge b -> c when x >= 10
  edge c -> d do left = true
}
"""


def short(value):
    """No id for the text of a model, whose query says enough."""
    return "" if "automaton" in str(value) else None


def figure(text, query, seed=1):
    network = loads_network(text)
    return sample(network, query_on(network, query)[1], seed=seed)


def sampled(query, seed=1):
    return figure(COIN, query, seed)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("model", "query", "truth", "width"),
    [
        (COIN, "Pr[<=2; 2000](<> A.heads)", 0.3, 0.05),
        (COIN, "Pr[<=2; 2000]([] not A.heads)", 0.7, 0.05),
        (COIN, "E[<=2; 2000](max: n)", 0.3 * 3 + 0.7 * 1, 0.1),
        (COIN, "E[<=2; 2000](max: 10 * n)", 16, 1),
        # Delays are uniform in their window.
        (WINDOW, "Pr[<=6; 2000](<> A.b)", 0.5, 0.05),
        # A wait without a bound is exponential; the rate of the location is 1:4.
        (STOPPED, "Pr[<=14; 4000](<> left)", 1 - exp(-1), 0.05),
    ],
    ids=short,
)
def test_the_true_value_lies_within_the_bounds(model, query, truth, width):
    one = figure(model, query)
    assert one.runs == int(query.partition("; ")[2].partition("]")[0])
    assert one.low < truth < one.high < one.low + width


@pytest.mark.slow
@pytest.mark.parametrize(
    ("model", "query", "value"),
    [
        (COIN, "Pr[<=0](<> A.heads)", 0),
        (COIN, "E[<=2; 100](min: n)", 0),
        (WINDOW, "Pr[<=10](<> A.b)", 1),
        (WINDOW, "Pr[<=1](<> A.b)", 0),
        # The clock `used` stands still for 4 units, then runs at a rate of 2 for 6 units.
        (STOPPED, "Pr[<=10](<> A.c and used >= 12)", 1),
        (STOPPED, "Pr[<=10](<> A.c and used > 12)", 0),
        (STOPPED, "Pr[<=7](<> used > 6)", 0),
        (STOPPED, "Pr[<=8](<> used > 6)", 1),
        (STOPPED, "Pr[<=4](<> used > 0)", 0),
    ],
    ids=short,
)
def test_a_certain_value_is_exact(model, query, value):
    assert figure(model, query).value == value


def test_the_seed_decides_the_runs():
    one = sampled("Pr[<=2](<> A.heads)")
    assert one.runs == 1_000
    assert sampled("Pr[<=2](<> A.heads)") == one
    assert sampled("Pr[<=2](<> A.heads)", seed=8) != one


def test_a_formula_that_holds_only_during_a_wait_is_met():
    text = "clock x automaton A { location a invariant x <= 9 start a edge a -> a do x = 0 }"
    assert figure(text, "Pr[<=50](<> x == 3 and A.a)").value > 0.5


@pytest.mark.parametrize(("successes", "runs"), [(0, 20), (1, 20), (10, 20), (20, 20)])
def test_bounds_are_those_of_clopper_and_pearson(successes, runs):
    """At each bound the observed count is just as improbable as the confidence allows."""
    low, high = interval(successes, runs, 0.9)
    at_least = sum(
        comb(runs, k) * low**k * (1 - low) ** (runs - k) for k in range(successes, runs + 1)
    )
    at_most = sum(comb(runs, k) * high**k * (1 - high) ** (runs - k) for k in range(successes + 1))
    assert low == 0 if successes == 0 else at_least == pytest.approx(0.05)
    assert high == 1 if successes == runs else at_most == pytest.approx(0.05)


def test_a_run_in_which_no_time_passes_is_refused(monkeypatch):
    monkeypatch.setattr("rvmon.models.runs.simulate.MOST_MOVES", 1_000)
    hasty = "clock x automaton A { location a invariant x <= 0 start a edge a -> a }"
    with pytest.raises(ModelError, match="made 1,000 moves in 0 units of time"):
        figure(hasty, "Pr[<=5; 9](<> x > 3)")


@pytest.mark.parametrize(
    ("query", "expected"),
    [
        ("Pr[<=2](<> A.heads) >= 0.2", True),
        ("Pr[<=2](<> A.heads) >= 0.4", False),
        ("Pr[<=2](<> A.heads) <= 0.4", True),
        ("Pr[<=2](<> A.heads) <= 0.2", False),
        ("Pr[<=2]([] not A.heads) >= 0.6", True),
        ("Pr[<=1](<> A.heads or A.tails) >= 0.99", True),
    ],
)
def test_a_test_takes_as_many_runs_as_it_needs(query, expected):
    one = sampled(query)
    assert one.holds is expected
    assert 5 < one.runs < 5_000


@pytest.mark.slow
def test_a_test_errs_no_more_often_than_stated():
    """At the edge of the indifference region, 5 % of the tests may be wrong."""
    level = 0.3 - 4 * MARGIN
    wrong = sum(
        not sampled(f"Pr[<=2](<> A.heads) >= {level:.2f}", seed).holds for seed in range(10)
    )
    assert wrong <= 2


def test_a_test_with_too_few_runs_is_undecided():
    one = sampled("Pr[<=2; 50](<> A.heads) >= 0.3")
    assert (one.runs, one.holds, one.margin) == (50, None, MARGIN)


@each(
    ("query", "message", "fix"),
    [
        ("Pr[<=2](<> A.heads) >= 1.5", "this is not a test", "above 0 and below 1"),
        ("Pr[<=2](<> A.heads) > 0.5", "this is not a test", ">= or <="),
        ("Q[<=2](<> A.heads)", "a bound in runs", "Pr[<=T](<> p)"),
        ("E[<=2; 9](max: x)", "a clock has no value here", ""),
        ("E[<=2; 9](sum: n)", "not an expected value", "E[<=T; n](max: e)"),
        ("E[<=2; 1](max: n)", "1 runs", "from 2 to"),
        ("E<> (Pr[<=2](<> A.heads))", "this form of a statistical query", "Pr[<=T](<> p)"),
        ("Pr[<=2](<> deadlock)", "a lack of moves", "E<> deadlock"),
        ("Pr[<=2](<> A.heads and not deadlock) >= 0.5", "a lack of moves", "E<> deadlock"),
        ("Pr[<=2](<> EF A.heads)", "refers to other runs", "Pr[<=T](<> p)"),
    ],
)
def test_a_query_without_a_figure_is_refused_with_the_reason(query, message, fix):
    with pytest.raises(ModelError, match=message) as raised:
        sampled(query)
    assert fix in raised.value.diagnostics[0].help


@pytest.mark.slow
def test_the_command_reports_figures(tmp_path, capsys, says):
    model = tmp_path / "coin.ta"
    model.write_text(COIN, "utf-8")
    assert main(["verify", str(model), "--query", "Pr[<=2](<> A.heads)"]) == 0
    assert "simulated: Pr" in (told := capsys.readouterr().out)
    assert "95 % confidence" in told
    failing = ["verify", str(model), "--query", "Pr[<=2](<> A.heads) >= 0.5"]
    assert "does not hold, by a statistical test" in says(1, *failing).out
    (one,) = json.loads(says(1, *failing, "--format", "json").out)["simulated"]
    assert one["holds"] is False
    assert one["error"] == 0.05


TICKING = """
clock x, cost
int[0, 9] n
automaton A {
  location a invariant x <= 2 and cost' == 3
  start a
  edge a -> a when x >= 2 do x = 0, n = n + 1
}
query: simulate [<=5; 2] {n, x, cost, n > 1}
"""


def test_trajectories_have_every_change_of_value(tmp_path, says):
    network = loads_network(TICKING)
    found = trajectories(network, network.queries[0])
    assert len(found) == 2
    times = (0, 2, 2, 4, 4, 5)
    rows = (0, 0, 0, 0), (0, 2, 6, 0), (1, 0, 6, 0), (1, 2, 12, 0), (2, 0, 12, 1), (2, 1, 15, 1)
    assert [(one.times, one.values) for one in found] == [(times, rows)] * 2
    model = tmp_path / "ticking.ta"
    model.write_text(TICKING, "utf-8")
    told = says(0, "verify", model).out
    assert "simulated: simulate [<=5; 2]" in told
    assert "        4  x = 2, cost = 12\n" in told
    (one,) = json.loads(says(0, "verify", model, "--format", "json").out)["simulated"]
    assert one["runs"][1]["cost"] == [0, 6, 6, 12, 12, 15]


@pytest.mark.parametrize("text", ["simulate 3 [<=2] {n}", "simulate [<=2; 3] {n}"])
def test_the_number_of_runs_may_be_before_or_in_the_brackets(text):
    """The default is one run."""
    network = loads_network(COIN)
    assert len(trajectories(network, query_on(network, text)[1])) == 3
    assert len(trajectories(network, query_on(network, "simulate[<=2]{n}")[1])) == 1
    with pytest.raises(ModelError, match="does not simulate runs"):
        trajectories(network, query_on(network, "E<> n > 0")[1])


@pytest.mark.parametrize(
    "query", ["Pr[<=2](<> A.heads)", "simulate 3 [<=2] {n}", "sup: n", "E[<=2; 9](max: n)"]
)
def test_a_query_for_figures_cannot_be_verified(query):
    with pytest.raises(ModelError, match="not a decision"):
        verify(loads_network(COIN), query)


def test_the_value_of_a_stop_watch_is_undecidable():
    network = loads_network(STOPPED)
    assert verify(network, "E<> A.c").holds
    for query in ("E<> used > 3", "A<> cost > 3", "G (cost < 9)"):
        with pytest.raises(ModelError, match="not decidable"):
            verify(network, query)
    with pytest.raises(ModelError, match="not decidable"):
        list(extremes(network, query_on(network, "sup: cost")[1]))
    guarded = loads_network(STOPPED.replace("when x >= 10", "when x >= 10 and used > 3"))
    with pytest.raises(ModelError, match="2 places"):
        verify(guarded, "E<> A.c")


@pytest.mark.parametrize("invariant", ["used' == n - 1", "cost' == 1 + n"])
def test_a_rate_set_by_two_automata_is_an_error_of_the_run(invariant):
    text = STOPPED.replace("bool left", "int[0,3] n\nbool left")
    text += f"automaton B {{ location l invariant {invariant} start l }}"
    network = loads_network(text.replace("used' == 0", "x <= 10"))
    with pytest.raises(ModelError, match="set by two automata"):
        sample(network, query_on(network, "Pr[<=10](<> left)")[1])


def test_rates_survive_the_round_trip_through_xml():
    network = loads_network(STOPPED)
    assert loads_network(uppaal_xml(network)).automata == network.automata


def test_rates_may_be_quantified_over_elements():
    text = """
    clock y[2]
    automaton A { location l invariant forall (i : int[0,1]) y[i]' == i and y[i] <= 9 start l }
    """
    (place,) = loads_network(text).automata[0].locations
    assert [(rate.clock, rate.value.value) for rate in place.rates] == [(0, 0), (1, 1)]
    assert [compare.clock for compare in place.invariant.clocks] == [0, 1]


@each(
    ("written", "share"),
    [
        ("4", (4, 1)),
        ("OFTEN", (10, 1)),
        ("1 : OFTEN * 2", (1, 20)),
        ("0.25", (1, 4)),
        ("1e2", (100, 1)),
        ("1:2.5", (2, 5)),
    ],
)
def test_the_rate_of_a_location_may_be_a_fraction(written, share):
    text = f"const int OFTEN = 10 automaton A {{ location l rate {written} start l }}"
    (place,) = loads_network(text).automata[0].locations
    assert tuple(number.value for number in place.leaving) == share

"""Numbers with a fraction: random runs compute with them, and proofs refuse them."""

from fractions import Fraction

import pytest
from tests.tools.findings import codes_of

import rvmon
from rvmon.errors import ModelError
from rvmon.models.conform import conform
from rvmon.models.language.elaborate import query_on
from rvmon.models.language.load import loads_network
from rvmon.models.requirement_check import observe
from rvmon.models.runs.statistics import sample, trajectories
from rvmon.models.search.extremes import extremes
from rvmon.models.search.suite import Criterion, build_suite
from rvmon.models.search.verify import verify
from rvmon.models.uppaal_xml import uppaal_xml

MODEL = """
unit 1 s
const double GAIN = 0.5, HALF = GAIN
const double ROW[2] = {1, 2.5}
double last = 18
double seen[2]
int[0,9] rounds
clock x, warm
double next(double a, int[0,3] n) {
  double b = a;
  for (i : int[0,3]) if (i < n) b += sqrt(GAIN * GAIN);
  return b;
}
void keep(double &at, double v) { at = v; }
automaton Room {
  location cold  invariant warm <= 2.5 and warm' == GAIN
  location hot   invariant x <= 7.5 and warm' == -0.25
  start cold
  edge cold -> hot when warm >= ROW[1] and rounds < 9 do last = next(last, 2), x = 0, rounds++
  edge hot -> cold when x >= 7.5 and last < 21.25
    do x = 0.5, last = last - HALF, keep(seen[1], last)
}
"""


def values(terms, text=MODEL, horizon=20):
    network = loads_network(text)
    (run,) = trajectories(network, query_on(network, f"simulate [<={horizon}; 1] {{{terms}}}")[1])
    return run.times, run.values


def test_a_run_computes_with_doubles():
    times, rows = values("last, warm, seen[1], x")
    assert [float(t) for t in times] == [0, 5, 5, 12.5, 12.5, pytest.approx(16.25, abs=1e-3),
                                         pytest.approx(16.25, abs=1e-3), 20]  # fmt: skip
    last, warm, seen, x = ([float(v) for v in column] for column in zip(*rows, strict=True))
    assert last == [18, 18, 19, 19, 18.5, 18.5, 19.5, 19.5]
    assert warm[:4] == [0, 2.5, 2.5, 0.625]
    assert seen[3:5] == [0, 18.5]
    assert x[4] == 0.5


def test_probabilities_and_means_over_doubles():
    network = loads_network(MODEL)
    assert sample(network, query_on(network, "Pr[<=30; 20](<> last >= 19.5)")[1]).value == 1
    assert sample(network, query_on(network, "Pr[<=30; 20](<> last > 19.5 + 1)")[1]).value == 0
    mean = sample(network, query_on(network, "E[<=6; 20](max: last / 2)")[1])
    assert mean.value == 9.5


@pytest.mark.slow
@pytest.mark.parametrize(
    ("term", "expected"),
    [
        ("7 / 2", 3),
        ("7 / 2.0", 3.5),
        ("-7.5", -7.5),
        ("1 - 0.5 * 3", -0.5),
        ("fmod(7.5, 2)", 1.5),
        ("7.5 % 2", 1.5),
        ("fint(-2.5)", -2),
        ("floor(-2.5) + ceil(1.25) + round(0.75)", 0),
        ("fabs(-0.25) + pow(2, -1)", 0.75),
        ("(1 <? 0.5) + (1 >? 0.5)", 1.5),
        ("(rounds == 0 ? 1 : 0.5) + 1", 2),
        ("0.5 < 1 and not (0.5 >= 1) and 0.5 != 1", 1),
        ("ln(exp(1)) + log(100)", 3),
    ],
)
def test_operators(term, expected):
    _, rows = values(term)
    assert float(rows[0][0]) == pytest.approx(expected)


@pytest.mark.parametrize("value", ["3", "WHOLE", "2.5 + 0.5"])
@pytest.mark.parametrize(
    "automaton",
    [
        "double half() { const double own = VALUE; return own / 2; }\n"
        "automaton B { location l invariant x <= 0 location m start l edge l -> m do d = half() }",
        "automaton B(const double own) { location l invariant x <= 0 location m start l "
        "edge l -> m do d = own / 2 }\nb = B(VALUE)\nsystem b",
        "automaton B(const double &own) { location l invariant x <= 0 location m start l "
        "edge l -> m do d = own / 2 }\nb = B(WHOLE)\nsystem b",
        "automaton B(double own) { location l invariant x <= 0 location m start l "
        "edge l -> m do d = own / 2 }\nb = B(VALUE)\nsystem b",
    ],
)
def test_a_double_set_to_an_integer_divides_as_a_double(automaton, value):
    text = "const int WHOLE = 3\ndouble d\nclock x\n" + automaton.replace("VALUE", value)
    assert float(values("d", text)[1][-1][0]) == 1.5


@pytest.mark.parametrize(
    "update", ["last = 1 / (last - last)", "last = sqrt(-last)", "last = exp(1000 * last)"]
)
def test_an_undefined_value_is_an_error_of_the_run(update):
    with pytest.raises(ModelError, match="has no value for"):
        values("last", MODEL.replace("rounds++", f"rounds++, {update}"))


def template(parameter, argument):
    return f"automaton B({parameter}) {{ location l start l }}\nb = B({argument})\nsystem Room, b"


@pytest.mark.parametrize(
    ("declared", "code"),
    [
        ("int[0,9] n = 2.5", "TA004"),
        ("int[0,2.5] n", "TA004"),
        ("int[0,9] f() { return last; }\nbool b = f() > 0", "TA004"),
        ("int[0,9] f(int[0,9] a) { return a; }\nbool b = f(0.5) > 0", "TA004"),
        ("int[0,9] n\nvoid f() { n = last; }", ""),
        ("int[0,9] n\nvoid f() { keep(n, 1); }\nautomaton B { location l start l "
         "edge l -> l do f() }", "TA015"),
        ("double d = 1 << 0.5", "TA004"),
        ("double d = ~0.5", "TA004"),
        ("double d = sqrt(1, 2)", "TA015"),
        ("double d = x", "TA009"),
        (template("double &d", "last"), ""),
        (template("double &d", "rounds"), "TA015"),
        (template("int[0,9] &d", "last"), "TA015"),
        (template("double &d[2]", "seen"), ""),
        (template("const double &d", "GAIN"), ""),
        (template("const int[0,9] &d", "GAIN"), "TA004"),
        (template("const int[0,9] &d", "TEN"), "TA007"),
    ],
)  # fmt: skip
def test_integers_and_doubles_are_not_mixed_up(declared, code):
    """A fraction is refused where an integer is needed, and a reference must fit exactly."""
    text = f"const int TEN = 10\n{MODEL}{declared}\n"
    if not code:
        loads_network(text)
        return
    assert set(codes_of(loads_network, text)) == {code}


def test_proofs_refuse_numbers_with_a_fraction():
    network = loads_network(MODEL)
    spec = rvmon.loads("spec s\ntime held\nevent a\nrequirement R\n  upon a then within 1 s a\n")
    searches = [
        lambda: verify(network, network.queries[0] if network.queries else "E<> Room.hot"),
        lambda: list(observe(network, spec.checked)),
        lambda: build_suite(network, Criterion.EDGES),
        lambda: list(extremes(network, query_on(network, "sup: rounds")[1])),
        lambda: conform(network, [], observed=frozenset(), end=1, tolerance=0),
    ]
    for search in searches:
        with pytest.raises(ModelError, match="proofs work on integers only") as raised:
            search()
        assert "Pr[<=T]" in raised.value.diagnostics[0].help
    plain = loads_network("clock x int[0,1] n automaton A { location l start l }")
    for query in ("E<> n > 0.5", "E<> x > 0.5", "sup{n < 0.5}: n"):
        with pytest.raises(ModelError, match="proofs work on integers only"):
            query_on(plain, query)[1]


def test_a_model_with_fractions_survives_the_round_trip_through_xml():
    network = loads_network(MODEL)
    again = loads_network(uppaal_xml(network))
    query = "simulate [<=20; 2] {last, warm, rounds}"
    assert trajectories(again, query_on(again, query)[1]) == trajectories(
        network, query_on(network, query)[1]
    )


def test_time_goes_on_if_a_bound_is_off_the_grid():
    text = MODEL.replace("x >= 7.5", "x >= 2.1").replace("x <= 7.5", "x <= 2.1")
    times, rows = values("warm", text, horizon=20)
    assert times[-1] == Fraction(20)
    assert max(float(row[0]) for row in rows) <= 2.501

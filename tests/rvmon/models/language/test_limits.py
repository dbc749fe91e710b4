"""Models that are too large or refer to themselves are findings."""

import pytest
from tests.tools.findings import findings_of

from rvmon.models.language import resolve
from rvmon.models.language.load import load_network, loads_network

A = "automaton A { location a start a } "
EDGE = "clock x automaton T {{ location a start a edge a -> a when {} }}"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "code", "message"),
    [
        ("int[0," + "9" * 5000 + "] v " + A, "TA007", "the number is too large"),
        ("unit " + "9" * 5000 + " ms " + A, "TA007", "the number is too large"),
        ("clock x[99999999999] " + A, "TA007", "the number is too large"),
        ("clock x[2000000000] " + A, "TA019", "an array of more than"),
        ("clock x[5000] " + A, "TA019", "more than 4,999 clocks"),
        (" ".join(f"bool a{i}[10000]" for i in range(11)) + " " + A, "TA019", "variables"),
        (" ".join(f"chan a{i}[10000]" for i in range(11)) + " " + A, "TA019", "channels"),
        (
            A + "query: A[] forall (i : int[0,999]) forall (j : int[0,999]) i + j >= 0",
            "TA019",
            "quantifiers expand to more than",
        ),
        (
            "automaton T(const int[0,999] i, const int[0,999] j) { location a start a }",
            "TA019",
            "more than 10,000 instances",
        ),
        (
            "automaton T { location a start a "
            "edge a -> a select i : int[0,999], j : int[0,999] }",
            "TA019",
            "edges in one",
        ),
        (EDGE.format("x == 0" + " == 0" * 4), "TA019", "more than 16 cases"),
        (EDGE.format("x == 0" + " == 0" * 50), "TA019", "too many conditions are compared"),
        ("b(const int[0,1] i) = c(i) c(const int[0,1] i) = b(i) system b " + A, "TA015", "itself"),
        ("b() = b() system b " + A, "TA015", "an instance of itself"),
        (
            "automaton T(const int[0,1] i, const int[0,1] i) { location a start a }",
            "TA003",
            "two things named `i`",
        ),
        (
            "automaton T { location a start a edge a -> a select i : bool, i : bool }",
            "TA003",
            "two things named `i`",
        ),
        (A + "query q: E<> A.a query q: A[] A.a", "TA003", "two things named `q`"),
        ("signal s = A.a signal s = A.a " + A, "TA003", "two things named `s`"),
        (
            A + "automaton B { location b start b edge b -> b when A.a }",
            "TA002",
            "edges and invariants do not see the locations of `A`",
        ),
        (A + "query: E<>[<=2147483647] A.a", "TA007", "a bound of 2147483647"),
        (A + "query: A.a -->[<=-1] A.a", "TA007", "a bound of -1"),
        (EDGE.format("x[" * 600 + "0" + "]" * 600 + " == 0"), "TA019", "nested too deeply"),
        (EDGE.format("not " * 5000 + "true"), "TA019", "nested too deeply"),
        (EDGE.format(" + ".join(["1"] * 5000) + " > 1"), "TA019", "nested too deeply"),
        (EDGE.format("f(" * 5000 + "1" + ")" * 5000), "TA019", "nested too deeply"),
    ],
)  # fmt: skip
def test_an_exceeded_limit_is_one_finding(text, code, message, monkeypatch):
    monkeypatch.setattr(resolve, "MAX_UNROLLED", 5_000)
    (diagnostic,) = findings_of(loads_network, text)
    assert diagnostic.code == code
    assert message in diagnostic.message


def test_at_most_a_hundred_findings_are_given():
    names = ", ".join(f"x{i}, x{i}" for i in range(200))
    assert len(findings_of(loads_network, f"clock {names}")) == 100


def test_the_same_error_at_many_places_is_one_finding():
    (found,) = findings_of(loads_network, "clock x, x, x, x, x, x " + A)
    assert found.message == "two things named `x` (5 places)"
    assert [label.span.start for label in found.spans] == [9, 6, 12, 15]


def test_a_byte_order_mark_is_ignored(tmp_path):
    path = tmp_path / "model.ta"
    path.write_bytes(b"\xef\xbb\xbf" + A.encode())
    assert len(load_network(path).automata) == 1


def test_a_wide_range_is_a_warning():
    text = "int[0, 1000000000] n\nint[0, 10] m\nautomaton a { location l start l }"
    (warning,) = loads_network(text).warnings
    assert (warning.code, warning.severity) == ("TA005", "warning")
    assert "`n` has 1,000,000,001 values" in warning.message

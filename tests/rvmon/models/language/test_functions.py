"""Functions, records and whole arrays: what they compute and what is refused."""

import pytest
from tests.tools.each import each
from tests.tools.findings import codes_of
from tests.tools.timed_regions import shows

from rvmon.errors import ModelError
from rvmon.models.language.load import loads_network
from rvmon.models.search.verify import verify
from rvmon.models.uppaal_xml import uppaal_xml

HEAD = """clock x
int[0,99] v
int[0,9] a[3] = {1, 2, 3}
typedef struct { int[0,5] p; int[0,9] q[2]; } S
S s[2], t
const S ks[2] = {{1, {2, 3}}, {4, {5, 6}}}
"""
EDGE = "automaton A {{ location l location m start l edge l -> m when x >= 1 do {} }} query: E<> {}"


@pytest.mark.parametrize(
    ("functions", "update", "holds"),
    [
        ("int[0,99] f(int[0,9] n) { return n * n; }", "v = f(3) + f(f(2))", "v == 25"),
        (
            "int[0,99] f(int[0,9] z[3]) { z[0] = 9; return z[0]; }",
            "v = f(a)",
            "v == 9 and a[0] == 1",
        ),
        ("void f(int[0,9] &z[3]) { z[0] = 9; }", "f(a)", "a[0] == 9"),
        ("void f(int[0,9] &z) { v = 2; z = 7; }", "v = 1, f(a[v])", "a[1] == 7 and a[2] == 3"),
        ("void f() { int[0,9] i; for (i = 0; i < 3; i++) v += a[i]; }", "f()", "v == 6"),
        ("void f() { for (i : int[0,2]) { if (i == 1) return; v++; } }", "f()", "v == 1"),
        ("void f() { do v++; while (v < 5); }", "f()", "v == 5"),
        ("void f() { if (v == 0) if (v == 1) v = 2; else v = 3; }", "f()", "v == 3"),
        ("void f() { int[0,9] k = 1; { int[0,9] k = 5; v = k; } v += k; }", "f()", "v == 6"),
        ("void f() { const int[0,9] k = a[1]; v = k << 2 | 1; }", "f()", "v == 9"),
        ("void f() { a[v++] = 7; a[v++] += 7; }", "f()", "v == 2 and a[0] == 7 and a[1] == 9"),
        ("", "v = 2, a[v--] = 9", "v == 1 and a[2] == 9 and a[1] == 2"),
        ("int[-5,-1] w\nvoid f() { int[-5,-1] k; v = k - w + 1; }", "f()", "v == 1 and w == -5"),
        ("void f() { x = 0; }", "f()", "A.m and x == 0"),
        ("void f(clock &c) { c = 5; }", "f(x)", "A.m and x == 5"),
        ("void f(S &z) { z.q[1] = 4; z.p = z.q[1]; }", "f(s[1])", "s[1].p == 4 and s[0].p == 0"),
        ("S g = {3, {1, 2}}", "t = g, s[0] = t", "s[0] == g and s[1] != g"),
        ("", "v = ks[a[0]].q[a[0]]", "v == 6"),
        ("", "a[0] = a[1] = 8", "a[0] == 8 and a[1] == 8"),
        ("", "v = (7 & 12) + (1 ^ 3) + (5 <? 2) + (5 >? 2) + (17 >> 2)", "v == 17"),
        ("", "v = sum (i : int[0,2]) a[i]", "v == 6"),
    ],
)
def test_what_functions_compute(functions, update, holds):
    network = loads_network(HEAD + functions + "\n" + EDGE.format(update, holds))
    outcome = verify(network, network.queries[0])
    assert outcome.holds
    assert shows(network, outcome)
    again = loads_network(uppaal_xml(network))
    assert verify(again, again.queries[0]).holds


@each(
    ("functions", "update", "code"),
    [
        ("int[0,9] f(int[0,9] n) { return f(n); }", "v = f(1)", "TA016"),
        ("int[0,9] f(int[0,9] n) { return n; }", "v = f()", "TA015"),
        ("void f(int[0,9] &n) { n = 1; }", "f(a)", "TA015"),
        ("void f() { return 1; }", "f()", "TA004"),
        ("int[0,9] f() { return; }", "v = f()", "TA004"),
        ("S f() { return t; }", "f()", "TA016"),
        ("void f() { clock y; }", "f()", "TA004"),
        ("void f() { int[0,1] k; int[0,1] k; }", "f()", "TA003"),
        ("void f() { const int[0,3] k = 7; v = k; }", "f()", "TA007"),
        ("int[0,9] f() { return missing; }", "v = f() + f()", "TA002"),
        ("", "t = a", "TA004"),
        ("", "t.r = 1", "TA002"),
        (
            "bool f() { v = 1; return true; } bool g() { return f(); }\n"
            "automaton B { location l start l edge l -> l when g() }",
            "v = 1",
            "TA009",
        ),
    ],
)
def test_a_meaningless_model_is_one_finding(functions, update, code):
    assert codes_of(loads_network, HEAD + functions + "\n" + EDGE.format(update, "A.m")) == [code]


@pytest.mark.parametrize(
    ("functions", "update", "message"),
    [
        ("int[0,9] f(int[0,9] n) { if (n > 5) return 1; }", "v = f(1)", "ends without a value"),
        pytest.param(
            "void f() { while (true) v = 1; }",
            "f()",
            "go round more than 1,000,000 times",
            marks=pytest.mark.slow,
        ),
        ("int[0,9] f(int[0,9] n) { return n; }", "v = f(10)", "outside [0, 9]"),
        ("void f() { v = a[v + 3]; }", "f()", "index 3 is outside the array"),
        ("void f() { v = 1 << (v + 40); }", "f()", "a shift by 40 bits"),
        (
            "void f0() { v = 1; } "
            + " ".join(f"void f{k}() {{ f{k - 1}(); }}" for k in range(1, 61)),
            "f60()",
            "more than 60 calls in calls",
        ),
    ],
)
def test_a_failing_computation_is_an_error_of_the_run(functions, update, message):
    network = loads_network(HEAD + functions + "\n" + EDGE.format(update, "A.m"))
    with pytest.raises(ModelError) as caught:
        verify(network, network.queries[0])
    assert message in str(caught.value)

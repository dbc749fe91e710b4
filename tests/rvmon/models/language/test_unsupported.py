"""Unsupported features of UPPAAL are refused by name, with their place and an alternative."""

from xml.sax.saxutils import escape

import pytest
from tests.tools.each import each
from tests.tools.findings import findings_of

from rvmon.errors import ModelError
from rvmon.models.language.elaborate import query_on
from rvmon.models.language.load import loads_network
from rvmon.models.search.verify import verify


def model(declaration="", local="", invariant="", system="system T;", queries="", **labels):
    texts = "".join(f'<label kind="{kind}">{text}</label>' for kind, text in labels.items())
    return f"""<nta><declaration>{declaration}</declaration>
<template><name>T</name><declaration>{local}</declaration>
<location id="a"><name>A</name><label kind="invariant">{invariant}</label></location><init ref="a"/>
<transition><source ref="a"/><target ref="a"/>{texts}</transition></template>
<system>{system}</system><queries>{queries}</queries></nta>"""


@each(
    ("parts", "message"),
    [
        ({"declaration": 'import "lib.so" { int f(); };'}, "functions from outside"),
        ({"declaration": "hybrid clock x;"}, "hybrid clocks"),
        ({"declaration": "const string s = &quot;a&quot;;"}, "texts"),
        ({"declaration": "dynamic T();"}, "templates that are started by runs"),
        ({"declaration": "before_update { i = 0 }"}, "updates around every step"),
        ({"declaration": "const N 5;"}, "a constant without a type: write const int N = 5"),
        ({"assignment": "if (1) { }"}, "statements"),
        ({"declaration": "void f() { break; }"}, "break"),
        ({"declaration": "int i, j; void f() { if (i = j) { } }"}, "an assignment is not a value"),
        ({"declaration": "int f(int a) { return f(a); }", "guard": "f(3) == 2"}, "calls itself"),
        ({"guard": "random(2) &gt; 1"}, "`random`"),
    ],
)  # fmt: skip
def test_an_unsupported_feature_is_named(parts, message):
    (diagnostic,) = findings_of(loads_network, model(**parts))
    assert diagnostic.code == "TA016"
    assert message in f"{diagnostic.message}: {diagnostic.help}"
    assert diagnostic.help
    assert diagnostic.spans


@pytest.mark.parametrize(
    ("formula", "message"),
    [
        ("Pr[<=10](<> T.A) >= Pr[<=9](<> T.A)", "statistical query"),
        ("simulate [#<=10] { T.A }", "statistical query"),
        ("control: A<> T.A", "games"),
        ("E<> T.A under s", "games"),
        ("A<> T.A U T.A", "takes brackets"),
    ],
)
def test_an_unsupported_query_is_an_error_by_itself_and_a_warning_in_a_file(formula, message):
    with pytest.raises(ModelError, match=message):
        query_on(loads_network(model()), formula)
    queries = "".join(
        f"<query><formula>{escape(text)}</formula><comment/></query>"
        for text in (formula, "E<> T.A", "")
    )
    network = loads_network(model(queries=queries))
    (warning,) = network.warnings
    assert (warning.code, warning.severity) == ("TA020", "warning")
    assert message in warning.message
    assert [query.text for query in network.queries] == ["E<> T.A"]


def test_an_increment_may_be_a_prefix_or_a_suffix():
    network, same = (
        loads_network(model(declaration="int i;", assignment=text)) for text in ("++i", "i++")
    )
    assert network.automata == same.automata


def test_constants_are_computed_and_copied():
    network = loads_network(
        model("""int half(int n) { int k = n; while (k * 2 &gt; n) k--; return k; }
    const int N = half(7) + 1;
    typedef struct { int[0,9] a; int[0,9] b[2]; } pair;
    const pair one = {N, {1, 2}};
    const int[0,9] row[2] = {half(4), N};
    const pair both[2] = {one, {0, row}};
    pair first = both[1];
    int[0,N] n;""")
    )
    assert [(v.name, v.high, v.initial) for v in network.variables] == [
        ("first.a", 9, 0),
        ("first.b[0]", 9, 2),
        ("first.b[1]", 9, 4),
        ("n", 4, 0),
    ]


@pytest.mark.parametrize(
    ("declared", "code"),
    [
        ("int v; int f() { return v; } const int N = f();", "TA006"),
        ("int v; int f() { v = 1; return 2; } const int N = f();", "TA006"),
        pytest.param(
            "int f() { while (true) { } return 2; } const int N = f();",
            "TA019",
            marks=pytest.mark.slow,
        ),
        ("int f(int n) { return 1 / n; } const int N = f(0);", "TA007"),
        ("const int v[2] = {1, 2}; const int w[3] = v;", "TA004"),
        ("typedef struct { int a; } p; const int v[2] = {1, 2}; p w = v;", "TA004"),
        ("typedef struct { int a; } p; p v[2]; const int N = v[1];", "TA004"),
    ],
)
def test_a_constant_without_a_constant_value_of_its_type_is_refused(declared, code):
    assert findings_of(loads_network, model(declared))[0].code == code


def test_cost_and_reward_of_priced_automata_are_ignored_unless_declared():
    text = """<nta><declaration>clock x; {}</declaration><template><name>A</name>
    <location id="a"><label kind="invariant">cost' == 2 and x &lt;= 5 and reward' == 1</label>
    </location><init ref="a"/><transition><source ref="a"/><target ref="a"/>
    <label kind="guard">{}</label><label kind="assignment">cost += 7, reward += x0, x = 0</label>
    </transition></template><system>system A;</system></nta>"""
    network = loads_network(text.format("", "x >= 5"))
    assert [clock.name for clock in network.clocks] == ["x"]
    assert verify(network, "A[] not deadlock").holds
    with pytest.raises(ModelError, match="no name `cost`"):
        loads_network(text.format("", "cost >= 5"))
    with pytest.raises(ModelError, match="no name `x0`"):
        loads_network(text.format("int cost, reward;", "x >= 5"))


def test_the_integer_types_of_uppaal_are_known_in_xml_only():
    declared = "int8_t a = INT8_MIN; uint16_t b = UINT16_MAX; int32_t c; int d = -5;"
    network = loads_network(model(declared))
    ranges = [(v.low, v.high, v.initial) for v in network.variables]
    assert ranges == [
        (-128, 127, -128),
        (0, 65535, 65535),
        (-(1 << 31), (1 << 31) - 1, 0),
        (-32768, 32767, -5),
    ]
    with pytest.raises(ModelError, match="no type named `int8_t`"):
        loads_network("int8_t a automaton A { location l start l }")


def test_a_function_sees_what_is_declared_before_it():
    local = "int f() { return a; } int a = 2; int g() { return a; }"
    network = loads_network(model("const int a = 1;", local, guard="f() == 1 and g() == 2"))
    assert verify(network, "A[] not deadlock").holds


def test_an_index_out_of_range_is_an_error_only_where_it_is_evaluated():
    declared = "int a[2]; const int b[2] = {1, 2}; const int N = -1;"
    network = loads_network(model(declared, guard="N &gt;= 0 and b[N] == a[N]"))
    assert verify(network, "E<> deadlock").holds
    network = loads_network(model(declared, assignment="a[0] = b[N + 3]"))
    with pytest.raises(ModelError, match="index 2 is outside the array") as raised:
        verify(network, "E<> deadlock")
    assert raised.value.diagnostics[0].spans[0].span.text == "b[N + 3]"
    with pytest.raises(ModelError, match="index 2 is outside the array"):
        loads_network(model("clock x[2];", guard="x[2] &gt; 0"))

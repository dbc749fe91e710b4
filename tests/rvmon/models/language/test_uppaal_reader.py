"""UPPAAL's XML: textbook models load unchanged, and errors have their place."""

from pathlib import Path
from xml.sax.saxutils import escape

import pytest
from tests.tools.each import each
from tests.tools.findings import findings_of

from rvmon.errors import ModelError
from rvmon.models.language.elaborate import query_on
from rvmon.models.language.load import load_network, loads_network
from rvmon.models.runs.statistics import sample
from rvmon.models.search.verify import verify

MODELS = Path(__file__).parents[4] / "examples" / "models"


def wrap(template, *, declaration="", system="system T;", queries="", parameter=""):
    return f"""<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE nta PUBLIC '-//Uppaal Team//DTD Flat System 1.1//EN' 'http://nowhere/flat-1_2.dtd'>
<nta>
  <declaration>{declaration}</declaration>
  <template><name>T</name><parameter>{parameter}</parameter>{template}</template>
  <system>{system}</system>
  <queries>{queries}</queries>
</nta>"""


ONE = '<location id="a"><name>a</name></location><init ref="a"/>'


def edge(**labels):
    texts = "".join(f'<label kind="{kind}">{text}</label>' for kind, text in labels.items())
    return f'<transition><source ref="a"/><target ref="a"/>{texts}</transition>'


ENTITIES = (
    '<!DOCTYPE nta [<!ENTITY a "b">]>',
    '<!DOCTYPE nta [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;&a;&a;">]>',
    '<!DOCTYPE nta [<!ENTITY a SYSTEM "file:///etc/passwd">]>',
    '<!DOCTYPE nta [<!ENTITY % a SYSTEM "http://nowhere/"> %a;]>',
)


def branching(*weights):
    """A model whose edge leads to a branch point with one location per weight."""
    places = "".join(
        f'<location id="p{i}"><name>p{i}</name></location>' for i in range(len(weights))
    )
    branches = "".join(
        f'<transition><source ref="b"/><target ref="p{i}"/>'
        f'<label kind="probability">{weight}</label><label kind="assignment">v = v + {i}</label>'
        "</transition>"
        for i, weight in enumerate(weights)
    )
    return wrap(
        f'<location id="a"><name>a</name></location>{places}<branchpoint id="b"/><init ref="a"/>'
        '<transition><source ref="a"/><target ref="b"/><label kind="guard">x &gt;= 2</label>'
        f'<label kind="assignment">v = 3</label></transition>{branches}',
        declaration="clock x; int[0,9] v; const int N = 4;",
    )


def finding(text):
    (diagnostic,) = findings_of(loads_network, text)
    return diagnostic.code, diagnostic.spans[0].span.text if diagnostic.spans else None


@pytest.mark.slow
@pytest.mark.parametrize(
    ("model", "constants"),
    [
        ("fischer", {"N": 3}),
        ("train_gate", {"N": 3}),
        ("train_gate_queue", {}),
        ("bridge", {}),
        ("csma_cd", {"N": 2}),
    ],
)
def test_textbook_models_load_and_have_the_known_answers(model, constants):
    network = load_network(MODELS / f"{model}.xml", constants=constants)
    assert network.warnings == ()
    assert network.queries
    for query in network.queries:
        assert verify(network, query).holds, query.text


def test_a_location_without_a_name_goes_by_its_id():
    body = '<location id="id7"/><init ref="id7"/>'
    query = (
        "<query><formula>A[] T.id7 &amp;&amp; x &gt;= 0</formula><comment>so  so</comment></query>"
    )
    network = loads_network(wrap(body, declaration="clock x; // &lt;", queries=query))
    assert network.automata[0].locations[0].name == "id7"
    assert network.queries[0].text == "A[] T.id7 && x >= 0"
    assert network.queries[0].remark == "so so"


def test_not_binds_as_tightly_as_the_exclamation_mark():
    """As in UPPAAL, `not x == 1` is `(not x) == 1`, and `not a && b` is `(not a) && b`."""
    texts = ("A[] not n == 1", "E<> not n == 1", "A[] not n && n == 2", "A[] (not n) == 0")
    queries = "".join(f"<query><formula>{escape(text)}</formula></query>" for text in texts)
    network = loads_network(wrap(ONE, declaration="int n = 2;", queries=queries))
    answers = [verify(network, query).holds for query in network.queries]
    assert answers == [False, False, False, True]


def test_instances_may_be_written_the_old_or_the_new_way():
    text = wrap(ONE, parameter="const int[0,3] n", system="A := T(1); B = T(2); system A, B, C;")
    text = text.replace("<system>", "<instantiation>C = T(3);</instantiation><system>")
    assert [a.name for a in loads_network(text).automata] == ["A", "B", "C"]


def test_arrays_may_be_indexed_by_a_type():
    text = wrap(
        ONE + edge(select="i : id", guard="a[i] == 2", assignment="a[i] = 9, c[i] = 0"),
        declaration="typedef int[3,4] id; int[0,9] a[id] = {1, 2}; clock c[id];",
    )
    network = loads_network(text)
    assert [v.name for v in network.variables] == ["a[3]", "a[4]"]
    assert verify(network, "E<> a[4] == 9").holds
    assert not verify(network, "E<> a[3] == 9").holds


def test_elements_without_an_effect_on_runs_are_ignored():
    body = ONE.replace("</location>", '<label kind="exponentialrate">1</label></location>') + edge(
        testcode="x"
    ).replace("</transition>", '<nail x="1" y="2"/></transition>')
    charts = "system T; progress { 1; } gantt { T: 1 -&gt; 2; }"
    queries = "<query><formula>// later: A[] true</formula></query>"
    assert loads_network(wrap(body, system=charts, queries=queries)).warnings == ()


@each(
    ("text", "expected"),
    [
        ("<nta><declaration></nta>", ("TA018", "")),
        ("<html></html>", ("TA018", "<html")),
        (wrap(ONE + edge(guard="y &lt; 3")), ("TA002", "y")),
        (wrap(ONE + edge(synchronisation="go?:"), declaration="chan go;"), ("TA001", ":")),
        (wrap(ONE + edge(guard="x&lt;3&amp;&amp;y&gt;1"), declaration="clock x;"),
         ("TA002", "y")),
        (wrap(ONE + edge(guard="x -")), ("TA001", "")),
        (wrap(ONE.replace('ref="a"', 'ref="b"')), ("TA002", "<init")),
        (wrap('<location id="a"/>'), ("TA013", "T")),
        (wrap(ONE, declaration="hybrid clock x;"), ("TA016", ";")),
        (wrap(ONE, declaration="clock x, y;") .replace(
            "</location>", "<label kind='invariant'>x' != 0</label></location>"), ("TA009", "x'")),
        (wrap(ONE + edge(guard="x + y &lt; 3"), declaration="clock x, y;"),
         ("TA008", "x + y &lt; 3")),
        (wrap(ONE + edge(comments="weight 2")), ("TA017", "<label")),
        (wrap(ONE, system="system T, U;"), ("TA002", "U")),
        (wrap(ONE, parameter="const int n"), ("TA019", "const int")),
        # Entities may expand without limit or read other files.
        *((f"{one}<nta><declaration>&a;</declaration></nta>", ("TA018", "")) for one in ENTITIES),
        (branching(0, 0), ("TA017", "<transition")),
        (branching(2, -1), ("TA017", "<transition")),
    ],
)  # fmt: skip
def test_each_error_has_its_code_and_place(text, expected):
    assert finding(text) == expected


def test_columns_are_right_after_entities_and_newlines():
    guard = "\n   x &lt;= 3 &amp;&amp;\r\n  ü == 1"
    text = wrap(ONE + edge(guard=guard.replace("ü", "nobody")), declaration="clock x; // äöü")
    span = findings_of(loads_network, text)[0].spans[0].span
    assert span.text == "nobody"
    assert span.column == 3


@pytest.mark.parametrize(
    ("comment", "told"),
    [
        ("query safe\nnever\n in a", ("safe", "never in a")),
        (" query safe ", ("safe", "")),
        ("query safe, always", ("", "query safe, always")),
        ("see\nquery safe", ("", "see query safe")),
        ("", ("", "")),
    ],
)
def test_the_first_line_of_a_comment_may_be_an_id(comment, told):
    queries = f"<query><formula>E&lt;&gt; T.a</formula><comment>{comment}</comment></query>"
    [query] = loads_network(wrap(ONE, queries=queries)).queries
    assert (query.id, query.remark) == told


def test_deep_and_huge_files_are_refused():
    with pytest.raises(ModelError, match="nested too deeply"):
        loads_network("<nta>" + "<a>" * 1000 + "</a>" * 1000 + "</nta>")
    for room, told in ((2_000_000, "there is no automaton"), (2_000_001, "more than")):
        with pytest.raises(ModelError, match=told):
            loads_network(f"<nta>{'</nta>':>{room - 5}}")


@pytest.mark.slow
@pytest.mark.parametrize("weights", [("N - 3", 3, 0), (0.25, 0.75, 0.0)])
def test_a_branch_point_is_a_weighted_choice(weights):
    """Weights with a fraction affect probabilities only, so the model can still be searched."""
    network = loads_network(branching(*weights))
    assert [edge.weight for edge in network.automata[0].edges] == [0.25, 0.75]
    assert verify(network, "E<> T.p1 and v == 4 and x == 2").holds
    assert not verify(network, "E<> (T.p0 and v != 3) or T.p2 or (not T.a and x < 2)").holds
    share = sample(network, query_on(network, "Pr[<=100; 2000](<> T.p1)")[1]).value
    assert 0.7 < share < 0.8

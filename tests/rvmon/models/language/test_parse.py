"""All syntax errors of a text are reported, each with its place."""

from tests.tools.each import each
from tests.tools.findings import findings_of

from rvmon.models.language.load import loads_network
from rvmon.models.language.parse import MOST

TEXT = """network wrong
clock x, y
int[0,5 n
int[0,3] f(int[0,3] a) {
  int[0,3] k = a +;
  return k;
}
automaton A {
  clock 3z
  location a invariant x <= 5
  location b
  start a
  edge a -> b when x >= 2 and > 1
  edge b -> a when x >= 5 $ do x = 0
  bool flag = = true
}
query one: E<> (A.b
query two: E<> A.a
signal s = 1 +
"""

XML = """<nta><declaration>clock x;
int[0,5 n;
int[0,3] f(int[0,3] a) {
  int[0,3] k = a +;
  for (i : int[0,3]) { k = i; }
  return k;
}
typedef struct { int[0,1] a; } pair;
pair s = {1}};
bool b = true true;
</declaration>
<template><name>A</name><declaration>int 5a; bool ok; clock c 7;</declaration>
<location id="a"><label kind="invariant">x &lt;= </label></location><init ref="a"/>
<transition><source ref="a"/><target ref="a"/><label kind="guard">x &gt;&gt;&gt; 1</label>
<label kind="assignment">x = , s.a = 1</label></transition></template>
<system>A1 = A( ; A2 = A(); system A1, A2;</system></nta>"""


def places_of(text):
    spans = [one.spans[0].span for one in findings_of(loads_network, text)]
    return [(span.line, span.column) for span in spans]


def lines_of(text):
    return [line for line, _ in places_of(text)]


def test_every_part_of_a_text_reports_its_error():
    found = " ".join(f"{line}:{column}" for line, column in places_of(TEXT))
    assert found == "3:9 5:19 9:9 13:31 14:27 15:15 18:1 20:1"


def test_every_part_of_xml_declarations_reports_its_error():
    assert lines_of(XML) == [2, 4, 9, 10, 12, 12, 13, 14, 15, 16]


def test_the_number_of_reported_errors_is_limited():
    assert len(lines_of("int[0,5 n\n" * 100)) == MOST


@each("text", ["}", "{", "automaton", "automaton A {", "query", "(" * 50, "x;"])
def test_a_short_fragment_is_one_error(text):
    assert lines_of(text) == [1]

"""The `.ta` text form: what it accepts and which findings it gives."""

import logging
import random

import lark
import pytest
from tests.tools.each import each
from tests.tools.findings import findings_of

from rvmon.errors import ModelError
from rvmon.models.language.elaborate import query_on
from rvmon.models.language.load import load_network, loads_network
from rvmon.models.language.parse import STARTS
from rvmon.models.search.verify import verify


def findings(text):
    return [
        (d.code, d.spans[0].span.line, d.spans[0].span.column) if d.spans else (d.code, 0, 0)
        for d in findings_of(loads_network, text)
    ]


@pytest.mark.slow
def test_the_grammar_has_no_conflicts(caplog):
    from importlib import resources

    grammar = resources.files("rvmon.models.language").joinpath("ta.lark").read_text()
    lark.logger.setLevel(logging.DEBUG)
    try:
        with caplog.at_level(logging.DEBUG, logger="lark"):
            lark.Lark(grammar, parser="lalr", start=list(STARTS), debug=True)
    finally:
        lark.logger.setLevel(logging.CRITICAL)
    assert not [record for record in caplog.records if "conflict" in record.getMessage().lower()]


def test_a_model_with_every_kind_of_part():
    network = loads_network("""
    network demo "A demo"   // a comment
    unit 50 ms              /* another */
    const int N = 2, M[2] = {3, 4}
    typedef int[0,N-1] id
    int[0,9] count = 1, grid[2][id]
    bool flag = true
    clock x
    broadcast chan c[N]
    urgent chan u
    automaton T(const id me, const int[1,1] one) {
      clock y
      location a invariant x <= M[me] and (flag imply count < 5)
      urgent location b
      committed location d
      start a
      edge a -> b select i : id when y >= one && i == me on c[i]!
             do y = 0, count += 2, grid[1][i]++ weight 0.25 as go
      edge b -> d on u?
    }
    automaton U { location a start a edge a -> a on u! }
    W = T(1, 1)
    system W, U
    query Q "a question": E<> W.b and exists (i : id) grid[1][i] == 1
    """)
    assert (network.name, network.title, network.unit) == ("demo", "A demo", 50_000_000)
    assert [clock.name for clock in network.clocks] == ["x", "W.y"]
    assert [automaton.name for automaton in network.automata] == ["W", "U"]
    assert [variable.initial for variable in network.variables] == [1, 0, 0, 0, 0, 1]
    first = network.automata[0].edges[0]
    assert (first.weight, first.label) == (0.25, "go")
    assert [(q.id, q.remark) for q in network.queries] == [("Q", "a question")]
    assert verify(network, network.queries[0]).holds


def test_templates_are_instantiated_for_all_values_of_their_free_parameters():
    """`Half` binds one parameter of `T` and leaves the other free."""
    network = loads_network("""
    automaton U(const int[1,2] i, const bool b) { location a start a }
    automaton T(const int[0,9] i, const int[0,9] j) {
      int[0,99] v = 10 * i + j
      location a start a
    }
    Half(const int[1,2] k) = T(k, 7)
    """)
    names = ["U(1, 0)", "U(1, 1)", "U(2, 0)", "U(2, 1)", "Half(1)", "Half(2)"]
    assert [a.name for a in network.automata] == names
    assert [v.initial for v in network.variables] == [17, 27]


def test_reference_parameters_are_aliases():
    network = loads_network("""
    clock x
    int[0,3] v, w[2]
    chan c
    automaton T(clock &t, int[0,3] &n, int[0,3] &list[2], chan &to) {
      location a location b start a
      edge a -> b when t >= 2 on to! do n = 3, list[1] = 2
    }
    automaton R { location a start a edge a -> a on c? }
    one = T(x, v, w, c)
    """)
    assert verify(network, "E<> one.b and v == 3 and w[1] == 2 and x < 3").holds
    assert not verify(network, "E<> one.b and x < 2").holds


def test_a_parameter_type_may_refer_to_earlier_parameters():
    text = """
    int[0,3] v[3]
    automaton T(const int n, const int[0,n] k, int[0,3] &w[n]) {
      location a start a
      edge a -> a when w[k-1] == 0 do w[0] = n
    }
    one = T(3, {k}, v)
    system one
    """
    assert loads_network(text.replace("{k}", "3")).automata[0].name == "one"
    assert [code for code, _, _ in findings(text.replace("{k}", "4"))] == ["TA007"]


def test_constants_can_be_set_from_outside():
    text = "const int N = 1 automaton T(const int[1,N] i) { location a start a }"
    assert len(loads_network(text, constants={"N": 3}).automata) == 3
    with pytest.raises(ModelError, match="no constant `M`"):
        loads_network(text, constants={"M": 3})


A = "automaton A { location a start a } "


@each(
    ("text", "code"),
    [
        ("automaton A { location }", "TA001"),
        ("automaton A { location a start a edge a a }", "TA001"),
        ("unit 5 parsecs " + A, "TA001"),
        ("clock x automaton A { location a invariant z <= 3 start a }", "TA002"),
        (A + "system B", "TA002"),
        (A + "query: E<> A.c", "TA002"),
        ("clock x, x " + A, "TA003"),
        ("automaton A { location a location a start a }", "TA003"),
        ("automaton A { location a start a edge a -> a when true when true }", "TA003"),
        ("int[0,1] v automaton A { location a start a edge a -> a on v! }", "TA004"),
        ("chan c int[0,1] v = c " + A, "TA004"),
        (A + "query: E<> A", "TA004"),
        (A + "query: E<> A == 1", "TA004"),
        ("automaton Q { location a start a } A = Q() system A query: E<> Q", "TA004"),
        ("int v " + A, "TA005"),
        ("int v automaton A { location a start a edge a -> a when v == 1 do v = 0 }", "TA005"),
        ("int[0,1] v const int N = v " + A, "TA006"),
        ("int[0,1] v = 2 " + A, "TA007"),
        ("int[3,1] v " + A, "TA007"),
        ("const int N = 1, M = N[0] " + A, "TA004"),
        ("const int N[2] = {1, 2}, M = N[2] " + A, "TA007"),
        ("clock x, y automaton A { location a start a edge a -> a when x + y < 3 }", "TA008"),
        ("clock x automaton A { location a invariant x >= 1 start a }", "TA014"),
        ("clock x automaton A { location a invariant x < 1 or x > 2 start a }", "TA009"),
        ("clock x int[0,1] v automaton A { location a start a edge a -> a do v = x }", "TA009"),
        (
            "clock x urgent chan c "
            "automaton A { location a start a edge a -> a when x > 1 on c! edge a -> a on c? }",
            "TA011",
        ),
        ("automaton A { location a }", "TA013"),
        ("automaton T(const int[0,1] i) { location a start a } B = T(1, 2) system B", "TA015"),
        ("automaton A { location a start a edge a -> a when f(1) }", "TA002"),
        ("automaton A { location a start a edge a -> a weight 0.0 }", "TA017"),
        ("int[0,1] v[1000000] " + A, "TA019"),
        (A + "query: A<> (E<> A.a)  query: true -->[<=3] (A.a --> A.a)", "TA001"),
        ("", "TA021"),
        # Text that starts no declaration.
        *((text, "TA001") for text in ("t,b", '"', "x", "=1")),
        # The error is the `= 3`, not the name that is a keyword in UPPAAL only.
        *(
            (
                f"automaton A {{ location {word} start {word} edge {word} -> {word} do = 3 }}",
                "TA001",
            )
            for word in ("do", "for", "priority", "E")
        ),
    ],
)
def test_each_mistake_has_its_code(text, code):
    assert [found[0] for found in findings(text)] == [code]


MISTAKEN = """clock x, x
int v
automaton A {
  location a invariant y <= 3
  start b
  edge a -> c when x - x < 2
  edge a -> a do w = 1
}"""


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (MISTAKEN, "3:1:10 5:2:1 2:4:24 2:5:9 2:6:13 2:7:18"),
        # An error of a template is reported once, not per instance.
        ("automaton T(const int[1,10] i) { location a start b }", "2:1:51"),
    ],
)
def test_all_findings_come_at_once_in_order_of_place(text, found):
    places = [tuple(map(int, one.split(":"))) for one in found.split()]
    assert findings(text) == [(f"TA{code:03}", line, column) for code, line, column in places]


@pytest.mark.slow
def test_exactly_the_damaged_lines_are_reported():
    for seed in range(15):
        rng = random.Random(seed)
        lines = ["clock x", "automaton A {", "  location a", "  start a"]
        lines += ["  edge a -> a when x > 1 do x = 0"] * 12 + ["}", "query: E<> A.a"]
        damaged = sorted(rng.sample(range(4, 15), rng.randint(1, 4)))
        for row in damaged:
            lines[row] = rng.choice(["  edge a -> a when x > > 1", "  edge a -> a do x = ) 0"])
        assert [line for _, line, _ in findings("\n".join(lines))] == [row + 1 for row in damaged]


def test_a_channel_used_by_nobody_is_a_warning():
    network = loads_network("""
    chan lonely, sent, heard
    broadcast chan radio
    automaton A {
      location a start a
      edge a -> a on sent!
      edge a -> a on heard?
      edge a -> a on radio!
    }
    """)
    told = [(w.code, w.message.split(":")[0], w.spans[0].span.text) for w in network.warnings]
    assert told == [
        ("TA010", "the channel `lonely` is never used", "lonely"),
        ("TA010", "the channel `sent` is never received", "sent"),
        ("TA010", "the channel `heard` is never sent", "heard"),
    ]


def test_a_value_outside_its_range_is_an_error_only_if_a_run_reaches_it():
    text = """clock x int[0,2] v automaton A { location a invariant x <= 1 start a
    edge a -> a when x >= 1 do v = v + 1, x = 0 }"""
    (diagnostic,) = findings_of(verify, loads_network(text), "A[] v <= 2")
    assert diagnostic.code == "TA007"
    assert "set to 3, outside [0, 2]" in diagnostic.message
    assert diagnostic.spans[0].span.text == "v"
    assert verify(loads_network(text.replace("x <= 1", "x < 1")), "A[] v <= 2").holds


def test_unreadable_files_are_findings(tmp_path):
    with pytest.raises(ModelError, match="No such file"):
        load_network(tmp_path / "missing.ta")
    (tmp_path / "binary.ta").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ModelError, match="is not text"):
        load_network(tmp_path / "binary.ta")


@pytest.mark.parametrize("guard", ["1 / v > 0", "1 % v > 0"])
def test_a_division_by_zero_has_its_place(guard):
    text = f"int[0,3] v automaton A {{ location a start a edge a -> a when {guard} }}"
    (found,) = findings_of(verify, loads_network(text), "A[] A.a")
    assert found.code == "TA007"
    assert found.spans[0].span.text == guard.removesuffix(" > 0")


@each(
    ("text", "bound"),
    [
        ("p imply q imply r", "(p imply q) imply r"),
        ("p imply q or r imply s", "((p imply q) or r) imply s"),
        ("p or q && r", "p or (q && r)"),
        ("not p && q", "(not p) && q"),
        ("not v == 1", "not (v == 1)"),
        ("p and q ? r : s", "(p and q) ? r : s"),
        ("p ? q : r ? s : p", "p ? q : (r ? s : p)"),
        ("p imply forall (i : int[0,1]) q imply r", "p imply (forall (i : int[0,1]) (q imply r))"),
        ("p && !forall (i : int[0,1]) q || r", "p && !(forall (i : int[0,1]) (q || r))"),
        ("EF p && q", "(EF p) && q"),
    ],
)
def test_operators_bind_as_those_of_uppaal(text, bound):
    """In UTAP's grammar `imply` and `or` share one left-associative level, below `and`."""
    network = loads_network("bool p, q, r, s int[0,3] v automaton A { location l start l }")
    assert (
        query_on(network, f"E<> ({text})")[1].formula
        == query_on(network, f"E<> ({bound})")[1].formula
    )


@each(
    ("text", "said"),
    [
        ("clock speed automaton A { location a invariant spede <= 3 start a }", "mean `speed`?"),
        ("int v " + A, "unbounded-int"),
        ("int v " + A, "int[low, high]"),
        ("automaton my-name { location l start l }", "first a letter: `my_name`"),
        ("automaton a { location l-1 start l }", "first a letter: `l_1`"),
        ("automaton a { location 1st start l }", "first a letter: `st`"),
        # Meaningless priorities.
        ("chan a chan priority a < a " + A, "a second priority"),
        ("chan a, b chan priority a < b " + A, "without `default`"),
        ("chan a chan priority a < default chan priority default " + A, "a second list"),
        ("int[0,1] a chan priority a < default " + A, "not a channel"),
        ("int[0,1] i chan a[2] chan priority a[i] < default " + A, "not a channel"),
        ("chan priority a < default " + A, "no name `a`"),
    ],
)
def test_a_finding_suggests_what_was_meant(text, said):
    (diagnostic,) = findings_of(loads_network, text)
    assert said in f"{diagnostic.name}: {diagnostic.message} ({diagnostic.help})"

"""Automata in the HOA format: valid, complete, deterministic, least, and right."""

from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lark import Lark, Transformer
from tests.tools.build import requirement, spec_of, start
from tests.tools.generate_ltl import random_ltl
from tests.tools.ltl3 import Tableau

from rvmon import loads
from rvmon.errors import RvmonError
from rvmon.export.hoa import hoa
from rvmon.monitor import compile_spec
from rvmon.spec.checked.specification import TimeModel

pytestmark = pytest.mark.law

GRAMMAR = Lark(
    r"""
    automaton: "HOA:" "v1" header* "--BODY--" state* "--END--"
    ?header: "States:" INT -> states
        | "Start:" INT -> start
        | "AP:" INT STRING* -> ap
        | "Acceptance:" INT ACC -> acceptance
        | "acc-name:" WORD -> name
        | "name:" STRING -> name
        | "tool:" STRING STRING? -> name
        | "properties:" WORD+ -> name
    state: "State:" INT STRING? marks? edge*
    marks: "{" INT* "}"
    edge: "[" expr "]" INT
    ?expr: conj ("|" conj)* -> any_of
    ?conj: atom ("&" atom)* -> all_of
    ?atom: "t" -> true | "f" -> false | INT -> ap_true | "!" INT -> ap_false
        | "(" expr ")"
    ACC: "Inf(0)" | "t"
    WORD: /[a-zA-Z][\w-]*/
    %import common.INT
    %import common.ESCAPED_STRING -> STRING
    %import common.WS
    %ignore WS
    """,
    start="automaton",
)


class Conditions(Transformer):
    """Label expressions as functions of the set of true propositions."""

    def any_of(self, parts):
        return lambda letter: any(part(letter) for part in parts)

    def all_of(self, parts):
        return lambda letter: all(part(letter) for part in parts)

    def true(self, _):
        return lambda _: True

    def ap_true(self, found):
        return lambda letter: int(found[0]) in letter

    def ap_false(self, found):
        return lambda letter: int(found[0]) not in letter


class Read:
    """A HOA text, read by the grammar above."""

    def __init__(self, text):
        tree = Conditions().transform(GRAMMAR.parse(text))
        parts = {part.data: part.children for part in tree.children if part.data != "state"}
        self.propositions = [str(name)[1:-1] for name in parts["ap"][1:]]
        assert int(parts["ap"][0]) == len(self.propositions)
        self.start = int(parts["start"][0])
        self.names, self.edges = {}, {}
        for state in tree.find_data("state"):
            number = int(state.children[0])
            self.names[number] = str(state.children[1])[1:-1]
            self.edges[number] = [
                (edge.children[0], int(edge.children[1])) for edge in state.find_data("edge")
            ]
            marked = any(True for _ in state.find_data("marks"))
            assert marked is (self.names[number] == "P")
        assert sorted(self.names) == list(range(int(parts["states"][0])))

    @property
    def letters(self):
        count = len(self.propositions)
        return [
            frozenset(place for place, here in enumerate(truths) if here)
            for truths in product((False, True), repeat=count)
        ]

    def after(self, state, letter):
        [target] = [target for holds, target in self.edges[state] if holds(letter)]
        return target

    def run(self, word):
        state = self.start
        for letter in word:
            indices = frozenset(n for n, p in enumerate(self.propositions) if p in letter)
            state = self.after(state, indices)
        return self.names[state]

    def classes(self):
        block = dict(self.names)
        while True:
            finer = {
                state: (block[state], *(block[self.after(state, x)] for x in self.letters))
                for state in self.names
            }
            if len(set(finer.values())) == len(set(block.values())):
                return len(set(block.values()))
            number = {look: n for n, look in enumerate(dict.fromkeys(finer.values()))}
            block = {state: number[look] for state, look in finer.items()}


def compiled(formula):
    spec = spec_of(requirement(formula, upon=start), time=TimeModel.SAMPLED)
    return compile_spec(spec).requirements["R"]


@settings(max_examples=40, deadline=None)
@given(data=st.data())
def test_random_formulas(data):
    """Every word leads where the tableau says; no two states are alike; letters lead one way."""

    class Drawn:
        def randint(self, a, b, /):
            return data.draw(st.integers(a, b))

    formula = random_ltl(Drawn(), data.draw(st.integers(1, 3)))
    one = compiled(formula)
    if one.automaton is None:
        return
    read = Read(hoa(one))
    for state in read.names:
        for letter in read.letters:
            read.after(state, letter)  # exactly one
    assert read.classes() == len(read.names)
    if not set(read.propositions) <= set("pqr"):
        return  # a combination of signals is one proposition there
    tableau = Tableau(formula)
    word = data.draw(st.lists(st.frozensets(st.sampled_from("pqr")), min_size=1, max_size=5))
    possible = tableau.possible(word)
    wanted = "?" if len(possible) == 2 else "P" if True in possible else "F"
    assert read.run(word) == wanted


def test_text_of_propositions_is_quoted():
    """Labels are numbers, propositions strings with their quotes escaped."""
    spec = loads(
        'spec s\nsignal mode : {idle, busy}\nrequirement R1 "a \\"b\\""\n'
        "  upon start\n  then eventually mode == busy\n"
    )
    text = hoa(compile_spec(spec.checked).requirements["R1"])
    assert Read(text).propositions == ["mode == busy"]
    assert text.startswith("HOA: v1\n")


def test_windows_of_time_are_refused():
    """HOA has no clocks; the message says what to do."""
    spec = loads('spec s\nevent e\nrequirement R1 "x"\n  upon start\n  then within 3 s e\n')
    with pytest.raises(RvmonError, match="windows of time, which HOA cannot express"):
        hoa(compile_spec(spec.checked).requirements["R1"])


def test_states_that_differ_only_where_something_is_unknown_are_one():
    """Of `p <-> eventually always p` nothing is ever decided: one state is enough."""
    spec = loads(
        "spec s\nsignal p : bool\nrequirement R\n  upon start\n  then p iff eventually always p\n"
    )
    assert "States: 1\n" in hoa(compile_spec(spec.checked).requirements["R"])

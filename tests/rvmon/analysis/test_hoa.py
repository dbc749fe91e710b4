"""Automata in the HOA format: valid, complete, deterministic, least, and right."""

import re
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lark import Lark, Transformer
from tests.tools.build import requirement, spec_of, start
from tests.tools.ltl3 import Tableau
from tests.tools.random_specs import random_ltl

from rvmon import loads
from rvmon.analysis.hoa import hoa
from rvmon.errors import RvmonError
from rvmon.language.checked.specification import TimeModel
from rvmon.language.print import format_formula
from rvmon.monitor.compiled_spec import compile_spec

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

    def classes(self, letters):
        """The number of states that words of these letters distinguish, by marking pairs."""
        pairs = [(one, other) for one in self.names for other in self.names if one < other]
        apart = {pair for pair in pairs if self.names[pair[0]] != self.names[pair[1]]}
        while True:
            more = {
                (one, other)
                for one, other in pairs
                for x in letters
                if tuple(sorted((self.after(one, x), self.after(other, x)))) in apart
            }
            if more <= apart:
                break
            apart |= more
        return sum(all((one, it) in apart for one in range(it)) for it in self.names)

    def reached(self, letters):
        """The states that words of these letters reach."""
        found = [self.start]
        for state in found:
            found += [to for x in letters if (to := self.after(state, x)) not in found]
        return set(found)


def written(spec, name="R"):
    """A requirement in the HOA format."""
    return hoa(compile_spec(spec).requirements[name], spec)


def drawn_formula(data):
    """An untimed formula of future operators."""

    class Drawn:
        def randint(self, a, b, /):
            return data.draw(st.integers(a, b))

    return random_ltl(Drawn(), data.draw(st.integers(1, 3)))


@settings(max_examples=40, deadline=None)
@given(data=st.data())
def test_random_formulas(data):
    formula = drawn_formula(data)
    spec = spec_of(requirement(formula, upon=start), time=TimeModel.SAMPLED)
    if compile_spec(spec).requirements["R"].automaton is None:
        return
    read = Read(written(spec))
    for state in read.names:
        for letter in read.letters:
            read.after(state, letter)  # exactly one
    assert read.classes(read.letters) == len(read.reached(read.letters)) == len(read.names)
    if not set(read.propositions) <= set("pqr"):
        return  # a combination of signals is one proposition in the file
    tableau = Tableau(formula)
    word = data.draw(st.lists(st.frozensets(st.sampled_from("pqr")), min_size=1, max_size=5))
    possible = tableau.possible(word)
    wanted = "?" if len(possible) == 2 else "P" if True in possible else "F"
    assert read.run(word) == wanted


def test_states_that_differ_only_where_something_is_unknown_are_one():
    """`p <-> eventually always p` is never decided: one state is enough."""
    spec = loads(
        "spec s\nsignal p : bool\nrequirement R\n  upon start\n  then p iff eventually always p\n"
    )
    assert "States: 1\n" in written(spec.checked)


LIMITS = ("x > 1", "x > 2", "x > 3")
VALUES = (0.5, 1.5, 2.5, 3.5)
REQUIRED = dict(zip("pqr", LIMITS, strict=True))


@settings(max_examples=40, deadline=None)
@given(data=st.data())
def test_letters_that_cannot_be(data):
    required = format_formula(drawn_formula(data))
    text = re.sub(r"\b[pqr]\b", lambda found: f"({REQUIRED[found[0]]})", required)
    when = data.draw(st.sampled_from(("start", *LIMITS)))
    spec = loads(
        f"spec s\ntime sampled\nsignal x : real\nrequirement R\n  upon {when} then {text}\n"
    )
    try:
        read = Read(written(spec.checked))
    except RvmonError:
        return
    if not all(re.fullmatch(r"x > \d", name) for name in read.propositions):
        return  # a combination of comparisons is one proposition in the file
    holding = {
        value: frozenset(
            place for place, name in enumerate(read.propositions) if value > float(name[-1])
        )
        for value in VALUES
    }
    letters = [*holding.values()]
    assert read.classes(letters) == len(read.names)
    values = data.draw(st.lists(st.sampled_from(VALUES), min_size=1, max_size=6))
    monitor, state, decided = spec.monitor(), None, None
    for t, value in enumerate(values):
        if state is None and (when == "start" or value > float(when[-1])):
            state = read.start
        state = state if state is None else read.after(state, holding[value])
        for attempt in monitor.step_ns(t, {"x": value}):
            decided = decided or (attempt.number == 1 and attempt.verdict.value) or None
        if decided is not None:
            assert read.names[state] == decided

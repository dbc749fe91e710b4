"""`monitor as written`: universal CTL properties on single runs, and what is refused."""

import random

import pytest
from tests.tools.each import each
from tests.tools.findings import findings_of
from tests.tools.ltl3 import Tableau

from rvmon import loads
from rvmon.errors import SpecError
from rvmon.language.check.ctl import linear_form
from rvmon.language.checked.formula import Binary, BinaryOp, SignalAtom, Unary, UnaryOp
from rvmon.language.checked.properties import (
    PathBinary,
    PathUnary,
    StateAtom,
    StateBinary,
    StateNot,
)
from rvmon.language.checked.specification import TimeModel
from rvmon.language.compile import compile_text
from rvmon.language.print import format_formula
from rvmon.language.rules import Refusal

HEAD = "spec s\ntime sampled\nsignal a, b, c : bool\n"


def parts(text, head=HEAD):
    spec = loads(f"{head}requirement R1\n  monitor as written\n  property {text}")
    one = spec.requirements["R1"]
    return one.mode.value, format_formula(one.trigger), format_formula(one.consequent)


LINEAR = {
    "A[] (a -> AF b)": ("whenever", "a", "eventually b"),
    "a --> b": ("whenever", "a", "eventually b"),
    "a -->[0, 3 s] b": ("whenever", "a", "within 3 s b"),
    "AG AF a": ("whenever", "true", "eventually a"),
    "A<> a": ("upon", "start", "eventually a"),
    "A[ ] not (E[] a)": ("whenever", "true", "eventually not a"),
    "A[a U b]": ("upon", "start", "a until b"),
    "A[(a and AF c) U (not a and AF b)]": (
        "upon",
        "start",
        "(a and eventually c) until (not a and eventually b)",
    ),
    "(a and AF b) or (not a and AG c)": (
        "upon",
        "start",
        "(a and eventually b) or not a and always c",
    ),
    "not EF (a and EG b)": ("whenever", "true", "not a or eventually not b"),
    "AG (a -> AX b)": ("whenever", "a", "next b"),
}


@each("text", LINEAR)
def test_properties_of_single_runs_are_monitored(text):
    assert parts(text) == LINEAR[text]


REFUSED = {
    "AF AG a": "means something else on all paths together",
    "A[a U AF b]": "means something else on all paths together",
    "AG EF a": "`EF a` refers to one of several paths",
    "E<> a": "refers to one of several paths",
    "(AF a) or (AG b)": "leaves open which of the two",
    "AG (a <-> AF b)": "refers to one of several paths",
    "AG (arm.moving -> AF a)": "`arm.moving` reads a clock or location of a model",
}


@each("text", REFUSED)
def test_other_properties_are_refused_with_a_reason(text):
    """RV054 marks the part that is not linear."""
    [finding] = findings_of(parts, text)
    assert finding.code == "RV054"
    assert REFUSED[text] in finding.message


@pytest.mark.parametrize("text", ["AF[2 s, 5 s] AG a", "AG EF[1 s, 2 s] a", "E<>[1 s, 2 s] AG a"])
def test_the_advice_is_not_refused_in_turn(text):
    [finding] = findings_of(parts, text)
    assert finding.help.endswith("does not decide a window that opens later either")


def test_monitor_needs_a_property():
    with pytest.raises(SpecError, match="add a clause `property"):
        loads(f"{HEAD}requirement R1\n  monitor as written")


def test_next_has_no_meaning_in_held_time():
    with pytest.raises(SpecError, match="RV034"):
        parts("AG (a -> AX b)", HEAD.replace("sampled", "held"))


# Compared with the definitions on random structures.


def random_property(rng, depth):
    """A universal property as text, linear or not."""
    if depth == 0 or rng.random() < 0.15:
        return rng.choice(["a", "b", "not a", "not b", "(a and b)", "(a or not b)"])
    below = [random_property(rng, depth - 1) for _ in range(2)]
    forms = ("({} and {})", "({} or {})", "({} -> {})", "A[{} U {}]", "A[{} W {}]", "A[{} R {}]")
    unary = ("AG {}", "AF {}", "AX {}", "not EF not {}")
    guarded = ("A[(a and {}) U (not a and {})]", "((a and {}) or (not a and {}))")
    form = rng.choice((*forms, *unary, *unary, *guarded))
    return "(" + form.format(*(f"({part})" for part in below)) + ")"


def holds_everywhere(structure, state):
    """The states in which a CTL formula is true, by fixed points of its operators."""
    labels, after = structure
    worlds = frozenset(labels)

    def fixed(found, step):
        while (more := step(found)) != found:
            found = more
        return found

    def pre(found, universal=True):
        quantified = all if universal else any
        return frozenset(w for w in worlds if quantified(one in found for one in after[w]))

    def of(node):
        match node:
            case StateAtom(formula=formula):
                return frozenset(w for w in worlds if _true(formula, labels[w]))
            case StateNot(operand=operand):
                return worlds - of(operand)
            case StateBinary(op=op, left=left, right=right):
                one, two = of(left), of(right)
                if op is BinaryOp.AND:
                    return one & two
                return (one if op is BinaryOp.OR else worlds - one) | two
            case PathUnary(universal=universal, op=op, operand=operand):
                inner = of(operand)
                if op is UnaryOp.NEXT:
                    return pre(inner, universal)
                if op is UnaryOp.EVENTUALLY:
                    return fixed(frozenset(), lambda found: inner | pre(found, universal))
                return fixed(worlds, lambda found: inner & pre(found, universal))
            case PathBinary(op=op, left=left, right=right):
                one, two = of(left), of(right)
                if op is BinaryOp.RELEASE:
                    return fixed(worlds, lambda found: two & (one | pre(found)))
                begin = frozenset() if op is BinaryOp.UNTIL else worlds
                return fixed(begin, lambda found: two | (one & pre(found)))

    return of(state)


def _true(formula, label):
    match formula:
        case SignalAtom(name=name):
            return name in label
        case Unary(operand=operand):
            return not _true(operand, label)
        case Binary(op=op, left=left, right=right):
            one, two = _true(left, label), _true(right, label)
            return one and two if op is BinaryOp.AND else two or one is (op is BinaryOp.OR)


def on_all_paths(structure, tableau):
    """The states of a structure from which no path violates a formula."""
    labels, after = structure
    nodes = [
        (world, state)
        for world, label in labels.items()
        for state in tableau.states
        if state.letter == frozenset(label) & frozenset(tableau.names)
    ]
    graph = {
        (world, state): [
            one for one in nodes if one[0] in after[world] and one[1] in tableau.after[state]
        ]
        for world, state in nodes
    }
    live = tableau.lasting(graph, of=lambda node: node[1])
    broken = {world for world, state in live if not tableau.begins(state)}
    return frozenset(labels) - broken


def random_structure(rng):
    worlds = range(rng.randint(2, 4))
    labels = {w: "".join(name for name in "ab" if rng.random() < 0.5) for w in worlds}
    after = {w: rng.sample(list(worlds), rng.randint(1, 2)) for w in worlds}
    return labels, after


@pytest.mark.law
@pytest.mark.parametrize("seed", range(4))
def test_a_structure_has_the_property_iff_all_its_runs_fulfil_the_formula(seed):
    rng = random.Random(seed)
    linear = refused = 0
    while linear < 25:
        text = random_property(rng, 2)
        checked, _ = compile_text(f"{HEAD}property P1: {text}")
        property_ = checked.properties["P1"]
        try:
            formula = linear_form(property_, property_.span, TimeModel.SAMPLED)
        except Refusal:
            refused += 1
            continue
        tableau = Tableau.of(formula, 5)
        if tableau is None or not tableau.temporal:
            continue
        linear += 1
        for _ in range(15):
            structure = random_structure(rng)
            wanted = holds_everywhere(structure, property_.formula)
            assert on_all_paths(structure, tableau) == wanted, (text, structure)
    assert refused > 5

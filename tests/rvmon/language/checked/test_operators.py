"""The table of operators and functions agrees with the grammar, the law and the reference."""

from itertools import product
from pathlib import Path

import pytest

import rvmon
from rvmon.language.checked.classify import subformulas
from rvmon.language.checked.formula import Binary, Interval, SignalAtom, Unary
from rvmon.language.checked.functions import FUNCTIONS, Argument
from rvmon.language.checked.operators import OPERATORS, BinaryOp, UnaryOp, Window
from rvmon.language.checked.rewrite import rewritten
from rvmon.language.print import format_formula

PAGE = (Path(__file__).parents[4] / "docs" / "reference" / "language.md").read_text("utf-8")
LETTERS = {
    Argument.FORMULA: "φ",
    Argument.DURATION: "D",
    Argument.NUMBER: "x",
    Argument.WHOLE: "n",
    Argument.SIGNAL: "x",
    Argument.SOURCE: "x",
}
BASIS = {
    *(UnaryOp.NOT, UnaryOp.NEXT, UnaryOp.PREVIOUS),
    *(BinaryOp.AND, BinaryOp.OR, BinaryOp.UNTIL, BinaryOp.SINCE),
}
SIGNALS = (SignalAtom("p"), SignalAtom("q"))


def formula_of(op, operands=SIGNALS):
    """A formula with the operator over signals, and an interval if it takes one."""
    window = None if op.entry.window is Window.NONE else Interval(0, 2)
    if isinstance(op, UnaryOp):
        return Unary(op, operands[0], window)
    return Binary(op, *operands, window)


def test_the_reference_lists_all_operators():
    """Each has a row with its words, signs and meaning."""
    for op in [op for op in OPERATORS if not op.entry.called]:
        word, *others = op.spellings
        form = f"{word} φ" if isinstance(op, UnaryOp) else f"φ {word} ψ"
        signs = ", ".join(f"`{other}`" for other in others).replace("|", "\\|")
        assert f"| `{form}` | {signs} | {op.entry.doc} |".replace("|  |", "| |") in PAGE


def test_the_reference_lists_all_functions():
    for function in FUNCTIONS.values():
        arguments = [LETTERS[argument] for argument in function.arguments]
        if arguments[:2] == ["x", "x"]:
            arguments = list("xyzw"[: len(arguments)])
        form = f"{function.name}({', '.join([*arguments, *(['…'] if function.more else [])])})"
        assert f"| `{form}` | {function.doc} |" in PAGE


def test_expansions_use_basic_operators_only():
    """The expansion of an operator contains only basic ones."""
    for op in OPERATORS:
        parts = subformulas(rewritten(formula_of(op)))
        assert {part.op for part in parts if isinstance(part, Unary | Binary)} <= BASIS


def verdicts_of(formulas):
    """The verdicts of formulas on all short runs of two signals."""
    body = "".join(
        f"requirement R{n}\n  upon rise(once[1 ns, 1 ns] true)\n  then {format_formula(formula)}\n"
        for n, formula in enumerate(formulas)
    )
    spec = rvmon.loads(f"spec s\ntime sampled\nsignal p, q : bool\n{body}")
    letters = list(product((False, True), repeat=2))
    for word in product(letters, repeat=4):
        samples = [(t, {"p": p, "q": q}) for t, (p, q) in enumerate(word)]
        yield [verdict.value for verdict in spec.evaluate(samples).verdicts.values()]


@pytest.mark.law
@pytest.mark.parametrize("op", OPERATORS, ids=lambda op: op.name)
def test_an_expansion_means_the_same(op):
    formula = formula_of(op)
    pair = [formula, rewritten(formula)]
    assert all(one == other for one, other in verdicts_of(pair))


@pytest.mark.law
@pytest.mark.parametrize("op", [op for op in OPERATORS if op.entry.dual], ids=lambda op: op.name)
def test_duals_are_negations(op):
    denied = tuple(Unary(UnaryOp.NOT, signal) for signal in SIGNALS)
    dual = type(op).of(op.entry.dual)
    pair = [Unary(UnaryOp.NOT, formula_of(op)), formula_of(dual, denied)]
    assert all(one == other for one, other in verdicts_of(pair))
    assert dual.entry.dual == op.value
    assert dual.entry.tense is op.entry.tense

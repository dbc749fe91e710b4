"""Rules on grammar, brackets, and the size of a specification.

Depth, size and cost refer to expressions with expanded macros.
"""

from __future__ import annotations

from dataclasses import replace

from msgspec import Struct

from rvmon.diagnostics import Diagnostic, Severity, Span
from rvmon.language.rules import MOST, Breach, Refusal, Reported, Rule, finding, short

SYNTAX = Rule("RV001", "syntax", Severity.ERROR)
REACH = Rule("RV002", "reach-of-operator", Severity.ERROR)
MIXED_CHAIN = Rule("RV003", "mixed-chain", Severity.ERROR)
COMPARISON_CHAIN = Rule("RV004", "comparison-chain", Severity.ERROR)
TOO_DEEP = Rule("RV005", "too-deep", Severity.ERROR)
TOO_MANY = Rule("RV006", "too-many-findings", Severity.ERROR)
EMPTY = Rule("RV007", "empty-file", Severity.WARNING)


def reach(operator: Span, operand: Span, end: Span) -> Diagnostic:
    """An operator that may apply to its operand alone, or to everything up to `end`."""
    head = short(operator.text)
    near = short(operand.text)
    rest = Span(end.source, operand.end, end.end)
    far = short(operand.to(end).text)
    return finding(
        REACH,
        f"`{head}` can be read in two ways here",
        operator.to(operand),
        fix=f"write `{head} ({far})` or `({head} {near}) {short(rest.text)}`",
    )


def two_sides(whole: Span, operator: Span, connective: Span, near: Span) -> Diagnostic:
    """`a unless b and c`: the connective may join all of `a unless b` or only its operand `near`.

    `whole` is `a unless b` and `operator` is `unless`.
    """
    first, second = short(operator.text), short(connective.text)
    is_after = connective.start >= whole.end
    text, side = short(whole.text), short(near.text)
    other = f"{first} ({side} {second} …)" if is_after else f"(… {second} {side}) {first}"
    alone = f"({text}) {second} …" if is_after else f"… {second} ({text})"
    return finding(
        REACH,
        f"`{first}` next to `{second}` can be read in two ways here",
        whole,
        connective,
        fix=f"write `… {other}` or `{alone}`" if is_after else f"write `{other} …` or `{alone}`",
    )


mixed_chain = Breach(
    MIXED_CHAIN,
    "`{1}` and `{0}` in one chain need brackets",
    "put brackets around the part that belongs together",
)
"""Two different operators of the `until` family in one chain.

Arguments: the places of the second and the first operator, and the text of the first.
"""


def comparison_chain(left: Span, first: str, middle: Span, second: str, right: Span) -> Diagnostic:
    """A chain of comparisons, `a <= b <= c`."""
    texts = [short(span.text) for span in (left, middle, right)]
    return finding(
        COMPARISON_CHAIN,
        "comparisons cannot be chained",
        left.to(right),
        fix=f"write `{texts[0]} {first} {texts[1]} and {texts[1]} {second} {texts[2]}`",
    )


too_deep = Breach(
    TOO_DEEP, "this is nested more than {1} levels deep", "split it into several requirements"
)
too_large = Breach(
    TOO_DEEP,
    "this has more than {1:,} operators once its macros are expanded",
    "split it into several requirements",
)
too_much_work = Breach(
    TOO_DEEP,
    "the macros of this file expand to more than can be checked",
    "use macros without parameters where you can: they are expanded once",
)
empty_file = Breach(
    EMPTY,
    "there is nothing in this file: no signal, no requirement",
    "`rvmon init DATA` writes a first specification from a recording",
)


def too_many(*, broken: bool) -> Diagnostic:
    """The note at the end of a list of findings that was cut; an error if one of them is."""
    message = f"only the first {MOST} findings are shown"
    breach = finding(TOO_MANY, message, fix="fix these first")
    return breach if broken else replace(breach, severity=Severity.WARNING)


DEEPEST = 100  # deeper nesting is refused
LARGEST = 5_000  # formulas with more operators are refused

BUDGET = 20_000
"""Operators to which a file may expand, plus `PER_CHARACTER` for each of its characters."""

PER_CHARACTER = 5


class Cost(Struct, frozen=True):
    """The levels of nesting and the number of operators of an expression."""

    depth: int
    size: int


class Effort:
    """Limits the size of formulas and the total work for a file of so many `characters`."""

    def __init__(self, characters: int) -> None:
        self._depth = self._deepest = self._size = 0
        self._refused = False
        self._rest = BUDGET + PER_CHARACTER * characters

    def restart(self) -> None:
        """Start to count a new formula."""
        self._size = 0
        self._refused = False

    def enter(self, span: Span) -> None:
        """Count an operator and descend to its operands; `leave` must be called in any case.

        Raises:
            Refusal: there are too many operators, or they are nested too deeply.
            Reported: this has already been reported for the formula or the file.
        """
        self._depth += 1
        self._deepest = max(self._deepest, self._depth)
        self.add(Cost(0, 1), span)
        self.spend(1, span)

    def leave(self) -> None:
        """Return from the operands of an operator."""
        self._depth -= 1

    def spend(self, work: int, span: Span) -> None:
        """Take work off the budget of the file.

        Raises:
            Refusal: the budget is used up now.
            Reported: the budget was used up before.
        """
        if self._rest < 0:
            raise Reported
        self._rest -= work
        if self._rest < 0:
            raise Refusal(too_much_work(span))

    def mark(self) -> Cost:
        """Start to measure a part; the result is for `since`."""
        mark = Cost(self._deepest, self._size)
        self._deepest = self._depth  # so that it becomes the deepest level of the part alone
        return mark

    def since(self, mark: Cost) -> Cost:
        """The cost of everything since the mark."""
        cost = Cost(self._deepest - self._depth, self._size - mark.size)
        # The part is taken out of the size again, as the caller adds it for each use.
        self._deepest, self._size = max(mark.depth, self._deepest), mark.size
        return cost

    def add(self, cost: Cost, span: Span) -> None:
        """Count an expression at the current level.

        Raises:
            Refusal: the formula is now too large or too deep.
            Reported: it was reported before that the formula is too large.
        """
        self._size += cost.size
        if self._refused:
            raise Reported
        if self._depth + cost.depth > DEEPEST:
            raise Refusal(too_deep(span, DEEPEST))
        if self._size > LARGEST:
            self._refused = True
            raise Refusal(too_large(span, LARGEST))

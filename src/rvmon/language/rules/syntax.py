"""Rules on how a specification is written: grammar, brackets, and its size.

Depth, size and cost are those of expressions with their macros expanded.
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
    """The operator can be read as reaching over its operand alone or on to `end`."""
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
    """`a unless b and c`: the connective may belong to its neighbour `near` alone."""
    first, second = short(operator.text), short(connective.text)
    behind = connective.start >= whole.end
    text, side = short(whole.text), short(near.text)
    other = f"{first} ({side} {second} …)" if behind else f"(… {second} {side}) {first}"
    alone = f"({text}) {second} …" if behind else f"… {second} ({text})"
    return finding(
        REACH,
        f"`{first}` beside `{second}` can be read in two ways here",
        whole,
        connective,
        fix=f"write `… {other}` or `{alone}`" if behind else f"write `{other} …` or `{alone}`",
    )


mixed_chain = Breach(
    MIXED_CHAIN,
    "`{1}` and `{0}` in one chain need brackets",
    "put brackets around the part that belongs together",
)
"""Two different operators of the `until` family: the places of second and first, and the first."""


def comparison_chain(left: Span, first: str, middle: Span, second: str, right: Span) -> Diagnostic:
    """`a <= b <= c`."""
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
    """The end of a long list of findings: an error where one of them is."""
    message = f"only the first {MOST} findings are shown"
    breach = finding(TOO_MANY, message, fix="fix these first")
    return breach if broken else replace(breach, severity=Severity.WARNING)


DEEPEST = 100  # deeper nesting is refused
LARGEST = 5_000  # formulas with more operators are refused

BUDGET = 20_000
"""A file may expand to this and `PER_CHARACTER` operators for each of its characters."""

PER_CHARACTER = 5


class Cost(Struct, frozen=True):
    """Levels and operators of an expression."""

    depth: int
    size: int


class Effort:
    """Counts what is evaluated, and refuses what is too much of it; a long file may do more."""

    def __init__(self, characters: int) -> None:
        self._depth = self._deepest = self._size = 0
        self._refused = False
        self._rest = BUDGET + PER_CHARACTER * characters

    def begin(self) -> None:
        """A new formula starts."""
        self._size = 0
        self._refused = False

    def enter(self, span: Span) -> None:
        """An operator's operands follow; `leave` has to be called in any case.

        Raises:
            Refusal: there are too many, or they are nested too deeply.
            Reported: that has been reported of this formula or file.
        """
        self._depth += 1
        self._deepest = max(self._deepest, self._depth)
        self.add(Cost(0, 1), span)
        self.spend(1, span)

    def leave(self) -> None:
        """The operands are through."""
        self._depth -= 1

    def spend(self, work: int, span: Span) -> None:
        """Take work off the budget of the file.

        Raises:
            Refusal: it is used up now.
            Reported: it was used up before.
        """
        if self._rest < 0:
            raise Reported
        self._rest -= work
        if self._rest < 0:
            raise Refusal(too_much_work(span))

    def mark(self) -> Cost:
        """Start to measure what follows."""
        mark = Cost(self._deepest, self._size)
        self._deepest = self._depth
        return mark

    def since(self, mark: Cost) -> Cost:
        """The cost since the mark, without that of the mark."""
        cost = Cost(self._deepest - self._depth, self._size - mark.size)
        self._deepest, self._size = max(mark.depth, self._deepest), mark.size
        return cost

    def add(self, cost: Cost, span: Span) -> None:
        """Count an expression here.

        Raises:
            Refusal: it is too much.
            Reported: that has been reported of this formula.
        """
        self._size += cost.size
        if self._refused:
            raise Reported
        if self._depth + cost.depth > DEEPEST:
            raise Refusal(too_deep(span, DEEPEST))
        if self._size > LARGEST:
            self._refused = True
            raise Refusal(too_large(span, LARGEST))

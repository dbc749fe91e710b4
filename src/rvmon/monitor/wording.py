"""Causes and obligations in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rvmon.dataflow.flow import Flow
from rvmon.formula.core import Constant, Core, Literal, Release, Sense, Until
from rvmon.formula.lower import Origin
from rvmon.formula.progress import after, value
from rvmon.formula.residual import NO_CLOCK, Residual
from rvmon.formula.state import FALSE, TRUE, UNKNOWN
from rvmon.monitor.cause import Cause
from rvmon.monitor.sentence import Base, LastWith, Place, Sentence
from rvmon.spec.checked import Formula, Unary, UnaryOp
from rvmon.spec.printer import format_duration, format_formula
from rvmon.trace.time import format_ticks
from rvmon.verdict.attempt import Blame

_APART = 50
"""Instants that are so many binary digits apart are told from each other."""


class Words:
    """Names the parts of one requirement as its text does.

    Args:
        origins: where its core formulas come from.
    """

    def __init__(self, origins: Mapping[Core, Origin]) -> None:
        self._origins = dict(origins)
        for node, origin in origins.items():
            opened = node.opened if isinstance(node, Until | Release) else None
            if opened is not None:
                self._origins.setdefault(opened, origin)
        self._windows = {
            node.opened: node
            for node in origins
            if isinstance(node, Until | Release) and node.opened and node.opened not in origins
        }

    def formula(self, node: Core) -> Formula | None:
        """The formula of the spec that a node stands for; `None` if none does."""
        origin = self._origins.get(node)
        if origin is None:
            return None
        return origin.formula if origin.positive else Unary(UnaryOp.NOT, origin.formula)

    def text(self, node: Core) -> str:
        """A node as text of the spec."""
        formula = self.formula(node)
        return "what is owed" if formula is None else format_formula(formula)

    def window(self, node: Until | Release) -> tuple[int, int | None]:
        """The window of a node, in ticks after its start; of an opened one as it was before."""
        whole = self._windows.get(node, node)
        return whole.low, whole.high

    def sentence(self, cause: Cause, verdict: bool) -> Sentence:
        """One sentence about a decision and all that have this cause."""
        node, decided = cause.node, Place(Base.DECISION)
        if isinstance(node, Literal):
            return (f"{self._named(node, verdict)} at ", decided)
        if cause.over:
            return self._window_over(node)
        if cause.literal is None:
            return (f"`{self.text(node)}` {_decided(verdict)} at ", decided)
        named = self._named(cause.literal, verdict)
        if isinstance(node, Until):
            if verdict:
                return (f"{named} ", Place(Base.AGE), " after ", Place(Base.START))
            return (f"{named} at ", decided, f", before `{self.text(node.right)}`")
        if verdict:
            return (f"{named} at ", decided, ", which ends what was owed")
        if not isinstance(node.left, Constant):
            return (f"{named} at ", decided)
        return (f"{named} ", Place(Base.AGE), f" into {self._kept(node, cause)}")

    def _kept(self, node: Release, cause: Cause) -> str:
        """What was to be kept up, in two words: `never-for-2 s`, `always`."""
        origin = self._origins.get(cause.literal) if cause.literal else None
        never = origin is not None and not self._is_positive(origin)
        first, last = self.window(node)
        if last is None:
            return "never" if never else "always"
        span = f"for-{format_duration(last)}"
        if first > 0:
            span = f"from-{format_duration(first)}-{span}"
        return f"never-{span}" if never else span

    def _is_positive(self, origin: Origin) -> bool:
        formula, positive = origin.formula, origin.positive
        while isinstance(formula, Unary) and formula.op is UnaryOp.NOT:
            formula, positive = formula.operand, not positive
        return positive

    def _named(self, literal: Literal, verdict: bool) -> str:
        """The proposition that decided, with its truth where that is not plain."""
        origin = self._origins.get(literal)
        if origin is None:
            return "a proposition"
        formula, positive = origin.formula, origin.positive
        while isinstance(formula, Unary) and formula.op is UnaryOp.NOT:
            formula, positive = formula.operand, not positive
        return f"`{format_formula(formula)}`" + ("" if positive is verdict else " false")

    def _window_over(self, node: Until | Release) -> Sentence:
        low, high = self.window(node)
        last = Place(Base.DECISION) if high is None else Place(Base.START, high)
        window = ("window [", Place(Base.START, low), ", ", last)
        right = node.right
        if isinstance(node, Release):
            return (*window, f"] over, `{self.text(right)}` throughout")
        if not isinstance(right, Literal):
            return (*window, f"] closed without `{self.text(right)}`")
        seen = LastWith(right.proposition, TRUE if right.sense is Sense.TRUE else FALSE)
        return (*window, f"] closed, `{self.text(right)}` last true: ", seen)

    def blame(self, cause: Cause, t: int, start: int, flow: Flow) -> Blame:
        """What failed at `t`, instantiated at `start`."""
        node = cause.node
        formula = self.formula(node)
        span = None if formula is None else formula.span
        if span is None and isinstance(formula, Unary):
            span = formula.operand.span
        window: tuple[int, int | None] = (t, t)
        if isinstance(node, Until | Release):
            low, high = self.window(node)
            window = (start + low, None if high is None else start + high)
        at: tuple[int, ...] = ()
        if cause.literal is not None:
            at = (flow.since[flow.graph.index[cause.literal.proposition]],)
        first, last = (0, 0) if span is None else (span.start, span.end)
        return Blame(self.text(node), first, last, window, at)

    def owed(self, residual: Residual, anchors: Sequence[int]) -> str:
        """What a residual still asks for, as text of the spec."""
        clauses = []
        for clause in sorted(residual, key=lambda c: (len(c), sorted((n.id, x) for n, x in c))):
            parts = [
                self._with_deadline(node, anchors, clock)
                for node, clock in sorted(clause, key=lambda atom: (atom[1], atom[0].id))
            ]
            clauses.append(all_of(parts))
        return ", or ".join(dict.fromkeys(clauses))

    def told(self, residual: Residual) -> tuple[str, int | None]:
        """All that people are told of a residual, for clocks that were started at any time."""
        clocks = {clock for clause in residual for _, clock in clause if clock != NO_CLOCK}
        anchors = [clock << _APART for clock in range(max(clocks, default=-1) + 1)]
        return self.owed(residual, anchors), deadline(residual, anchors)

    def _with_deadline(self, node: Core, anchors: Sequence[int], clock: int) -> str:
        text = f"`{self.text(node)}`"
        if clock == NO_CLOCK or not isinstance(node, Until | Release) or node.high is None:
            return text
        last = anchors[clock] + node.high
        return f"{text} {'by' if isinstance(node, Until) else 'to'} {format_ticks(last)}"


def all_of(parts: Sequence[str]) -> str:
    """Parts that are all owed: none twice, nor without its deadline where it stands with one.

    >>> all_of(["`p`", "`q` by 7 s", "`q`"])
    '`p` and `q` by 7 s'
    """
    kept = dict.fromkeys(part for part in parts if part)
    dated = tuple(part.rpartition(word)[0] for part in kept for word in (" by ", " to "))
    return " and ".join(part for part in kept if part not in dated)


def settled_alone(residual: Residual, anchors: Sequence[int]) -> tuple[int, bool] | None:
    """What time alone makes of what is owed, and the last instant before; `None` if nothing."""
    ends = {
        anchors[clock] + node.high
        for clause in residual
        for node, clock in clause
        if clock != NO_CLOCK and isinstance(node, Until | Release) and node.high is not None
    }
    for last in sorted(ends):
        found = value(after(residual, [last + 1 - anchor for anchor in anchors]))
        if found != UNKNOWN:
            return last, found == TRUE
    return None


def deadline(residual: Residual, anchors: Sequence[int]) -> int | None:
    """The last instant before time alone settles what is owed; see `Attempt`."""
    found = settled_alone(residual, anchors)
    return None if found is None else found[0]


def _decided(verdict: bool) -> str:
    return "came true" if verdict else "came false"

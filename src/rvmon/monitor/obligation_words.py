"""Puts causes of decisions and open obligations into words that quote the specification."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache

from msgspec import Struct

from rvmon.language.checked.classify import has_future, is_pulse
from rvmon.language.checked.formula import Amount, EventAtom, Formula, Unary, UnaryOp
from rvmon.language.print import format_formula
from rvmon.logic.formula import Constant, Core, Literal, Release, Sense, Until
from rvmon.logic.normal_form import Origin
from rvmon.logic.progress import after, value
from rvmon.logic.residual import NO_CLOCK, Residual
from rvmon.logic.state_formula import FALSE, TRUE, UNKNOWN
from rvmon.monitor.cause import Cause, Moment
from rvmon.trace.time import format_instant, format_ticks
from rvmon.verdicts.attempt import Blame

_APART = 50
"""Shift that keeps the anchors of different clocks, and so their deadlines, distinct in labels."""


class _Atom(Struct, frozen=True):
    """A required proposition, with the phrases for it in sentences."""

    quoted: str  # its text
    positive: bool  # whether it is required to be true, not false
    is_event: bool  # whether it is an event, which occurs rather than being true
    lasting: bool  # whether the required value can last longer than single instants

    def truth(self, right: bool) -> str:
        """The required truth value (`right`), or the other one."""
        return "true" if self.positive is right else "false"

    def was(self, right: bool) -> str:
        """The same in the past tense, as an observation."""
        if self.is_event:
            return "occurred" if self.positive is right else "did not occur"
        return f"was {self.truth(right)}"

    def had_to(self, verb: str) -> str:
        """The requirement as a clause, with the verb `be` or `stay`."""
        if self.is_event:
            return "it had to occur" if self.positive else "it was not to occur"
        return f"it had to {verb} {self.truth(True)}"

    @property
    def kept(self) -> str:
        """The clause that it had the required value all along."""
        return self.was(True) if self.is_event else f"stayed {self.truth(True)}"

    @property
    def due(self) -> str:
        """The clause that the required value had to come up."""
        if self.is_event:
            return "had to occur" if self.positive else "had to be absent"
        return "had to come true" if self.positive else "had to become false"

    @property
    def been(self) -> str:
        """The participle for when it last had the required value, as in "it had never occurred"."""
        if self.is_event and self.positive:
            return "occurred"
        return "been absent" if self.is_event else f"been {self.truth(True)}"


class Words:
    """Puts the parts of one requirement into words.

    A part is quoted as the formula it originates from, or as the whole consequent if it has none.
    """

    def __init__(self, origins: Mapping[Core, Origin], consequent: Formula) -> None:
        self._origins = dict(origins)
        self._consequent = consequent
        # Cached, as the same few parts explain many attempts.
        self.text = cache(self._text)
        self._atom = cache(self._found_atom)
        self._looks_ahead = cache(self._found_ahead)
        # An operator whose window has opened is quoted like the one that it derives from.
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
        """The formula of the specification that is the origin of a node; `None` if it has none."""
        origin = self._origins.get(node)
        if origin is None:
            return None
        return origin.formula if origin.positive else Unary(UnaryOp.NOT, origin.formula)

    def _text(self, node: Core) -> str:
        """The text of a node in the specification language."""
        return format_formula(self.formula(node) or self._consequent)

    def window(self, node: Until | Release) -> tuple[int, int | None]:
        """The window of a node in ticks after its start; for an opened node, the original one."""
        whole = self._windows.get(node, node)
        return whole.low, whole.high

    def sentence(self, cause: Cause, verdict: bool, moment: Moment) -> str:
        """The sentence that explains a decision with this cause."""
        node = cause.node
        if cause.over and not isinstance(node, Literal):
            return self._window_over(node, moment)
        at = f"at {moment.instant(moment.t)}"
        if cause.literal is None or cause.literal not in self._origins:
            became = "was fulfilled" if verdict else "could no longer be fulfilled"
            return f"{self._quoted(node)} {became} {at}"
        atom = self._atom(cause.literal)
        if verdict:
            return f"{atom.quoted} {atom.was(True)} {at}{self._in_time(node, moment)}"
        seen = f"{atom.was(False)} {at}"
        if not atom.is_event and atom.lasting:
            text = atom.quoted.strip("`")
            seen = moment.turned(cause.literal.proposition, text, atom.truth(False))
        return f"{atom.quoted} {seen}{self._required(node, atom, moment)}"

    def _in_time(self, node: Literal | Until | Release, moment: Moment) -> str:
        """The clause after a literal that came true and so ended an obligation."""
        if isinstance(node, Literal):
            return ""
        if isinstance(node, Release):
            return "; after that no obligation was left"
        high, start = self.window(node)[1], moment.start
        due = "" if high is None else f"; it was due by {moment.instant(start + high)}"
        return f", {format_ticks(moment.t - start)} after {moment.instant(start)}{due}"

    def _required(self, node: Literal | Until | Release, atom: _Atom, moment: Moment) -> str:
        """The clause after a literal that failed: what was required of it, and when."""
        if isinstance(node, Literal):
            return f"; {atom.had_to('be')} then"
        low, high = self.window(node)
        stay = f"{moment.after_trigger}; {atom.had_to('stay')}"
        last = "" if high is None else moment.instant(moment.start + high)
        if isinstance(node, Until):
            due = f", due by {last}" if last else ""
            return f"{stay} until {self._quoted(node.right)}{due}"
        if not self._looks_ahead(node):  # a `whenever` or `always` around it
            all_along = " at all times" if isinstance(node.left, Constant) else " then"
            return f"; {atom.had_to('be')}{all_along}"
        if not isinstance(node.left, Constant):
            return f"{stay} until {self._quoted(node.left)}"
        from_ = f" from {moment.instant(moment.start + low)}"
        if high is None:
            return f"{stay}{from_} on"
        if low == high:
            return f"{moment.after_trigger}; {atom.had_to('be')} at {last}"
        return f"{stay} until {last}" if not (low or atom.is_event) else f"{stay}{from_} to {last}"

    def _window_over(self, node: Until | Release, moment: Moment) -> str:
        low, high = self.window(node)
        first = moment.instant(moment.start + low)
        last = moment.instant(moment.t if high is None else moment.start + high)
        right = node.right
        atom = self._atom(right) if isinstance(right, Literal) else None
        if isinstance(node, Release):
            held = "held" if atom is None else atom.kept
            named = self._quoted(right) if atom is None else atom.quoted
            return f"{named} {held} from {first} to {last}"
        window = f"at {last}" if low == high else f"between {first} and {last}"
        if atom is None or not isinstance(right, Literal):
            return f"{self._quoted(right)} had to come true {window}, and did not"
        value = TRUE if right.sense is Sense.TRUE else FALSE
        seen = moment.last_with(right.proposition, value, atom.been, lasting=atom.lasting)
        return f"{atom.quoted} {atom.due} {window}, and did not; {seen}"

    def _quoted(self, node: Core) -> str:
        return f"`{self.text(node)}`"

    def _found_ahead(self, node: Core) -> bool:
        formula = self.formula(node)
        return formula is not None and has_future(formula)

    def _found_atom(self, literal: Literal) -> _Atom:
        """The required proposition of a literal."""
        origin = self._origins.get(literal)
        if origin is None:
            return _Atom("a proposition", literal.sense is Sense.TRUE, False, True)
        formula, positive = origin.formula, origin.positive
        while isinstance(formula, Unary) and formula.op is UnaryOp.NOT:
            formula, positive = formula.operand, not positive
        if isinstance(formula, Amount) and not positive:
            formula, positive = Unary(UnaryOp.NOT, formula), True  # prints the negated comparison
        quoted, is_event = f"`{format_formula(formula)}`", isinstance(formula, EventAtom)
        return _Atom(quoted, positive, is_event, not (positive and is_pulse(formula)))

    def blame(self, cause: Cause, moment: Moment) -> Blame:
        """The obligation that failed."""
        node, t, start = cause.node, moment.t, moment.start
        formula = self.formula(node) or self._consequent
        span = formula.span
        if span is None and isinstance(formula, Unary):
            span = formula.operand.span
        window: tuple[int, int | None] = (t, t)
        if isinstance(node, Until | Release):
            low, high = self.window(node)
            window = (start + low, None if high is None else start + high)
            if high is None and node in self._windows and not isinstance(node.left, Constant):
                window = (t, None)  # opened instances are merged: the first may have been released
        at: tuple[int, ...] = ()
        if cause.literal is not None:
            at = (moment.flow.since(cause.literal.proposition),)
        first, last = (0, 0) if span is None else (span.start, span.end)
        return Blame(self.text(node), first, last, window, at)

    def required(self, residual: Residual, anchors: Sequence[int], origin: int) -> str:
        """A residual in words, with deadlines; `anchors` are the start instants of its clocks."""
        clauses = []
        for clause in sorted(residual, key=lambda c: (len(c), sorted((n.id, x) for n, x in c))):
            parts = [
                self.dated(node, None if clock == NO_CLOCK else anchors[clock], origin)
                for node, clock in sorted(clause, key=lambda atom: (atom[1], atom[0].id))
            ]
            clauses.append(all_of(parts))
        return ", or ".join(dict.fromkeys(clauses))

    def label(self, residual: Residual) -> tuple[str, int | None]:
        """A key that residuals share if they are reported alike, whenever their clocks started."""
        clocks = {clock for clause in residual for _, clock in clause if clock != NO_CLOCK}
        anchors = [clock << _APART for clock in range(max(clocks, default=-1) + 1)]
        return self.required(residual, anchors, 0), deadline(residual, anchors)

    def dated(self, node: Core, start: int | None, origin: int) -> str:
        """A part in quotes, with its deadline if it has one; `start` is its start in ticks."""
        if start is None or not isinstance(node, Until | Release) or node.high is None:
            return self._quoted(node)
        word = "by" if isinstance(node, Until) else "until"
        return f"{self._quoted(node)} {word} {format_instant(start + node.high, origin)}"


def all_of(parts: Sequence[str]) -> str:
    """A conjunction in words, without repetitions; a part with a deadline absorbs the one without.

    >>> all_of(["`p`", "`q` by 7 s", "`q`"])
    '`p` and `q` by 7 s'
    """
    kept = dict.fromkeys(part for part in parts if part)
    dated = {f"{part.rpartition(word)[0]}`" for part in kept for word in ("` by ", "` until ")}
    return " and ".join(part for part in kept if part not in dated)


def settled_alone(residual: Residual, anchors: Sequence[int]) -> tuple[int, bool] | None:
    """The last instant (ticks) before time alone decides a residual, and the value it then has.

    `None` if time alone never decides it.
    """
    ends = {
        anchors[clock] + node.high
        for clause in residual
        for node, clock in clause
        if clock != NO_CLOCK and isinstance(node, Until | Release) and node.high is not None
    }
    for last in sorted(ends):
        truth = value(after(residual, [last + 1 - anchor for anchor in anchors]))
        if truth != UNKNOWN:
            return last, truth == TRUE
    return None


def deadline(residual: Residual, anchors: Sequence[int]) -> int | None:
    """The last instant before time alone decides a residual; see `Attempt.deadline`."""
    settled = settled_alone(residual, anchors)
    return None if settled is None else settled[0]

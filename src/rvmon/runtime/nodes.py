"""The state formulas and inputs of a generated monitor: what they are, and when they change."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

from rvmon.runtime.past import History, Since, beyond, doubt, within
from rvmon.runtime.timers import Timers
from rvmon.runtime.values import FALSE, NEVER, TRUE, UNKNOWN

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    Pairs = tuple[tuple[int, int], ...]

LIMIT = 1 << 62
BUSY = LIMIT + 1
"""Stands for the instant after which samples are taken, while one is: none is after it."""
MISSING = object()


class Nodes(Timers):
    """Values of state formulas; the generated part fills in the constants below.

    Formulas that are only part of one other have no value of their own.

    Args:
        absent: the names without a source.

    Attributes:
        v: per node, its truth.
        since: per node of a letter, the position from which on it has had its value.
        until: per node of a letter and truth, the last position at which it had that before.
        s: per signal, its value; `None` if it is unknown.
        births: per signal, 0 before its first known value, 1 from then on, 2 after an update more,
            where something depends on that.
        o: per event, whether it occurs at this position.
        p: per event, its payloads.
        w: per node, what it remembers, taking the unknown for the worse.
        b: the same, taking it for the better: the same object, if that is equal.
        clerk: hears which signals are not known.
        growing: whether more bits may come to stand in `grown`.
        grown: a bit for each part of what is generated that takes the signals to have been born.
        position: that the values are of.
        dirty: the nodes that may have changed since.
        fading: the nodes that speak of that position only.
    """

    __slots__ = (
        "absent",
        "b",
        "before",
        "births",
        "c",
        "clerk",
        "dirty",
        "expired",
        "fading",
        "first",
        "gathered",
        "growing",
        "grown",
        "h",
        "marked",
        "momentary",
        "o",
        "origin",
        "p",
        "position",
        "s",
        "silent",
        "since",
        "u",
        "until",
        "v",
        "w",
    )

    STATE: tuple[str, ...] = (
        *("v", "since", "until", "s", "last", "first", "o", "p", "u", "c", "h", "w", "b", "marked"),
        *("origin", "before", "gathered", "wake", "wakes", "queued", "stale_at", "expired"),
        *("timers", "births", "growing", "grown", "dirty", "fading"),
    )
    VARIED = ("w", "b")

    SIGNALS: tuple[str, ...] = ()
    EVENTS: tuple[str, ...] = ()
    GAP: int | None = 1
    KEPT = 0
    """A bit for each node that has a value."""
    EVALUATE: tuple[Callable[[Any, int], int] | None, ...] = ()
    PARENTS: tuple[int, ...] = ()
    """Per node, a bit for each node whose value depends on it."""
    LETTERS: tuple[int, ...] = ()
    """Per node, a bit for each requirement whose letter it is part of."""
    TRIGGERS: tuple[int, ...] = ()
    """Per node, a bit for each requirement that it triggers."""
    READERS: Mapping[str, int]
    """Per name, a bit for each leaf that reads it."""
    MOMENTARY: tuple[tuple[int, tuple[str, ...]], ...] = ()
    """The leaves that speak of one position, with the names of which one has to have a source."""
    BEFORE: tuple[int, ...] = ()
    """Per node, its value before the first position."""
    MEMORY: tuple[int | None, ...] = ()
    """Per node, what it remembers before the first position."""
    MARKED: Mapping[int, tuple[int, int | None]]
    """Per node that keeps stretches of time, its bounds."""
    HISTORIES: tuple[int, ...] = ()
    GROWING: tuple[tuple[int, Pairs], ...] = ()
    """Bits of `grown`, each with the nodes that have to have come to the value they keep."""

    clerk: Any

    def __init__(self, absent: frozenset[str] = frozenset()) -> None:
        self.absent = absent

    def clear(self) -> None:
        """Know nothing."""
        absent = self.absent
        self.v = list(self.BEFORE)
        self.since = [0] * self.NODES
        self.until: list[int | None] = [None] * (3 * self.NODES)
        self.s: list[Any] = [None] * len(self.SIGNALS)
        self.last = (MISSING,) * len(self.SIGNALS)
        self.first: list[int | None] = [None] * len(self.SIGNALS)
        self.silent = [UNKNOWN if name in absent else FALSE for name in self.EVENTS]
        self.o = list(self.silent)
        self.p: list[list[Any]] = [[] for _ in self.EVENTS]
        self.births = [0] * len(self.SIGNALS)
        self.u: set[str] = set()
        self.c: dict[int, int] = {}
        self.h = [History() if index in self.HISTORIES else None for index in range(len(self.s))]
        self.w = list(self.MEMORY)
        self.b = list(self.MEMORY)
        gap = self.GAP or 1
        self.marked = {place: Since(low, high, gap) for place, (low, high) in self.MARKED.items()}
        self.momentary = 0
        for place, needs in self.MOMENTARY:
            if not needs or not absent.issuperset(needs):
                self.momentary |= 1 << place
        self.origin: int | None = None
        self.before = 0
        self.gathered = False
        self.wake = -LIMIT
        self.wakes = [NEVER] * self.NODES
        self.queued = [NEVER] * self.NODES
        self.stale_at = [NEVER] * len(self.SIGNALS)
        self.expired: dict[int, tuple[int, int]] = {}
        self.timers: list[tuple[int, int]] = []
        self.grown = 0
        self.growing = bool(self.GROWING)
        self.position = 0
        self.dirty = 0
        self.fading = 0

    @property
    def last(self) -> tuple[Any, ...]:
        """Per signal, its value; `MISSING` if it is unknown: nothing that a sample brings is that.

        Each is an attribute of the generated part, `last` and the number of the signal.
        """
        return tuple([getattr(self, f"last{signal}") for signal in range(len(self.SIGNALS))])

    @last.setter
    def last(self, values: Sequence[Any]) -> None:
        for signal, value in enumerate(values):
            setattr(self, f"last{signal}", value)

    # Positions.

    def enter(self, t: int) -> None:
        """Go to just before the first position, at `t`, where all nodes are to be evaluated."""
        self.origin = t
        self.position = t - (self.GAP or 1)
        self.since[:] = [t] * self.NODES
        self.dirty = self.KEPT

    def evaluate(self, t: int, dirty: int) -> tuple[int, int, int]:
        """Evaluate nodes and what depends on them.

        Returns the requirements of which the letter changed, those of which the trigger changed,
        and the nodes to evaluate again at the next position.
        """
        letters = triggers = fading = 0
        v, since, until = self.v, self.since, self.until
        functions = self.EVALUATE
        momentary = self.momentary
        while dirty:
            bit = dirty & -dirty
            dirty ^= bit
            place = bit.bit_length() - 1
            new = functions[place](self, t)  # type: ignore[misc]
            if new and bit & momentary:
                fading |= bit
            old = v[place]
            if new != old:
                own = self.LETTERS[place]
                if own:
                    until[3 * place + old] = self.before
                    since[place] = t
                    letters |= own
                v[place] = new
                dirty |= self.PARENTS[place]
                triggers |= self.TRIGGERS[place]
        return letters, triggers, fading

    def next_change(self) -> int:
        """The first position after this one at which a value can change by time alone."""
        if self.GAP is None or self.origin is None:
            return NEVER
        found = self.next_timer()
        if self.fading:
            found = min(found, self.position + self.GAP)
        if found >= NEVER:
            return NEVER
        return self.position + -(-(found - self.position) // self.GAP) * self.GAP

    # What nodes call.

    def within_(self, place: int, t: int, last: int, left: int, right: int, high: int) -> int:
        """The value of a `since` with an upper bound, over what may be unknown."""
        w, b = self.w, self.b
        w[place], holds, wake = within(w[place], t, last, high, left == TRUE, right == TRUE)
        b[place], may, other = within(b[place], t, last, high, left != FALSE, right != FALSE)
        self.agree(place)
        self.set_wake(place, min(wake, other))
        return TRUE if holds else UNKNOWN if may else FALSE

    def beyond_(self, place: int, t: int, last: int, left: int, right: int, low: int) -> int:
        """The value of a `since` with a lower bound, over what may be unknown."""
        w, b = self.w, self.b
        w[place], holds, wake = beyond(w[place], t, last, low, left == TRUE, right == TRUE)
        b[place], may, other = beyond(b[place], t, last, low, left != FALSE, right != FALSE)
        self.agree(place)
        self.set_wake(place, min(wake, other))
        return TRUE if holds else UNKNOWN if may else FALSE

    def agree(self, place: int) -> None:
        """Have both readings of what a node remembers be one object if they are equal."""
        worse, better = self.w[place], self.b[place]
        if worse == better and worse.__class__ is better.__class__:
            self.b[place] = worse

    def grow(self) -> None:
        """See which nodes have come to the values that they keep."""
        v, wakes = self.v, self.wakes
        self.growing = False
        for bit, awaited in self.GROWING:
            if self.grown & bit:
                continue
            if all(v[place] == value and wakes[place] >= NEVER for place, value in awaited):
                self.grown |= bit
            else:
                self.growing = True

    def elapsed_(self, place: int, t: int, duration: int) -> int:
        """Whether so much time has passed since the first position."""
        due = (self.origin or 0) + duration
        self.set_wake(place, due if t < due else NEVER)
        return FALSE if t < due else TRUE

    def uncertain_(self, events: Sequence[int]) -> bool:
        """Whether it is not known of some occurrence of these events, or what it says."""
        return any(
            self.silent[event] == UNKNOWN or any(one is None for one in self.p[event])
            for event in events
        )

    def doubt_(self, place: int, t: int, now: int, pulse: bool, every: bool) -> int:
        """Whether a trigger may have been hidden at `t`, where its truth is `now`."""
        found = doubt(self.w[place] or FALSE, now, self.v[place], pulse, every)
        stays = doubt(now, now, found, pulse, every) == found
        self.set_wake(place, NEVER if stays else t + (self.GAP or 1))
        return found

    def over_(self, events: Sequence[int], truth: Callable[[dict[int, Any]], int]) -> int:
        """The truth of a comparison over all occurrences of the events whose fields it reads."""
        found = FALSE
        silent, occurred = self.silent, self.p
        choices = [[None] if silent[event] == UNKNOWN else occurred[event] for event in events]
        for payloads in product(*choices):
            one = UNKNOWN if None in payloads else truth(dict(zip(events, payloads, strict=True)))
            if one > found:
                found = one
        return found

    # What samples call.

    def occur(self, event: int, value: Any) -> None:
        """Take what a sample says of an event."""
        self.gathered = True
        payloads: tuple[Any, ...]
        if value is True:
            truth, payloads = TRUE, ({},)
        elif value is None:
            truth, payloads = UNKNOWN, (None,)
        elif value is False:
            truth, payloads = FALSE, ()
        elif isinstance(value, (tuple, list)):
            payloads = tuple(value)
            truth = max([UNKNOWN if one is None else TRUE for one in payloads], default=FALSE)
        else:
            truth, payloads = TRUE, (value,)
        self.p[event].extend(payloads)
        if truth > self.o[event]:
            self.o[event] = truth

    def mark(self, t: int, signal: int, value: Any) -> None:
        """Take the update of a signal that more is asked of than its value."""
        self.gathered = True
        self.u.add(self.SIGNALS[signal])
        if self.births[signal] == 1:
            self.births[signal] = 2
        history = self.h[signal]
        if history is not None:
            changed = history.update(t, value)
            self.c[signal] = max(changed, self.c.get(signal, FALSE))

    def leave(self) -> None:
        """Forget what occurred at the position."""
        self.gathered = False
        self.o[:] = self.silent
        for payloads in self.p:
            payloads.clear()
        self.u.clear()
        self.c.clear()

    def found(self, signal: int, t: int) -> None:
        """Note that a signal that was not known has a value."""
        if self.first[signal] is None:
            self.first[signal] = t
        self.clerk.found(self.SIGNALS[signal], t)

    def expire(self, signal: int, t: int) -> int:
        """See `Timers`."""
        name = self.SIGNALS[signal]
        if self.s[signal] is not None:
            self.clerk.lost(name, t, "stale")
        self.s[signal] = None
        setattr(self, f"last{signal}", MISSING)
        count, first = self.expired.get(signal, (0, t))
        self.expired[signal] = (count + 1, first)
        return self.READERS[name]

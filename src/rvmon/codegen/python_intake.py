"""How samples are taken, as Python source: checked first, then only what changed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rvmon.codegen.python_leaf_cases import ConeWriter
from rvmon.codegen.python_values import ValueWriter
from rvmon.codegen.python_visit import VisitWriter, alone, indented
from rvmon.plan.plan import Plan

_WHOLE = 64
"""Up to so many names, samples that hold all of them are taken name by name."""

_PAIRED = 24
"""Up to so many names, a row is searched for a value that alone is another."""


class IntakeWriter:
    """Writes the methods that take samples.

    Args:
        plan: what to judge.
        visit: writes what follows.
        cones: writes what follows if one value alone is another.
        arriving: the names that have a source.
    """

    def __init__(
        self,
        plan: Plan,
        visit: VisitWriter,
        cones: ConeWriter,
        arriving: tuple[str, ...],
    ) -> None:
        self.plan = plan
        self.visit = visit
        self.cones = cones
        self.values = ValueWriter(plan)
        self.arriving = arriving
        self.near = f"t - self.position <= {visit.span()}" if visit.sparse() else ""
        """Whether no stretch of time has a hole before a sample; empty: none ever has."""
        self.whole = 0 < len(arriving) <= _WHOLE
        self.every = [
            line for n, name in enumerate(arriving) for line in self.values.every(f"x{n}", name)
        ]
        """What updates do though their values are the same."""
        self.single = [(n, name) for n, name in enumerate(arriving) if self._is_single(name)]
        """Names whose updates do nothing but bring a value."""

    def functions(self) -> Iterator[str]:
        """What samples do that bring one value."""
        for number, name in self.single:
            yield from self._one(number, name)
            yield ""
            yield ""
        if self.single:
            listed = ", ".join(f"{name!r}: one{number}" for number, name in self.single)
            yield f"ONE = {{{listed}}}"
            yield ""
            yield ""

    def lines(self) -> Iterator[str]:
        """All of them, and the tables that they look up."""
        yield "def step(self, t, values):"
        yield '    """Take one sample; returns what it decided."""'
        # Other mappings may answer what they do not hold.
        yield "    if values.__class__ is dict:"
        yield from indented(self._by_size(), 2)
        yield "    return self.some(t, values)"
        yield ""
        yield from self._some()
        yield ""
        yield from self._take()
        yield ""

    def takers(self) -> Iterator[str]:
        """By name, what is looked at in a sample of which nothing was checked."""
        yield "TAKERS = {"
        for number, name in enumerate((*self.plan.signals, *self.plan.events)):
            if name in self.arriving:
                takes = f"{self.values.classes(name)}, {self.values.labels(name)!r}, take{number}"
                yield f"    {name!r}: ({takes}),"
        yield "}"

    # A sample that holds all names.

    def _by_size(self) -> Iterator[str]:
        """See what a dictionary holds; be done with one that brings one value or nothing new."""
        branch = "if"
        if self.whole:
            yield from self._unpacked()
            if not self.every:
                yield from indented(self._compared())
            yield from indented(self._checked())
            yield from indented(self._whole())
            branch = "elif"
        yield f"{branch} not values:"
        yield f"    if {self._in_order(self._quiet())}:"
        yield from indented([*self.visit.done(), "return ()"], 2)
        if self.single and len(self.arriving) > 1:
            yield "elif len(values) == 1:"
            yield "    if t.__class__ is int:"
            yield "        (name,) = values"
            yield "        one = ONE.get(name)"
            yield "        if one is not None:"
            yield "            return one(self, t, values[name], values)"

    def _unpacked(self) -> Iterator[str]:
        """The values of a row that has all signals; an event that it does not name is not there."""
        numbered = [*enumerate(self.arriving)]
        events = [(n, name) for n, name in numbered if name in self.plan.events]
        signals = [(n, name) for n, name in numbered if name not in self.plan.events]
        every = len(numbered)
        # A row of one name has a way of its own.
        least = max(len(signals), 2) if signals and not self._asks_events() else every
        if least >= every:
            yield f"if len(values) == {every}:"
            signals, events = numbered, []
        else:
            yield f"if {least} <= len(values) <= {every}:"
        yield "    try:"
        yield from indented((f"x{n} = values[{name!r}]" for n, name in signals), 2)
        yield "    except LookupError:"
        yield "        return self.some(t, values)"
        if not events:
            return
        if least == len(signals):
            yield f"    if len(values) == {least}:"
            yield from indented((f"x{n} = False" for n, _ in events), 2)
            yield "    else:"
        named = " + ".join(f"({name!r} in values)" for _, name in events)
        counted = [f"x{n} = values.get({name!r}, False)" for n, name in events]
        counted.append(f"if {named} != len(values) - {len(signals)}:")
        counted.append("    return self.some(t, values)")
        yield from indented(counted, 2 if least == len(signals) else 1)

    def _asks_events(self) -> bool:
        """Whether it matters that a row names an event that does not occur."""
        return any(
            [*self.values.every(f"x{n}", name)]
            for n, name in enumerate(self.arriving)
            if name in self.plan.events
        )

    def _in_order(self, before: str) -> str:
        """Whether a time is whole and later than the one before; it may be beyond the limit."""
        return f"t.__class__ is int and self.after < t and {before}"

    def _checked(self) -> Iterator[str]:
        """Have an invalid time seen to."""
        yield "if t.__class__ is not int or not self.after < t < LIMIT:"
        yield "    return self.clerk.other(t, values)"

    def _compared(self) -> Iterator[str]:
        """Compare a whole row with the one before; go on with a value that alone is another."""
        names = list(enumerate(self.arriving))
        quiet = self._in_order(self._quiet())
        if len(self.single) < len(names) or len(names) > _PAIRED:
            yield f"if {self._same(names)} and {quiet}:"
            yield from indented([*self.visit.done(), "return ()"])
            return
        for number, name in names:
            branch = "elif" if number else "if"
            yield f"{branch} x{number} is not {self.values.before(name)}:"
            rest = names[number + 1 :]
            same = f"{self._same(rest)} and " if rest else ""
            yield f"    if {same}t.__class__ is int:"
            yield f"        return one{number}(self, t, x{number}, values)"
        yield f"elif {quiet}:"
        yield from indented([*self.visit.done(), "return ()"])

    def _same(self, names: Sequence[tuple[int, str]]) -> str:
        return " and ".join(f"x{number} is {self.values.before(name)}" for number, name in names)

    def _whole(self) -> Iterator[str]:
        yield "changed = 0"
        for number, name in enumerate(self.arriving):
            yield from self._noticed(number, name)
        yield from alone(self._updated())
        yield from self.visit.flush()

    def _updated(self) -> Iterator[str]:
        """Take the values of a whole row that `changed`."""
        yield from self._time()
        yield from indented(self._expired())
        yield "dirty = 0"
        yield from self.every
        for number, name in enumerate(self.arriving):
            yield f"if changed & {1 << number}:"
            yield from indented(self.values.new(f"x{number}", name))
        yield from self._after()

    def _expired(self) -> Iterator[str]:
        """After time has passed: what became unknown is another value, though it is the same."""
        for number, name in enumerate(self.arriving):
            signal = self.plan.spec.signals.get(name)
            if signal is not None and signal.stale_after is not None:
                yield f"if self.last{self.plan.signals.index(name)} is MISSING:"
                yield f"    changed |= {1 << number}"

    def _noticed(self, number: int, name: str) -> Iterator[str]:
        """See whether a value is another; refuse what needs a closer look."""
        x = f"x{number}"
        yield f"if {x} is not {self.values.before(name)}:"
        yield f"    if {self.values.is_odd(x, name)}:"
        yield "        return self.clerk.other(t, values)"
        yield f"    changed |= {1 << number}"

    # A sample of one name.

    def _is_single(self, name: str) -> bool:
        """Whether an update does nothing but bring a value."""
        return not list(self.values.every("x", name))

    def _one(self, number: int, name: str) -> Iterator[str]:
        yield f"def one{number}(self, t, x, values):"
        yield f"    # {name!a}"
        yield "    if not self.after < t < LIMIT:"
        yield "        return self.clerk.other(t, values)"
        head = [f"if x is {self.values.before(name)}:", f"    if {self._quiet()}:"]
        head += indented([*self.visit.done(), "return ()"], 2)
        head += [f"elif {self.values.is_odd('x', name)}:", "    return self.clerk.other(t, values)"]
        lines: list[str] = []
        if name in self.plan.signals and self.cones.can_follow(name, self.values.instant):
            kept = self.values.replaced("x", name, "x")
            followed = [*alone(self.cones.followed(name, kept)), *self.visit.flush()]
            lines = [f"elif {self.cones.apart(name, self.near)}:", *indented(followed)]
        general = [*self._time(), "dirty = 0", f"if x is not {self.values.before(name)}:"]
        general += indented(self.values.new("x", name))
        general += self._after()
        yield from indented([*head, *lines, *alone(general), *self.visit.flush()])

    # A sample of any names.

    def _some(self) -> Iterator[str]:
        yield "def some(self, t, values):"
        yield '    """Take a sample of which nothing was checked."""'
        yield "    takers = self.TAKERS"
        yield "    try:"
        yield "        found = [(*takers[name], x) for name, x in values.items()]"
        yield "    except (AttributeError, LookupError, TypeError):"
        yield "        return self.clerk.other(t, values)"
        yield "    for classes, labels, _, x in found:"
        yield "        if x.__class__ not in classes or x != x or (labels and x not in labels):"
        yield "            return self.clerk.other(t, values)"
        yield from indented(self._checked())
        general = [*self._time(), "dirty = 0", "for _, _, take, x in found:"]
        general += ["    dirty |= take(self, t, x)", *self._after()]
        yield from indented([*alone(general), *self.visit.flush()])

    def _take(self) -> Iterator[str]:
        yield "def take(self, t, values):"
        yield '    """Take the updates of a valid sample; time has come to `t` − 1 before."""'
        yield "    for name, x in values.items():"
        yield "        self.dirty |= self.TAKE[name](self, t, x)"
        yield f"    self.{self._go_on}(t)"
        yield from indented(self.visit.done())

    # What all ways share.

    def _quiet(self) -> str:
        """Whether nothing happens at a sample at which nothing changes."""
        return " and ".join(filter(None, ["t < self.wake", self.near]))

    def _time(self) -> Iterator[str]:
        """Let time come to just before the sample."""
        if self.plan.gap is None:
            yield "if self.dues and self.dues[0][0] < t:"
        else:
            yield "if t > self.wake:"
        yield "    self.through(t - 1)"

    def _after(self) -> Iterator[str]:
        """Go on with what changed."""
        yield f"if dirty or not ({self._quiet()}):"
        yield "    self.dirty |= dirty"
        yield f"    self.{self._go_on}(t)"

    @property
    def _go_on(self) -> str:
        return "visit" if self.plan.gap in (None, 1) else "sampled"

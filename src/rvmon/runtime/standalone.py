"""A monitor that runs without rvmon: records, verdicts, the end of a trace."""

from __future__ import annotations

from collections import namedtuple
from typing import TYPE_CHECKING, Any

from rvmon.runtime.nodes import BUSY, LIMIT
from rvmon.runtime.rule import Rule
from rvmon.runtime.table import Table
from rvmon.runtime.unit import Unit
from rvmon.runtime.values import FAILED, PASSED

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

Attempt = namedtuple("Attempt", "requirement number triggered decided verdict decision in_doubt")
"""`decided` is None and `verdict` "I" for what stayed open; instants are nanoseconds. What is
`in_doubt` may have had no trigger: it has numbers of its own."""


class Open:
    """An undecided attempt."""

    __slots__ = ("better", "clouded", "number", "sure", "token", "triggered", "void")

    def __init__(self, number: int, triggered: int, token: Any, sure: bool = True) -> None:
        self.number = number
        self.triggered = triggered
        self.token = token
        self.better: Any = None
        self.sure = sure
        self.void = False
        self.clouded = False


class Monitor:
    """Judges a stream of samples.

    Args:
        absent: names of signals and events without a source: unknown throughout.
    """

    UNIT: type[Unit]
    """The generated class."""
    NAMES: tuple[str, ...] = ()
    """The requirements."""
    TABLES: tuple[Any, ...] = ()
    """Per requirement, the arguments of its table."""
    OUTCOMES: tuple[Sequence[tuple[str, str]], ...] = ()
    """Per requirement what becomes of an undecided attempt, counted through in binary: it holds
    by the rule for the end (1), it can pass no more (2), it can fail no more (4)."""
    KINDS: Mapping[str, Any]
    """Per signal what values it takes: a class, or its labels; per event its fields."""

    def __init__(self, absent: Sequence[str] = ()) -> None:
        machines = [Table(*tables) for tables in self.TABLES]
        self.unit = self.UNIT(machines, frozenset(absent))
        self.unit.after = -LIMIT
        self.reset()

    def reset(self) -> None:
        """Forget the run."""
        self._enter()
        try:
            self.unit.restart(self, [self] * len(self.UNIT.RULES))
            self.unit.after = BUSY  # the call goes on
            self.attempts: list[Attempt] = []
            self.fresh: list[Attempt] = []
            self.counts = [0] * len(self.NAMES)
            self.doubts = [0] * len(self.NAMES)
            self.void: list[tuple[Rule, Open]] = []
            self.last: int | None = None
            self.reached: int | None = None
            self.finished = False
        finally:
            self.unit.after = -LIMIT

    # What the generated code calls.

    def lost(self, name: str, t: int, why: str) -> None:
        """Records have no reasons: since when a signal is not known is not asked for."""

    def found(self, name: str, t: int) -> None:
        """Nor until when."""

    def of(self, rule: Rule) -> int:
        """The requirement that a rule judges."""
        hidden = rule.index - len(self.NAMES)
        return rule.index if hidden < 0 else self.UNIT.HIDDEN_OF[hidden]

    def opened(self, rule: Rule, triggered: int, token: Any, sure: bool) -> Open:
        """A new attempt; `sure`: its trigger was true."""
        counts = self.counts if sure else self.doubts
        index = self.of(rule)
        counts[index] += 1
        return Open(counts[index], triggered, token, sure)

    def assured(self, rule: Rule, attempt: Open) -> None:
        """Hear that the trigger of an attempt was true, which was unknown before."""
        self.counts[rule.index] += 1
        attempt.number = self.counts[rule.index]

    def entered(self, rule: Rule) -> tuple[int, tuple[int, ...]]:
        """The number of a new attempt, and nothing that was seen."""
        self.counts[rule.index] += 1
        return self.counts[rule.index], ()

    def reopened(self, _: Rule, number: int, triggered: int, token: Any, __: Any) -> Open:
        """An attempt that was moved together with others, by itself."""
        return Open(number, triggered, token)

    def decided_in_run(
        self, rule: Rule, number: int, triggered: int, _: Any, verdict: bool, t: int, __: Any
    ) -> None:
        """Hear of the decision of an attempt that was moved together with others."""
        self.decided(rule, Open(number, triggered, None), verdict, t, None)

    def parted(self, rule: Rule, attempt: Open, apart: bool) -> None:
        """Hear that unknown input made the two runs of an attempt part, or that they met."""

    def decided(self, rule: Rule, attempt: Open, verdict: bool, t: int, _: Any) -> None:
        """Hear of a decision."""
        if verdict and attempt.void:
            self.void.append((rule, attempt))
            return
        if not attempt.sure:
            return
        self.unit.news = True
        upon_end = rule.trigger < 0
        at = attempt.triggered if upon_end else t
        self._record(rule, attempt, at, "P" if verdict else "F", "prefix")

    def _record(
        self, rule: Rule, attempt: Open, t: int | None, verdict: str, decision: str
    ) -> None:
        name, doubt = self.NAMES[self.of(rule)], not attempt.sure
        made = Attempt(name, attempt.number, attempt.triggered, t, verdict, decision, doubt)
        self.fresh.append(made)

    def flush(self, t: int) -> list[Attempt]:
        """The records since the last call, after a sample at `t` that the unit took."""
        found = self._flush()
        self.unit.after = t
        return found

    def _flush(self) -> list[Attempt]:
        """The records since the last call, in order."""
        self.unit.news = False
        ranks = {name: rank for rank, name in enumerate(self.NAMES)}
        self.fresh.sort(
            key=lambda one: (
                one.decided is None,
                one.decided or 0,
                ranks[one[0]],
                one.in_doubt,
                one.number,
            )
        )
        found, self.fresh = self.fresh, []
        self.attempts += found
        return found

    def other(self, t: int, values: Mapping[str, Any]) -> Sequence[Attempt]:
        """Take a sample that needs a closer look."""
        after = self._enter()
        try:
            if self.finished:
                raise ValueError("the run is finished: call reset() before the next")
            if t.__class__ is not int or not after < t < LIMIT:
                raise ValueError(f"sample at {t!r}: expected whole nanoseconds, later than {after}")
            if not hasattr(values, "items"):
                raise ValueError(f"sample at {t}: expected values by name, found {values!r}")
            plain = {name: self._plain(name, value) for name, value in values.items()}
            torn, self.unit.torn = self.unit.torn, t
            self.unit.through(t - 1)
            self.unit.take(t, plain)
            self.unit.after = BUSY  # the call goes on
            after = t
            found = self._flush()
            self.unit.torn = torn
            return found
        finally:
            self.unit.after = after

    def _plain(self, name: str, value: Any) -> Any:
        if name not in self.KINDS or name in self.unit.absent:
            raise ValueError(f"no signal or event named {name!r} is expected")
        kind = self.KINDS[name]
        if isinstance(kind, dict):
            if value is None or value is True or value is False:
                return value
            if not isinstance(value, dict) or not set(value) <= set(kind):
                raise ValueError(f"{name}: expected True, False, None or its payload")
            return {
                field: self._scalar(f"{name}.{field}", kind[field], one)
                for field, one in value.items()
            }
        return self._scalar(name, kind, value)

    def _scalar(self, name: str, kind: Any, value: Any) -> Any:
        if value is None or value != value:
            return None
        if isinstance(kind, tuple):
            if value in kind:
                return value
        elif kind is float:
            if isinstance(value, (float, int)) and not isinstance(value, bool):
                return value
        elif value.__class__ is kind:
            return value
        raise ValueError(f"{name}: {value!r} is no value of it")

    # What users call.

    def step(self, t: float, values: Mapping[str, Any]) -> Sequence[Attempt]:
        """Take a sample at `t` seconds; returns the attempts that it decided."""
        return self.unit.step(round(t * 1000000000), values)

    def step_ns(self, t_ns: int, values: Mapping[str, Any]) -> Sequence[Attempt]:
        """Take a sample at whole nanoseconds, later than all before; only what was updated.

        Signals by value, None if one became unknown; events True, or their payload as a dict.
        """
        return self.unit.step(t_ns, values)

    def advance_ns(self, t_ns: int) -> Sequence[Attempt]:
        """Say that no sample before `t_ns` will come."""
        after = self._enter()
        try:
            if self.finished:
                raise ValueError("the run is finished: call reset() before the next")
            self._see(after)
            news = self.reached is None or t_ns > self.reached
            torn, self.unit.torn = self.unit.torn, after
            if news:
                self.unit.advance(t_ns)
                self.reached = t_ns
                after = max(after, t_ns - 1)
            found = self._flush()
            self.unit.torn = torn
            return found
        finally:
            self.unit.after = after

    def _enter(self) -> int:
        """Refuse all other calls until `after` is set again; returns what it was."""
        after = self.unit.after
        if after == BUSY:
            raise RuntimeError(
                "another call of this monitor is under way: give each thread a monitor of its "
                "own, or hold a lock round the calls"
            )
        self.unit.after = BUSY
        return after

    def _see(self, after: int) -> None:
        """Note the last sample, which only the generated code knows of."""
        if after > -LIMIT and (self.reached is None or after > self.reached - 1):
            self.last = self.reached = after

    def finish_ns(self, t_ns: int | None = None) -> dict[str, str]:
        """End the run, at `t_ns` if that is later; returns the verdict of each requirement.

        After a call that was interrupted, what has not failed is I.
        """
        after = self._enter()
        try:
            if not self.finished:
                torn, self.unit.torn = self.unit.torn, after
                self._see(after)
                self.finished, after = True, LIMIT
                if self.last is not None:
                    self._close(t_ns)
                self.unit.torn = torn
        finally:
            self.unit.after = after
        found = {}
        for index, name in enumerate(self.NAMES):
            seen = {one.verdict for one in self.attempts if one.requirement == name}
            if self.unit.torn is None:
                silent = "NT" if self.unit.is_determined(index) else "I"
                found[name] = next((verdict for verdict in "FIP" if verdict in seen), silent)
            else:
                found[name] = "F" if "F" in seen else "I"
        return found

    def _close(self, t_ns: int | None) -> None:
        known = [self.last or 0] if t_ns is None else [self.last or 0, t_ns]
        if self.unit.GAP is not None and self.reached is not None:
            known.append(self.reached - 1)
        end = max(known)
        reached = end if self.reached is None else max(end, self.reached)
        self.unit.through(end)
        self.unit.close(end, reached)
        for rule in self.unit.rules:
            rule.attempts, rule.runs = rule.undecided(), {}
            rule.settle_flags()
            for attempt in rule.attempts:
                held = not attempt.void and rule.machine.holds_at_end(attempt.token, end, reached)
                state = 1 if held else 0
                state += 2 if attempt.void or attempt.token[0] == FAILED else 0
                passes = attempt.better is not None and attempt.better[0] == PASSED
                state += 4 if passes or attempt.clouded or not attempt.sure else 0
                verdict, decision = self.OUTCOMES[self.of(rule)][state]
                if verdict == "P" and not attempt.sure:
                    continue
                at = None if decision == "open" else end
                self._record(rule, attempt, at, verdict, decision)
        for rule, attempt in self.void:
            self._record(rule, attempt, None, "I", "open")
        self._flush()

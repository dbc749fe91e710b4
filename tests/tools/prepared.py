"""The engine `auto` with and without what was compiled ahead: do they say the same of a case?"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from functools import partial
from typing import Any

from rvmon.codegen.c_online import online_library
from rvmon.errors import RvmonError
from rvmon.monitor.attempts.network_judge import NetworkJudge
from rvmon.monitor.c import beside as beside_module
from rvmon.monitor.c.beside import Beside, LendingMonitor, beside, plan_beside
from rvmon.monitor.c.prepared import taken_of
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec, compile_spec
from rvmon.monitor.online.forms import Forms, forms_of
from rvmon.monitor.online.generated import GeneratedEvaluators, GeneratedMonitor
from rvmon.monitor.online.monitor import Monitor
from rvmon.monitor.online.snapshot import document_of, put_back
from rvmon.runtime.values import NEVER
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.testing.case import Case
from rvmon.testing.show import show_case
from rvmon.trace.sample import Sample, Value
from rvmon.verdict.attempt import Attempt


@dataclass(frozen=True, slots=True)
class Pair:
    """A specification in generated Python, and what is compiled to stand beside it.

    Attributes:
        compiled: the specification.
        forms: of Python alone.
        shared: of what C takes, and what it does not.
        own: what is compiled.
    """

    compiled: CompiledSpec
    forms: Forms
    shared: Forms
    own: Beside

    def lending(self, keep: int | None) -> _Counted:
        """What has C beside it; it lends whenever it can."""
        return _Counted(*(self.own, self.shared, *self._how), None, keep)

    def plain(self, keep: int | None, *, shared: bool = False) -> Monitor:
        """Python alone; `shared`: as one that goes on where C has judged."""
        return GeneratedMonitor(
            self.shared if shared else self.forms, *self._how, "now", None, keep
        )

    @property
    def _how(self) -> tuple[CompiledSpec, Sequence[CompiledRequirement], str]:
        return self.compiled, self.compiled.chosen(None), "auto"


def compiled_beside(spec: CheckedSpec) -> Pair | None:
    """Compile a specification; `None` if `auto` takes nothing that is compiled for it."""
    compiled = compile_spec(replace(spec, max_delay=None))
    chosen = compiled.chosen(None)
    taken = {one.requirement.id for one in taken_of(chosen)}
    if not taken:
        return None
    left = compiled.requirements.keys() - taken
    forms, shared = (forms_of(compiled, chosen, None, left=names) for names in ((), left))
    try:
        plan = plan_beside(shared.plan, shared.requirements)
        library = online_library(plan, optimised=False, beside=True)
    except RvmonError:
        return None
    return Pair(compiled, forms, shared, beside(shared, library))


class _Counted(LendingMonitor):
    """Lends whenever it can, and counts what C has taken."""

    taken = 0
    shared = 0

    @property
    def alone(self) -> int:
        """How many samples C has taken alone."""
        return self.taken + self._taken_now() - self.shared

    def _taken_now(self) -> int:
        return int.from_bytes(self._core.take_back()[:8], "little") if self._is_lent else 0

    def _judge(self, t: int, values: Mapping[str, Value]) -> None:
        super()._judge(t, values)
        self.shared += self._is_lent

    def _have_back(self) -> None:
        self.taken += self._taken_now()
        super()._have_back()


def differences(pair: Pair, case: Case, seed: str) -> tuple[list[str], int]:
    """Lead both through a case and ask them at random; what they say otherwise, a line each.

    Args:
        pair: of the specification of the case.
        case: what to tell them.
        seed: of what is asked, and of wrong samples.

    Returns:
        The differences, and how many samples C took.
    """
    rng = random.Random(seed)
    keep = rng.choice((None, None, None, 0, 2))
    lends = rng.choice((1, 1, 3))
    waits = (beside_module._FEW, beside_module._MANY)
    beside_module._FEW = beside_module._MANY = lends
    try:
        run = Run(pair, keep, rng.random() < 0.3)
        is_left_alone = rng.random() < 0.3
        for action in case.actions:
            run.both(partial(_told, action=action))
            if run.found:
                break
            if is_left_alone:
                continue
            for ask in _asked(rng, pair, action):
                run.both(ask)
            if rng.random() < 0.2:
                run.see_next_due()
            if rng.random() < 0.05:
                run.put_away(across=rng.random() < 0.5)
            if run.found:
                break
        run.both(lambda m: _report(m, case.end))
    finally:
        beside_module._FEW, beside_module._MANY = waits
    return ([*run.found, show_case(case)] if run.found else []), run.lending.taken


class Run:
    """Two monitors of a pair, which are told and asked the same."""

    def __init__(self, pair: Pair, keep: int | None, listens: bool) -> None:
        self.pair, self.keep = pair, keep
        self.plain: Monitor = pair.plain(keep)
        self.lending = pair.lending(keep)
        self.found: list[str] = []
        self.heard: tuple[list[str], list[str]] = ([], [])
        if listens:
            self.plain.on_decided(lambda one: self.heard[0].append(_shown(one)))
            self.lending.on_decided(lambda one: self.heard[1].append(_shown(one)))
            self.lending.on_failure(lambda _: self.lending.next_due)

    def both(self, ask: Callable[[Monitor], Any]) -> None:
        """Ask both the same."""
        wanted, got = _answer(self.plain, ask), _answer(self.lending, ask)
        if self.heard[0] != self.heard[1]:
            self.found.append(_apart(self.heard[0], self.heard[1]))
        if repr(wanted) != repr(got):
            self.found.append(_apart(wanted, got))

    def see_next_due(self) -> None:
        """Neither names an instant behind the next decision by time alone.

        That of a network may come in vain, and so may that of requirements that generated Python
        judges only where C judges nothing; else C's comes no sooner than Python's.
        """
        pair, plan = self.pair, self.pair.forms.plan
        has_network = any(rule.automaton is None for rule in plan.rules)
        is_exact = not has_network and not _left(pair) and plan.gap in (None, 1)
        wanted, got = _next_decision(self.plain), self.lending.next_due
        if wanted is not None and (got is None or got > wanted):
            if self._decides_by(wanted if got is None else got - 1):
                self.found.append(f"next due: {got} is later than {wanted}")
        elif is_exact and got != self.plain.next_due:
            self.found.append(f"next due: {got} is sooner than {self.plain.next_due}")

    def _decides_by(self, t: int) -> bool:
        """Whether time alone decides something up to an instant."""
        self.lending.snapshot()  # which drops what is too much
        return bool(self._plain_from(self.plain.snapshot()).advance_ns(t))

    def put_away(self, *, across: bool) -> None:
        """Put both away, and take them up again, perhaps each as the other was.

        C does not go on where generated Python judged together what C leaves to Python.
        """
        plain, lending = self.plain.snapshot(), self.lending.snapshot()
        goes_on = document_of(self.pair.compiled, plain)["left"] == _left(self.pair)
        taken = self.lending.taken
        self.plain = self._plain_from(lending if across else plain)
        self.lending = self.pair.lending(self.keep)
        _put_back(self.pair.compiled, self.lending, plain if across and goes_on else lending)
        self.lending.taken = taken

    def _plain_from(self, data: bytes) -> Monitor:
        """Python alone that goes on from a snapshot, judging as was judged."""
        shared = bool(document_of(self.pair.compiled, data)["left"])
        made = self.pair.plain(self.keep, shared=shared)
        _put_back(self.pair.compiled, made, data)
        return made


def _left(pair: Pair) -> list[str]:
    """What generated Python judges only where C judges nothing."""
    left = pair.shared.left
    return [] if left is None else sorted(one.requirement.id for one in left.requirements)


def _apart(wanted: object, got: object) -> str:
    """Where two texts of the same are no longer alike."""
    texts = repr(wanted), repr(got)
    size = next((n for n, (a, b) in enumerate(zip(*texts, strict=False)) if a != b), 0)
    start = max(size - 150, 0)
    return f"wanted …{texts[0][start : size + 150]}\n   got …{texts[1][start : size + 150]}"


def _put_back(compiled: CompiledSpec, monitor: Monitor, data: bytes) -> None:
    put_back(document_of(compiled, data), monitor.options, monitor.evaluators, monitor)


def _next_decision(monitor: Monitor) -> int | None:
    """The next instant at which time alone decides something, of networks worked out anew."""
    due, evaluators = monitor.next_due, monitor.evaluators
    if due is None or not isinstance(evaluators, GeneratedEvaluators):
        return due
    evaluators.take_along(evaluators.unit.position)
    unit = evaluators.unit
    found = [unit.next_position()]
    for rule in unit.rules:
        is_network = isinstance(rule, NetworkJudge)
        if is_network:
            rule._look(rule.now)  # samples like the last one were but noted
        found.append(rule.next_due if is_network else unit.due_at[rule.index])
    found += [one.next_decision for one in evaluators.all]
    soonest = min(found)
    return max(soonest, due) if soonest < NEVER else None


def _told(monitor: Monitor, action: Sample | int) -> list[str]:
    if isinstance(action, Sample):
        return [*map(_shown, monitor.step_ns(action.t, action.values))]
    return [*map(_shown, monitor.advance_ns(action))]


def _asked(
    rng: random.Random, pair: Pair, action: Sample | int
) -> Iterator[Callable[[Monitor], Any]]:
    """What is asked behind an action."""
    t = action.t if isinstance(action, Sample) else action
    if rng.random() < 0.1:
        yield lambda m: [*map(_shown, m.open)]
    if rng.random() < 0.2:
        yield lambda m: m.verdicts
    if rng.random() < 0.1:
        later = t + rng.choice((0, 1, 2))
        yield lambda m: _told(m, later)
    if rng.random() < 0.1:
        name = rng.choice([*pair.compiled.checked.signals, "nothing"])
        value: Any = rng.choice(["no such", None, [1], float("nan"), 1 << 70])
        at = rng.choice([t, t + 1, t - 1])
        yield lambda m: [*map(_shown, m.step_ns(at, {name: value}))]
    if rng.random() < 0.05:
        yield lambda m: [*map(_shown, m.step_ns(str(t), {}))]  # type: ignore[arg-type]


def _report(monitor: Monitor, end: int | None) -> Any:
    report = monitor.finish_ns(end)
    attempts = [_shown(one) for one in report.attempts]
    others = {
        one.name: getattr(report, one.name)
        for one in fields(report)
        if one.name not in ("attempts", "engine", "dropped")
    }
    dropped = [(name, sorted(counts.items())) for name, counts in report.dropped.items()]
    return attempts, others, sorted(dropped)


def _answer(monitor: Monitor, ask: Callable[[Monitor], Any]) -> Any:
    try:
        return ask(monitor)
    except RvmonError as error:
        return type(error), str(error)


def _shown(attempt: Attempt) -> str:
    with suppress(AttributeError):
        return repr(attempt)
    return "an attempt that cannot be read"

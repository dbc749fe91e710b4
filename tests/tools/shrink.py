"""From a case that shows something to a small one that still shows it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from rvmon.language.checked.formula import (
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    Captured,
    Constant,
    Formula,
    Interval,
    Unary,
)
from rvmon.language.checked.specification import EndPolicy, Mode, Requirement
from rvmon.testing.generate.trace import Case
from rvmon.testing.law.attempts import is_pulse
from rvmon.testing.law.syntax import numerics
from rvmon.trace.sample import Sample


def shrink(case: Case, shows: Callable[[Case], bool], *, most: int = 5_000) -> Case:
    """Take away from a case as long as it still shows what is looked for.

    Greedy: the first smaller case that shows it is taken, until none does. Every step takes
    something away for good, so it ends.
    """
    tried = 0
    while True:
        for candidate in _smaller(case):
            tried += 1
            if tried > most:
                return case
            if shows(candidate):
                case = candidate
                break
        else:
            return case


def _smaller(case: Case) -> Iterator[Case]:
    """Cases one step smaller, the big steps first."""
    requirements = case.spec.requirements
    for name in requirements:
        if len(requirements) > 1:
            kept = {key: value for key, value in requirements.items() if key != name}
            yield replace(case, spec=replace(case.spec, requirements=kept))
    actions = case.actions
    for size in sorted({max(len(actions) // 2, 1), 1}, reverse=True):
        for start in range(0, len(actions), size):
            yield replace(case, actions=actions[:start] + actions[start + size :])
    if case.end is not None:
        yield replace(case, end=None)
    if case.names is not None:
        yield replace(case, names=None)
    yield from _less_lost(case)
    for name, requirement in requirements.items():
        for smaller in _smaller_requirement(requirement):
            spec = replace(case.spec, requirements={**requirements, name: smaller})
            yield replace(case, spec=spec)
    for name, signal in case.spec.signals.items():
        if signal.stale_after is not None:
            signals = {**case.spec.signals, name: replace(signal, stale_after=None)}
            yield replace(case, spec=replace(case.spec, signals=signals))
        if signal.ignores_nan:
            signals = {**case.spec.signals, name: replace(signal, ignores_nan=False)}
            yield replace(case, spec=replace(case.spec, signals=signals))
    yield from _fewer_values(case)
    yield from _less_time(case)


def _less_lost(case: Case) -> Iterator[Case]:
    for place, outage in enumerate(case.outages):
        rest = (*case.outages[:place], *case.outages[place + 1 :])
        yield replace(case, outages=rest)
        smaller = [replace(outage, names=outage.names - {name}) for name in sorted(outage.names)]
        if outage.first < outage.last:
            smaller.append(replace(outage, last=outage.last - 1))
        for one in smaller:
            yield replace(case, outages=(*rest, one))


def _fewer_values(case: Case) -> Iterator[Case]:
    for index, action in enumerate(case.actions):
        if isinstance(action, Sample):
            for name in action.values:
                values = {key: value for key, value in action.values.items() if key != name}
                changed = Sample(action.t, values)
                yield replace(
                    case, actions=(*case.actions[:index], changed, *case.actions[index + 1 :])
                )


def _less_time(case: Case) -> Iterator[Case]:
    """All from some action on earlier, down to zero, where there is room for it; then the end."""
    before = 0
    for index, action in enumerate(case.actions):
        instant = action.t if isinstance(action, Sample) else action
        for step in _steps(instant - before):
            later = (_earlier(action, step) for action in case.actions[index:])
            moved = (*case.actions[:index], *later)
            if _in_order(moved):
                end = None if case.end is None else case.end - step
                yield replace(case, actions=moved, end=end)
        before = instant
    if case.end is not None:
        for step in _steps(case.end - before):
            yield replace(case, end=case.end - step)


def _steps(room: int) -> list[int]:
    """All the room, half of it, one tick."""
    return sorted({room, room // 2, 1}, reverse=True) if room > 0 else []


def _in_order(actions: Sequence[Sample | int]) -> bool:
    """Whether a monitor may be told this: samples rise, and none comes before an `advance`."""
    reached, sampled = 0, -1
    for action in actions:
        if isinstance(action, Sample):
            if action.t < reached or action.t <= sampled:
                return False
            reached = sampled = action.t
        elif action < reached:
            return False
        else:
            reached = action
    return True


def _earlier(action: Sample | int, step: int) -> Sample | int:
    return Sample(action.t - step, action.values) if isinstance(action, Sample) else action - step


def _smaller_requirement(requirement: Requirement) -> Iterator[Requirement]:
    if requirement.at_end is not EndPolicy.DEFAULT:
        yield replace(requirement, at_end=EndPolicy.DEFAULT)
    read = {
        part.name
        for formula in (requirement.trigger, requirement.consequent)
        for part in numerics(formula)
        if isinstance(part, Captured)
    }
    if requirement.for_each is not None and requirement.for_each.name not in read:
        yield replace(requirement, for_each=None)
    if requirement.captures and not read & {capture.name for capture in requirement.captures}:
        yield replace(requirement, captures=())
    if requirement.mode is Mode.WHENEVER:
        yield replace(requirement, mode=Mode.UPON)
    start = BoundAtom(Bound.START)
    if not isinstance(requirement.trigger, BoundAtom):
        yield replace(requirement, trigger=start, pulse=False)
    for trigger in smaller_formulas(requirement.trigger):
        yield replace(requirement, trigger=trigger, pulse=is_pulse(trigger))
    for consequent in smaller_formulas(requirement.consequent):
        yield replace(requirement, consequent=consequent)


def smaller_formulas(formula: Formula) -> Iterator[Formula]:
    """Formulas one step smaller: a part of it, or a part replaced by a smaller one."""
    match formula:
        case Unary(operand=operand, interval=interval):
            yield operand
            yield from (replace(formula, operand=smaller) for smaller in smaller_formulas(operand))
            for window in _smaller_intervals(interval):
                yield replace(formula, interval=window)
        case Binary(left=left, right=right, interval=interval):
            yield left
            yield right
            if formula.op not in (BinaryOp.AND, BinaryOp.OR) and interval is None:
                yield replace(formula, op=BinaryOp.AND)
            yield from (replace(formula, left=smaller) for smaller in smaller_formulas(left))
            yield from (replace(formula, right=smaller) for smaller in smaller_formulas(right))
            for window in _smaller_intervals(interval):
                yield replace(formula, interval=window)
        case Constant() | BoundAtom():
            return
        case _:
            yield Constant(True)
            yield Constant(False)


def _smaller_intervals(interval: Interval | None) -> Iterator[Interval]:
    if interval is None:
        return
    if interval.low:
        yield Interval(interval.low - 1, interval.high)
    if interval.high is not None and interval.high > interval.low:
        yield Interval(interval.low, interval.high - 1)

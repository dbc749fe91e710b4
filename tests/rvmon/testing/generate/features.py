"""What random cases are made of: which operators meet which windows, triggers, ends and times."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

from rvmon.language.checked.formula import (
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    Interval,
    Unary,
    UnaryOp,
)
from rvmon.language.checked.specification import (
    CheckedSpec,
    EndPolicy,
    Mode,
    Requirement,
    TimeModel,
)
from rvmon.testing.law.syntax import subformulas

WINDOWS = ("[0,0]", "[0,b]", "[0,∞)", "[a,a]", "[a,b]", "[a,∞)")
TRIGGERS = (
    "upon start",
    "upon end",
    "upon pulse",
    "upon level",
    "whenever pulse",
    "whenever level",
)
EXTRAS = ("alone", "let", "for each")
STEPS = (UnaryOp.NEXT, UnaryOp.PREVIOUS)


@dataclass(frozen=True, slots=True)
class Feature:
    """One operator of a consequent and what it met; `window` is empty if it has none."""

    operator: UnaryOp | BinaryOp
    window: str
    time: TimeModel
    trigger: str
    policy: EndPolicy
    extra: str


def features(spec: CheckedSpec) -> Iterator[Feature]:
    """One feature per operator of each consequent."""
    for requirement in spec.requirements.values():
        extra = "let" if requirement.captures else "alone"
        extra = extra if requirement.for_each is None else "for each"
        trigger = _trigger(requirement)
        for part in subformulas(requirement.consequent):
            if isinstance(part, Unary | Binary):
                window = "" if part.interval is None else _window(part.interval)
                yield Feature(part.op, window, spec.time, trigger, requirement.at_end, extra)


def possible() -> Iterator[Feature]:
    """All features that the language allows."""
    rest = [*product(TimeModel, TRIGGERS, EndPolicy, EXTRAS)]
    for operator in (*UnaryOp, *BinaryOp):
        for window in _windows(operator):
            for time, trigger, policy, extra in rest:
                if time is TimeModel.HELD and operator in STEPS:
                    continue
                yield Feature(operator, window, time, trigger, policy, extra)


def _windows(operator: UnaryOp | BinaryOp) -> tuple[str, ...]:
    match operator:
        case UnaryOp.HELD:
            return WINDOWS[:2]
        case BinaryOp.WEAK_UNTIL | BinaryOp.STRONG_RELEASE:
            return WINDOWS[:3]
        case UnaryOp.EVENTUALLY | UnaryOp.ALWAYS | UnaryOp.ONCE | UnaryOp.HISTORICALLY:
            return WINDOWS
        case BinaryOp.UNTIL | BinaryOp.RELEASE | BinaryOp.SINCE:
            return WINDOWS
        case _:
            return ("",)


def _window(interval: Interval) -> str:
    low = "a" if interval.low else "0"
    if interval.high is None:
        return f"[{low},∞)"
    return f"[{low},{low if interval.high == interval.low else 'b'}]"


def _trigger(requirement: Requirement) -> str:
    if isinstance(requirement.trigger, BoundAtom) and requirement.mode is Mode.UPON:
        return "upon start" if requirement.trigger.bound is Bound.START else "upon end"
    kind = "pulse" if requirement.pulse else "level"
    return f"{'whenever' if requirement.mode is Mode.WHENEVER else 'upon'} {kind}"

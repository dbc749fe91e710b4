"""Lowers requirements to obligations: when an attempt starts, and what it owes, in core form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import assert_never

from rvmon.errors import RvmonError
from rvmon.logic.formula import (
    And,
    Core,
    Factory,
    Literal,
    Next,
    Or,
    Previous,
    Release,
    Sense,
    Since,
    Until,
)
from rvmon.logic.formula import Constant as CoreConstant
from rvmon.logic.four_valued import Four
from rvmon.logic.normal_form import Lowering, Origin, flattened
from rvmon.logic.state_formula import FALSE, TRUE, UNKNOWN, Lapsed, State, Unborn, signals_of
from rvmon.spec.checked.classify import has_future, looks_back_at_future, subformulas
from rvmon.spec.checked.formula import (
    Bound,
    BoundAtom,
    Compare,
    Formula,
    SignalAtom,
    itself,
    windows_in,
)
from rvmon.spec.checked.specification import Mode, Requirement


class UnmonitorableError(RvmonError):
    """A formula cannot be monitored; the message names the part."""


@dataclass(frozen=True, slots=True)
class Obligation:
    """A requirement in core form.

    Attributes:
        trigger: starts an attempt; `None` for `upon end`. Unborn counts as FALSE.
        required: what an attempt owes from its trigger on; for an episode, over all its positions.
        origins: for explanations, the source of each part of `required`.
        running: for an episode, FALSE where it is over; with captured values, also where these are
            no longer certain.
        again: for an episode, FALSE where the consequent fails at once; after a failure it goes on
            at the first position where it does not. `None` if it does not go on, as an operator of
            the past stands above one of the future.
        unborn: for an episode, TRUE while some signal of its consequent had no value yet.
        determined: TRUE as soon as the trigger was TRUE or FALSE; `None` if it always is.
        hidden: what an attempt in doubt owes, as an episode whose trigger is UNKNOWN wherever one
            may start; `None` if the trigger is never unknown.
        doubted: the same for an instance of `for each` that may not exist.
        doubt: for an episode with captured values, UNKNOWN where another one may have begun.
        caught: states that say whether the windows captured by `let` have known values.
    """

    trigger: State | None
    required: Core
    origins: Mapping[Core, Origin]
    running: State | None = None
    again: State | None = None
    unborn: State | None = None
    determined: State | None = None
    hidden: Obligation | None = None
    doubted: Obligation | None = None
    doubt: State | None = None
    caught: tuple[State, ...] = ()


def lower(
    requirement: Requirement,
    factory: Factory,
    period: int | None = None,
    *,
    measured: bool = False,
    sampled: bool = False,
) -> Obligation:
    """Bring a requirement into core form.

    Args:
        requirement: as checked.
        factory: where its formulas are made; shared by the requirements of a spec.
        period: the D of `sampled every D`, ticks; past intervals are cut to its multiples.
        measured: see `rvmon.logic.three_valued.Reader`.
        sampled: whether only samples are positions.

    Raises:
        UnmonitorableError: the trigger speaks of the future.
    """
    favour = requirement.mode is Mode.WHENEVER and not requirement.pulse
    begin = partial(Lowering, factory, period, favour, measured=measured, sampled=sampled)
    lowering = begin()
    in_truth = begin(measured=False).reader if measured else lowering.reader
    of_windows = [itself(one.value) for one in requirement.captures if windows_in(one.value)]
    caught = tuple(in_truth.four(one).read(UNKNOWN) for one in of_windows)
    match requirement.trigger:
        case BoundAtom(bound=Bound.END):
            required = lowering.core(requirement.consequent, True)
            return Obligation(None, required, lowering.origins, caught=caught)
        case formula if has_future(formula):
            raise UnmonitorableError("its trigger speaks of the future")
    reader = lowering.reader if requirement.mode is Mode.WHENEVER else in_truth
    four = reader.four(requirement.trigger)  # an episode owes its trigger, too: that is measured
    trigger = four.read(FALSE)
    determined = _determined(four, factory)
    if requirement.mode is Mode.WHENEVER:
        parts = flattened(requirement.consequent, True, False)
        running = _running(trigger, requirement, factory)
        implied = lowering.join_signed(parts, False, [factory.negation(running)])
        # An episode is over where its trigger is FALSE, by whatever distance.
        truth = _running(in_truth.four(requirement.trigger).read(FALSE), requirement, factory)
        required = lowering.episode(truth, lowering.required(implied), requirement)
        again = None
        if not looks_back_at_future(requirement.consequent):
            again = _at_once(begin(opened=True).core(requirement.consequent, True), factory)
        unborn = _unborn(requirement.consequent, factory) if favour else None
        doubt = None
        if requirement.captures:
            doubt = factory.doubt(trigger, pulse=requirement.pulse, every=False)
        return Obligation(
            *(trigger, required, lowering.origins, running, again, unborn, determined),
            doubt=doubt,
            caught=caught,
        )
    required = lowering.core(requirement.consequent, True)

    def hidden(every: bool) -> Obligation:
        doubt = factory.doubt(trigger, pulse=requirement.pulse, every=every)
        running = _running(doubt, requirement, factory)
        here = factory.state_any([factory.negation(running), factory.sure(running)])
        either = factory.any_of([factory.literal(here, Sense.TRUE), lowering.required(required)])
        whole = lowering.episode(running, either, requirement)
        return Obligation(doubt, whole, lowering.origins, running)

    return Obligation(
        trigger,
        required,
        lowering.origins,
        determined=determined,
        hidden=hidden(False),
        doubted=hidden(True) if requirement.for_each is not None else None,
        caught=caught,
    )


def _running(trigger: State, requirement: Requirement, factory: Factory) -> State:
    if not requirement.captures:
        return trigger
    return factory.state_all([trigger, factory.negation(factory.leaf(Lapsed()))])


def _determined(trigger: Four, factory: Factory) -> State:
    """TRUE as soon as a trigger was TRUE or FALSE."""
    is_false = factory.sure(factory.negation(trigger.read(TRUE)))
    known = factory.state_any([factory.sure(trigger.read(FALSE)), is_false])
    return factory.since(factory.state_true, known, 0, None)


def _unborn(consequent: Formula, factory: Factory) -> State | None:
    """TRUE while some signal that a consequent reads had no value; `None` if it reads none."""
    found: dict[str, bool] = {}
    for atom in subformulas(consequent):
        if isinstance(atom, SignalAtom | Compare):
            for name, moved in signals_of(atom).items():
                found[name] = found.get(name, False) or moved
    return factory.leaf(Unborn(tuple(sorted(found.items())))) if found else None


def _at_once(core: Core, factory: Factory) -> State:
    """A state formula that is FALSE where a position alone makes what is required there FALSE.

    Args:
        core: the consequent, with the lower bounds of its `G` and `R` taken as 0.
        factory: makes the state formula.

    Source: SEMANTICS, section 3 (After a failure).
    """

    def of(part: Core) -> State:
        return _at_once(part, factory)

    match core:
        case CoreConstant(value=value):
            return factory.state_true if value else factory.state_false
        case Literal(proposition=proposition, sense=sense):
            return proposition if sense is Sense.TRUE else factory.negation(proposition)
        case And(args=args):
            return factory.state_all(map(of, args))
        case Or(args=args):
            return factory.state_any(map(of, args))
        case Next():
            return factory.state_true
        case Until(left=left, right=right, low=low):
            return of(left) if low else factory.state_any([of(left), of(right)])
        case Release(right=right):
            return of(right)
        case Since() | Previous():
            raise AssertionError("what looks back is asked otherwise")
        case _:
            assert_never(core)

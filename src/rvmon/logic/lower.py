"""Lowers requirements to obligations: when an attempt starts and what it requires, as formulas."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import assert_never

from msgspec import Struct

from rvmon.errors import RvmonError
from rvmon.language.checked import formula as rv
from rvmon.language.checked.classify import has_future, looks_back_at_future, subformulas
from rvmon.language.checked.specification import Mode, Requirement
from rvmon.logic import formula as mtl
from rvmon.logic.formula import Constant as CoreConstant
from rvmon.logic.four_valued import Four
from rvmon.logic.normal_form import Lowering, Origin, flattened
from rvmon.logic.state_formula import FALSE, TRUE, UNKNOWN, Lapsed, State, Unborn, signals_of


class UnmonitorableError(RvmonError):
    """A formula cannot be monitored; the message names the part."""


class Obligation(Struct, frozen=True):
    """A requirement in core form."""

    trigger: State | None  # starts an attempt; `None` for `upon end`. Unborn counts as FALSE
    # the formula an attempt must satisfy from its trigger on; of an episode, over all its positions
    required: mtl.Core
    origins: Mapping[mtl.Core, Origin]  # the source of each part of `required`, for explanations
    # of an episode, FALSE where it is over, and where its captured values are no longer certain
    running: State | None = None
    # of an episode, FALSE where the consequent fails at once: after a failure the episode resumes,
    # as a new attempt, at the next position where this is not FALSE. `None` if it never resumes,
    # because a past operator stands above a future one
    again: State | None = None
    # of an episode, TRUE while some signal of its consequent had no value yet
    unborn: State | None = None
    # TRUE once the trigger was TRUE or FALSE at some position; `None` if that is not tracked
    determined: State | None = None
    # the obligation of attempts in doubt, as an episode whose trigger is UNKNOWN wherever a trigger
    # may be hidden; `None` for episodes and `upon end`
    hidden: Obligation | None = None
    doubted: Obligation | None = None  # the same for an instance of `for each` that may not exist
    # of an episode with captured values, UNKNOWN where another episode may have started
    doubt: State | None = None
    # TRUE where the windows captured by `let` have known values
    captures_known: tuple[State, ...] = ()


def lower(
    requirement: Requirement,
    factory: mtl.Factory,
    period: int | None = None,
    *,
    measured: bool = False,
    sampled: bool = False,
) -> Obligation:
    """Lower a requirement to its obligation.

    `period` is the D of `sampled every D`, in ticks: past intervals are cut to its multiples.
    `measured` is explained at `rvmon.logic.three_valued.Reader`. `sampled` says whether only
    samples are positions.

    Raises:
        UnmonitorableError: the trigger has a future operator.
    """
    favour = requirement.mode is Mode.WHENEVER and not requirement.pulse
    new_lowering = partial(Lowering, factory, period, favour, measured=measured, sampled=sampled)
    lowering = new_lowering()
    truth_reader = new_lowering(measured=False).reader if measured else lowering.reader
    of_windows = [
        rv.itself(capture.value) for capture in requirement.captures if rv.windows_in(capture.value)
    ]
    captures_known = tuple(truth_reader.four(window).read(UNKNOWN) for window in of_windows)
    match requirement.trigger:
        case rv.BoundAtom(bound=rv.Bound.END):
            required = lowering.core(requirement.consequent, True)
            return Obligation(None, required, lowering.origins, captures_known=captures_known)
        case formula if has_future(formula):
            raise UnmonitorableError("its trigger refers to the future")
    reader = lowering.reader if requirement.mode is Mode.WHENEVER else truth_reader
    four = reader.four(requirement.trigger)  # an episode's robustness depends on its trigger too
    trigger = four.read(FALSE)
    determined = _determined(four, factory)
    if requirement.mode is Mode.WHENEVER:
        parts = flattened(requirement.consequent, True, False)
        running = _running(trigger, requirement, factory)
        implied = lowering.join_signed(parts, False, [factory.negation(running)])
        # Where an episode ends only the truth of its trigger counts, not its robustness.
        truth = _running(truth_reader.four(requirement.trigger).read(FALSE), requirement, factory)
        required = lowering.episode(truth, lowering.required(implied), requirement)
        # Where a past operator stands above a future one, the position alone falsifies nothing.
        again = None
        if not looks_back_at_future(requirement.consequent):
            again = _at_once(new_lowering(opened=True).core(requirement.consequent, True), factory)
        unborn = _unborn(requirement.consequent, factory) if favour else None
        doubt = None
        if requirement.captures:
            doubt = factory.doubt(trigger, pulse=requirement.pulse, every=False)
        return Obligation(
            *(trigger, required, lowering.origins, running, again, unborn, determined),
            doubt=doubt,
            captures_known=captures_known,
        )
    required = lowering.core(requirement.consequent, True)

    def hidden(every: bool) -> Obligation:
        doubt = factory.doubt(trigger, pulse=requirement.pulse, every=every)
        running = _running(doubt, requirement, factory)
        # The consequent is owed only where a trigger may be hidden: where `running` is UNKNOWN.
        # There `here` is UNKNOWN too; elsewhere it is TRUE, which excuses the consequent.
        here = factory.state_any([factory.negation(running), factory.sure(running)])
        either = factory.any_of(
            [factory.literal(here, mtl.Sense.TRUE), lowering.required(required)]
        )
        whole = lowering.episode(running, either, requirement)
        return Obligation(doubt, whole, lowering.origins, running)

    return Obligation(
        trigger, required, lowering.origins, determined=determined, hidden=hidden(False),
        doubted=hidden(True) if requirement.for_each is not None else None,
        captures_known=captures_known,
    )  # fmt: skip


def _running(trigger: State, requirement: Requirement, factory: mtl.Factory) -> State:
    if not requirement.captures:
        return trigger
    return factory.state_all([trigger, factory.negation(factory.leaf(Lapsed()))])


def _determined(trigger: Four, factory: mtl.Factory) -> State:
    """TRUE once the trigger was TRUE or FALSE at some position."""
    is_false = factory.sure(factory.negation(trigger.read(TRUE)))
    known = factory.state_any([factory.sure(trigger.read(FALSE)), is_false])
    return factory.since(factory.state_true, known, 0, None)


def _unborn(consequent: rv.Formula, factory: mtl.Factory) -> State | None:
    """TRUE while some signal that the consequent reads had no value; `None` if it reads none."""
    found: dict[str, bool] = {}
    for atom in subformulas(consequent):
        if isinstance(atom, rv.SignalAtom | rv.Compare):
            for name, moved in signals_of(atom).items():
                found[name] = found.get(name, False) or moved
    return factory.leaf(Unborn(tuple(sorted(found.items())))) if found else None


def _at_once(core: mtl.Core, factory: mtl.Factory) -> State:
    """A state formula that is FALSE where the position alone falsifies the consequent.

    The consequent has the lower bounds of its `G` and `R` taken as 0.

    Source: SEMANTICS, section 3 (After a failure).
    """

    def of(part: mtl.Core) -> State:
        return _at_once(part, factory)

    match core:
        case CoreConstant(value=value):
            return factory.state_true if value else factory.state_false
        case mtl.Literal(proposition=proposition, sense=sense):
            return proposition if sense is mtl.Sense.TRUE else factory.negation(proposition)
        case mtl.And(args=args):
            return factory.state_all(map(of, args))
        case mtl.Or(args=args):
            return factory.state_any(map(of, args))
        case mtl.Next():
            return factory.state_true
        case mtl.Until(left=left, right=right, low=low):
            return of(left) if low else factory.state_any([of(left), of(right)])
        case mtl.Release(right=right):
            return of(right)
        case mtl.Since() | mtl.Previous():
            raise AssertionError("a consequent that looks back has no `again`")
        case _:
            assert_never(core)

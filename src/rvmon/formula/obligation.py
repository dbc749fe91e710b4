"""What a requirement demands, in core form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rvmon.errors import RvmonError
from rvmon.formula.core import Core
from rvmon.formula.state import State
from rvmon.spec.checked.formula import Formula


class UnmonitorableError(RvmonError):
    """A formula cannot be monitored; the message says which part of it."""


@dataclass(frozen=True, slots=True)
class Origin:
    """What a core formula was made from: a formula of the spec, or its negation."""

    formula: Formula
    positive: bool


@dataclass(frozen=True, slots=True)
class Obligation:
    """A requirement in core form.

    Attributes:
        trigger: starts an attempt; `None` where it is the end of the trace. What is not born is
            FALSE for it.
        owed: what an attempt owes from its trigger on; of an episode, all that it owes.
        origins: for explanations, where the parts of `owed` come from.
        running: of an episode, what is FALSE where it is over; with captured values also where it
            is not known any more which these are.
        again: of an episode, not FALSE where what is owed has not failed at once: there it goes on
            after a failure; `None` where it does not, as the future stands below the past.
        unborn: of an episode, where something of its consequent had no value yet.
        determined: TRUE as soon as the trigger was TRUE or FALSE; `None` if it always is.
        hidden: what an attempt in doubt owes, as an episode whose trigger is UNKNOWN where one may
            start; `None` if the trigger is never unknown.
        doubted: the same where it is not known whether there is such an instance at all.
        doubt: of an episode with captured values, UNKNOWN where another may have begun.
    """

    trigger: State | None
    owed: Core
    origins: Mapping[Core, Origin]
    running: State | None = None
    again: State | None = None
    unborn: State | None = None
    determined: State | None = None
    hidden: Obligation | None = None
    doubted: Obligation | None = None
    doubt: State | None = None

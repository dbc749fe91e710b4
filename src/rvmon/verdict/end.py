"""What becomes of an undecided attempt when its trace has ended."""

from __future__ import annotations

from typing import assert_never

from rvmon.spec.checked.specification import EndPolicy
from rvmon.verdict.attempt import Decision
from rvmon.verdict.verdict import Verdict

_OPEN = (Verdict.INCONCLUSIVE, Decision.OPEN)


def settle_at_end(
    policy: EndPolicy, *, held: bool, cannot_pass: bool, cannot_fail: bool
) -> tuple[Verdict, Decision]:
    """The verdict of an attempt that no prefix decided, and what settled it.

    Args:
        policy: of its requirement.
        held: whether it is true if every opened unbounded `R` counts as true and all else that is
            pending as unknown.
        cannot_pass: whether unknown input has left it without a way to become true.
        cannot_fail: the same for false.

    Source: SEMANTICS, section 3, The end.

    >>> settle_at_end(EndPolicy.FAIL, held=True, cannot_pass=False, cannot_fail=False)[0].value
    'F'
    """
    match policy:
        case EndPolicy.DEFAULT:
            return (Verdict.PASS, Decision.HELD_TO_END) if held else _OPEN
        case EndPolicy.STRICT:
            return _OPEN
        case EndPolicy.WEAK:
            return _OPEN if cannot_pass else (Verdict.PASS, Decision.POLICY)
        case EndPolicy.STRONG:
            return _OPEN if cannot_fail else (Verdict.FAIL, Decision.POLICY)
        case EndPolicy.PASS | EndPolicy.FAIL:
            if cannot_pass or cannot_fail:
                return _OPEN
            settled = Verdict.PASS if policy is EndPolicy.PASS else Verdict.FAIL
            return settled, Decision.POLICY
        case _:
            assert_never(policy)

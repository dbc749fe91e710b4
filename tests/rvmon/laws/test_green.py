"""Green never hides a failure: what was lost, filled in, turns no verdict."""

from __future__ import annotations

from typing import Any

from hypothesis import assume
from hypothesis import strategies as st
from tests.tools.sound import is_spoken_of, overturned

from rvmon.testing.strategies import cases


def test_filling_in_what_was_lost(subject: Any, holds: Any) -> None:
    """A run's P or NT never becomes F, nor its F anything else."""

    @holds
    def _(data: st.DataObject) -> None:
        case = data.draw(cases(subject.profile, subject.traces))
        assume(is_spoken_of(case.spec))
        rng = data.draw(st.randoms(use_true_random=False))
        assert overturned(rng, case, 4, subject.judge).overturning is None

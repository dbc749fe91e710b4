"""The length of a tick does not matter, as evaluation goes from event to event."""

from dataclasses import replace

import pytest
from hypothesis import assume, given
from msgspec import structs
from tests.rvmon.laws.tried import TRIED, judge, moved
from tests.tools.build import scaled

from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, show_spec
from rvmon.testing.strategies import cases
from rvmon.verdicts.report import Report

SPARSE = 1_000
"""Ticks between two different instants, so that one tick more never reaches the next."""

FURTHER = 1_000_000


@pytest.mark.law
@TRIED
@given(cases(Profile(mixed=False, requirements=1)))
def test_scaled_times_give_scaled_attempts(case: Case) -> None:
    assume("rate(" not in show_spec(case.spec))  # a rate is per second
    short = judge(longer(case, SPARSE))
    long = judge(longer(case, SPARSE * FURTHER))
    assert in_units(long, SPARSE * FURTHER) == in_units(short, SPARSE)


def longer(case: Case, factor: int) -> Case:
    spec = case.spec
    signals = {
        name: structs.replace(one, stale_after=one.stale_after and one.stale_after * factor)
        for name, one in spec.signals.items()
    }
    requirements = {
        name: replace(
            one, trigger=scaled(one.trigger, factor), consequent=scaled(one.consequent, factor)
        )
        for name, one in spec.requirements.items()
    }
    period = spec.period and spec.period * factor
    return replace(
        case,
        spec=structs.replace(spec, period=period, signals=signals, requirements=requirements),
        actions=moved(case.actions, lambda t: t * factor),
        end=case.end and case.end * factor,
    )


def in_units(report: Report, unit: int) -> list[tuple[object, ...]]:
    """The attempts with each instant as a number of whole units and a rest of ticks."""

    def split(instant: int | None) -> tuple[int, int] | None:
        if instant is None:
            return None
        whole = (instant + unit // 2) // unit
        return whole, instant - whole * unit

    return [
        (a.requirement, a.number, split(a.triggered), split(a.decided), a.verdict, a.decision)
        for a in report.attempts
    ]

"""Coverpoints and crosses on random traces: what a monitor finds against the definition."""

from __future__ import annotations

import random
from collections import Counter

from rvmon.coverage.model import combination
from rvmon.coverage.monitor import SpecCoverage
from rvmon.testing.case import Case
from rvmon.testing.generate.coverage import with_random_coverage
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile, random_trace
from rvmon.testing.law.coverage import hits_on
from rvmon.testing.law.sample_words import word_of
from rvmon.trace.sample import Sample

Counted = dict[str, dict[str, tuple[int, int | None]]]


def by_law(case: Case) -> Counted:
    """What the definition says, as `by_monitor` tells it."""
    word = word_of(case.spec, case.samples, end=case.end, advances=case.advances, names=case.names)
    return {
        name: {combination(bins): found for bins, found in own.items()}
        for name, own in hits_on(case.spec, word).items()
    }


def by_monitor(case: Case, coverage: SpecCoverage) -> Counted:
    """What a monitor finds: how often, and when first."""
    monitor = coverage.monitor(sources=case.names, requirements=False)
    for one in case.actions:
        if isinstance(one, Sample):
            monitor.step_ns(one.t, one.values)
        else:
            monitor.advance_ns(one)
    hits = monitor.finish_ns(case.end)
    return {
        name: {item: (hit.count, hit.first) for item, hit in own.items()}
        for name, own in hits.items()
    }


def judge(seed: str, each: int, tally: Counter[str]) -> list[str]:
    """Compare on the traces of one specification; returns what differs."""
    rng = random.Random(seed)
    spec = with_random_coverage(rng, Profile(requirements=1, captures=False, for_each=False))
    coverage = SpecCoverage(spec)
    wrong = []
    for place in range(each):
        case = random_trace(rng, spec, TraceProfile(long=10))
        law, found = by_law(case), by_monitor(case, coverage)
        tally["pairs"] += 1
        tally["hits"] += sum(count for own in law.values() for count, _ in own.values())
        if law != found:
            wrong.append(f"{seed}, trace {place}: law {law}, monitor {found}")
    return wrong

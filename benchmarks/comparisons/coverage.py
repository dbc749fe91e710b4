"""Coverpoints and crosses on random traces: hits found by a monitor against the definition."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise, product

from tests.tools.differential import Campaign
from tests.tools.random_specs import with_random_coverage

from rvmon.coverage import combination
from rvmon.coverage.monitor import SpecCoverage
from rvmon.language.checked.formula import Formula
from rvmon.language.checked.properties import Bin
from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, TraceProfile, random_trace
from rvmon.testing.law.attempts import is_pulse
from rvmon.testing.law.sample_words import word_of
from rvmon.testing.law.truths import Truths
from rvmon.testing.law.word import Truth, Word, conjunction
from rvmon.trace.sample import Sample

EACH = 10
"""The number of traces for each specification."""

Found = dict[str, tuple[int, int | None]]
"""For each combination of bins: the number of hits, and the instant of the first."""


def _hits(word: Word, axes: Sequence[Sequence[Bin]], upon: Formula | None) -> Found:
    found: Found = {}
    for bins in product(*axes):
        truths = [
            conjunction([_truth(word, bin_.formula, k) for bin_ in bins])
            for k in range(len(word.letters))
        ]
        if upon is not None:
            instants = [k for k in _starts(word, upon) if truths[k] is Truth.TRUE]
        elif any(is_pulse(bin_.formula) for bin_ in bins):
            instants = [k for k, truth in enumerate(truths) if truth is Truth.TRUE]
        else:
            instants = [*_stretches(truths)]
        if instants:
            name = combination([bin_.name for bin_ in bins])
            found[name] = (len(instants), word.letters[instants[0]].instant)
    return found


def _truth(word: Word, formula: Formula, k: int) -> Truth:
    """The truth as for a trigger: unborn is taken as false."""
    found = Truths(word, {}).state(formula, k)
    return Truth.FALSE if found is Truth.UNBORN else found


def _starts(word: Word, upon: Formula) -> list[int]:
    """The positions at which an attempt `upon` this formula would certainly start."""
    truths = [_truth(word, upon, k) for k in range(len(word.letters))]
    return [
        k
        for k, truth in enumerate(truths)
        if truth is Truth.TRUE and (is_pulse(upon) or k == 0 or truths[k - 1] is Truth.FALSE)
    ]


def _stretches(truths: Sequence[Truth]) -> list[int]:
    """The starts of stretches: true positions that are the first, or follow a false one."""
    true = [k for k, truth in enumerate(truths) if truth is Truth.TRUE]
    return true[:1] + [k for j, k in pairwise(true) if Truth.FALSE in truths[j:k]]


def by_law(case: Case) -> dict[str, Found]:
    """The hits of coverpoints and crosses by definition; groups without hits are left out."""
    spec = case.spec
    word = word_of(spec, case.samples, end=case.end, advances=case.advances, names=case.names)
    found = {one.name: _hits(word, [one.bins], one.upon) for one in spec.coverpoints.values()}
    for cross in spec.crosses.values():
        axes = [spec.coverpoints[name].bins for name in cross.points]
        found[cross.name] = _hits(word, axes, cross.upon)
    return {name: own for name, own in found.items() if own}


def by_monitor(case: Case) -> dict[str, Found]:
    """The hits that a monitor finds."""
    monitor = SpecCoverage(CompiledSpec(case.spec)).monitor(sources=case.names, requirements=False)
    for one in case.actions:
        if isinstance(one, Sample):
            monitor.step_ns(one.t, one.values)
        else:
            monitor.advance_ns(one)
    return {
        name: {item: (hit.count, hit.first) for item, hit in own.items()}
        for name, own in monitor.finish_ns(case.end).items()
    }


def judge_hits(found: Campaign, seed: int, numbers: range) -> None:
    """Hits of coverpoints and crosses against the definition."""

    def drawn(place: object) -> Iterator[Case]:
        rng = place if isinstance(place, random.Random) else random.Random(str(place))
        spec = with_random_coverage(rng, Profile(requirements=1, captures=False, for_each=False))
        yield from (random_trace(rng, spec, TraceProfile(long=10)) for _ in range(EACH))

    def ways(_: int, case: Case) -> Iterator[tuple[str, Callable[[Case], list[str]]]]:
        hits = (count for own in by_law(case).values() for count, _ in own.values())
        found.counts.update(pairs=1, hits=sum(hits))
        yield "coverage", _differs

    for number in numbers:
        found.compare(drawn, f"{seed}/{number}", ways, 1)


def _differs(case: Case) -> list[str]:
    law, ours = by_law(case), by_monitor(case)
    return [] if law == ours else [f"law {law}, monitor {ours}"]

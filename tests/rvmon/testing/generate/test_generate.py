"""Random cases: what has to occur in them often enough to find what monitors get wrong."""

import random
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given, settings
from tests.rvmon.testing.generate.features import Feature, features, possible
from tests.tools.build import compared, eventually, requirement, spec_of, x
from tests.tools.differential import Campaign, case_of
from tests.tools.judgement import Judgement
from tests.tools.law import judge

from rvmon.language.checked.formula import Compare, UnaryOp
from rvmon.language.checked.specification import EndPolicy, TimeModel
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import Case, TraceProfile, random_trace
from rvmon.testing.law.syntax import subformulas
from rvmon.testing.strategies import cases
from rvmon.trace.sample import Sample

pytestmark = pytest.mark.law


def some_cases(time: TimeModel, number: int = 400) -> list[Case]:
    return [case_of(seed, Profile(time=time), TraceProfile()) for seed in range(number)]


@pytest.mark.parametrize("time", TimeModel)
def test_verdicts_are_mixed(time: TimeModel) -> None:
    """P, F and I make up 15 % of the attempts each, and 10 % are decided on a bound."""
    found = Campaign()
    for case in some_cases(time, 250):
        found.count(Judgement(case))
    by_verdict = [found.counts[f"attempts {verdict}"] for verdict in ("P", "F", "I", "NT")]
    attempts = sum(by_verdict)
    assert attempts > 250
    assert min(by_verdict[:3]) >= 0.15 * attempts
    assert found.counts["decided on a bound"] >= 0.10 * attempts


def test_everything_occurs() -> None:
    seen: Counter[str] = Counter()
    for time in TimeModel:
        for case in some_cases(time, 600):
            for found in case.spec.requirements.values():
                seen[f"pulse {found.pulse}"] += 1
            seen["none"] += any(None in sample.values.values() for sample in case.samples)
            seen["stale"] += any(s.stale_after is not None for s in case.spec.signals.values())
            seen["absent"] += case.names is not None
            seen["advance"] += bool(case.advances)
            seen["finish"] += case.end is not None
    assert len(seen) == 7
    assert min(seen.values()) >= 10


def test_operators_meet_everything() -> None:
    """All that the language allows, and nothing else: in held time there is no `X`."""
    found: Counter[Feature] = Counter()
    for seed in range(11_000):
        found.update(features(random_spec(random.Random(f"met/{seed}"), Profile())))
    assert not set(found) - set(possible())

    def pairs(all_: Iterable[Feature]) -> set[tuple[object, ...]]:
        others = ("time", "trigger", "policy", "extra")
        return {(one.operator, one.window, getattr(one, name)) for one in all_ for name in others}

    assert pairs(possible()) - pairs(found) == set()


def test_known_traces() -> None:
    for seed in range(200):
        case = case_of(seed, Profile(), TraceProfile(unknowns=False))
        assert case.names is None
        values = [value for sample in case.samples for value in sample.values.values()]
        assert all(value is not None and value == value for value in values)


def test_traces_for_other_specs() -> None:
    spec = spec_of(requirement(eventually(compared(x, ">", 1000), 0, 500)))
    rng = random.Random(1)
    profile = TraceProfile(span=5_000)
    found = [random_trace(rng, spec, profile) for _ in range(50)]
    times = [[sample.t for sample in case.samples] for case in found]
    gaps = {b - a for row in times for a, b in pairwise(row)}
    assert {500, 501} <= gaps
    values = {sample.values.get("x") for case in found for sample in case.samples}
    assert {999, 1000, 1001} <= values


@settings(max_examples=30, deadline=None)
@given(case=cases())
def test_strategy_gives_sound_cases(case: Case) -> None:
    times = [sample.t for sample in case.samples]
    assert times == sorted(set(times))
    told = [one.t if isinstance(one, Sample) else one for one in case.actions]
    assert told == sorted(told)
    assert set(judge(case).verdicts) == set(case.spec.requirements)


def test_features_can_be_left_out() -> None:
    plain = Profile(past=False, numbers=False, captures=False, for_each=False, policies=False)
    plain = replace(plain, stale=False)
    for seed in range(200):
        spec = case_of(seed, plain, TraceProfile()).spec
        assert all(signal.stale_after is None for signal in spec.signals.values())
        for found in spec.requirements.values():
            assert not found.captures
            assert found.for_each is None
            assert found.at_end is EndPolicy.DEFAULT
            parts = [*subformulas(found.trigger), *subformulas(found.consequent)]
            assert not any(isinstance(part, Compare) for part in parts)
            assert not any(getattr(part, "op", None) is UnaryOp.ONCE for part in parts)

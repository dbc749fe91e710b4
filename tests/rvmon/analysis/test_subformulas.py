"""The truth shown for each subformula agrees with the definitions."""

import random
from dataclasses import replace

import pytest

from rvmon.analysis.subformulas import dissect
from rvmon.analysis.truths import look_through, parts_of, subformulas, truths_of_parts
from rvmon.language.checked.specification import TimeModel
from rvmon.monitor.compiled_spec import compile_spec
from rvmon.monitor.monitor import build_monitor
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import TraceProfile, random_trace, show_case
from rvmon.testing.law.sample_words import word_of
from rvmon.testing.law.truths import Truths
from rvmon.testing.law.word import Truth
from rvmon.trace.sample import Sample
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt

PROFILE = Profile(requirements=1, depth=3, captures=False, for_each=False)


def ticks(spans):
    return {t for low, high in spans for t in range(low, high + 1)}


@pytest.mark.law
@pytest.mark.parametrize("time", list(TimeModel))
@pytest.mark.parametrize("seed", range(4))
def test_subformulas_have_the_truth_of_the_oracle(time, seed):
    rng = random.Random(seed)
    compared = set()
    for _ in range(25):
        spec = random_spec(rng, replace(PROFILE, time=time))
        case = random_trace(rng, spec, TraceProfile(samples=6, span=14, advances=False))
        samples = [action for action in case.actions if isinstance(action, Sample)]
        if not samples:
            continue
        requirement = spec.requirements["R1"]
        end = max(samples[-1].t, samples[-1].t if case.end is None else case.end)
        word = word_of(spec, samples, end=end, names=case.names)
        attempt = Attempt("R1", 1, samples[0].t, None, Verdict.INCONCLUSIVE)
        seen = look_through(spec, [parts_of(requirement, attempt)], samples, end, case.names)
        parts = truths_of_parts(requirement, attempt, seen)
        truths = Truths(word, {})
        for _, formula in subformulas(requirement.consequent, 0):
            found = parts[id(formula)]
            true, false = found.true, found.false
            for i, letter in enumerate(word.letters):
                shown = _shown(true, false, letter.instant)
                assert shown is truths.truth(formula, i), (show_case(case), formula, letter.instant)
                compared.add(shown)
    assert compared == {Truth.TRUE, Truth.UNKNOWN, Truth.FALSE}


def _shown(true, false, t):
    if any(low <= t <= high for low, high in true):
        return Truth.TRUE
    return Truth.FALSE if any(low <= t <= high for low, high in false) else Truth.UNKNOWN


def test_an_attempt_of_an_instance_and_with_captures():
    import rvmon

    spec = rvmon.loads(
        "signal x : real\nevent pick(id: int)\nrequirement Q\n upon pick\n"
        " then within 10 ns (x > v and n == 2)\n for each n in pick.id\n let v = x\n"
    ).checked
    samples = [
        Sample(0, {"x": 1.0, "pick": {"id": 1}}),
        Sample(2, {"pick": {"id": 2}}),
        Sample(5, {"x": 3.0}),
    ]
    monitor = build_monitor(compile_spec(spec))
    for sample in samples:
        monitor.step_ns(sample.t, sample.values)
    second = next(a for a in monitor.finish_ns(20).attempts if a.number == 2)
    found = {s.text: s for s in dissect(spec, samples, 20, second).part_truths}
    assert ticks(found["pick"].true) == {2}
    assert min(ticks(found["x > v"].true)) == 5
    assert second.decided == 5

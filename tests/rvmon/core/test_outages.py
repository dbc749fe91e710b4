"""Outages in the core, by the sentences of section 1 of SEMANTICS.md."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest
from tests.tools.build import actions
from tests.tools.differential import case_of
from tests.tools.drive import feed
from tests.tools.each import each
from tests.tools.law import after_late, judge

import rvmon
from rvmon.language.checked.specification import TimeModel
from rvmon.monitor.compiled_spec import CompiledSpec, compile_spec
from rvmon.monitor.packed_plan import PlannedCore, planned_core
from rvmon.monitor.records import report_of_run
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile

NAMES = """
signal p, q : bool
signal x : real
signal s : bool stale after 2 ns
event e
event g(k: int)
"""


def planned(requirements: str, time: str = "held") -> PlannedCore:
    """The plan of requirements over the names above."""
    spec = rvmon.loads(f'spec some "thing"\ntime {time}\n{NAMES}\n{requirements}')
    compiled: CompiledSpec = compile_spec(spec.checked)
    return planned_core(compiled)


def test_lost_names_are_given_by_their_numbers_in_the_plan():
    run = planned("requirement R\n  always p").monitor(frozenset({"q"}))
    assert run.lose(iter([1]), 0)
    assert run.found((), 0)
    for wrong in ([99], [-1]):
        with pytest.raises(ValueError, match="no such name"):
            run.lose(wrong, 0)
    for wrong in (3, ["p"]):
        with pytest.raises(TypeError):
            run.lose(wrong, 1)


LONG = {
    "upon e\n  then within 3 {0} p": "I",
    "upon e\n  then within 8 {0} p": "P",
    "upon e\n  then always[0 {0}, 1 {0}] p": "F",
    "upon e\n  then always[0 {0}, 9 {0}] within 4 {0} p": "I",
    "upon e\n  then (p until[0 {0}, 3 {0}] q) or eventually[4 {0}, 5 {0}] p": "P",
    "upon p\n  then historically[5 {0}, 6 {0}] p": "I",
    "whenever p\n  then not q": "F",
}


def judged(requirement, time, unit, said, lost, first, last):
    """The report on `actions` whose instants are in a unit, with an outage of one name."""
    monitor = rvmon.loads(
        f"time {time}\n{NAMES}\nrequirement R\n  {requirement.format(unit)}\n"
    ).monitor()
    scale = {"ns": 1, "s": 1_000_000_000}[unit]
    for number, one in enumerate(actions(said)):
        if number == 1:
            monitor.lose_ns([lost], first * scale, last * scale)
        feed(monitor, one if isinstance(one, int) else replace(one, t=one.t * scale))
    return monitor.finish_ns(20 * scale), scale


@pytest.mark.slow
@each("time", ["held", "sampled"])
@each("requirement", LONG)
@each("unit", ["ns", "s"])
def test_a_long_outage_is_judged_like_a_short_one(time, requirement, unit):
    """In sampled time each of its ticks may have been a trigger."""
    report, _ = judged(requirement, time, unit, "0 -p q e; 7 p", "p", 2, 5)
    in_doubt = time == "sampled" and LONG[requirement] == "P"
    assert report.verdicts["R"] == ("I" if in_doubt else LONG[requirement])


@pytest.mark.slow
@each("unit", ["ns", "s"])
def test_a_network_is_inconclusive_on_an_outage(unit):
    """So is what looks back at the outage later."""
    text = "upon e\n  then once[0 s, 4 {0}] (eventually[0 s, 1 {0}] p)"
    report, scale = judged(text, "sampled", unit, "0 -p; 7 -p e; 9", "q", 2, 5)
    found = [(one.triggered, one.in_doubt, one.verdict) for one in report.attempts]
    assert found == [(7 * scale, False, "I"), (2 * scale, True, "I")]


@pytest.mark.law
def test_a_late_sample_leaves_the_verdicts_that_the_law_leaves():
    traces = TraceProfile(unknowns=False, advances=False, fewest=3)
    changed = 0
    for number in range(40):
        case = case_of(f"late/{number}", Profile(captures=False), traces)
        rng = random.Random(number)
        if len(case.samples) < 3:
            continue
        late = rng.choice(case.samples[:-1])
        kept = replace(case, actions=tuple(one for one in case.samples if one is not late))
        compiled = compile_spec(case.spec)
        plan = planned_core(compiled)
        run = plan.monitor(frozenset())
        for sample in kept.samples:
            assert run.judge(sample.t, plan.plain(sample.t, sample.values), True)
        without = judge(kept).verdicts
        assert run.late([plan.numbers[name] for name in late.values], late.t)
        verdicts = report_of_run(plan, run, 0, run.finish(kept.end)).verdicts
        expected = after_late(case.spec, without, kept.samples, [late])
        first = case.spec.time is TimeModel.SAMPLED or late.t < kept.samples[0].t
        for name, one in compiled.requirements.items():
            if not first and one.reads.isdisjoint(late.values):
                expected[name] = without[name]  # the core drops names that decide nothing
        assert verdicts == expected
        changed += verdicts != without
    assert changed > 6

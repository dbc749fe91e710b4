"""Names that are lost for a while: what the core says of them, by the sentences of SEMANTICS 1."""

from __future__ import annotations

import random
from dataclasses import replace
from typing import Any

import pytest
from tests.tools.differential import case_of
from tests.tools.law import after_late, judge

import rvmon
from rvmon import native
from rvmon.language.checked.specification import TimeModel
from rvmon.monitor.compiled_spec import CompiledSpec, compile_spec
from rvmon.monitor.packed_plan import PlannedCore, planned_core
from rvmon.monitor.records import report_of_run
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile
from rvmon.verdicts.report import Report

NAMES = """
signal p, q : bool
signal x : real
signal s : bool stale after 2 ns
event e
event g(k: int)
"""


def planned(requirements: str, time: str = "held") -> PlannedCore:
    """The plan of some requirements over the names above."""
    spec = rvmon.loads(f'spec some "thing"\ntime {time}\n{NAMES}\n{requirements}')
    compiled: CompiledSpec = compile_spec(spec.checked)
    return planned_core(compiled)


class Run:
    """A run of the core, told in few words."""

    def __init__(self, requirements: str, time: str = "held") -> None:
        self._planned = planned(requirements, time)
        self.core: native.Monitor = self._planned.monitor(frozenset())

    def sample(self, t: int, **values: Any) -> Run:
        assert self.core.judge(t, values, True)
        return self

    def lost(self, names: str, first: int, last: int) -> Run:
        assert self.lose(names, first)
        assert self.found(names, last)
        return self

    def lose(self, names: str, since: int) -> bool:
        return self.core.lose([self._planned.numbers[name] for name in names.split()], since)

    def found(self, names: str, at: int) -> bool:
        return self.core.found([self._planned.numbers[name] for name in names.split()], at)

    def report(self, end: int | None = None) -> Report:
        return report_of_run(self._planned, self.core, 0, self.core.finish(end))

    def said(self, end: int | None = None) -> list[str]:
        """Of each attempt when it was triggered, its verdict, and when it was decided."""
        found = []
        for one in self.report(end).attempts:
            decided = "" if one.decided is None else f" {one.decided}"
            mark = "?" if one.in_doubt else ""
            found.append(f"{one.triggered}{mark} {one.verdict.value}{decided}")
        return found


@pytest.mark.parametrize("names", [[99], [-1]])
def test_what_is_no_name_cannot_be_lost(names):
    """Names are told by their numbers in the plan."""
    run = planned("requirement R\n  always p").monitor(frozenset({"q"}))
    with pytest.raises(ValueError, match="no such name"):
        run.lose(names, 0)


def test_names_come_as_numbers():
    run = planned("requirement R\n  always p").monitor(frozenset({"q"}))
    assert run.lose(iter([1]), 0)
    assert run.found((), 0)
    with pytest.raises(TypeError):
        run.lose(3, 1)
    with pytest.raises(TypeError):
        run.lose(["p"], 1)


@pytest.mark.slow
@pytest.mark.parametrize("time", ["held", "sampled"])
@pytest.mark.parametrize(
    ("requirement", "expected"),
    [
        ("upon e\n  then within 3 {0} p", "I"),
        ("upon e\n  then within 8 {0} p", "P"),
        ("upon e\n  then always[0 {0}, 1 {0}] p", "F"),
        ("upon e\n  then always[0 {0}, 9 {0}] within 4 {0} p", "I"),
        ("upon e\n  then (p until[0 {0}, 3 {0}] q) or eventually[4 {0}, 5 {0}] p", "P"),
        ("upon p\n  then historically[5 {0}, 6 {0}] p", "I"),
        ("whenever p\n  then not q", "F"),
    ],
)
def test_long_outages_are_as_short_ones(time, requirement, expected):
    """However many ticks they have; of samples each of them may have been a trigger, too."""
    for unit, scale in (("ns", 1), ("s", 1_000_000_000)):
        run = Run(f"requirement R\n  {requirement.format(unit)}", time)
        run.sample(0, p=False, q=True, e=True).lost("p", 2 * scale, 5 * scale)
        found = run.sample(7 * scale, p=True).report(20 * scale)
        in_doubt = time == "sampled" and expected == "P"
        assert found.verdicts["R"].value == ("I" if in_doubt else expected), unit


@pytest.mark.slow
def test_of_many_ticks_a_network_says_nothing():
    """Better than something wrong, also of what looks back at them later."""
    text = "requirement R\n  upon e\n  then once[0 s, 4 {0}] (eventually[0 s, 1 {0}] p)"
    for unit, scale in (("ns", 1), ("s", 1_000_000_000)):
        run = Run(text.format(unit), "sampled").sample(0, p=False).lost("q", 2 * scale, 5 * scale)
        found = run.sample(7 * scale, p=False, e=True).sample(9 * scale).said()
        assert found == [f"{7 * scale} I", f"{2 * scale}? I"]


@pytest.mark.law
def test_random_samples_too_late_leave_what_the_law_leaves():
    """Of each requirement the verdict."""
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
                expected[name] = without[name]  # what a formula does not depend on is not read
        assert verdicts == expected
        changed += verdicts != without
    assert changed > 6

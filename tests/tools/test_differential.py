"""The differential test finds what it is for, and shrinks it to what a person can read."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from statistics import median
from typing import Any, ClassVar

import pytest

from rvmon.errors import TimeOrderError
from rvmon.monitor.monitor import Monitor
from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, TraceProfile
from rvmon.trace.sample import Sample, Value
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt, Decision
from rvmon.verdicts.report import Report, report_of
from tests.tools.build import (
    always,
    e,
    eventually,
    no,
    p,
    probe,
    q,
    requirement,
    spec_of,
    timeline,
    two,
)
from tests.tools.compare import differences
from tests.tools.differential import campaign, cases_of
from tests.tools.drive import drive
from tests.tools.health import expected_health, health_differences
from tests.tools.judgement import Judgement, Moment
from tests.tools.law import judge, word
from tests.tools.online import differences_after_end, online_differences
from tests.tools.shrink import shrink

pytestmark = pytest.mark.law


class Right:
    """A monitor, of which others do something else."""

    def __init__(self, case: Case) -> None:
        self.monitor = Spec(case.spec).monitor(sources=case.names)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.monitor, name)


class LateFailure(Right):
    """Wrong by one tick where a window is over."""

    def finish_ns(self, t_ns: int | None = None, /) -> Report:
        report = self.monitor.finish_ns(t_ns)
        attempts = [
            replace(a, decided=a.decided + 1)
            if a.decided is not None and a.verdict is Verdict.FAIL
            else a
            for a in report.attempts
        ]
        return replace(report, attempts=tuple(attempts))


class Stepping(Right):
    """Does something else with a sample."""

    step: ClassVar[Callable[[Monitor, int, Mapping[str, Value]], Sequence[Attempt]]]

    def step_ns(self, t_ns: int, values: Mapping[str, Value], /) -> Sequence[Attempt]:
        return type(self).step(self.monitor, t_ns, values)


def _gullible(monitor: Monitor, t: int, values: Mapping[str, Value]) -> Sequence[Attempt]:
    with suppress(TimeOrderError):
        return monitor.step_ns(t, values)
    return []


WRONG: Mapping[str, tuple[Callable[..., Sequence[Attempt]], str]] = {
    "right": (lambda m, t, values: m.step_ns(t, values), ""),
    "tells nothing": (lambda m, t, values: [*m.step_ns(t, values)][:0], "returned []"),
    "tells all twice": (
        lambda m, t, values: [*m.step_ns(t, values)] * 2,
        "decides [('R1', False, 1)], returned [('R1', False, 1), ('R1', False, 1)]",
    ),
    "raises": (lambda *_: [1 // 0], "raised ZeroDivisionError: "),
    "takes what is late": (_gullible, "and it was taken"),
}
"""What monitors do with a sample, and what is said of each."""


class Showing(Right):
    """Shows something else of what is open, and of what is due."""

    shown: ClassVar[Mapping[str, Any]] = {}
    due: ClassVar[Sequence[int | None]] = ()

    @property
    def open(self) -> Sequence[Attempt]:
        left = self.monitor.open
        return [] if self.shown == {"open": False} else [replace(a, **self.shown) for a in left]

    @property
    def next_due(self) -> int | None:
        return self.due[0] if self.due else self.monitor.next_due


def test_wrong_monitors_are_found() -> None:
    """What each does wrong is said; of one that is right nothing is."""
    engines = {
        name: type("Wrong", (Stepping,), {"step": staticmethod(step)})
        for name, (step, _) in WRONG.items()
    }
    found = campaign(
        engines, range(15), Profile(), TraceProfile(), online_every=1, shrunk=0
    ).disagreements
    for name, (_, said) in WRONG.items():
        own = [text for text in found if text.startswith(f"{name}, seed")]
        assert any(said in text for text in own) if said else own == []


def test_a_disagreement_is_shown_in_a_case_of_a_few_lines() -> None:
    found = campaign(
        {"late": LateFailure}, range(15), Profile(), TraceProfile(), online_every=0, shrunk=1
    ).disagreements
    shown = found[0].split("shrunk:")[1]
    assert "F" in shown
    assert shown.count("sample ") <= 2
    assert shown.count("requirement ") == 1


def test_what_is_open_and_due_is_compared() -> None:
    """What is shown of an open attempt has to be undecided, and so has time to be, until then.

    What time alone decided had to be due, and forecasts come true.
    """
    required = two(eventually(p, 0, 3), "and", eventually(q, 0, 5))
    case = Case(spec_of(requirement(required)), timeline(p="0", q="0"))

    def told(case: Case = case, due: Sequence[int | None] = (), **shown: Any) -> list[str]:
        kind = type("Showing", (Showing,), {"shown": shown, "due": due})
        return online_differences(Judgement(case), kind(case))

    assert told() == []
    assert told(required="`within 3 ns p` by 3 ns and `within 5 ns q` by 5 ns", deadline=3) == []
    assert told(open=False) == ["action 1 leaves open [('R', False, 1, 0)], shown are []"]
    assert "has the deadline 3, shown is 5" in told(deadline=5)[0]
    assert "owe `within 5 ns q` by 6 ns" in told(required="`within 5 ns q` by 6 ns")[0]
    assert "owe something" in told(required="something")[0]
    late = replace(case, actions=(*case.actions, 4))
    assert "but due was None" in told(late, due=[None])[0]
    met = Case(spec_of(requirement(eventually(p, 0, 3))), timeline(p="01"))
    assert told(met, forecast=Verdict.FAIL)[0].endswith("F was forecast")


def test_a_finished_run_stays_finished() -> None:
    """After the end nothing is due, and nothing is taken any more."""

    class Restless(Right):
        """Goes on."""

        next_due = 7

        def step_ns(self, t_ns: int, values: Mapping[str, Value], /) -> Sequence[Attempt]:
            return []

        def advance_ns(self, t_ns: int, /) -> Sequence[Attempt]:
            return []

    case = Case(spec_of(requirement(p)), timeline(p="1"))
    monitor = Restless(case)
    report, _ = drive(monitor.monitor, case)
    assert differences_after_end(case, monitor.monitor, report) == []
    found = differences_after_end(case, monitor, replace(report, end=9))
    assert [line.split()[0] for line in found] == ["due", "sample", "advance", "finishing"]


def test_input_health_is_compared() -> None:
    """Unknown, missing and stale values are counted, with the requirements that read them."""
    spec = spec_of(requirement(probe("known", "x"), upon=e), stale={"x": 2})
    case = Case(spec, (Sample(0, {}), Sample(1, {"x": None}), Sample(2, {"x": 1.0}), 9))
    expected = found = expected_health(case, word(case))
    assert [(one.kind, one.name, one.count, one.first) for one in found] == [
        ("missing", "x", 1, 0),
        ("none", "x", 1, 1),
        ("stale", "x", 1, 5),
    ]
    assert all(one.requirements == ("R",) for one in found)
    assert not health_differences(spec, expected, found)
    for changed_ in (
        found[1:],
        found[::-1],
        [replace(found[0], requirements=()), *found[1:]],
        [*found[:2], replace(found[2], count=2)],
        [*found, replace(found[0], name="y")],
    ):
        assert health_differences(spec, expected, changed_)


def test_what_was_seen_is_compared() -> None:
    """The propositions at the trigger and at the decision have to be those of the trace."""
    case = Case(spec_of(requirement(eventually(p, 0, 2), upon=e)), timeline(p="0.u", e=".1"))
    report = judge(case)
    [made] = report.attempts
    at = {"e": True, "p": False}
    good = replace(made, at_trigger=at)
    seen = Judgement(case).seen
    assert not seen.differences(replace(report, attempts=(good,)))
    for bad in (
        made,
        replace(made, at_trigger={**at, "p": True}),
        replace(made, at_trigger={**at, "q": False}),
        replace(good, at_decision={"p": True}),
    ):
        assert seen.differences(replace(report, attempts=(bad,)))


def test_differences() -> None:
    """Every field that engines have to agree on; what is missing, twice, or in another order."""
    spec = spec_of(requirement(p, upon=e), requirement(p, name="S"))
    report = judge(Case(spec, timeline(p="1", e=".1.1")))
    names, (first, *others) = tuple(report.verdicts), report.attempts
    assert differences(report, report) == []
    for fields in (
        {"triggered": 7},
        {"decided": 7},
        {"verdict": Verdict.FAIL},
        {"decision": Decision.POLICY},
        {"number": 7},
    ):
        changed = report_of(names, [replace(first, **fields), *others], end=report.end)  # type: ignore[arg-type]
        assert differences(report, changed) != []
    fewer = report_of(names, others)
    assert any("got None" in line for line in differences(report, fewer))
    without = report_of(("R",), [a for a in report.attempts if a.requirement == "R"])
    assert "S: verdict P, got none" in differences(report, without)
    backwards = replace(report, attempts=report.attempts[::-1])
    assert "in the order" in differences(report, backwards)[0]
    twice = replace(report, attempts=(*report.attempts, first))
    assert differences(report, twice) != []


def test_shrinking_ends_at_the_least() -> None:
    """What is not needed to show the thing is taken away."""

    def drawn(rng: random.Random) -> Case:
        return next(cases_of(rng, Profile(), TraceProfile()))

    def fails(case: Case) -> bool:
        return Verdict.FAIL in judge(case).verdicts.values()

    seeds = [seed for seed in range(20) if fails(drawn(random.Random(str(seed))))]
    small = [shrink(drawn, seed, fails) for seed in seeds]
    assert len(small) >= 5
    assert all(map(fails, small))
    sizes = [len(case.spec.requirements) + len(case.actions) for case in small]
    assert median(sizes) == 2
    assert max(sizes) <= 6
    assert not any(case.end or case.outages for case in small)


def test_deadline_is_the_last_instant_before_time_alone_decides() -> None:
    """Of all that is required the first, of two choices the last; none if nothing bounds it."""
    short, long, ever = eventually(p, 0, 3), eventually(no(q), 0, 5), eventually(no(q))
    for required, wanted in (
        (two(short, "and", long), 3),
        (two(short, "or", long), 5),
        (two(always(q, 0, 3), "and", long), 5),
        (two(short, "and", always(q)), 3),
        (two(always(q, 0, 3), "and", ever), None),
        (two(short, "or", ever), None),
        (eventually(always(p, 2, 2), 0, 3), 2),
    ):
        judgement = Judgement(Case(spec_of(requirement(required)), timeline(p="0", q="1")))
        _, waiting = judgement.at(Moment(0, 0))
        assert [one.deadline() for one in waiting.values()] == [wanted]

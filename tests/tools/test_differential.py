"""The differential test finds what it is for, and shrinks it to what a person can read."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import replace
from statistics import median
from typing import Any, ClassVar

import pytest

from rvmon.errors import TimeOrderError, TraceError
from rvmon.language.checked.formula import UnaryOp
from rvmon.monitor.monitor import Monitor
from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, TraceProfile
from rvmon.testing.law.syntax import subformulas
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
from tests.tools.judgement import Judgement
from tests.tools.law import judge, word
from tests.tools.moments import Moment
from tests.tools.online import differences_after_end, online_differences
from tests.tools.shrink import shrink

pytestmark = pytest.mark.law


class Echo:
    """The oracle as an online monitor: it judges the whole prefix anew at every call."""

    def __init__(self, case: Case) -> None:
        self.case = Case(case.spec, (), None, case.names)
        self.told: set[tuple[str, int]] = set()
        self.floor = -100

    def step_ns(self, t_ns: int, values: Mapping[str, Value], /) -> Sequence[Attempt]:
        if t_ns < self.floor:
            raise TimeOrderError("too late")
        if "nothing of that name" in values or isinstance(values.get("p"), str):
            raise TraceError("no such value")
        self.floor = t_ns + 1
        return self._do(Sample(t_ns, values))

    def advance_ns(self, t_ns: int, /) -> Sequence[Attempt]:
        self.floor = max(self.floor, t_ns)
        return self._do(t_ns)

    def finish_ns(self, t_ns: int | None = None, /) -> Report:
        return judge(replace(self.case, end=t_ns))

    def _do(self, action: Sample | int) -> Sequence[Attempt]:
        self.case = replace(self.case, actions=(*self.case.actions, action))
        reached = max(one.t if isinstance(one, Sample) else one for one in self.case.actions)
        triggers = {name: r.trigger for name, r in self.case.spec.requirements.items()}
        new = [
            attempt
            for attempt in judge(self.case).attempts
            if attempt.decision is Decision.PREFIX
            and attempt.decided <= reached  # at its end time comes to the tick behind it
            and (attempt.requirement, attempt.number) not in self.told
            and getattr(triggers[attempt.requirement], "bound", None) != "end"
        ]
        self.told |= {(attempt.requirement, attempt.number) for attempt in new}
        return new


class LateDeadline(Echo):
    """Wrong by one tick where a deadline is missed."""

    def finish_ns(self, t_ns: int | None = None, /) -> Report:
        report = super().finish_ns(t_ns)
        attempts = [
            replace(a, decided=a.decided + 1)
            if a.decided is not None
            and a.verdict is Verdict.FAIL
            and any(
                getattr(part, "op", None) is UnaryOp.EVENTUALLY
                for part in subformulas(self.case.spec.requirements[a.requirement].consequent)
            )
            else a
            for a in report.attempts
        ]
        incomplete = [name for name, v in report.verdicts.items() if v is Verdict.INCONCLUSIVE]
        return report_of(tuple(report.verdicts), attempts, incomplete=incomplete, end=report.end)


class Silent(Echo):
    """Right in the end, but it tells nothing before."""

    def _do(self, action: Sample | int) -> Sequence[Attempt]:
        super()._do(action)
        return []


class Broken(Echo):
    """Raises at every call."""

    def _do(self, action: Sample | int) -> Sequence[Attempt]:
        raise ZeroDivisionError(f"no {action}")


class Gullible(Echo):
    """Takes samples that come too late."""

    def step_ns(self, t_ns: int, values: Mapping[str, Value], /) -> Sequence[Attempt]:
        return [] if t_ns < self.floor and not values else super().step_ns(t_ns, values)


def found_in(make: type[Echo], pairs: int = 30) -> Sequence[str]:
    """The disagreements of a monitor with the oracle on random cases."""
    echo = {"echo": make}
    return campaign(
        echo, range(pairs), Profile(), TraceProfile(), online_every=2, shrunk=1
    ).disagreements


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (Echo, ""),
        (LateDeadline, "shrunk:"),
        (Silent, "returned []"),
        (Broken, "raised ZeroDivisionError: no"),
        (Gullible, "and it was taken"),
    ],
)
def test_a_wrong_monitor_is_found(make: type[Echo], said: str) -> None:
    """What it does wrong is said, in a case of a few lines; of one that is right nothing is."""
    found = found_in(make)
    assert any(said in text for text in found) if said else found == []
    if make is LateDeadline:
        shown = found[0].split("shrunk:")[1]
        assert "F" in shown
        assert shown.count("sample ") <= 2
        assert shown.count("requirement ") == 1


def test_open_attempts_are_looked_at() -> None:
    """What is open is compared, what time alone decided had to be due, forecasts come true."""

    class Showing(Echo):
        next_due: int | None = None
        fields: Mapping[str, Any] | None = None

        @property
        def open(self) -> Sequence[Attempt]:
            left = [one for one in judge(self.case).attempts if one.decided is None]
            return [] if self.fields is None else [replace(one, **self.fields) for one in left]

    def told(row: str, then: Sequence[int], due: int | None, **fields: Any) -> str:
        actions = (*timeline(p=row), *then)
        case = Case(spec_of(requirement(eventually(p, 0, 3))), actions, *then)
        monitor = Showing(case)
        monitor.next_due, monitor.fields = due, fields or None
        [found] = online_differences(Judgement(case), monitor)
        return found

    assert told("0", [4], None) == "action 1 leaves open [('R', False, 1, 0)], shown are []"
    assert "but due was None" in told("0", [4], None, deadline=3)
    assert told("01", [], 1, forecast=Verdict.FAIL, deadline=3).endswith("F was forecast")


def test_a_finished_run_stays_finished() -> None:
    """After the end nothing is due, and nothing is taken any more."""
    case = Case(spec_of(requirement(p)), timeline(p="1"))
    found = differences_after_end(case, Echo(case), judge(case))
    assert [line.split()[0] for line in found] == ["sample", "advance", "finishing"]
    monitor = Spec(case.spec).monitor()
    report, _ = drive(monitor, case)
    assert differences_after_end(case, monitor, report) == []


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


def test_what_is_owed_and_its_deadline_are_compared() -> None:
    """What is shown of an open attempt has to be undecided, and so has time to be, until then."""
    required = two(eventually(p, 0, 3), "and", eventually(q, 0, 5))
    case = Case(spec_of(requirement(required)), timeline(p="0", q="0"))

    class Showing(Monitor):
        """A monitor that shows something else."""

        shown: ClassVar[Mapping[str, Any]] = {}

        @property
        def open(self) -> Sequence[Attempt]:
            return [replace(attempt, **self.shown) for attempt in super().open]

    def told(**shown: Any) -> list[str]:
        monitor = Spec(case.spec).monitor()
        monitor.__class__ = type("Showing", (Showing,), {"shown": shown})
        return online_differences(Judgement(case), monitor)

    assert told() == []
    assert told(required="`within 3 ns p` by 3 ns and `within 5 ns q` by 5 ns", deadline=3) == []
    assert "has the deadline 3, shown is 5" in told(deadline=5)[0]
    assert "owe `within 5 ns q` by 6 ns" in told(required="`within 5 ns q` by 6 ns")[0]
    assert "owe something" in told(required="something")[0]


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

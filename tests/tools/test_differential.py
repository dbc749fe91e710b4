"""The differential test finds what it is for, and shrinks it to what a person can read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import pytest

from rvmon.errors import TimeOrderError, TraceError
from rvmon.session import Spec
from rvmon.spec.checked.formula import UnaryOp
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, TraceProfile, show_case
from rvmon.testing.law.syntax import subformulas
from rvmon.trace.sample import Sample, Value
from rvmon.verdict import Verdict
from rvmon.verdict.attempt import Attempt, Decision
from rvmon.verdict.report import Report, report_of
from tests.tools.build import (
    always,
    e,
    eventually,
    p,
    probe,
    requirement,
    spec_of,
    timeline,
)
from tests.tools.compare import differences, frame_differences
from tests.tools.differential import (
    campaign,
    decided_on_bound,
    disagreements,
)
from tests.tools.drive import drive
from tests.tools.health import expected_health, health_differences
from tests.tools.judgement import Judgement
from tests.tools.law import judge, word
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


def changed(report: Report, **fields: object) -> Report:
    """The report with its first decided attempt changed."""
    first, *others = report.attempts
    attempts = [replace(first, **fields), *others]  # type: ignore[arg-type]
    return report_of(tuple(report.verdicts), attempts, end=report.end)


def refolded(report: Report, attempts: Sequence[Attempt]) -> Report:
    """A report of other attempts on the same run."""
    incomplete = [name for name, v in report.verdicts.items() if v is Verdict.INCONCLUSIVE]
    return report_of(tuple(report.verdicts), attempts, incomplete=incomplete, end=report.end)


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
        return refolded(report, attempts)


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


class Forgetful(Echo):
    """Knows nothing of what is open, and expects nothing."""

    open: Sequence[Attempt] = ()
    next_due = None


def run(make: type[Echo], pairs: int = 60) -> list[str]:
    echo = {"echo": make}
    found = campaign(echo, range(pairs), Profile(), TraceProfile(), online_every=2, shrunk=1)
    return found.disagreements


def test_no_disagreement_with_itself() -> None:
    """A monitor that does as the oracle does has no disagreement, online neither."""
    found = campaign({"echo": Echo}, range(60), Profile(), TraceProfile(), online_every=1)
    assert found.disagreements == []
    assert found.counts["judged by echo"] == found.counts["pairs"] == 60


def test_wrong_instant_is_found_and_shrunk() -> None:
    """An instant that is off by one is found, and shown in a case of a few lines."""
    first = run(LateDeadline)[0]
    assert first.startswith("echo, seed ")
    shown = first.split("shrunk:")[1]
    assert "F" in shown
    assert shown.count("sample ") <= 2
    assert shown.count("requirement ") == 1


def test_silence_is_found() -> None:
    """A monitor that decides in time and tells late is found by the online check."""
    assert any("returned []" in text for text in run(Silent))
    case = Case(spec_of(requirement(p)), timeline(p="1"))
    assert disagreements(case, Silent) == []
    assert disagreements(case, Silent, online=True) == [
        "action 1 decides [('R', False, 1)], returned []"
    ]


def test_late_samples_have_to_be_refused() -> None:
    """A sample that comes too late must not be taken."""
    case = Case(spec_of(requirement(p)), timeline(p="1"))
    [found] = disagreements(case, Gullible, online=True)
    assert found == "action 1 was followed by a sample at 0 with {}, and it was taken"


def test_open_attempts_and_their_dues_are_looked_at() -> None:
    """What is open is compared, and what time alone decided had to be due."""
    case = Case(spec_of(requirement(eventually(p, 0, 3))), (*timeline(p="0"), 4), 4)
    [found] = online_differences(Judgement(case), Forgetful(case))
    assert found == "action 1 leaves open [('R', False, 1, 0)], shown are []"

    class Unexpecting(Echo):
        next_due = None

        @property
        def open(self) -> Sequence[Attempt]:
            return [replace(a, deadline=3) for a in judge(self.case).attempts if a.decided is None]

    [found] = online_differences(Judgement(case), Unexpecting(case))
    assert "but due was None" in found


def test_a_finished_run_stays_finished() -> None:
    """After the end nothing is due, and nothing is taken any more."""
    case = Case(spec_of(requirement(p)), timeline(p="1"))
    found = differences_after_end(case, Echo(case), judge(case))
    assert [line.split()[0] for line in found] == ["sample", "advance", "finishing"]
    monitor = Spec(case.spec).monitor()
    report, _ = drive(monitor, case)
    assert differences_after_end(case, monitor, report) == []


def test_forecasts_have_to_come_true() -> None:
    """What is said to fail for sure must not pass."""

    class Prophet(Echo):
        next_due = 1

        @property
        def open(self) -> Sequence[Attempt]:
            return [
                replace(a, forecast=Verdict.FAIL, deadline=3)
                for a in judge(self.case).attempts
                if a.decided is None
            ]

    case = Case(spec_of(requirement(eventually(p, 0, 3))), timeline(p="01"))
    [found] = online_differences(Judgement(case), Prophet(case))
    assert found.endswith("F was forecast")


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


def test_begin_and_end_are_compared() -> None:
    """Where the trace begins and ends is part of a report."""
    report = judge(Case(spec_of(requirement(p)), timeline(p="1"), 7))
    assert frame_differences(report, report) == []
    assert frame_differences(report, replace(report, end=8))
    assert frame_differences(report, replace(report, origin=8))


def test_exceptions_are_findings() -> None:
    """What an engine raises is a disagreement, not the end of the campaign."""
    assert len(run(Broken)) > 50
    assert "raised ZeroDivisionError: no" in run(Broken, 5)[0]


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("triggered", 7),
        ("decided", 7),
        ("verdict", Verdict.FAIL),
        ("decision", Decision.POLICY),
        ("number", 7),
    ],
)
def test_differences(field: str, value: object) -> None:
    """Every field that engines have to agree on is compared."""
    report = judge(Case(spec_of(requirement(p, upon=e)), timeline(p="1", e=".1.1")))
    assert differences(report, report) == []
    assert differences(report, changed(report, **{field: value})) != []


def test_differences_see_missing_attempts_and_order() -> None:
    """A missing attempt, a missing requirement and another order are differences."""
    spec = spec_of(requirement(p, upon=e), requirement(p, name="S"))
    report = judge(Case(spec, timeline(p="1", e=".1.1")))
    fewer = report_of(tuple(report.verdicts), report.attempts[1:])
    assert any("got None" in line for line in differences(report, fewer))
    without = report_of(("R",), [a for a in report.attempts if a.requirement == "R"])
    assert "S: verdict P, got none" in differences(report, without)
    backwards = replace(report, attempts=report.attempts[::-1])
    assert "in the order" in differences(report, backwards)[0]
    twice = replace(report, attempts=(*report.attempts, report.attempts[-1]))
    assert differences(report, twice) != []


def test_shrinking_ends_at_the_least() -> None:
    """What is not needed to show the thing is taken away."""
    spec = spec_of(requirement(always(eventually(p, 1, 3), 0, 5), upon=e), requirement(p, name="S"))
    case = Case(spec, (*timeline(p="0..1..0", x="123456", e=".1..1"), 9, 20), 30)

    def fails(smaller: Case) -> bool:
        return Verdict.FAIL in judge(smaller).verdicts.values()

    small = shrink(case, fails)
    assert fails(small)
    assert len(small.spec.requirements) == 1
    assert len(small.actions) == 1
    assert small.end is None
    text = show_case(small)
    assert "then false" in text or "then p" in text


def test_shrinking_is_bounded() -> None:
    """However slowly it gets on, shrinking ends after so many tries."""
    tries = []

    def always_shows(case: Case) -> bool:
        tries.append(case)
        return True

    shrink(Case(spec_of(requirement(p)), timeline(p="1" * 30)), always_shows, most=7)
    assert len(tries) == 7


def test_on_bound() -> None:
    """Decided on a bound is: at b or b + 1 of a window that begins at the trigger."""
    spec = spec_of(requirement(eventually(p, 1, 3)))
    at = {
        row: decided_on_bound(spec, judge(Case(spec, timeline(p=row))).attempts[0])
        for row in ("0.1", "0..1", "0...1", "0")
    }
    assert at == {"0.1": False, "0..1": True, "0...1": True, "0": False}


def test_drive_tells_everything_in_order() -> None:
    """Samples, advances and the end reach the monitor as the case lists them."""
    calls: list[object] = []

    class Spy(Echo):
        def _do(self, action: Sample | int) -> Sequence[Attempt]:
            calls.append(action)
            return []

        def finish_ns(self, t_ns: int | None = None, /) -> Report:
            calls.append(("finish", t_ns))
            return super().finish_ns(t_ns)

    case = Case(spec_of(requirement(p)), (Sample(0, {}), 2, Sample(2, {})), 5)
    _, returned = drive(Spy(case), case)
    assert calls == [*case.actions, ("finish", 5)]
    assert returned == [[], [], []]

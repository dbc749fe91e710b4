"""The differential test finds what it is for, and shrinks it to what a person can read."""

import random
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from statistics import median
from typing import Any

import pytest

from rvmon.errors import TimeOrderError
from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, TraceProfile
from rvmon.trace.sample import Sample
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
from tests.tools.each import each
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


def wrong(**methods: Any) -> type[Right]:
    """A monitor of which some methods are others; they are given that which is right."""
    made = {
        name: lambda self, *words, does=does: does(self.monitor, *words)
        for name, does in methods.items()
    }
    return type("Wrong", (Right,), made)


def gullible(monitor: Any, *words: Any) -> Sequence[Attempt]:
    with suppress(TimeOrderError):
        return monitor.step_ns(*words)
    return []


def late(monitor: Any, t_ns: int | None = None) -> Report:
    """Wrong by one tick where a window is over."""
    report = monitor.finish_ns(t_ns)
    later = [
        replace(a, decided=a.decided + (a.verdict is Verdict.FAIL)) if a.decided is not None else a
        for a in report.attempts
    ]
    return replace(report, attempts=tuple(later))


WRONG: Mapping[str, tuple[Callable[..., Sequence[Attempt]], str]] = {
    "right": (lambda m, *words: m.step_ns(*words), ""),
    "tells nothing": (lambda m, *words: [*m.step_ns(*words)][:0], "returned []"),
    "tells all twice": (
        lambda m, *words: [*m.step_ns(*words)] * 2,
        "decides [('R1', False, 1)], returned [('R1', False, 1), ('R1', False, 1)]",
    ),
    "raises": (lambda *_: [1 // 0], "raised ZeroDivisionError: "),
    "takes what is late": (gullible, "and it was taken"),
}
"""What monitors do with a sample, and what is said of each."""


def test_wrong_monitors_are_found() -> None:
    """What each does wrong is said; of one that is right nothing is."""
    engines = {name: wrong(step_ns=step) for name, (step, _) in WRONG.items()}
    found = campaign(
        engines, range(8), Profile(), TraceProfile(), online_every=1, shrunk=0
    ).disagreements
    for name, (_, said) in WRONG.items():
        own = [text for text in found if text.startswith(f"{name}, seed")]
        assert any(said in text for text in own) if said else own == []


def test_a_disagreement_is_shown_in_a_case_of_a_few_lines() -> None:
    engines = {"late": wrong(finish_ns=late)}
    found = campaign(engines, range(8), Profile(), TraceProfile(), online_every=0, shrunk=1)
    shown = found.disagreements[0].split("shrunk:")[1]
    assert "F" in shown
    assert shown.count("sample ") <= 2
    assert shown.count("requirement ") == 1


BOTH = requirement(two(eventually(p, 0, 3), "and", eventually(q, 0, 5)))
OPEN = Case(spec_of(BOTH), timeline(p="0", q="0"))
MET = Case(spec_of(requirement(eventually(p, 0, 3))), timeline(p="01"))


@each(
    ("case", "shown", "said"),
    [
        (OPEN, {}, ""),
        (OPEN, {"required": "`within 3 ns p` by 3 ns and `within 5 ns q` by 5 ns"}, ""),
        (OPEN, {"open": []}, "action 1 leaves open [('R', False, 1, 0)], shown are []"),
        (OPEN, {"deadline": 5}, "has the deadline 3, shown is 5"),
        (OPEN, {"required": "`within 5 ns q` by 6 ns"}, "owe `within 5 ns q` by 6 ns"),
        (OPEN, {"required": "something"}, "owe something"),
        (replace(OPEN, actions=(*OPEN.actions, 4)), {"next_due": None}, "but due was None"),
        (MET, {"forecast": Verdict.FAIL}, "F was forecast"),
    ],
)
def test_what_is_open_and_due_is_compared(case: Case, shown: dict[str, Any], said: str) -> None:
    """What is shown of an open attempt has to be undecided, and so has time to be, until then.

    What time alone decided had to be due, and forecasts come true.
    """
    own = {name: shown[name] for name in ("open", "next_due") if name in shown}
    fields = {name: one for name, one in shown.items() if name not in own}

    class Showing(Right):
        def __getattribute__(self, name: str) -> Any:
            if name in own:
                return own[name]
            if name == "open":
                return [replace(one, **fields) for one in self.monitor.open]
            return super().__getattribute__(name)

    found = online_differences(Judgement(case), Showing(case))
    assert said in found[0] if said else found == []


def test_a_finished_run_stays_finished() -> None:
    """After the end nothing is due, and nothing is taken any more."""
    case = Case(spec_of(requirement(p)), timeline(p="1"))
    goes_on = wrong(step_ns=lambda *_: [], advance_ns=lambda *_: [])
    goes_on.next_due = 7
    monitor = goes_on(case)
    report, _ = drive(monitor.monitor, case)
    assert differences_after_end(case, monitor.monitor, report) == []
    found = differences_after_end(case, monitor, replace(report, end=9))
    assert [line.split()[0] for line in found] == ["due", "sample", "advance", "finishing"]


def test_input_health_is_compared() -> None:
    """Unknown, missing and stale values are counted, with the requirements that read them."""
    spec = spec_of(requirement(probe("known", "x"), upon=e), stale={"x": 2})
    case = Case(spec, (Sample(0, {}), Sample(1, {"x": None}), Sample(2, {"x": 1.0}), 9))
    found = expected_health(case, word(case))
    assert [(one.kind, one.name, one.count, one.first, one.requirements) for one in found] == [
        ("missing", "x", 1, 0, ("R",)),
        ("none", "x", 1, 1, ("R",)),
        ("stale", "x", 1, 5, ("R",)),
    ]
    assert not health_differences(spec, found, found)
    for changed in (
        found[1:],
        found[::-1],
        [replace(found[0], requirements=()), *found[1:]],
        [*found[:2], replace(found[2], count=2)],
        [*found, replace(found[0], name="y")],
    ):
        assert health_differences(spec, found, changed)


def test_what_was_seen_is_compared() -> None:
    """The propositions at the trigger and at the decision have to be those of the trace."""
    case = Case(spec_of(requirement(eventually(p, 0, 2), upon=e)), timeline(p="0.u", e=".1"))
    judgement = Judgement(case)
    [made] = judgement.report.attempts
    at = {"e": True, "p": False}
    for told, is_right in (
        ({"at_trigger": at}, True),
        ({}, False),
        ({"at_trigger": {**at, "p": True}}, False),
        ({"at_trigger": {**at, "q": False}}, False),
        ({"at_trigger": at, "at_decision": {"p": True}}, False),
    ):
        report = replace(judgement.report, attempts=(replace(made, **told),))
        assert (judgement.seen.differences(report) == []) is is_right


def test_differences() -> None:
    """Every field that engines have to agree on; what is missing, twice, or in another order."""
    spec = spec_of(requirement(p, upon=e), requirement(p, name="S"))
    report = judge(Case(spec, timeline(p="1", e=".1.1")))
    names, (first, *others) = tuple(report.verdicts), report.attempts
    assert differences(report, report) == []
    for field, value in (
        ("triggered", 7),
        ("decided", 7),
        ("verdict", Verdict.FAIL),
        ("decision", Decision.POLICY),
        ("number", 7),
    ):
        changed = report_of(names, [replace(first, **{field: value}), *others], end=report.end)
        assert differences(report, changed) != []
    assert any("got None" in line for line in differences(report, report_of(names, others)))
    without = report_of(("R",), [a for a in report.attempts if a.requirement == "R"])
    assert "S: verdict P, got none" in differences(report, without)
    backwards = replace(report, attempts=report.attempts[::-1])
    assert "in the order" in differences(report, backwards)[0]
    assert differences(report, replace(report, attempts=(*report.attempts, first))) != []


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


@each(
    ("required", "wanted"),
    [
        (two(eventually(p, 0, 3), "and", eventually(no(q), 0, 5)), 3),
        (two(eventually(p, 0, 3), "or", eventually(no(q), 0, 5)), 5),
        (two(always(q, 0, 3), "and", eventually(no(q), 0, 5)), 5),
        (two(eventually(p, 0, 3), "and", always(q)), 3),
        (two(always(q, 0, 3), "and", eventually(no(q))), None),
        (two(eventually(p, 0, 3), "or", eventually(no(q))), None),
        (eventually(always(p, 2, 2), 0, 3), 2),
    ],
)
def test_deadline_is_the_last_instant_before_time_alone_decides(required, wanted) -> None:
    """Of all that is required the first, of two choices the last; none if nothing bounds it."""
    judgement = Judgement(Case(spec_of(requirement(required)), timeline(p="0", q="1")))
    _, waiting = judgement.at(Moment(0, 0))
    assert [one.deadline() for one in waiting.values()] == [wanted]

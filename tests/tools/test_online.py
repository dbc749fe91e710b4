"""What the law says of a run underway, and how a monitor is held to it."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar

import pytest

from rvmon.monitor import Monitor
from rvmon.session import Spec
from rvmon.spec.checked.specification import TimeModel
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, TraceProfile
from rvmon.testing.law.syntax import is_upon_end
from rvmon.verdict.attempt import Attempt, Decision
from tests.tools.build import always, eventually, no, p, q, requirement, spec_of, timeline, two
from tests.tools.compare import outcomes
from tests.tools.differential import campaign, case_of
from tests.tools.drive import drive
from tests.tools.forms import HeldBack, Maker
from tests.tools.health import health_differences
from tests.tools.judgement import Judgement
from tests.tools.law import judge
from tests.tools.moments import Moment, moments
from tests.tools.online import online_differences

pytestmark = pytest.mark.law


def test_what_is_owed_and_its_deadline_are_compared() -> None:
    """What is shown of an open attempt has to be undecided, and so has time to be, until then."""
    owed = two(eventually(p, 0, 3), "and", eventually(q, 0, 5))
    case = Case(spec_of(requirement(owed)), timeline(p="0", q="0"))

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
    """Of all that is owed the first, of one of two things the last; none if nothing bounds it."""
    short, long, ever = eventually(p, 0, 3), eventually(no(q), 0, 5), eventually(no(q))
    for owed, wanted in (
        (two(short, "and", long), 3),
        (two(short, "or", long), 5),
        (two(always(q, 0, 3), "and", long), 5),
        (two(short, "and", always(q)), 3),
        (two(always(q, 0, 3), "and", ever), None),
        (two(short, "or", ever), None),
        (eventually(always(p, 2, 2), 0, 3), 2),
    ):
        judgement = Judgement(Case(spec_of(requirement(owed)), timeline(p="0", q="1")))
        _, waiting = judgement.at(Moment(0, 0))
        assert [one.deadline() for one in waiting.values()] == [wanted]


@pytest.mark.parametrize("time", TimeModel)
def test_a_moment_of_a_run_is_the_run_up_to_there(time: TimeModel) -> None:
    """What was decided and what was open at a moment is what a trace that ends there says."""
    seen: Counter[str] = Counter()
    for seed in range(40):
        case = case_of(f"moments {seed}", Profile(time=time), TraceProfile())
        judgement = Judgement(case)
        at_end = {name for name, r in case.spec.requirements.items() if is_upon_end(r)}
        for count, moment in enumerate(moments(case), start=1):
            report = judge(Case(case.spec, case.actions[:count], None, case.names))
            told = {
                key: outcome for key, outcome in outcomes(report).items() if key[0] not in at_end
            }
            decided, waiting = ({}, {}) if moment is None else judgement.at(moment)
            # At the end of a trace time comes to the tick behind it.
            wanted = {
                key: outcome
                for key, outcome in told.items()
                if outcome.decision is Decision.PREFIX and outcome.decided <= moment.reached
            }
            assert decided == wanted
            # What is in doubt may be met by the end: then a trace says nothing of it.
            assert {
                key: one.triggered
                for key, one in waiting.items()
                if not (key[1] and key not in told)
            } == {key: outcome.triggered for key, outcome in told.items() if key not in wanted}
            seen.update(decided=len(decided), waiting=len(waiting))
    assert min(seen.values()) > 20


def test_samples_in_portions() -> None:
    """Portions of a sample with one stamp come to the same, a stamp later."""
    makers = {way: Maker(f"c+{way}") for way in ("next", "next+interrupt")}
    found = campaign(makers, range(25), Profile(), TraceProfile(), online_every=3)
    assert found.disagreements == []


def test_portions_say_what_they_provoke() -> None:
    """Of a signal that came with two values at one stamp, the conflict is counted."""
    case = Case(spec_of(requirement(eventually(p))), timeline(p="0101", e="1111"))
    conflicts = set()
    for seed in range(10):
        monitor = HeldBack(Spec(case.spec).monitor(settle="next"), case.spec, random.Random(seed))
        report, _ = drive(monitor, case)
        provoked = monitor.health()
        assert not health_differences(
            case.spec, [*Judgement(case).health, *provoked], report.health
        )
        conflicts |= {one.name for one in provoked}
    assert conflicts == {"p"}

"""A notation for what the oracle and the core say of a trace drawn as rows of characters."""

from collections.abc import Callable, Mapping, Sequence

import pytest
from tests.tools.build import requirement, spec_of, timeline
from tests.tools.compare import differences
from tests.tools.drive import drive
from tests.tools.forms import Maker

from rvmon.language.checked.formula import Formula
from rvmon.language.checked.specification import Requirement, TimeModel
from rvmon.testing.generate.trace import Case
from rvmon.testing.law.word import Outage
from rvmon.testing.oracle import evaluate
from rvmon.trace.sample import Sample
from rvmon.verdicts.attempt import Attempt, Decision

Judge = Callable[..., list[str]]

_MARK = {
    Decision.PREFIX: "",
    Decision.OPEN: "",
    Decision.HELD_TO_END: " held",
    Decision.POLICY: " policy",
}


def brief(attempt: Attempt) -> str:
    """Trigger instant, verdict, decision instant, and what settled it if not the prefix."""
    decided = "" if attempt.decided is None else f" {attempt.decided}"
    return f"{attempt.triggered} {attempt.verdict.value}{decided}{_MARK[attempt.decision]}"


def judge(
    what: Formula | Requirement,
    *,
    samples: Sequence[Sample] = (),
    time: TimeModel = TimeModel.HELD,
    period: int | None = None,
    stale: Mapping[str, int] | None = None,
    end: int | None = None,
    advances: Sequence[int] = (),
    names: frozenset[str] | None = None,
    lost: Sequence[tuple[str, int, int]] = (),
    **rows: str,
) -> list[str]:
    """All attempts in the order of the report; a formula stands for `upon start then` it.

    What was `lost` are names in one word, first and last instant.
    """
    judged = what if isinstance(what, Requirement) else requirement(what)
    spec = spec_of(judged, time=time, period=period, stale=stale)
    told = samples or timeline(**rows)
    outages = tuple(Outage(frozenset(own.split()), *stretch) for own, *stretch in lost)
    report = evaluate(spec, told, end=end, advances=advances, names=names, outages=outages)
    actions = sorted((*told, *advances), key=lambda one: one.t if isinstance(one, Sample) else one)
    case = Case(spec, tuple(actions), end, names, outages)
    assert differences(report, drive(Maker()(case), case)[0]) == []
    return [brief(attempt) for attempt in report.attempts]


@pytest.fixture(name="judge")
def _judge() -> Judge:
    return judge

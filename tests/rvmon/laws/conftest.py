"""The judges that the laws are tested on."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, replace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.tools.compare import differences
from tests.tools.drive import drive
from tests.tools.forms import Maker
from tests.tools.law import judge as oracle

from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, TraceProfile
from rvmon.verdict.report import Report

PLAIN = TraceProfile()

Law = Callable[[st.DataObject], None]


@dataclass(frozen=True, slots=True)
class Subject:
    """What a law is tested on: how it judges a case, what it takes, on how many examples."""

    judge: Callable[[Case], Report]
    profile: Profile
    examples: int
    traces: TraceProfile = PLAIN

    @property
    def one(self) -> Profile:
        """Specs of one requirement without captured values."""
        return replace(self.profile, requirements=1, captures=False, for_each=False)

    def differences(self, left: Case, right: Case) -> list[str]:
        """How the reports on two cases differ."""
        return differences(self.judge(left), self.judge(right))


class Form:
    """A form that the core is run in, told cases call by call."""

    def __init__(self, name: str) -> None:
        self.make = Maker(name)

    def __call__(self, case: Case) -> Report:
        return drive(self.make(case), case)[0]


TIMES = int(os.environ.get("LAW_TIMES", "1"))
"""So many times as many examples: for campaigns."""

ALL = Profile()

SUBJECTS = {
    "oracle": Subject(oracle, ALL, 15),
    "oracle, outages": Subject(oracle, ALL, 15, TraceProfile(outages=70)),
    "c": Subject(Form("c"), ALL, 12),
    "c rows": Subject(Form("c rows"), ALL, 6),
}


@pytest.fixture(scope="session", params=SUBJECTS)
def subject(request: pytest.FixtureRequest) -> Subject:
    """The oracle, then every form."""
    return SUBJECTS[request.param]


@pytest.fixture
def holds(subject: Subject) -> Callable[[Law], None]:
    """Decorates a law: it is tried at once, on as many examples as the subject is worth."""

    def tried(law: Law) -> None:
        few = settings(
            max_examples=subject.examples * TIMES,
            deadline=None,
            suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow],
        )
        few(given(st.data())(law))()

    return tried

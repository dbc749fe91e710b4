"""The judges that the laws are tested on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import pytest

from rvmon.session import Spec
from rvmon.testing.case import Case
from rvmon.testing.compare import differences
from rvmon.testing.drive import drive
from rvmon.testing.generate_spec import Profile
from rvmon.testing.law import judge as oracle
from rvmon.verdict.report import Report


@dataclass(frozen=True, slots=True)
class Subject:
    """What a law is tested on: how it judges a case, and which specs it takes."""

    judge: Callable[[Case], Report]
    profile: Profile

    @property
    def one(self) -> Profile:
        """Specs of one requirement without captured values."""
        return replace(self.profile, requirements=1, captures=False, for_each=False)

    def differences(self, left: Case, right: Case) -> list[str]:
        """How the reports on two cases differ."""
        return differences(self.judge(left), self.judge(right))


def engine(case: Case) -> Report:
    """The engine that the compiler picks, told the case call by call."""
    report, _ = drive(Spec(case.spec).monitor(sources=case.names), case)
    return report


SUBJECTS = {
    "oracle": Subject(oracle, Profile()),
    "engine": Subject(engine, Profile(mixed=False)),
}


@pytest.fixture(scope="session", params=SUBJECTS)
def subject(request: pytest.FixtureRequest) -> Subject:
    """The oracle, then the engine."""
    return SUBJECTS[request.param]

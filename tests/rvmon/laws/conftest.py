"""The judges that the laws are tested on."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from rvmon.testing.case import Case
from rvmon.testing.differential import judge as oracle
from rvmon.verdict.report import Report

Judge = Callable[[Case], Report]


@pytest.fixture(scope="session", params=["oracle"])
def judge(request: pytest.FixtureRequest) -> Judge:
    """What judges a case."""
    return {"oracle": oracle}[request.param]

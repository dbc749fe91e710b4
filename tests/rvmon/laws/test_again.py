"""A monitor that is used again is as a new one."""

from dataclasses import replace

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from tests.tools.drive import drive, feed

from rvmon.errors import RvmonError
from rvmon.session import Spec
from rvmon.testing.strategies import cases


@pytest.mark.law
@settings(max_examples=20, deadline=None)
@given(data=st.data())
def test_a_run_leaves_nothing_behind(data: st.DataObject) -> None:
    case = data.draw(cases())
    before = data.draw(st.integers(0, len(case.actions)))
    try:
        monitor, new = (Spec(case.spec).monitor(sources=case.names) for _ in "12")
    except RvmonError:  # the core does not judge it
        assume(False)
    for action in case.actions[:before]:
        feed(monitor, action)
    if data.draw(st.booleans()):
        monitor.finish_ns()
    monitor.reset()
    assert monitor.open == new.open
    told = drive(monitor, replace(case))
    assert told == drive(new, case)

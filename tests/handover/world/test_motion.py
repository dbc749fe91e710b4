"""Minimum-jerk paths and the arm's geometry."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from handover.world.motion import DOWN, evaluate, grip_point, joints_for, min_jerk, quintic, slope

numbers = st.floats(-2, 2)


@pytest.mark.slow
@settings(deadline=None)
@given(numbers, numbers, numbers, st.floats(0.2, 3))
def test_path_meets_its_ends(start: float, speed: float, goal: float, duration: float) -> None:
    path = quintic(start, speed, goal, duration)
    assert evaluate(path, 0.0) == start
    assert slope(path, 0.0) == speed
    assert evaluate(path, duration) == pytest.approx(goal, abs=1e-9)
    assert slope(path, duration) == pytest.approx(0.0, abs=1e-8)


@pytest.mark.slow
@settings(deadline=None)
@given(st.floats(0, 1))
def test_path_from_rest_is_the_min_jerk_profile(share: float) -> None:
    """From rest, both forms of the path agree."""
    assert evaluate(quintic(0.0, 0.0, 1.0, 1.0), share) == pytest.approx(min_jerk(share), abs=1e-12)


@pytest.mark.slow
@settings(deadline=None)
@given(st.floats(-0.2, 0.25), st.floats(0.05, 0.4))
def test_inverse_kinematics_inverts(x: float, z: float) -> None:
    joints = joints_for(x, z)
    assert joints is not None
    assert grip_point(joints) == pytest.approx((x, z), abs=1e-9)
    assert sum(joints) == pytest.approx(DOWN)

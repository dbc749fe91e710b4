"""Gymnasium environments with monitored episodes."""

import warnings

import pytest

from rvmon import RvmonError, Verdict, loads

gymnasium = pytest.importorskip("gymnasium")
SPEC = """
spec pole
signal angle : real [rad]
signal pushed_right : bool
requirement P1 "The pole stays upright"
  always abs(angle) <= 0.15 rad
requirement P2 "A push is answered"
  upon rise(pushed_right)
  then within 200 ms not pushed_right
"""


def _judged(**options):
    from rvmon.adapters.gym import Judged

    def observe(observation, action, _):
        return {"angle": float(observation[2]), "pushed_right": action == 1}

    return Judged(gymnasium.make("CartPole-v1"), loads(SPEC), observe, step_s=0.02, **options)


def _played(env):
    """The rewards, the information and the length of an episode of pushes to the right."""
    env.reset(seed=1)
    steps, over = [], False
    while not over:
        _, reward, terminated, truncated, info = env.step(1)
        steps.append((reward, info["rv"]))
        over = terminated or truncated
    return steps


def test_a_wrapped_environment_is_a_good_one():
    from gymnasium.utils.env_checker import check_env

    with warnings.catch_warnings():  # it advises the bare environment instead of a wrapper
        warnings.simplefilter("ignore", UserWarning)
        check_env(_judged(), skip_render_check=True)


def test_each_episode_is_a_run():
    env = _judged()
    for _ in range(2):
        _, info = env.reset(seed=1)
        assert set(info["rv"]["verdicts"].values()) == {Verdict.NOT_TRIGGERED}
        told = [one for _, one in _played(env)]
        assert told[-1]["verdicts"]["P1"] is Verdict.FAIL
        assert "P1#1" in {attempt.name for one in told for attempt in one["decided"]}


def test_a_failure_can_end_the_episode():
    ended, whole = (_played(_judged(ends_on_failure=ends)) for ends in (True, False))
    assert len(ended) < len(whole)
    assert ended[-1][1]["verdicts"]["P1"] is Verdict.FAIL


def test_the_reward_can_be_shaped_by_robustness():
    """Each figure counts once, when it is final."""
    steps = _played(_judged(shaping=lambda figures: 100.0 * len(figures)))
    figures = [len(one["margins"]) for _, one in steps]
    assert sum(figures) >= 2
    assert [reward for reward, _ in steps] == [1 + 100.0 * count for count in figures]


def test_samples_within_a_step_have_their_instants():
    """A deadline is decided in the step in which it passes, even without a sample."""
    from rvmon.adapters.gym import Judged

    decided = []

    def observe(_, action, __):
        is_first = action is not None and not decided
        return [(30_000_000, {"pushed_right": True})] if is_first else []

    env = Judged(gymnasium.make("CartPole-v1"), loads(SPEC), observe, step_s=0.04)
    env.reset(seed=1)
    for action in (1, 0, 1, 0, 1, 0):
        *_, info = env.step(action)
        decided.append([(one.name, one.triggered, one.decided) for one in info["rv"]["decided"]])
    assert decided == [[], [], [], [], [], [("P2#1", 30_000_000, 230_000_001)]]
    with pytest.raises(RvmonError, match="step_s"):
        Judged(gymnasium.make("CartPole-v1"), loads(SPEC), observe, step_s=0.0)

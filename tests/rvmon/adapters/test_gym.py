"""Environments of Gymnasium whose episodes are judged."""

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


def test_a_wrapped_environment_is_a_good_one():
    from gymnasium.utils.env_checker import check_env

    with warnings.catch_warnings():  # the wrapper is not the bare environment, which it advises
        warnings.simplefilter("ignore", UserWarning)
        check_env(_judged(), skip_render_check=True)


def test_each_episode_is_a_run():
    env = _judged()
    for _ in range(2):
        _, info = env.reset(seed=1)
        assert set(info["rv"]["verdicts"].values()) == {Verdict.NOT_TRIGGERED}
        decided, over = [], False
        while not over:
            _, _, terminated, truncated, info = env.step(1)
            decided += info["rv"]["decided"]
            over = terminated or truncated
        assert info["rv"]["verdicts"]["P1"] is Verdict.FAIL
        assert "P1#1" in {attempt.name for attempt in decided}


def test_a_failure_can_end_the_episode():
    lengths = {}
    for ends in (True, False):
        env = _judged(ends_on_failure=ends)
        env.reset(seed=1)
        steps, over = 0, False
        while not over:
            _, _, terminated, truncated, info = env.step(1)
            over, steps = terminated or truncated, steps + 1
        lengths[ends] = steps
    assert lengths[True] < lengths[False]
    assert info["rv"]["verdicts"]["P1"] is Verdict.FAIL


def test_the_reward_can_be_shaped_by_robustness():
    """Each figure counts once, when nothing can change it any more."""
    env = _judged(shaping=lambda figures: 100.0 * len(figures))
    env.reset(seed=1)
    total, steps, figures, over = 0.0, 0, 0, False
    while not over:
        _, reward, terminated, truncated, info = env.step(1)
        total, steps = total + reward, steps + 1
        figures += len(info["rv"]["margins"])
        over = terminated or truncated
    assert figures >= 2
    assert total == steps + 100.0 * figures


def test_samples_within_a_step_have_their_instants():
    """And a deadline is decided in the step in which it passes, though nothing comes."""
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

"""The handover as a Gymnasium environment."""

import random
import warnings

import pytest

from handover.driver import run_test
from rvmon import load

gymnasium = pytest.importorskip("gymnasium")
pytestmark = pytest.mark.campaign


def _env(**options):
    return gymnasium.make("handover.environment:rvmon/Handover-v0", **options)


def _episode(env, seed, steps=400):
    """Random actions at random times; the result of each step."""
    rng = random.Random(seed)
    env.reset(seed=seed)
    for _ in range(steps):
        action = rng.randrange(env.action_space.n) if rng.random() < 0.05 else 0
        *told, info = env.step(action)
        yield *told, info
        if told[2] or told[3]:
            return


def test_gymnasiums_checker_accepts_it():
    from gymnasium.utils.env_checker import check_env

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(_env().unwrapped, skip_render_check=True)


def test_an_episode_is_a_test_that_can_be_played_again():
    for seed in (1, 2):
        env = _env(robot="legacy")
        samples = [one for *_, info in _episode(env, seed) for one in info["samples"]]
        assert tuple(samples) == run_test(env.unwrapped.test, robot="legacy").samples
        assert len(samples) > 50


def test_it_is_judged_as_its_test_is():
    from handover.checker import spec_path
    from handover.environment import STEP_S, published
    from rvmon.adapters.gym import Judged

    spec = load(spec_path("legacy").with_name("handover.rv"))
    env = Judged(_env(robot="legacy"), spec, published(spec), step_s=STEP_S)
    decided = [one for *_, info in _episode(env, 2) for one in info["rv"]["decided"]]
    declared = {*spec.schema.signals, *spec.schema.events}
    samples = [
        (t / 1e9, {name: value for name, value in values.items() if name in declared})
        for t, values in run_test(env.unwrapped.test, robot="legacy").samples
    ]
    wanted = [one for one in spec.evaluate(samples).attempts if one.decided is not None]
    assert sorted(decided, key=_place) == sorted(wanted, key=_place)
    assert decided


def _place(attempt):
    return attempt.requirement, attempt.number


def _taken(env):
    """A person who activates the robot, and takes the piece as soon as it is held out."""
    from handover.environment import ACTIONS

    numbers = {name: number for number, name in enumerate(ACTIONS)}
    observation, _ = env.reset(seed=3)
    informed, over, step = None, False, 0
    while not over:
        if observation[1] and informed is None:
            informed = step
        after = step if informed is None else 1000 + step - informed
        name = {
            10: "activate the robot",
            100: "activate the robot",
            110: "look at the piece",
            1001: "say that one is ready",
            1030: "look at the piece",
            1031: "reach for the piece",
            1032: "close the hand",
        }.get(after, "nothing")
        observation, reward, terminated, truncated, info = env.step(numbers[name])
        yield after, name, observation, reward, terminated, info
        over, step = terminated or truncated, step + 1


def test_the_piece_is_given_to_who_takes_it():
    """Which is rewarded, once. Who speaks, or is not there yet, begins nothing else."""
    steps = [*_taken(_env())]
    assert [
        after for after, name, *_, info in steps if name != "nothing" and not info["begun"]
    ] == [10, 110]
    assert sum(reward for *_, reward, _, _ in steps) == 1.0
    _, _, observation, _, terminated, info = steps[-1]
    assert observation[-1] == 1.0  # who took it holds it
    assert terminated
    assert info["error"] is None


@pytest.mark.parametrize(
    ("mutation", "error"), [("crashes", "ZeroDivisionError"), ("ends-silently", "None")]
)
def test_a_robot_that_has_ended_ends_the_episode(mutation, error):
    *_, (*_, terminated, info) = _taken(_env(mutation=mutation))
    assert terminated
    assert str(info["error"]).startswith(error)


def test_what_is_no_action_is_told():
    """Also without the checker that `gymnasium.make` puts around it."""
    env = _env().unwrapped
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(0)
    env.reset(seed=0)
    with pytest.raises(gymnasium.error.InvalidAction, match="0 to 9"):
        env.step(-1)

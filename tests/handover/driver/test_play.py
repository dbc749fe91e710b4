"""Complete runs: repeatable, equal with and without time jumps, within the protocol's bounds."""

import hashlib
import itertools
import os
import subprocess
import sys

import pytest
from msgspec import structs

from handover.driver import Run, run_test
from handover.driver.play import draw
from handover.generator.abstract_test import AbstractTest, ReceiveSignal, SendSignal, SetParam
from handover.generator.disturbed import disturbed
from handover.generator.pseudorandom import constrained, pseudorandom
from handover.world.faults import SensorFaults
from rvmon.cdv import TestError

pytestmark = pytest.mark.campaign

NUMBERS = {
    "hand_distance",
    "hand_offset_x",
    "hand_offset_z",
    "true_distance",
    "hand_force",
    "gripper_opening",
    "piece_height",
    "tool_speed",
}


def protocol_test(seed: int, **settings: object) -> AbstractTest:
    """A test in which the human follows the protocol and takes the piece."""
    actions = (
        SendSignal("activateRobot"),
        SetParam("time", 40),
        ReceiveSignal("informHumanOfHandoverStart"),
        SendSignal("humanIsReady"),
        SetParam("time", 10),
        SetParam("hgazeOk", 1),
        SetParam("hpressureOk", 1),
        SetParam("hlocationOk", 1),
    )
    return AbstractTest(
        name="protocol",
        strategy="directed",
        seed=seed,
        actions=actions,
        startup_loss=False,
        **settings,  # type: ignore[arg-type]
    )


def instants(run: Run, name: str) -> list[float]:
    return [t / 1e9 for t, values in run.samples if values.get(name) is True]


def facts(run: Run) -> list[tuple[int, dict[str, object]]]:
    """All two-valued signals and events of a run with their instants."""
    kept = (
        (t, {name: value for name, value in values.items() if name not in NUMBERS})
        for t, values in run.samples
    )
    return [(t, values) for t, values in kept if values]


@pytest.mark.parametrize("robot", ["correct", "legacy"])
def test_jumps_change_no_event(robot: str) -> None:
    gripped = 0
    for whole in pseudorandom(1, seed=5) + constrained(3, seed=5):
        test = structs.replace(whole, horizon_s=80.0)  # nothing happens afterwards
        jumped = run_test(test, robot=robot)
        stepped = run_test(test, robot=robot, jump=False)
        assert facts(jumped) == facts(stepped)
        assert stepped.stepped_s == pytest.approx(80.0)
        assert jumped.stepped_s < 40.0
        closings = [
            (a["hand_distance"], b["hand_distance"])
            for (_, a), (_, b) in zip(jumped.samples, stepped.samples, strict=False)
            if "grip_closed" in a and "grip_closed" in b
        ]
        gripped += len(closings)
        for one, other in closings:
            assert one == pytest.approx(other, abs=1e-3)
    assert gripped >= 2


def test_jumps_change_no_event_where_the_scene_surprises() -> None:
    for test in disturbed(3, seed=6):
        short = structs.replace(test, horizon_s=40.0)
        assert facts(run_test(short)) == facts(run_test(short, jump=False))


def test_no_signal_to_the_correct_robot_is_lost() -> None:
    """Loss at start-up was fitted to the robot of the paper's testbench only."""
    seed = next(seed for seed in range(100) if not draw(seed, startup_loss=True).connected)
    test = structs.replace(protocol_test(seed), startup_loss=True)
    assert not instants(run_test(test, robot="legacy"), "activateRobot")
    assert instants(run_test(test), "activateRobot")


def digest(run: Run) -> str:
    return hashlib.sha256(repr((run.samples, run.states)).encode()).hexdigest()


def test_same_seed_same_run_in_every_process() -> None:
    test = constrained(3, seed=9)[2]
    first = run_test(test)
    run_test(protocol_test(1))
    assert digest(run_test(test)) == digest(first)
    code = (
        "import hashlib; from handover.driver import run_test;"
        "from handover.generator.pseudorandom import constrained;"
        "run = run_test(constrained(3, seed=9)[2]);"
        "print(hashlib.sha256(repr((run.samples, run.states)).encode()).hexdigest())"
    )
    for hash_seed in ("1", "2"):
        other = subprocess.run(  # noqa: S603
            [sys.executable, "-c", code],
            env={**os.environ, "PYTHONHASHSEED": hash_seed},
            capture_output=True,
            text=True,
            check=True,
        )
        assert other.stdout.strip() == digest(first)


def test_arm_is_slow_and_distance_is_fresh_while_anything_moves() -> None:
    """Near the hand the tool is slower than 250 mm/s; the distance is up to date in motion."""
    run = run_test(protocol_test(4))
    distance, speed, measured = 9.0, 0.0, 0
    for t, values in run.samples:
        if speed > 0.001:
            assert t - measured <= 200_000_000
        if values.get("hand_distance") is not None:
            distance, measured = float(values["hand_distance"] or 0.0), t
        speed = float(values.get("tool_speed", speed) or 0.0)
        assert distance >= 0.5 or speed <= 0.25


def test_a_scene_is_kept_on_demand() -> None:
    assert run_test(protocol_test(1)).scene is None
    scene = run_test(protocol_test(1), films=True).scene
    assert scene is not None
    stamps = [t for t, _ in scene.frames]
    assert min(b - a for a, b in itertools.pairwise(stamps)) >= 100_000_000
    assert {len(frame) for _, frame in scene.frames} == {3 * len(scene.bodies)}
    assert {outline.body for outline in scene.outlines} == {*scene.bodies, "ground"}
    column = 3 * scene.bodies.index("piece")
    xs = [frame[column] for _, frame in scene.frames]
    assert xs[0] == 0.0
    assert xs[-1] == pytest.approx(0.2, abs=0.02)


def test_arguments_win_over_the_file() -> None:
    test = protocol_test(1, robot="legacy", mutation="crashes")
    assert run_test(test).error
    asked = {"robot": "correct", "mutation": "releases-late"}
    assert run_test(test, **asked) == run_test(protocol_test(1, **asked))
    assert run_test(test, **asked) != run_test(test, mutation="releases-late")


@pytest.mark.parametrize(
    ("settings", "names"),
    [({"robot": "modern"}, "correct, legacy"), ({"mutation": "no-such"}, "never-decides")],
)
def test_unknown_names_are_told(settings: dict[str, str], names: str) -> None:
    with pytest.raises(TestError, match=names):
        run_test(protocol_test(1), **settings)  # type: ignore[arg-type]


def test_loss_switched_off_changes_nothing_else() -> None:
    """Without the fitted loss all other conditions of a seed are unchanged."""
    lost = 0
    for seed in range(500):
        fitted, plain = draw(seed, startup_loss=True), draw(seed, startup_loss=False)
        assert plain.connected
        lost += not fitted.connected
        assert (fitted.human_start_s, fitted.timeout_time_s, fitted.start_pose) == (
            plain.human_start_s,
            plain.timeout_time_s,
            plain.start_pose,
        )
    assert 20 < lost < 50


def test_dead_sensors_are_unknown() -> None:
    """The signal of a dead sensor is unknown, and the robot gives up without a reading."""
    test = protocol_test(1, faults=SensorFaults(dropout=("gaze",)))
    run = run_test(test)
    values = [values["gaze_ok"] for _, values in run.samples if "gaze_ok" in values]
    assert values == [None]
    assert instants(run, "timed_out")


def test_slow_sensors_delay_the_decision() -> None:
    """With sensors that are 1 s late the robot decides later, on older readings."""
    quick = run_test(protocol_test(1))
    slow = run_test(protocol_test(1, faults=SensorFaults(delay_s=1.0)))
    assert instants(slow, "released")
    assert instants(slow, "sensed")[0] >= instants(quick, "sensed")[0] + 0.5


def test_noise_is_seeded() -> None:
    noisy = protocol_test(1, faults=SensorFaults(noise_m=0.05))
    assert digest(run_test(noisy)) == digest(run_test(noisy))
    assert digest(run_test(noisy)) != digest(run_test(protocol_test(1)))

"""Requirements about the world: the correct robot meets them, deceiving robots do not."""

import inspect
from dataclasses import replace

import pytest

import rvmon
from handover.checker import spec_path
from handover.driver import run_test
from handover.driver.play import set_up
from handover.generator.abstract_test import directed
from handover.generator.disturbed import disturbed
from handover.generator.model_based import model_based
from handover.generator.pseudorandom import constrained, pseudorandom
from handover.robot import handover, mutants
from handover.robot.handover import HandoverRobot
from handover.world.measures import contact_forces
from rvmon.cdv.system import Checker

pytestmark = pytest.mark.campaign

TESTS = {test.name: test for test in directed()}
SPEC = rvmon.load(spec_path("correct"))
EITHER = frozenset({"activateRobot", "humanIsReady"})


def failed(test, mutation=None):
    """The requirements that fail when the correct robot, or a mutated one, plays a test."""
    checker = Checker(SPEC)
    checker.start()
    run = run_test(test, robot="correct", mutation=mutation, observer=checker.observe)
    verdicts = checker.finish(run.end_ns).verdicts
    return {name for name, verdict in verdicts.items() if verdict == "F"}


def other(**rules):
    class Other(HandoverRobot):
        def __init__(self, *ports):
            super().__init__(*ports[:-1], replace(ports[-1], **rules))

    return Other


def changed(method, before, after):
    """The robot with one place of a method replaced."""
    own = inspect.getsource(getattr(HandoverRobot, method))
    assert own.count(before) == 1
    source = inspect.getsource(handover).replace(own, own.replace(before, after))
    names = {"__name__": handover.__name__}
    exec(source, names)  # noqa: S102 - our own
    return names["HandoverRobot"]


def more(method, before, *statements):
    """The robot with further statements after one of a method."""
    return changed(method, before, "; ".join([before, *statements]))


def say(topic, value=None):
    return f'self.node.publish("{topic}", {value})'


OPEN, CLOSE, DONE = "self.gripper.open()", "self.gripper.close()", 'return "done"'
RELEASED = "yield self.behaviour.release_s"
FOLLOW = "next(self.arm.follow(self.arm.interpolate({}, {})))"
TURN = FOLLOW.format('self.node.params["zero_pose"]', 3.0), "yield 1.5", OPEN
CREEP = "path = yield from self.arm.plan(0.26, 0.22)", FOLLOW.format("path.goal", 15.0)
"""Six centimetres while it waits, slower than anybody looks."""
OPENS_AT_DONE = more("done", 'self.node.publish("done")', OPEN)
IGNORES_LOCATION = changed(
    "decide", DONE, 'return "release" if reading.gaze and reading.pressure else "done"'
)
UNREAD = changed("sense", "reading = self.sensors.sense()", f"{say('withheld')}; {DONE}")
NO_REASON = changed("give_up", "self.node.publish(reason)", "pass")
REASONS = """nobody_came no_piece no_path_to_piece no_path_to_person hand_in_grip person_in_way
piece_left_behind never_ready never_sensed"""
ALL_REASONS = more("give_up", "self.node.publish(reason)", *map(say, REASONS.split()))
HEARS_LATE = changed("receive_activation", 'return "move"', 'yield 0.5; return "move"')
MINDS_NOBODY = changed("go_to", "self.behaviour.minds_hand", "False")
LONG_WAY = more("move", "x, z = HANDOVER_POINT", "yield from self.go_to(x, z + 0.1)")
BESIDE = changed("move", "self.go_to(x, z + GRIP", "self.go_to(x + 0.004, z + GRIP")
LOW = changed("move", "x, z = found", "x, z = found[0], 0.05")
HOLDS_ANYTHING = changed("move", "not self.has_piece()", "self.has_piece() is None")
AGAIN = changed("go_to", "PLAN_ATTEMPTS", "2 * PLAN_ATTEMPTS")

PLANTED = {
    "senses-one-poll-longer": (other(sense_limit_s=5.5), "no-posture", "T25 T26"),
    "senses-one-poll-less": (other(sense_limit_s=4.5), "no-posture", "T26"),
    "reads-sooner": (other(sense_poll_s=0.4), "no-posture", "T28"),
    "reads-later": (other(sense_poll_s=0.6), "released", "T27"),
    "reads-later-again": (other(sense_poll_s=0.6), "no-posture", "T28"),
    "keeps-its-polls": (other(shared_polls=True), "never-ready", "T24"),
    "polls-once-more": (other(poll_limit=201), "never-ready", "T23 T24"),
    "polls-once-more-at-first": (other(poll_limit=201), "nobody-comes", "T21 T22"),
    "polls-once-less": (other(poll_limit=199), "never-ready", "T24"),
    "keeps-stale-signals": (other(only_fresh=False), "ready-too-early", "T20"),
    "takes-any-signal": (other(readiness=EITHER), "activates-again", "T20"),
    "starts-at-any-signal": (other(activation=EITHER), "ready-first", "T18"),
    "checks-no-grip": (other(checks_grip=False), "piece-slips", "T13 T37"),
    "minds-no-hand": (mutants.MindsNoHand, "hand-in-the-grip", "R5 T33 T39 T58"),
    "strikes-a-forearm": (mutants.SwingsBlindly, "passes-a-forearm", "T63"),
    "strikes-a-hand": (mutants.SwingsBlindly, "passes-another-hand", "T63"),
    "resets-fast": (other(reset_s=0.9), "released", "T14"),
    "gives-no-time-to-take": (other(release_s=1.9), "released", "T31"),
    "says-released": (changed("release", OPEN, "pass"), "released", "T5 T6"),
    "opens-when-it-withholds": (mutants.DropsWhatItWithholds, "withheld-no-gaze", "T2 T3 T7 T8"),
    "drops-what-it-withholds": (mutants.DropsWhatItWithholds, "withheld-hand-far", "T1 T9"),
    "opens-at-done": (OPENS_AT_DONE, "no-posture", "T1 T2 T3 T8 T32"),
    "opens-at-done-after-release": (OPENS_AT_DONE, "released", "T32"),
    "grips-again": (more("release", RELEASED, CLOSE), "released", "T6 T12"),
    "releases-later-on": (
        changed("decide", DONE, 'yield 2.1; return "release"'),
        "withheld-empty-hand",
        "T1 T7 T8 T29",
    ),
    "ignores-location": (IGNORES_LOCATION, "location-misread", "R2 T7"),
    "opens-on-the-way": (more("send_signal", 'taken."""', *TURN), "never-ready", "T4"),
    "withholds-unread": (UNREAD, "released", "T10 T47"),
    "stays-silent": (changed("decide", DONE, "return END"), "withheld-no-gaze", "T30"),
    "grips-high": (changed("go_to", "plan(x, z)", "plan(x, z + 0.015)"), "released", "T34 T35"),
    "holds-out-anything": (HOLDS_ANYTHING, "piece-out-of-sight", "T36"),
    "tries-again": (AGAIN, "no-path-to-piece", "T38"),
    "says-that-it-grips": (more("reset", OPEN, say("robot_gripper", True)), "released", "T40"),
    "says-that-it-sensed": (more("reset", OPEN, say("sensed")), "released", "T43 T57"),
    "says-both": (more("decide", "ready)", say("gpl_is_ok", False)), "released", "T44"),
    "says-it-presses": (
        more("release", 'self.node.publish("released")', say("pressure_e1", True)),
        "released",
        "T46",
    ),
    "closes-longer": (other(grip_pause_s=0.6), "released", "T41"),
    "announces-longer": (other(announce_pause_s=0.06), "released", "T42"),
    "decides-sooner": (other(decide_s=0.05), "released", "T43"),
    "opens-longer": (other(open_s=0.4), "released", "T45"),
    "gives-no-reason": (NO_REASON, "no-posture", "T48"),
    "gives-all-reasons": (ALL_REASONS, "hand-in-the-grip", "T49 T50 T51 T52 T53 T54 T56 T65"),
    "sees-a-hand": (ALL_REASONS, "nobody-comes", "T55"),
    "opens-twice": (more("release", RELEASED, OPEN), "released", "T61"),
    "informs-twice": (
        more("send_signal", "now()", "yield 1.0", say("informed")),
        "never-ready",
        "T62",
    ),
    "creeps": (more("send_signal", "now()", *CREEP), "never-ready", "T60"),
    "hears-while-it-resets": (other(only_fresh=False), "activated-during-reset", "T18"),
    "ignores-height": (LOW, "piece-stands-high", "T34"),
    "never-decides": (mutants.NeverDecides, "withheld-no-gaze", "T11"),
    "ends-silently": (mutants.EndsSilently, "released", "T19"),
    "hears-late": (HEARS_LATE, "activated-as-it-listens", "T71"),
    "tells-nobody-late": (changed("send_signal", ", latched=True", ""), "released", "T67"),
    "goes-on-into-people": (MINDS_NOBODY, "arm-comes-in-the-way", "T66"),
    "takes-the-long-way": (LONG_WAY, "released", "T69"),
    "closes-beside": (BESIDE, "released", "T34 T68"),
    "closes-beside-a-person": (BESIDE, "hand-beside-the-grip", "T68"),
    "looks-for-no-hand": (mutants.MindsNoHand, "released", "T39"),
    "says-twice": (
        more("give_up", 'self.node.publish("timed_out")', say("timed_out")),
        "no-posture",
        "T70",
    ),
}
"""Fault, the directed test that meets it, and requirements of which each tells it."""

FREE = {"hand_force": 0.0}
CLAMPED = [(1, {"hand_force": 141.0}), (1.6, FREE)]
BY_SAMPLES = {
    "T15": [(0, {**FREE, "sensors_disturbed": False}), (1, {"hand_force": 281.0})],
    "T16": [(0, {**FREE, "sensors_disturbed": False}), *CLAMPED],
    "T59": [(0, {**FREE, "sensors_disturbed": True}), *CLAMPED],
    "T64": [
        (0, {"forearm_force": 0.0}),
        (1, {"forearm_force": 161.0}),
        (1.6, {"forearm_force": 0.0}),
    ],
    "T17": [
        (0, {"sensors_disturbed": False, "true_pressure": False, "true_location": True}),
        (0.5, {"true_gaze": True, "gaze_ok": True, "location_ok": True}),
        (1, {"pressure_ok": True, "fully_read": True}),
    ],
}
"""What no fault of this robot's code brings about, and what would fail it."""


@pytest.mark.parametrize("name", PLANTED)
def test_a_planted_fault_fails_its_requirements(monkeypatch, name):
    """Without the fault the test has no failure, as `test_directed.py` shows."""
    fault, test, requirements = PLANTED[name]
    monkeypatch.setitem(mutants.MUTATIONS, name, fault)
    assert failed(TESTS[test], name) >= set(requirements.split())


@pytest.mark.parametrize("requirement", BY_SAMPLES)
def test_an_inconsistent_world_fails(requirement):
    """Forces on the hand, and wrong sensor readings without a fault, fail their requirement."""
    report = SPEC.evaluate(BY_SAMPLES[requirement], end=3)
    assert report.verdicts[requirement] == "F"


def test_the_force_on_a_clamped_hand_is_that_of_one_finger():
    """Forces are per body: those of two clamping fingers are not added."""
    world = set_up(TESTS["hand-hidden-by-noise"]).world
    world.run(17_200_000_000)
    scene = world.scene
    by_finger = [contact_forces(scene.hand)[finger] for finger in scene.fingers]
    assert min(by_finger) > 140
    assert world.human.hand_force() == max(by_finger) < sum(by_finger)


def test_each_requirement_on_the_world_can_fail():
    told = {name for _, _, names in PLANTED.values() for name in names.split()}
    own = {name for name in SPEC.requirements if name.startswith("T")}
    assert own == {name for name in told | set(BY_SAMPLES) if name.startswith("T")}


GENERATED = {
    "pseudorandom": lambda: pseudorandom(2, seed=4),
    "constrained": lambda: constrained(2, seed=4),
    "model-based": lambda: model_based(4, seed=2),
    "disturbed": lambda: disturbed(6, seed=1),
}


@pytest.mark.parametrize("strategy", GENERATED)
def test_the_correct_robot_owes_nothing(strategy):
    for test in GENERATED[strategy]():
        assert failed(test) == set(), test.name

"""What the robot owes in the world: the correct one owes nothing, robots that deceive are told."""

from dataclasses import replace

import pytest

import rvmon
from handover.checker import spec_path
from handover.driver import run_test
from handover.driver.play import begun
from handover.generator.abstract_test import directed
from handover.generator.disturbed import disturbed
from handover.generator.model_based import model_based
from handover.generator.pseudorandom import constrained, pseudorandom
from handover.robot import mutants
from handover.robot.handover import END, HANDOVER_POINT, HandoverRobot
from handover.world.measures import contact_forces
from rvmon.cdv.system import Checker

pytestmark = pytest.mark.campaign

TESTS = {test.name: test for test in directed()}
SPEC = rvmon.load(spec_path("correct"))
EITHER = frozenset({"activateRobot", "humanIsReady"})


def failed(test, mutation=None):
    """The requirements that fail when the correct robot, or a mutated one, plays a test."""
    checker = Checker(SPEC)
    checker.begin()
    run = run_test(test, robot="correct", mutation=mutation, observer=checker.observe)
    verdicts = checker.finish(run.end_ns).verdicts
    return {name for name, verdict in verdicts.items() if verdict == "F"}


def other(**rules):
    class Other(HandoverRobot):
        def __init__(self, *ports):
            super().__init__(*ports[:-1], replace(ports[-1], **rules))

    return Other


class SaysReleased(HandoverRobot):
    def release(self):
        self.node.publish("released")
        yield self.behaviour.release_s
        return "done"


class OpensAtDone(HandoverRobot):
    def done(self):
        self.gripper.open()
        return (yield from super().done())


class GripsAgain(HandoverRobot):
    def release(self):
        next_state = yield from super().release()
        self.gripper.close()
        return next_state


class ReleasesLaterOn(HandoverRobot):
    def decide(self):
        next_state = yield from super().decide()
        if next_state == "done":
            yield 2.1
            return "release"
        return next_state


class IgnoresLocation(HandoverRobot):
    def decide(self):
        next_state = yield from super().decide()
        reading = self.reading
        return "release" if reading.gaze and reading.pressure else next_state


class OpensOnTheWay(HandoverRobot):
    def send_signal(self):
        next(self.arm.follow(self.arm.interpolate(self.node.params["zero_pose"], 3.0)))
        yield 1.5
        self.gripper.open()
        return (yield from super().send_signal())


class WithholdsUnread(HandoverRobot):
    def sense(self):
        yield self.behaviour.sense_poll_s
        self.node.publish("withheld")
        return "done"


class StaysSilentOnRefusal(HandoverRobot):
    def decide(self):
        next_state = yield from super().decide()
        return next_state if next_state == "release" else END


class GripsHigh(HandoverRobot):
    def go_to(self, x, z):
        return (yield from super().go_to(x, z + 0.015))


class HoldsOutAnything(HandoverRobot):
    def has_piece(self):
        return super().has_piece() or True


class TriesAgain(HandoverRobot):
    def go_to(self, x, z):
        arrived = yield from super().go_to(x, z)
        return arrived or (yield from super().go_to(x, z))


class SaysMore(HandoverRobot):
    """Says the opposite of its gripper and its decision, at the instants at which it says it."""

    def reset(self):
        steps = super().reset()
        wait_s = next(steps)
        self.node.publish("robot_gripper", True)
        self.node.publish("sensed")
        yield wait_s
        return (yield from steps)

    def decide(self):
        next_state = yield from super().decide()
        self.node.publish("gpl_is_ok", next_state != "release")
        return next_state

    def release(self):
        steps = super().release()
        yield next(steps)
        wait_s = next(steps)
        self.node.publish("pressure_e1", True)
        yield wait_s
        return "done"


class OpensTwice(HandoverRobot):
    def release(self):
        next_state = yield from super().release()
        self.gripper.open()
        return next_state


class InformsTwice(HandoverRobot):
    def send_signal(self):
        next_state = yield from super().send_signal()
        yield 1.0
        self.node.publish("informed", latched=True)
        return next_state


class Creeps(HandoverRobot):
    """Moves six centimetres while it waits, slower than anybody looks."""

    def send_signal(self):
        x, z = HANDOVER_POINT
        path = yield from self.arm.plan(x + 0.06, z)
        next_state = yield from super().send_signal()
        next(self.arm.follow(self.arm.interpolate(path.goal, 15.0)))
        return next_state


class IgnoresHeight(HandoverRobot):
    def go_to(self, x, z):
        _, height = self.sensors.piece()
        on_table = x != HANDOVER_POINT[0]
        return (yield from super().go_to(x, z - height + 0.05 if on_table else z))


class TellsNobodyLate(HandoverRobot):
    """Its message is gone for who comes to wait after it."""

    def send_signal(self):
        self.node.publish("informed")
        return "receive_readiness"
        yield


class GoesOnIntoPeople(HandoverRobot):
    def go_to(self, x, z):
        self.behaviour = replace(self.behaviour, minds_hand=False)
        return (yield from super().go_to(x, z))


class TakesTheLongWay(HandoverRobot):
    def go_to(self, x, z):
        if x == HANDOVER_POINT[0]:
            yield from super().go_to(x, z + 0.1)
        return (yield from super().go_to(x, z))


class ClosesBeside(HandoverRobot):
    def go_to(self, x, z):
        return (yield from super().go_to(x if x == HANDOVER_POINT[0] else x + 0.004, z))


class LooksForNoHand(HandoverRobot):
    def hand_is_close(self):
        return False


class HearsLate(HandoverRobot):
    def receive_activation(self):
        next_state = yield from super().receive_activation()
        if next_state == "move":
            yield 0.5
        return next_state


class SaysTwice(HandoverRobot):
    def give_up(self, reason):
        self.node.publish("timed_out")
        return super().give_up(reason)


class GivesNoReason(HandoverRobot):
    def give_up(self, reason):
        self.node.publish("timed_out")
        return "done"


class GivesAllReasons(HandoverRobot):
    def give_up(self, reason):
        for one in REASONS.split():
            self.node.publish(one)
        return super().give_up(reason)


REASONS = """nobody_came no_piece no_path_to_piece no_path_to_person hand_in_grip person_in_way
piece_left_behind never_ready never_sensed"""

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
    "says-released": (SaysReleased, "released", "T5 T6"),
    "opens-when-it-withholds": (mutants.DropsWhatItWithholds, "withheld-no-gaze", "T2 T3 T7 T8"),
    "drops-what-it-withholds": (mutants.DropsWhatItWithholds, "withheld-hand-far", "T1 T9"),
    "opens-at-done": (OpensAtDone, "no-posture", "T1 T2 T3 T8 T32"),
    "opens-at-done-after-release": (OpensAtDone, "released", "T32"),
    "grips-again": (GripsAgain, "released", "T6 T12"),
    "releases-later-on": (ReleasesLaterOn, "withheld-empty-hand", "T1 T7 T8 T29"),
    "ignores-location": (IgnoresLocation, "location-misread", "R2 T7"),
    "opens-on-the-way": (OpensOnTheWay, "never-ready", "T4"),
    "withholds-unread": (WithholdsUnread, "released", "T10 T47"),
    "stays-silent": (StaysSilentOnRefusal, "withheld-no-gaze", "T30"),
    "grips-high": (GripsHigh, "released", "T34 T35"),
    "holds-out-anything": (HoldsOutAnything, "piece-out-of-sight", "T36"),
    "tries-again": (TriesAgain, "no-path-to-piece", "T38"),
    "says-more": (SaysMore, "released", "T40 T44 T46 T57"),
    "closes-longer": (other(grip_pause_s=0.6), "released", "T41"),
    "announces-longer": (other(announce_pause_s=0.06), "released", "T42"),
    "decides-sooner": (other(decide_s=0.05), "released", "T43"),
    "opens-longer": (other(open_s=0.4), "released", "T45"),
    "gives-no-reason": (GivesNoReason, "no-posture", "T48"),
    "gives-all-reasons": (GivesAllReasons, "hand-in-the-grip", "T49 T50 T51 T52 T53 T54 T56 T65"),
    "sees-a-hand": (GivesAllReasons, "nobody-comes", "T55"),
    "opens-twice": (OpensTwice, "released", "T61"),
    "informs-twice": (InformsTwice, "never-ready", "T62"),
    "creeps": (Creeps, "never-ready", "T60"),
    "hears-while-it-resets": (other(only_fresh=False), "activated-during-reset", "T18"),
    "ignores-height": (IgnoresHeight, "piece-stands-high", "T34"),
    "never-decides": (mutants.NeverDecides, "withheld-no-gaze", "T11"),
    "ends-silently": (mutants.EndsSilently, "released", "T19"),
    "hears-late": (HearsLate, "activated-as-it-listens", "T71"),
    "tells-nobody-late": (TellsNobodyLate, "released", "T67"),
    "goes-on-into-people": (GoesOnIntoPeople, "arm-comes-in-the-way", "T66"),
    "takes-the-long-way": (TakesTheLongWay, "released", "T69"),
    "closes-beside": (ClosesBeside, "released", "T34 T68"),
    "closes-beside-a-person": (ClosesBeside, "hand-beside-the-grip", "T68"),
    "looks-for-no-hand": (LooksForNoHand, "released", "T39"),
    "says-twice": (SaysTwice, "no-posture", "T70"),
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
    """Without it nothing of that test fails, as `test_directed.py` has it."""
    fault, test, requirements = PLANTED[name]
    monkeypatch.setitem(mutants.MUTATIONS, name, fault)
    assert failed(TESTS[test], name) >= set(requirements.split())


@pytest.mark.parametrize("requirement", BY_SAMPLES)
def test_a_world_that_must_not_be_is_told(requirement):
    """Forces on the hand and sensors that lie without a cause fail their requirement."""
    report = SPEC.evaluate(BY_SAMPLES[requirement], end=3)
    assert report.verdicts[requirement] == "F"


def test_a_clamped_hand_bears_what_one_finger_presses():
    """Forces are of single bodies: two fingers that clamp it do not add up."""
    world = begun(TESTS["hand-hidden-by-noise"]).world
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

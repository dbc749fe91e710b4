"""The handover task as a state machine of nine states.

Input comes from the node and the sensors, and commands go to arm and gripper. The program is a
generator: it waits by yielding seconds, and its runner resumes it once they have passed.

::

    reset → receive_activation ⟲ → move → send_signal → receive_readiness ⟲ → sense ⟲ → decide
    decide → release → done        decide → done (not released)
    receive_activation, receive_readiness, sense → done (timed out)
"""

from __future__ import annotations

import math
from typing import Any

from handover.robot.behaviour import CORRECT, Behaviour
from handover.robot.ports import Arm, Gripper, Node, Reading, Sensors, Steps

STATES = (
    "reset",
    "receive_activation",
    "move",
    "send_signal",
    "receive_readiness",
    "sense",
    "decide",
    "release",
    "done",
)
"""The states in the order of a successful handover; each is the method of that name."""

END = "end"
HUMAN_SIGNALS = "human_signals"
RESET_MOTIONS = (("zero_pose", 0.2), ("start_pose", 0.8))
HANDOVER_POINT = (0.20, 0.22)
GRIP_ABOVE_CENTRE = 0.02
APPROACH_HEIGHTS = (0.18, 0.06, 0.0)
PLAN_ATTEMPTS = 3
PIECE_TOLERANCE = 0.05
HAND_CLEARANCE = 0.06
CLOCK_TOLERANCE_S = 1e-6


class HandoverRobot:
    """Fetches the piece, offers it to the human, and releases it when the human is ready.

    Args:
        node: connection to the message bus.
        arm: plans and follows paths.
        gripper: opens and closes.
        sensors: camera, trackers, pressure.
        behaviour: numbers and rules of this version.

    Attributes:
        state: the current state.
        reading: the reading of the sensors that it decides by, once it has sensed.
    """

    def __init__(
        self,
        node: Node,
        arm: Arm[Any],
        gripper: Gripper,
        sensors: Sensors,
        behaviour: Behaviour = CORRECT,
    ) -> None:
        self.node = node
        self.arm = arm
        self.gripper = gripper
        self.sensors = sensors
        self.behaviour = behaviour
        self.state = "reset"
        self.entered = 0.0
        self.polls = 0
        self.informed_at = 0.0
        self.is_stopped = False
        self.reading: Reading

    def run(self) -> Steps[None]:
        """Go through the states until the task is done."""
        next_state = "reset"
        while next_state != END:
            if next_state != self.state:
                self.entered = self.node.now()
            self.state = next_state
            self.node.publish("robot_state", next_state)
            next_state = yield from getattr(self, next_state)()

    # --- states: each method returns the name of the next state ------------------------------

    def reset(self) -> Steps[str]:
        """Reset the task, open the gripper and go to the start pose."""
        self.polls = 0
        self.informed_at = 0.0
        self.node.publish("robot_reset")
        self.node.publish("robot_gripper", False)
        self.node.publish("pressure_e1", False)
        if not self.behaviour.resubscribes:
            self.node.subscribe(HUMAN_SIGNALS)
        self.gripper.open()
        for pose, share in RESET_MOTIONS:
            shoulder, elbow, wrist = self.node.params[pose]
            path = self.arm.interpolate((shoulder, elbow, wrist), self.behaviour.reset_s * share)
            yield from self.arm.follow(path)
        return "receive_activation"

    def receive_activation(self) -> Steps[str]:
        """Wait for the human to start the task."""
        signal = yield from self.poll_signal()
        if signal in self.behaviour.activation:
            if not self.behaviour.shared_polls:
                self.polls = 0
            return "move"
        if self.polls >= self.behaviour.poll_limit:
            return self.give_up("nobody_came")
        return "receive_activation"

    def move(self) -> Steps[str]:
        """Fetch the piece and hold it out to the human."""
        found = self.sensors.piece()
        if found is None:
            return self.give_up("no_piece")
        x, z = found
        for height in APPROACH_HEIGHTS:
            arrived = yield from self.go_to(x, z + GRIP_ABOVE_CENTRE + height)
            if not arrived:
                return self.give_up("no_path_to_piece")
        if self.behaviour.minds_hand and self.hand_is_close():
            return self.give_up("hand_in_grip")
        self.gripper.close()
        yield self.behaviour.grip_pause_s
        self.node.publish("grip_closed")
        self.node.publish("robot_gripper", True)
        yield self.behaviour.announce_pause_s
        self.node.publish("pressure_e1", True)
        yield self.behaviour.announce_pause_s
        self.node.publish("robot_gripper", False)
        x, z = HANDOVER_POINT
        arrived = yield from self.go_to(x, z)
        if not arrived:
            return self.give_up("no_path_to_person")
        yield self.behaviour.settle_s
        if self.behaviour.checks_grip and not self.has_piece():
            return self.give_up("piece_left_behind")
        return "send_signal"

    def send_signal(self) -> Steps[str]:
        """Tell the human that the piece can be taken."""
        yield self.behaviour.inform_pause_s
        self.node.publish("informed", latched=True)
        yield self.behaviour.inform_pause_s
        self.informed_at = self.node.now()
        return "receive_readiness"

    def receive_readiness(self) -> Steps[str]:
        """Wait for the human to be ready to take the piece."""
        signal = yield from self.poll_signal()
        if signal in self.behaviour.readiness:
            return "sense"
        if self.polls >= self.behaviour.poll_limit:
            return self.give_up("never_ready")
        return "receive_readiness"

    def sense(self) -> Steps[str]:
        """Read the sensors until each of them has a reading."""
        if self.node.now() == self.entered:
            yield self.behaviour.sense_delay_s
        yield self.behaviour.sense_poll_s
        limit = self.behaviour.sense_limit_s
        elapsed = self.node.now() - self.entered
        if limit is None:
            limit = self.node.params["timeout_time"]
            elapsed = self.node.now() - self.informed_at
        if elapsed > limit - CLOCK_TOLERANCE_S:
            return self.give_up("never_sensed")
        reading = self.sensors.sense()
        missing = None in (reading.gaze, reading.pressure, reading.location)
        if missing and not self.behaviour.undefined_is_bad:
            return "sense"
        self.reading = reading
        self.node.publish("sensed")
        return "decide"

    def decide(self) -> Steps[str]:
        """Release the piece only if gaze, pressure and location are all right."""
        self.node.publish("decide")
        yield self.behaviour.decide_s
        reading = self.reading
        ready = all((reading.gaze, reading.pressure, reading.location))
        self.node.publish("decided")
        self.node.publish("gpl_is_ok", ready)
        if ready:
            return "release"
        if not reading.location:
            self.node.publish("hand_away")
        elif not reading.pressure:
            self.node.publish("hand_empty")
        else:
            self.node.publish("looks_away")
        self.node.publish("withheld")
        return "done"

    def release(self) -> Steps[str]:
        """Let go of the piece and give the human time to take it away."""
        self.gripper.open()
        yield self.behaviour.open_s
        self.node.publish("pressure_e1", False)
        self.node.publish("resetpiece")
        self.node.publish("released")
        yield self.behaviour.release_s
        return "done"

    def done(self) -> Steps[str]:
        """End the task; a piece that was not released stays in the gripper."""
        self.node.publish("done")
        yield 0.0
        return END

    # --- helpers -----------------------------------------------------------------------------

    def poll_signal(self) -> Steps[str | None]:
        """Wait for a poll period, then read the human's signal; `None` if there is none."""
        if self.behaviour.resubscribes:
            self.node.subscribe(HUMAN_SIGNALS)
        yield self.behaviour.poll_s
        self.polls += 1
        message = self.node.receive(HUMAN_SIGNALS)
        if message is None:
            return None
        if self.behaviour.only_fresh and message.stamp < self.entered:
            return None
        return str(message.value)

    def give_up(self, reason: str) -> str:
        """End the task without a decision, and publish the reason."""
        if self.is_stopped:
            reason = "person_in_way"
        self.node.publish(reason)
        self.node.publish("timed_out")
        return "done"

    def has_piece(self) -> bool:
        """Whether the piece is seen where the gripper should hold it."""
        found = self.sensors.piece()
        x, z = HANDOVER_POINT
        return (
            found is not None
            and math.hypot(found[0] - x, found[1] + GRIP_ABOVE_CENTRE - z) < PIECE_TOLERANCE
        )

    def hand_is_close(self) -> bool:
        """Whether a hand is seen so close that the gripper would close on it."""
        distance = self.sensors.hand_distance()
        return distance is not None and distance < HAND_CLEARANCE

    def go_to(self, x: float, z: float) -> Steps[bool]:
        """Plan a path of the grip to a point and follow it; return whether the arm got there."""
        for _ in range(PLAN_ATTEMPTS):
            path = yield from self.arm.plan(x, z)
            if path is not None:
                arrived = yield from self.arm.follow(path, minds_people=self.behaviour.minds_hand)
                self.is_stopped = not arrived
                return arrived
        return False

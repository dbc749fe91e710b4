"""The behaviour of the robot: the numbers and rules in which its two versions differ."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Behaviour:
    """Numbers and rules of one version of the robot."""

    reset_s: float  # seconds from the start to the first poll
    poll_s: float  # seconds between two reads of the human's signals
    poll_limit: int  # polls after which the robot gives up
    shared_polls: bool  # whether both receiving states count the same polls
    resubscribes: bool  # whether each poll subscribes again and never takes it down
    activation: frozenset[str]  # signals that activate the robot
    readiness: frozenset[str]  # signals that say that the human is ready
    only_fresh: bool  # whether signals from before the state was entered are ignored
    # Whether it refuses to close the gripper where a hand is seen, and stops the arm where a person
    # is close.
    minds_hand: bool
    grip_pause_s: float  # seconds from the command to close until the gripper is taken as closed
    announce_pause_s: float  # seconds between the messages about the closed gripper
    settle_s: float  # seconds at the handover pose before the human is informed
    checks_grip: bool  # whether it checks that the piece came along
    inform_pause_s: float  # seconds before and after informing the human
    sense_delay_s: float  # seconds in `sense` before the first poll of the sensors
    sense_poll_s: float  # seconds between two reads of the sensors
    # Seconds in `sense` until it times out; `None`: the run's parameter `timeout_time`, counted
    # from the instant at which the human was informed.
    sense_limit_s: float | None
    undefined_is_bad: bool  # whether a sensor without a reading is taken as not ok, at once
    decide_s: float  # seconds from sensing to the decision
    open_s: float  # seconds from the command to open until the piece is taken as released
    release_s: float  # seconds after the release


CORRECT = Behaviour(
    reset_s=4.5,
    poll_s=0.1,
    poll_limit=200,
    shared_polls=False,
    resubscribes=False,
    activation=frozenset({"activateRobot"}),
    readiness=frozenset({"humanIsReady"}),
    only_fresh=True,
    minds_hand=True,
    grip_pause_s=0.5,
    announce_pause_s=0.05,
    settle_s=0.15,
    checks_grip=True,
    inform_pause_s=0.0,
    sense_delay_s=0.0,
    sense_poll_s=0.5,
    sense_limit_s=5.0,
    undefined_is_bad=False,
    decide_s=0.1,
    open_s=0.3,
    release_s=2.0,
)
"""The intended protocol: the right signal in each state, and every wait bounded."""

LEGACY = Behaviour(
    reset_s=1.0,
    poll_s=0.2,
    poll_limit=500,
    shared_polls=True,
    resubscribes=True,
    activation=frozenset({"activateRobot", "humanIsReady"}),
    readiness=frozenset({"activateRobot", "humanIsReady"}),
    only_fresh=False,
    minds_hand=False,
    grip_pause_s=0.5,
    announce_pause_s=0.2,
    settle_s=1.0,
    checks_grip=False,
    inform_pause_s=0.5,
    sense_delay_s=3.0,
    sense_poll_s=0.2,
    sense_limit_s=None,
    undefined_is_bad=True,
    decide_s=0.0,
    open_s=0.5,
    release_s=0.0,
)
"""The robot of the paper's public testbench, with its quirks."""

BEHAVIOURS = {"correct": CORRECT, "legacy": LEGACY}

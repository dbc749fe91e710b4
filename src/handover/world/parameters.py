"""Every free number of the simulation, in one place, with its reason.

Units are SI (metres, seconds, kilograms, newtons, radians) unless a name says otherwise.
`FITTED` names those that were chosen to meet a figure of the paper's Table 1, `FREE` those of the
person that no study gives for a handover; all others come from the paper, from the behaviour of its
testbench, or from ordinary robot figures. What a person does, and how often, is free as well:
`handover.generator.disturbed.FREE`.
The robot's own numbers stand with the robot, in `handover.robot.behaviour`.

Axes: the scene is a vertical plane, x towards the human, z up, the table's top at z = 0. The
paper's third axis (sideways) is dropped: its location offset (0.05, −0.1, −0.05) m becomes
(x, z) = (+0.1, −0.05) m, the human standing on the paper's negative second axis.
"""

from __future__ import annotations

from typing import Final

# --- time -----------------------------------------------------------------------------------
NS: Final = 1_000_000_000
"""Nanoseconds in a second: all instants are integer nanoseconds."""

STEP_NS: Final = 5_000_000
"""Physics step: at 5 ms with 20 iterations a gripped piece keeps still to 0.1 mm over 20 s."""

ITERATIONS: Final = 20
"""Solver iterations: with 10, the piece slips out of the gripper while it is lifted."""

CONTROL_STEPS: Final = 4
"""Physics steps between two updates of motors and of the human's path: 50 Hz."""

CONTROL_S: Final = CONTROL_STEPS * STEP_NS / NS

WATCH_STEPS: Final = 20
"""Physics steps between two publications of distance and speed while something moves: 10 Hz."""

SETTLE_S: Final = 0.3
"""Physics goes on for this long after the last planned motion before it may be called rest."""

REST_SPEED: Final = 1e-3
"""m/s, and ten times as many rad/s: what is slower is at rest, once planned motion is over."""

# --- scene ----------------------------------------------------------------------------------
GRAVITY: Final = 9.81
SHOULDER: Final = (-0.40, 0.45)
UPPER_ARM: Final = 0.40
FOREARM: Final = 0.35
WRIST_TO_GRIP: Final = 0.11
"""Lengths of a small collaborative arm: it reaches the piece and the handover with bent elbow."""

LINK_MASSES: Final = (2.0, 1.5, 0.4)
JOINT_TORQUE: Final = 400.0
"""N·m, strong enough to follow every planned path; the motors, not the masses, limit speed."""

FINGER_MASS: Final = 0.12
FINGER_LENGTH: Final = 0.10
FINGER_THICKNESS: Final = 0.016
FINGER_TORQUE: Final = 3.0
"""N·m at the finger's root: about 30 N at the pads, ten times the weight of the piece."""

FINGER_SPEED: Final = 2.0
FINGER_OPEN: Final = 0.5
FINGER_OVERCLOSED: Final = -0.1
"""rad of a finger against the palm's axis: at 0 the pads lie flat on the piece."""

AT_STOP: Final = 1e-3
"""rad from its stop at which a finger's motor is stopped."""

PALM_LENGTH: Final = 0.05
PALM_WIDTH: Final = 0.08

GRIPPER_REACH: Final = (0.07, 0.11)
"""m below the grip and above it that gripper and piece take up; to the sides it is 0.08 m."""

PIECE_SIZE: Final = (0.03, 0.10)
PIECE_MASS: Final = 0.3
PIECE_X: Final = 0.0
"""A short table leg, standing on the table."""

FRICTION: Final = 1.0
"""Rubber pads on wood; Coulomb coefficients multiply, so the table's 0.8 acts as 0.8."""

TABLE_FRICTION: Final = 0.8
TABLE: Final = (-0.30, 0.12)
"""From, to: the table ends before the handover pose, so an unheld piece falls to the floor."""

TABLE_THICKNESS: Final = 0.03
FLOOR_Z: Final = -0.70

# --- planner --------------------------------------------------------------------------------
PLAN_LATENCY_S: Final = (1.8, 2.2)
"""Uniform. With three plans before it, the gripper closes 9 to 13 s after the activation (paper's
robot: 14.3 to 18.3 s after the start), and the correct robot's whole move takes at most 18 s from
any start pose, so that its 30 s for a decision hold."""

TOOL_SPEED_LIMIT: Final = 0.23
"""m/s at a path's fastest point: below the 0.25 m/s of collaborative operation."""

SHORTEST_MOTION_S: Final = 0.5
CLEARANCE: Final = (0.10, 0.09)
"""m around the gripper's axis: a path is planned so wide past people, and the arm stops where
one comes nearer; the open gripper reaches 0.08 m to its sides."""

START_POSE_RANGE: Final = 0.5
"""rad: the start pose is the zero pose with each joint off by U(−0.5, 0.5) (testbench)."""

ZERO_POSE: Final = (1.20, -2.31, -0.46)
"""rad: gripper down, 0.4 m above the table; no start pose comes near table or piece."""

SIGHT_RESOLUTION_DIGITS: Final = 3
"""Camera and eyes see places to the millimetre."""

# --- human ----------------------------------------------------------------------------------
REACTION_S: Final = 0.2
"""From a decision to the first motion: a fast human reaction. Single people correct a motion of the
hand after 0.087 to 0.441 s, on average 0.273 s (24 people; doi 10.1080/00140139.2014.933268)."""

REACH_SPEED: Final = 1.5
"""m/s at the fastest point of a motion of hand or head: 0.5 m take 0.65 s, a brisk reach. To the
ends of their reach people take up to 0.595 s (Li, Zhu and Adams 1995, Ergonomics 38(4))."""

SHORTEST_REACH_S: Final = 0.4
HAND_RADIUS: Final = 0.02
HAND_MASS: Final = 0.4
HAND_FORCE: Final = 25.0
"""N: the arm behind the hand pulls no harder than this."""

HOLD_FORCE: Final = 12.0
"""N while holding: carries the hand (3.9 N) and the piece (2.9 N), and pulls gently."""

GRASP_FORCE: Final = 40.0
"""N that the closed hand can transmit to the piece before it slips."""

GRASP_DEPTH: Final = 0.004
"""m that the hand aims into the piece, so that it arrives with a force."""

GRASP_SLIP: Final = 0.02
"""m: a hand torn further than this from where it took hold has lost the piece."""

HAND_REST: Final = (0.75, 0.25)
HEAD_REST: Final = (0.95, 0.50)
HEAD_REST_ANGLE: Final = 1.2
"""The human stands one metre away, hand at the chest, looking elsewhere (rad, 0 is along +x)."""

HEAD_RADIUS: Final = 0.09

LOWER_ARM: Final = (0.06, 0.31)
"""m behind the middle of the hand at which wrist and elbow are."""

ELBOW_FORCE: Final = 8.0
"""N: the greatest force of the upper arm on the elbow; it is the hand that pulls."""

LOWER_ARM_RADIUS: Final = 0.04
LOWER_ARM_MASS: Final = 2.0
"""kg that move with a struck lower arm (ISO/TS 15066:2016, table A.3: effective mass)."""

BESIDE_ARMS: Final = (-0.15, 0.15)
"""m along x from the middle of a person beside the robot's way to the near arm and the far one."""

BESIDE_REST: Final = (0.0, 0.25)
BESIDE_ELBOW: Final = (0.02, 0.0)
BESIDE_OTHER: Final = (0.0, 0.20)
"""Hand and elbow of the arm that takes, at rest, and the other hand: x from their arm, z."""

LOCATION_OK: Final = (0.10, -0.05)
LOCATION_BAD: Final = (0.5, 1.0)
"""m beside the piece; bad: both axes off by one draw from this range (paper's testbench)."""

GAZE_OK: Final = ((0.1, 0.2), (0.5, 0.6), (15.0, 40.0))
GAZE_BAD: Final = ((0.2, 0.5), (0.6, 0.8), (40.0, 50.0))
"""Ranges of offset m, distance m, angle in degrees (paper)."""

# --- sensing --------------------------------------------------------------------------------
GAZE_MAX_OFFSET: Final = 0.2
GAZE_MAX_DISTANCE: Final = 0.6
GAZE_MAX_ANGLE: Final = 40.0
LOCATION_MAX: Final = 0.3
"""Limits of a good gaze (the angle must be below its limit) and location (paper's testbench)."""

FACE_MAX_ANGLE: Final = 90.0
"""degrees: a camera at the piece sees the eyes of a head that is turned from it by less."""

HAND_MIN_OFFSET: Final = 0.10
"""m from the chest: a depth camera does not tell a nearer hand from the body."""

PRESSURE_MIN: Final = 0.5
"""N between holder and piece that counts as holding: a sixth of the piece's weight."""

STILL_SPEED: Final = 0.02
"""m/s: a tracker gives no reading of a hand that moves faster than this."""

# --- middleware and driver ------------------------------------------------------------------
POLL_GROWTH_S: Final = (0.0, 0.00083)
"""Uniform, one draw a run: what each subscription that was never taken down adds to every later
poll. 500 polls of 0.2 s then take 100 to 204 s. Only that polls slow down is known; the upper end
decides how many runs miss the horizon. Fitted: the likeliest value under the paper's two R4 cells
(2 of 100 each, taken as Poisson counts), so R4's I is no evidence."""

LATCH_LINGER_S: Final = 0.8
"""A latched message stays readable for this long after its publisher ended. Fitted."""

STARTUP_LOSS: Final = 0.07
"""Probability that the human's publisher and the robot do not find each other while the processes
start, so that no signal arrives. Fitted: it is the paper's 93 of 100 closed grippers in
constrained tests."""

HUMAN_START_S: Final = (3.0, 5.5)
"""Uniform: the human's process comes up after the robot's; with its first signal 2 s later the
gripper closes when the paper's robot closes it."""

TIMEOUT_TIME_S: Final = (0, 100)
"""Whole seconds, uniform: the sensing timeout that the legacy robot is given (testbench)."""

FITTED: Final = ("POLL_GROWTH_S", "LATCH_LINGER_S", "STARTUP_LOSS")

FREE: Final = (
    *("REACTION_S", "REACH_SPEED", "SHORTEST_REACH_S", "HAND_RADIUS", "HAND_MASS"),
    *("HAND_FORCE", "HOLD_FORCE", "GRASP_FORCE", "GRASP_DEPTH", "GRASP_SLIP", "HAND_REST"),
    *("HEAD_REST", "HEAD_REST_ANGLE", "HEAD_RADIUS", "LOWER_ARM", "LOWER_ARM_RADIUS"),
    *("ELBOW_FORCE", "BESIDE_ARMS", "BESIDE_REST", "BESIDE_ELBOW", "BESIDE_OTHER"),
)
"""Chosen within what people's bodies can do."""

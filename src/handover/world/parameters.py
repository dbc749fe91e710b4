"""All numbers of the simulation, each with its reason.

Units are SI (metres, seconds, kilograms, newtons, radians) unless a name says otherwise.
`FITTED` names the parameters that were fitted to figures of the paper's Table 1, and `FREE` those
of the person for which no study of handovers gives a value. All others come from the paper, from
the behaviour of its testbench, or from ordinary robots. The behaviour of people and its frequencies
are free as well: see `handover.generator.disturbed.FREE`. The robot's own numbers are in
`handover.robot.behaviour`.

Axes: the scene is a vertical plane, with x towards the human, z up, and the table's top at z = 0.
The paper's third axis (sideways) is dropped: its location offset (0.05, −0.1, −0.05) m becomes
(x, z) = (+0.1, −0.05) m, as the human stands on the paper's negative second axis.
"""

from __future__ import annotations

from typing import Final

# --- time -----------------------------------------------------------------------------------
NS: Final = 1_000_000_000
"""Nanoseconds per second: all instants are integer nanoseconds."""

STEP_NS: Final = 5_000_000
"""Physics step: at 5 ms with 20 iterations, a gripped piece moves less than 0.1 mm in 20 s."""

ITERATIONS: Final = 20
"""Solver iterations: with 10, the piece slips out of the gripper while it is lifted."""

CONTROL_STEPS: Final = 4
"""Physics steps between two updates of motors and of the human's path: 50 Hz."""

CONTROL_S: Final = CONTROL_STEPS * STEP_NS / NS

WATCH_STEPS: Final = 20
"""Physics steps between two publications of measurements while something moves: 10 Hz."""

SETTLE_S: Final = 0.3
"""Seconds after the last planned motion before the scene may be considered at rest."""

REST_SPEED: Final = 1e-3
"""m/s, and ten times this in rad/s: slower bodies are at rest, once planned motion is over."""

# --- scene ----------------------------------------------------------------------------------
GRAVITY: Final = 9.81
SHOULDER: Final = (-0.40, 0.45)
UPPER_ARM: Final = 0.40
FOREARM: Final = 0.35
WRIST_TO_GRIP: Final = 0.11
"""Lengths of a small collaborative arm, which reaches piece and handover with a bent elbow."""

LINK_MASSES: Final = (2.0, 1.5, 0.4)
JOINT_TORQUE: Final = 400.0
"""N·m, enough to follow every planned path: the motors limit the speed, not the masses."""

FINGER_MASS: Final = 0.12
FINGER_LENGTH: Final = 0.10
FINGER_THICKNESS: Final = 0.016
FINGER_TORQUE: Final = 3.0
"""N·m at the finger's root: about 30 N at the pads, ten times the weight of the piece."""

FINGER_SPEED: Final = 2.0
FINGER_OPEN: Final = 0.5
FINGER_OVERCLOSED: Final = -0.1
"""Angles of a finger against the palm's axis, rad; at 0 the pads lie flat on the piece."""

AT_STOP: Final = 1e-3
"""Angle from its stop at which a finger's motor is switched off, rad."""

PALM_LENGTH: Final = 0.05
PALM_WIDTH: Final = 0.08

GRIPPER_REACH: Final = (0.07, 0.11)
"""Extent of gripper and piece below and above the grip, m; to the sides it is 0.08 m."""

PIECE_SIZE: Final = (0.03, 0.10)
PIECE_MASS: Final = 0.3
PIECE_X: Final = 0.0
"""The piece is a short table leg that stands on the table."""

FRICTION: Final = 1.0
"""Rubber pads on wood; Coulomb coefficients multiply, so the table's 0.8 acts as 0.8."""

TABLE_FRICTION: Final = 0.8
TABLE: Final = (-0.30, 0.12)
"""From, to along x: the table ends before the handover point, so a dropped piece falls down."""

TABLE_THICKNESS: Final = 0.03
FLOOR_Z: Final = -0.70

# --- planner --------------------------------------------------------------------------------
PLAN_LATENCY_S: Final = (1.8, 2.2)
"""Uniform. After three plans, the gripper closes 9 to 13 s after the activation (paper's robot:
14.3 to 18.3 s after the start). The correct robot's whole move takes at most 18 s from any start
pose, so that it can decide within its 30 s."""

TOOL_SPEED_LIMIT: Final = 0.23
"""m/s at a path's fastest point: below the 0.25 m/s of collaborative operation."""

SHORTEST_MOTION_S: Final = 0.5
CLEARANCE: Final = (0.10, 0.09)
"""Distances from the gripper's axis, m: paths keep the first from people, and the arm stops if a
person is closer than the second; the open gripper reaches 0.08 m to its sides."""

START_POSE_RANGE: Final = 0.5
"""rad: the start pose is the zero pose plus U(−0.5, 0.5) for each joint (testbench)."""

ZERO_POSE: Final = (1.20, -2.31, -0.46)
"""rad: gripper down, 0.4 m above the table; no start pose is near table or piece."""

SIGHT_RESOLUTION_DIGITS: Final = 3
"""Camera and eyes locate the piece to the millimetre."""

# --- human ----------------------------------------------------------------------------------
REACTION_S: Final = 0.2
"""From a decision to the first motion: a fast human reaction. People correct a motion of the hand
after 0.087 to 0.441 s, on average 0.273 s (24 people; doi 10.1080/00140139.2014.933268)."""

REACH_SPEED: Final = 1.5
"""Peak speed of a motion of hand or head, m/s: 0.5 m take 0.65 s, a brisk reach. People take up to
0.595 s to the end of their reach (Li, Zhu and Adams 1995, Ergonomics 38(4))."""

SHORTEST_REACH_S: Final = 0.4
HAND_RADIUS: Final = 0.02
HAND_MASS: Final = 0.4
HAND_FORCE: Final = 25.0
"""The largest force with which the arm pulls the hand, N."""

HOLD_FORCE: Final = 12.0
"""The same while the hand holds: it carries hand (3.9 N) and piece (2.9 N), and pulls gently."""

GRASP_FORCE: Final = 40.0
"""The largest force that the closed hand can transmit to the piece before it slips, N."""

GRASP_DEPTH: Final = 0.004
"""How far into the piece the hand aims, so that it arrives with a force, m."""

GRASP_SLIP: Final = 0.02
"""A hand that is torn further than this from its hold loses the piece, m."""

HAND_REST: Final = (0.75, 0.25)
HEAD_REST: Final = (0.95, 0.50)
HEAD_REST_ANGLE: Final = 1.2
"""The human stands 1 m away, hand at the chest, and looks elsewhere (rad, 0 is along +x)."""

HEAD_RADIUS: Final = 0.09

LOWER_ARM: Final = (0.06, 0.31)
"""Distances of wrist and elbow behind the middle of the hand, m."""

ELBOW_FORCE: Final = 8.0
"""The largest force of the upper arm on the elbow, N; the pulling force acts at the hand."""

LOWER_ARM_RADIUS: Final = 0.04
LOWER_ARM_MASS: Final = 2.0
"""Effective mass of a struck lower arm, kg (ISO/TS 15066:2016, table A.3)."""

BESIDE_ARMS: Final = (-0.15, 0.15)
"""Near and far arm of a person beside the robot's way: x from the middle of the person, m."""

BESIDE_REST: Final = (0.0, 0.25)
BESIDE_ELBOW: Final = (0.02, 0.0)
BESIDE_OTHER: Final = (0.0, 0.20)
"""Resting places of hand and elbow of the taking arm, and of the other hand: x from the arm, z."""

LOCATION_OK: Final = (0.10, -0.05)
LOCATION_BAD: Final = (0.5, 1.0)
"""Position of the hand from the piece, m; bad: one draw from this range for both axes (paper's
testbench)."""

GAZE_OK: Final = ((0.1, 0.2), (0.5, 0.6), (15.0, 40.0))
GAZE_BAD: Final = ((0.2, 0.5), (0.6, 0.8), (40.0, 50.0))
"""Ranges of offset (m), distance (m) and angle (degrees) of the gaze (paper)."""

# --- sensing --------------------------------------------------------------------------------
GAZE_MAX_OFFSET: Final = 0.2
GAZE_MAX_DISTANCE: Final = 0.6
GAZE_MAX_ANGLE: Final = 40.0
LOCATION_MAX: Final = 0.3
"""Limits of a good gaze (the angle must be below its limit) and location (paper's testbench)."""

FACE_MAX_ANGLE: Final = 90.0
"""A camera at the piece sees the eyes of a head turned away by less than this, degrees."""

HAND_MIN_OFFSET: Final = 0.10
"""Distance from the chest below which a depth camera cannot tell the hand from the body, m."""

PRESSURE_MIN: Final = 0.5
"""The least force between holder and piece that counts as holding, N: 1/6 of the piece's weight."""

STILL_SPEED: Final = 0.02
"""A tracker gives no reading of a hand that moves faster than this, m/s."""

# --- middleware and driver ------------------------------------------------------------------
POLL_GROWTH_S: Final = (0.0, 0.00083)
"""The delay that each subscription which was never removed adds to every later poll; uniform, one
draw per run. 500 polls of 0.2 s then take 100 to 204 s. It is only known that polls slow down; the
upper end determines how many runs miss the horizon. Fitted: the most likely value given the paper's
two R4 cells (2 of 100 each, as Poisson counts), so the I of R4 is not evidence."""

LATCH_LINGER_S: Final = 0.8
"""A latched message stays readable for this long after its publisher has ended. Fitted."""

STARTUP_LOSS: Final = 0.07
"""Probability that the human's publisher and the robot do not find each other while the processes
start, so that no signal arrives. Fitted to the paper's constrained tests, in which the gripper
closed in 93 of 100."""

HUMAN_START_S: Final = (3.0, 5.5)
"""Uniform: the human's process is up after the robot's. With its first signal 2 s later, the
gripper closes at the time at which the paper's robot closes it."""

TIMEOUT_TIME_S: Final = (0, 100)
"""The sensing timeout of the legacy robot in whole seconds, uniform (testbench)."""

FITTED: Final = ("POLL_GROWTH_S", "LATCH_LINGER_S", "STARTUP_LOSS")

FREE: Final = (
    *("REACTION_S", "REACH_SPEED", "SHORTEST_REACH_S", "HAND_RADIUS", "HAND_MASS"),
    *("HAND_FORCE", "HOLD_FORCE", "GRASP_FORCE", "GRASP_DEPTH", "GRASP_SLIP", "HAND_REST"),
    *("HEAD_REST", "HEAD_REST_ANGLE", "HEAD_RADIUS", "LOWER_ARM", "LOWER_ARM_RADIUS"),
    *("ELBOW_FORCE", "BESIDE_ARMS", "BESIDE_REST", "BESIDE_ELBOW", "BESIDE_OTHER"),
)
"""Chosen within what the human body can do."""

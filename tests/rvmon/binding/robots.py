"""Recordings as robots make them, with what should feed which name.

The expected places were written down before anything was proposed for them: topic and value,
several where any of them is right, none where nothing in the recording is what the name says.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Robot:
    """A recording, a specification, and the binding that is right.

    Attributes:
        topics: type and content of the messages of each topic.
        declared: the body of a specification.
        expected: by name, `TOPIC VALUE`; empty: it is to be left open.
        definitions: of messages of its own.
    """

    topics: Mapping[str, tuple[str, Mapping[str, Any]]]
    declared: str
    expected: Mapping[str, tuple[str, ...]]
    definitions: Mapping[str, str] = field(default_factory=dict)


def speeds(topic: str, path: str = "twist.twist.") -> tuple[str, ...]:
    """The places of how fast something drives."""
    x, y = f"{path}linear.x", f"{path}linear.y"
    return f"{topic} {x}", f"{topic} hypot({x}, {y})"


OPEN: tuple[str, ...] = ()
ODOM = "nav_msgs/msg/Odometry"
TURNED = {"orientation": {"w": 1.0}}
ODOMETRY = (
    ODOM,
    {
        "child_frame_id": "base_link",
        "pose": {"pose": {"position": {"x": 1.5, "y": -2.0}, **TURNED}},
        "twist": {"twist": {"linear": {"x": 0.5}, "angular": {"z": 0.1}}},
    },
)
IMU = ("sensor_msgs/msg/Imu", {"header": {"frame_id": "imu_link"}, **TURNED})
TWIST = ("geometry_msgs/msg/Twist", {"linear": {"x": 0.6}})
POSE = ("geometry_msgs/msg/PoseStamped", {"pose": {"position": {"x": 1.0, "z": 2.0}, **TURNED}})
FLOAT = ("std_msgs/msg/Float64", {"data": 1.5})
BOOL = ("std_msgs/msg/Bool", {"data": False})
TEXT = ("std_msgs/msg/String", {"data": "idle"})
FIX = ("sensor_msgs/msg/NavSatFix", {"latitude": 48.1, "longitude": 11.5, "altitude": 510.0})
BATTERY = (
    "sensor_msgs/msg/BatteryState",
    {"voltage": 24.5, "current": -2.0, "percentage": 0.75, "temperature": 31.0},
)
SCAN = ("sensor_msgs/msg/LaserScan", {"ranges": [2.0, 1.5, 3.0], "intensities": [9.0, 8.0, 7.0]})


def joints(*names: str) -> tuple[str, Mapping[str, Any]]:
    """The state of joints."""
    numbers = [0.1 * place for place in range(len(names))]
    content = {"name": [*names], "position": numbers, "velocity": numbers, "effort": numbers}
    return "sensor_msgs/msg/JointState", content


UR_JOINTS = joints(
    *("shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint"),
    *("wrist_1_joint", "wrist_2_joint", "wrist_3_joint"),
)

REPORTED = {
    "jackal": Robot(
        {
            "/jackal_velocity_controller/odom": ODOMETRY,
            "/imu/data": IMU,
            "/jackal_velocity_controller/cmd_vel": TWIST,
        },
        "signal speed : real [m/s]\nsignal yaw_rate : real [rad/s]\n"
        "signal gyro_z : real [rad/s]\nsignal accel_x : real [m/s^2]",
        {
            "speed": speeds("/jackal_velocity_controller/odom"),
            "yaw_rate": ("/jackal_velocity_controller/odom twist.twist.angular.z",),
            "gyro_z": ("/imu/data angular_velocity.z",),
            "accel_x": ("/imu/data linear_acceleration.x",),
        },
    ),
    "cub": Robot(
        {"/cub1/pose": POSE},
        "signal x, y, z : real [m]\nsignal heading : real [rad]",
        {
            **{axis: (f"/cub1/pose pose.position.{axis}",) for axis in "xyz"},
            "heading": ("/cub1/pose yaw(pose.orientation)",),
        },
    ),
    "turtle": Robot(
        {
            "/turtle1/pose": ("turtlesim/msg/Pose", {"x": 5.5, "y": 5.5, "linear_velocity": 1.0}),
            "/turtle2/pose": ("turtlesim/msg/Pose", {"x": 1.5, "y": 2.5, "linear_velocity": 1.0}),
            "/turtle1/cmd_vel": TWIST,
        },
        "signal leader_x, leader_y, follower_x, follower_y : real [m]\n"
        "signal leader_speed, follower_speed, command_speed : real [m/s]",
        {
            "leader_x": ("/turtle1/pose x",),
            "leader_y": ("/turtle1/pose y",),
            "follower_x": ("/turtle2/pose x",),
            "follower_y": ("/turtle2/pose y",),
            "leader_speed": ("/turtle1/pose linear_velocity",),
            "follower_speed": ("/turtle2/pose linear_velocity",),
            "command_speed": speeds("/turtle1/cmd_vel", ""),
        },
        {
            "turtlesim/msg/Pose": "float32 x\nfloat32 y\nfloat32 theta\n"
            "float32 linear_velocity\nfloat32 angular_velocity\n"
        },
    ),
    "laser": Robot(
        {
            "/scan": SCAN,
            "/velocity": ("geometry_msgs/msg/TwistStamped", {"twist": {"linear": {"x": 0.5}}}),
            "/info_gps": ("xsens_mtig/msg/GPSInfoStatus2", {"satellites_locked": 7}),
            "/position_gps": FIX,
            "/temperature": ("xsens_mtig/msg/Thermistor", {"reading": 31.0}),
            "/imu_data": IMU,
        },
        "signal obstacle : real [m]\nsignal ground_speed : real [m/s]\nsignal satellites : int\n"
        "signal gps_valid : bool\nsignal latitude : real [deg]\nsignal altitude : real [m]\n"
        "signal imu_temperature : real [degC]",
        {
            "obstacle": ("/scan min(ranges)",),
            "ground_speed": speeds("/velocity", "twist."),
            "satellites": ("/info_gps satellites_locked",),
            "gps_valid": ("/info_gps valid_data",),
            "latitude": ("/position_gps latitude",),
            "altitude": ("/position_gps altitude",),
            "imu_temperature": ("/temperature reading",),
        },
        {
            "xsens_mtig/msg/GPSInfoStatus2": "std_msgs/Header header\nbool valid_data\n"
            "int32 satellites_locked\n",
            "xsens_mtig/msg/Thermistor": "std_msgs/Header header\nfloat32 reading\n",
        },
    ),
    "arm": Robot(
        {"/joint_states": joints(*(f"joint_{number}" for number in range(1, 7)))},
        "signal shoulder, elbow, wrist, joint_3_position : real [rad]",
        {
            **dict.fromkeys(("shoulder", "elbow", "wrist"), OPEN),
            "joint_3_position": ("/joint_states position[joint_3]",),
        },
    ),
}
"""What people reported."""

HELD_OUT = {
    "husky": Robot(
        {
            "/husky_velocity_controller/odom": ODOMETRY,
            "/husky_velocity_controller/cmd_vel": TWIST,
            "/navsat/fix": FIX,
            "/imu/data": IMU,
            "/joint_states": joints("front_left_wheel", "front_right_wheel"),
            "/status": ("husky_msgs/msg/HuskyStatus", {"battery_voltage": 26.1}),
            "/joy_teleop/joy": ("sensor_msgs/msg/Joy", {"axes": [0.0], "buttons": [0]}),
        },
        "signal speed, cmd_speed : real [m/s]\nsignal yaw_rate : real [rad/s]\n"
        "signal latitude : real [deg]\nsignal battery_voltage : real [V]\n"
        "signal left_driver_temp : real [degC]\nsignal estop : bool\n"
        "signal front_left_wheel : real [rad/s]\nsignal heading : real [deg]",
        {
            "speed": speeds("/husky_velocity_controller/odom"),
            "cmd_speed": speeds("/husky_velocity_controller/cmd_vel", ""),
            "yaw_rate": ("/husky_velocity_controller/odom twist.twist.angular.z",),
            "latitude": ("/navsat/fix latitude",),
            "battery_voltage": ("/status battery_voltage",),
            "left_driver_temp": ("/status left_driver_temp",),
            "estop": ("/status e_stop",),
            "front_left_wheel": ("/joint_states velocity[front_left_wheel]",),
            "heading": (
                "/husky_velocity_controller/odom yaw(pose.pose.orientation)",
                "/imu/data yaw(orientation)",
            ),
        },
        {
            "husky_msgs/msg/HuskyStatus": "std_msgs/Header header\nuint64 uptime\n"
            "float64 left_driver_voltage\nfloat64 right_driver_voltage\nfloat64 battery_voltage\n"
            "float64 left_driver_temp\nfloat64 right_driver_temp\nbool timeout\nbool e_stop\n"
        },
    ),
    "turtlebot": Robot(
        {
            "/odom": ODOMETRY,
            "/scan": SCAN,
            "/imu": IMU,
            "/battery_state": BATTERY,
            "/cmd_vel": TWIST,
            "/joint_states": joints("wheel_left_joint", "wheel_right_joint"),
        },
        "signal obstacle_distance : real [m]\nsignal battery : real [%]\n"
        "signal battery_voltage : real [V]\nsignal x, y : real [m]\n"
        "signal commanded_turn_rate : real [rad/s]\nsignal left_wheel_speed : real [rad/s]\n"
        "signal lidar_temperature : real [degC]\nsignal robot_speed : real [km/h]\n"
        "signal payload : real [kg]",
        {
            "obstacle_distance": ("/scan min(ranges)",),
            "battery": ("/battery_state percentage",),
            "battery_voltage": ("/battery_state voltage",),
            "x": ("/odom pose.pose.position.x",),
            "y": ("/odom pose.pose.position.y",),
            "commanded_turn_rate": ("/cmd_vel angular.z",),
            "left_wheel_speed": ("/joint_states velocity[wheel_left_joint]",),
            "lidar_temperature": OPEN,
            "robot_speed": speeds("/odom"),
            "payload": OPEN,
        },
    ),
    "ur5": Robot(
        {
            "/joint_states": UR_JOINTS,
            "/wrench": (
                "geometry_msgs/msg/WrenchStamped",
                {"header": {"frame_id": "tool0"}, "wrench": {"force": {"z": 4.0}}},
            ),
            "/speed_scaling_state_broadcaster/speed_scaling": FLOAT,
        },
        "signal elbow, wrist_1, wrist : real [rad]\nsignal shoulder_pan_speed : real [rad/s]\n"
        "signal tool_force_z : real [N]\nsignal elbow_torque : real [N*m]\n"
        "signal gripper_opening : real [mm]\nsignal speed_scaling : real",
        {
            "elbow": ("/joint_states position[elbow_joint]",),
            "wrist_1": ("/joint_states position[wrist_1_joint]",),
            "wrist": OPEN,  # there are three
            "shoulder_pan_speed": ("/joint_states velocity[shoulder_pan_joint]",),
            "tool_force_z": ("/wrench wrench.force.z",),
            "elbow_torque": ("/joint_states effort[elbow_joint]",),
            "gripper_opening": OPEN,
            "speed_scaling": ("/speed_scaling_state_broadcaster/speed_scaling data",),
        },
    ),
    "spot": Robot(
        {
            "/odometry": ODOMETRY,
            "/joint_states": joints("front_left_hip_x", "front_left_knee", "rear_left_knee"),
            "/status/power_state": ("spot_msgs/msg/PowerState", {"motor_power_state": 2}),
            "/cmd_vel": TWIST,
        },
        "signal speed : real [m/s]\nsignal front_left_knee : real [deg]\nsignal knee : real [rad]\n"
        "signal locomotion_charge : real [%]\nsignal motors_on : bool\n"
        "signal target_speed : real [m/s]",
        {
            "speed": speeds("/odometry"),
            "front_left_knee": ("/joint_states position[front_left_knee]",),
            "knee": OPEN,  # there are two
            "locomotion_charge": ("/status/power_state locomotion_charge_percentage",),
            "motors_on": OPEN,
            "target_speed": speeds("/cmd_vel", ""),
        },
        {
            "spot_msgs/msg/PowerState": "std_msgs/Header header\nuint8 motor_power_state\n"
            "uint8 shore_power_state\nfloat64 locomotion_charge_percentage\n"
        },
    ),
    "px4": Robot(
        {
            "/fmu/out/vehicle_local_position": ("px4_msgs/msg/VehicleLocalPosition", {"x": 1.0}),
            "/fmu/out/vehicle_global_position": ("px4_msgs/msg/VehicleGlobalPosition", {}),
            "/fmu/out/battery_status": ("px4_msgs/msg/BatteryStatus", {"voltage_v": 15.8}),
            "/fmu/out/sensor_combined": ("px4_msgs/msg/SensorCombined", {}),
            "/fmu/in/trajectory_setpoint": ("px4_msgs/msg/TrajectorySetpoint", {}),
        },
        "signal x, z : real [m]\nsignal vz : real [m/s]\nsignal altitude : real [m]\n"
        "signal heading, setpoint_yaw : real [rad]\nsignal battery_voltage : real [V]\n"
        "signal battery_remaining : real [%]\nsignal gyro_x : real [rad/s]\n"
        "signal airspeed : real [m/s]\nsignal armed : bool",
        {
            "x": ("/fmu/out/vehicle_local_position x",),
            "z": ("/fmu/out/vehicle_local_position z",),
            "vz": ("/fmu/out/vehicle_local_position vz",),
            "altitude": ("/fmu/out/vehicle_global_position alt",),
            "heading": ("/fmu/out/vehicle_local_position heading",),
            "setpoint_yaw": ("/fmu/in/trajectory_setpoint yaw",),
            "battery_voltage": ("/fmu/out/battery_status voltage_v",),
            "battery_remaining": ("/fmu/out/battery_status remaining",),
            "gyro_x": ("/fmu/out/sensor_combined gyro_rad[0]",),
            "airspeed": OPEN,
            "armed": OPEN,
        },
        {
            "px4_msgs/msg/VehicleLocalPosition": "uint64 timestamp\nbool xy_valid\nfloat32 x\n"
            "float32 y\nfloat32 z\nfloat32 vx\nfloat32 vy\nfloat32 vz\nfloat32 heading\n",
            "px4_msgs/msg/VehicleGlobalPosition": "uint64 timestamp\nfloat64 lat\nfloat64 lon\n"
            "float32 alt\nfloat32 alt_ellipsoid\n",
            "px4_msgs/msg/BatteryStatus": "uint64 timestamp\nbool connected\nfloat32 voltage_v\n"
            "float32 current_a\nfloat32 remaining\nfloat32 temperature\nuint8 cell_count\n",
            "px4_msgs/msg/SensorCombined": "uint64 timestamp\nfloat32[3] gyro_rad\n"
            "uint32 gyro_integral_dt\nfloat32[3] accelerometer_m_s2\n",
            "px4_msgs/msg/TrajectorySetpoint": "uint64 timestamp\nfloat32[3] position\n"
            "float32[3] velocity\nfloat32 yaw\nfloat32 yawspeed\n",
        },
    ),
    "mavros": Robot(
        {
            "/mavros/local_position/pose": POSE,
            "/mavros/setpoint_position/local": POSE,
            "/mavros/vfr_hud": ("mavros_msgs/msg/VfrHud", {"airspeed": 12.0, "heading": 90}),
            "/mavros/state": ("mavros_msgs/msg/State", {"mode": "AUTO", "armed": True}),
            "/mavros/battery": BATTERY,
            "/mavros/global_position/global": FIX,
            "/mavros/global_position/rel_alt": FLOAT,
        },
        "signal x, setpoint_x, relative_altitude : real [m]\nsignal airspeed : real [m/s]\n"
        "signal armed : bool\nsignal mode : {AUTO, GUIDED}\nsignal battery_voltage : real [V]\n"
        "signal longitude : real [deg]\nsignal throttle : real\nsignal climb_rate : real [m/s]",
        {
            "x": ("/mavros/local_position/pose pose.position.x",),
            "setpoint_x": ("/mavros/setpoint_position/local pose.position.x",),
            "relative_altitude": ("/mavros/global_position/rel_alt data",),
            "airspeed": ("/mavros/vfr_hud airspeed",),
            "armed": ("/mavros/state armed",),
            "mode": ("/mavros/state mode",),
            "battery_voltage": ("/mavros/battery voltage",),
            "longitude": ("/mavros/global_position/global longitude",),
            "throttle": ("/mavros/vfr_hud throttle",),
            "climb_rate": ("/mavros/vfr_hud climb",),
        },
        {
            "mavros_msgs/msg/VfrHud": "std_msgs/Header header\nfloat32 airspeed\n"
            "float32 groundspeed\nint16 heading\nfloat32 throttle\nfloat32 altitude\n"
            "float32 climb\n",
            "mavros_msgs/msg/State": "std_msgs/Header header\nbool connected\nbool armed\n"
            "bool guided\nbool manual_input\nstring mode\nuint8 system_status\n",
        },
    ),
    "two robots": Robot(
        {"/robot1/odom": ODOMETRY, "/robot2/odom": ODOMETRY},
        "signal speed, robot1_speed : real [m/s]\nsignal robot2_x : real [m]",
        {
            "speed": OPEN,
            "robot1_speed": speeds("/robot1/odom"),
            "robot2_x": ("/robot2/odom pose.pose.position.x",),
        },
    ),
    "boat": Robot(
        {
            "/battery_voltage": FLOAT,
            "/motor/left/current": FLOAT,
            "/motor/right/current": FLOAT,
            "/water_temperature": FLOAT,
            "/depth": FLOAT,
            "/leak": BOOL,
            "/emergency_stop": BOOL,
            "/mode": TEXT,
        },
        "signal battery_voltage : real [V]\nsignal left_motor_current : real [mA]\n"
        "signal depth : real [m]\nsignal hull_temperature : real [degC]\nsignal leak : bool\n"
        "signal pressure : real [Pa]\nsignal mode : {idle, drive}\nevent emergency_stop\n"
        "signal motor_current : real [A]",
        {
            "battery_voltage": ("/battery_voltage data",),
            "left_motor_current": ("/motor/left/current data",),
            "depth": ("/depth data",),
            "hull_temperature": OPEN,
            "leak": ("/leak data",),
            "pressure": OPEN,
            "mode": ("/mode data",),
            "emergency_stop": ("/emergency_stop data",),
            "motor_current": OPEN,  # of which motor?
        },
    ),
    "car": Robot(
        {
            "/odom": ODOMETRY,
            "/drive": ("ackermann_msgs/msg/AckermannDriveStamped", {"drive": {"speed": 2.0}}),
            "/imu": IMU,
        },
        "signal commanded_speed, person_speed : real [m/s]\nsignal energy : real [J]\n"
        "signal distance : real [m]\nsignal force : real [N]\nsignal temperature : real [degC]\n"
        "signal yaw : real\nsignal lateral_acceleration : real [m/s^2]",
        {
            "commanded_speed": ("/drive drive.speed",),
            "person_speed": OPEN,
            "energy": OPEN,
            "distance": OPEN,
            "force": OPEN,
            "temperature": OPEN,
            "yaw": ("/odom yaw(pose.pose.orientation)", "/imu yaw(orientation)"),
            "lateral_acceleration": ("/imu linear_acceleration.y",),
        },
        {
            "ackermann_msgs/msg/AckermannDriveStamped": "std_msgs/Header header\n"
            "ackermann_msgs/AckermannDrive drive\n" + "=" * 80 + "\n"
            "MSG: ackermann_msgs/AckermannDrive\nfloat32 steering_angle\n"
            "float32 steering_angle_velocity\nfloat32 speed\nfloat32 acceleration\nfloat32 jerk\n"
        },
    ),
}
"""Written down before it was tried."""

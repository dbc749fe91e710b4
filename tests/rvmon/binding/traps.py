"""What looks like what a name asks for, and is not; and robots that were right at once."""

from __future__ import annotations

from tests.rvmon.binding.more_robots import STAMPED_TWIST, TEMPERATURE, WRENCH
from tests.rvmon.binding.robots import (
    BATTERY,
    BOOL,
    FIX,
    FLOAT,
    IMU,
    ODOMETRY,
    OPEN,
    POSE,
    SCAN,
    TEXT,
    TWIST,
    Robot,
    joints,
    speeds,
)

TRAPS = {
    "estimator": Robot(
        {
            "/estimator_innovations": ("flight_msgs/msg/Innovations", {"airspeed": 0.5}),
            "/rate_ctrl_status": ("flight_msgs/msg/RateControl", {"yawspeed_integ": 0.1}),
            "/airspeed_validated": (
                "flight_msgs/msg/Airspeed",
                {"true_airspeed_m_s": 12.0, "selected_airspeed_index": 1},
            ),
        },
        "signal airspeed : real [m/s]\nsignal yaw_rate : real [rad/s]",
        {"airspeed": ("/airspeed_validated true_airspeed_m_s",), "yaw_rate": OPEN},
        {
            "flight_msgs/msg/Innovations": "float32 airspeed\n",
            "flight_msgs/msg/RateControl": "float32 yawspeed_integ\n",
            "flight_msgs/msg/Airspeed": "float32 true_airspeed_m_s\nint8 selected_airspeed_index\n",
        },
    ),
    "weather": Robot(
        {"/wind/speed": FLOAT, "/fan/rpm": FLOAT, "/launch_time": FLOAT, "/go_home": BOOL},
        "signal speed : real [m/s]\nsignal wind_speed : real [m/s]\nsignal motor_rpm : real [rpm]\n"
        "event launch, go\nsignal go_home : bool",
        {
            "speed": OPEN,
            "wind_speed": ("/wind/speed data",),
            "motor_rpm": OPEN,
            "launch": OPEN,
            "go": OPEN,
            "go_home": ("/go_home data",),
        },
    ),
    "gripper": Robot(
        {"/joint_states": joints("gripper_joint"), "/target/pose": POSE, "/person/pose": POSE},
        "signal speed : real [m/s]\nsignal position : real [m]\nsignal x : real [m]\n"
        "signal gripper : real [m]\nsignal gripper_speed : real [m/s]\nsignal effort : real [N]",
        {
            "speed": OPEN,
            "position": OPEN,
            "x": OPEN,
            "gripper": ("/joint_states position[gripper_joint]",),
            "gripper_speed": ("/joint_states velocity[gripper_joint]",),
            "effort": OPEN,
        },
    ),
    "parts": Robot(
        {
            "/battery": BATTERY,
            "/engine/temperature": TEMPERATURE,
            "/camera/imu": IMU,
            "/wheel_odom": ODOMETRY,
            "/obstacle/velocity": STAMPED_TWIST,
        },
        "signal temperature, cpu_temperature : real [degC]\nsignal current_limit : real [A]\n"
        "signal speed : real [m/s]\nsignal speed_error : real [m/s]\n"
        "signal yaw_rate_limit : real [rad/s]\n"
        "signal capacity : real [mAh]\nsignal engine_temperature : real [degC]\n"
        "signal obstacle_speed : real [m/s]",
        {
            "temperature": OPEN,
            "cpu_temperature": OPEN,
            "current_limit": OPEN,
            "speed": speeds("/wheel_odom"),
            "speed_error": OPEN,
            "yaw_rate_limit": OPEN,
            "capacity": ("/battery capacity",),
            "engine_temperature": ("/engine/temperature temperature",),
            "obstacle_speed": speeds("/obstacle/velocity", "twist."),
        },
    ),
}
"""What looks like what is asked for, and is not."""

FRESH = {
    "scout": Robot(
        {
            "/scout/odom": ODOMETRY,
            "/scout/status": (
                "scout_msgs/msg/ScoutStatus",
                {"linear_velocity": 0.4, "battery_voltage": 26.0},
            ),
            "/scout/cmd_vel": TWIST,
            "/velodyne/scan": SCAN,
            "/xsens/imu": IMU,
            "/xsens/gnss": FIX,
            "/rtk/fix": FIX,
        },
        "signal linear_velocity : real [m/s]\n"
        "signal battery_voltage : real [V]\n"
        "signal angular_velocity_z : real [rad/s]\n"
        "signal min_distance : real [m]\n"
        "signal longitude : real [deg]\n"
        "signal imu_yaw : real [deg]\n"
        "signal fault_code : int\n"
        "signal desired_speed : real [m/s]\n"
        "signal motor_current : real [A]\n"
        "signal acceleration_z : real [m/s^2]",
        {
            "linear_velocity": (
                "/scout/status linear_velocity",
                "/scout/odom twist.twist.linear.x",
            ),
            "battery_voltage": ("/scout/status battery_voltage",),
            "angular_velocity_z": (
                "/scout/odom twist.twist.angular.z",
                "/xsens/imu angular_velocity.z",
                "",
            ),
            "min_distance": ("/velodyne/scan min(ranges)",),
            "longitude": OPEN,
            "imu_yaw": ("/xsens/imu yaw(orientation)",),
            "fault_code": ("/scout/status fault_code",),
            "desired_speed": speeds("/scout/cmd_vel", ""),
            "motor_current": OPEN,
            "acceleration_z": ("/xsens/imu linear_acceleration.z",),
        },
        {
            "scout_msgs/msg/ScoutStatus": "std_msgs/Header header\n"
            "float64 linear_velocity\n"
            "float64 angular_velocity\n"
            "uint8 base_state\n"
            "uint8 control_mode\n"
            "uint16 fault_code\n"
            "float64 battery_voltage\n"
        },
    ),
    "iiwa": Robot(
        {
            "/iiwa/joint_states": joints(*(f"iiwa_joint_{n}" for n in range(1, 8))),
            "/iiwa/state/CartesianPose": POSE,
            "/iiwa/command/CartesianPose": POSE,
            "/iiwa/state/wrench": WRENCH,
            "/door_open": BOOL,
            "/cell/emergency_stop": BOOL,
            "/cell/light_curtain": BOOL,
            "/hand/state": TEXT,
        },
        "signal joint_2_velocity : real [deg/s]\n"
        "signal joint_6 : real [rad]\n"
        "signal tool_x : real [m]\n"
        "signal cartesian_z : real [m]\n"
        "signal commanded_z : real [m]\n"
        "signal force_x : real [N]\n"
        "signal torque_z : real [N*m]\n"
        "signal door_open : bool\n"
        "signal light_curtain : bool\n"
        "signal door_closed : bool\n"
        "event emergency_stop, door_open_request\n"
        "signal hand_state : {idle, closed}\n"
        "signal tool_temperature : real [degC]",
        {
            "joint_2_velocity": ("/iiwa/joint_states velocity[iiwa_joint_2]",),
            "joint_6": ("/iiwa/joint_states position[iiwa_joint_6]",),
            "tool_x": OPEN,
            "cartesian_z": ("/iiwa/state/CartesianPose pose.position.z",),
            "commanded_z": ("/iiwa/command/CartesianPose pose.position.z",),
            "force_x": ("/iiwa/state/wrench wrench.force.x",),
            "torque_z": ("/iiwa/state/wrench wrench.torque.z",),
            "door_open": ("/door_open data",),
            "light_curtain": ("/cell/light_curtain data",),
            "door_closed": OPEN,
            "emergency_stop": ("/cell/emergency_stop data",),
            "door_open_request": ("/door_open data", ""),
            "hand_state": ("/hand/state data",),
            "tool_temperature": OPEN,
        },
    ),
    "near": Robot(
        {
            "/home": POSE,
            "/mission_item": ("fleet_msgs/msg/Item", {"frame": 3, "seq": 7}),
            "/heartbeat": ("fleet_msgs/msg/Heartbeat", {"base_mode": 81, "custom_mode": 4}),
            "/validity": ("fleet_msgs/msg/Validity", {"z_valid": True}),
            "/position": ("fleet_msgs/msg/Position", {"az": 0.1}),
            "/sensor_accel": ("fleet_msgs/msg/Accel", {"z": 9.8}),
            "/stick": ("fleet_msgs/msg/Stick", {"throttle": 0.5}),
            "/transition": ("fleet_msgs/msg/Transition", {"transition_failure": True}),
            "/power": ("fleet_msgs/msg/Power", {"battery_volt": 12.1, "voltage_v": 12.0}),
            "/wifi": ("fleet_msgs/msg/Wifi", {"rssi": 60, "remote_rssi": 50}),
        },
        "signal heading : real [deg]\n"
        "signal mission_item : int\n"
        "signal mode : {manual, auto}\n"
        "signal validity_valid : bool\n"
        "signal accel_z : real [m/s^2]\n"
        "signal throttle : real [%]\n"
        "signal transition : bool\n"
        "signal power_voltage : real [V]\n"
        "signal rssi : int",
        {
            "heading": OPEN,
            "mission_item": OPEN,
            "mode": OPEN,
            "validity_valid": OPEN,
            "accel_z": ("/sensor_accel z",),
            "throttle": OPEN,
            "transition": OPEN,
            "power_voltage": ("/power voltage_v [V]",),
            "rssi": ("/wifi rssi",),
        },
        {
            "fleet_msgs/msg/Item": "int32 frame\nint32 seq\n",
            "fleet_msgs/msg/Heartbeat": "int32 base_mode\nint32 custom_mode\n",
            "fleet_msgs/msg/Validity": "bool z_valid\nbool other\n",
            "fleet_msgs/msg/Position": "float64 az  # m/s^2\nfloat64 x  # m\n",
            "fleet_msgs/msg/Accel": "float64 z  # m/s^2\nfloat64 x  # m/s^2\n",
            "fleet_msgs/msg/Stick": "float64 throttle\nfloat64 roll\n",
            "fleet_msgs/msg/Transition": "bool transition_failure\nbool other\n",
            "fleet_msgs/msg/Power": "float64 battery_volt\nfloat64 voltage_v\n",
            "fleet_msgs/msg/Wifi": "int32 rssi\nint32 remote_rssi\n",
        },
    ),
}
"""Right at the first attempt; what is near is left open."""

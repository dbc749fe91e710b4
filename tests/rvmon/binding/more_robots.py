"""More recordings, with what should feed which name, written down later."""

from __future__ import annotations

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
    TURNED,
    TWIST,
    Robot,
    joints,
    speeds,
)

RANGE = ("sensor_msgs/msg/Range", {"header": {"frame_id": "sonar_front"}, "range": 1.2})
TEMPERATURE = ("sensor_msgs/msg/Temperature", {"temperature": 41.0})
WRENCH = ("geometry_msgs/msg/WrenchStamped", {"wrench": {"force": {"x": 1.0}}})
STAMPED_TWIST = ("geometry_msgs/msg/TwistStamped", {"twist": {"linear": {"x": 0.2}}})
INT = ("std_msgs/msg/Int32", {"data": 3})

LATER = {
    "fetch": Robot(
        {
            "/base_scan": SCAN,
            "/odom": ODOMETRY,
            "/joint_states": joints(
                *("torso_lift_joint", "head_pan_joint", "head_tilt_joint", "shoulder_pan_joint"),
                *("elbow_flex_joint", "l_gripper_finger_joint", "r_gripper_finger_joint"),
            ),
            "/imu1/imu": IMU,
            "/gripper/imu": IMU,
            "/battery_state": BATTERY,
            "/cmd_vel": TWIST,
            "/base_controller/command": TWIST,
        },
        "signal torso_height : real [m]\nsignal torso_lift : real [m]\n"
        "signal head_pan : real [deg]\n"
        "signal elbow_flex_velocity : real [rad/s]\nsignal nearest_obstacle : real [m]\n"
        "signal gripper_accel_x : real [m/s^2]\nsignal robot_yaw : real [rad]\n"
        "signal battery_current : real [A]\nsignal gripper_force : real [N]\n"
        "signal command_speed : real [m/s]\nsignal gripper_temperature : real [degC]",
        {
            "torso_height": OPEN,
            "torso_lift": ("/joint_states position[torso_lift_joint]",),
            "head_pan": ("/joint_states position[head_pan_joint]",),
            "elbow_flex_velocity": ("/joint_states velocity[elbow_flex_joint]",),
            "nearest_obstacle": ("/base_scan min(ranges)",),
            "gripper_accel_x": ("/gripper/imu linear_acceleration.x",),
            "robot_yaw": ("/odom yaw(pose.pose.orientation)",),
            "battery_current": ("/battery_state current",),
            "gripper_force": OPEN,  # of two fingers
            "command_speed": OPEN,  # two topics command
            "gripper_temperature": OPEN,
        },
    ),
    "rov": Robot(
        {
            "/depth": ("sensor_msgs/msg/FluidPressure", {"fluid_pressure": 120000.0}),
            "/bluerov/heading": FLOAT,
            "/bluerov/thruster_1/rpm": FLOAT,
            "/bluerov/thruster_2/rpm": FLOAT,
            "/dvl/altitude": RANGE,
            "/dvl/velocity": STAMPED_TWIST,
            "/bluerov/leak_detected": BOOL,
            "/bluerov/lights": INT,
            "/bluerov/internal_temperature": TEMPERATURE,
            "/bluerov/external_temperature": TEMPERATURE,
        },
        "signal depth : real [m]\nsignal heading : real [deg]\nsignal thruster_2_rpm : real [rpm]\n"
        "signal altitude : real [m]\nsignal leak : bool\nsignal water_pressure : real [kPa]\n"
        "signal internal_temperature : real [degC]\nsignal temperature : real [degC]\n"
        "signal lights : int\nsignal forward_speed : real [m/s]\nsignal thruster_rpm : real [rpm]",
        {
            "depth": OPEN,  # the topic holds a pressure
            "heading": ("/bluerov/heading data",),
            "thruster_2_rpm": ("/bluerov/thruster_2/rpm data",),
            "altitude": ("/dvl/altitude range",),
            "leak": ("/bluerov/leak_detected data",),
            "water_pressure": OPEN,
            "internal_temperature": ("/bluerov/internal_temperature temperature",),
            "temperature": OPEN,
            "lights": ("/bluerov/lights data",),
            "forward_speed": ("/dvl/velocity twist.linear.x",),
            "thruster_rpm": OPEN,
        },
    ),
    "autoware": Robot(
        {
            "/vehicle/status/velocity_status": (
                "autoware_vehicle_msgs/msg/VelocityReport",
                {"longitudinal_velocity": 8.0},
            ),
            "/vehicle/status/steering_status": (
                "autoware_vehicle_msgs/msg/SteeringReport",
                {"steering_tire_angle": 0.1},
            ),
            "/control/command/control_cmd": (
                "autoware_control_msgs/msg/Command",
                {"velocity": 9.0},
            ),
            "/localization/kinematic_state": ODOMETRY,
            "/localization/acceleration": (
                "geometry_msgs/msg/AccelWithCovarianceStamped",
                {"accel": {"accel": {"linear": {"x": 0.5}}}},
            ),
            "/perception/obstacle_distance": FLOAT,
            "/system/emergency": BOOL,
        },
        "signal longitudinal_velocity : real [m/s]\nsignal steering_angle : real [deg]\n"
        "signal lateral_velocity : real [m/s]\nsignal target_velocity : real [m/s]\n"
        "signal obstacle_distance : real [m]\nsignal emergency : bool\n"
        "signal longitudinal_acceleration : real [m/s^2]\nsignal brake_pressure : real [bar]\n"
        "signal pedestrian_distance : real [m]",
        {
            "longitudinal_velocity": (
                "/vehicle/status/velocity_status longitudinal_velocity",
                "/localization/kinematic_state twist.twist.linear.x",
            ),
            "steering_angle": ("/vehicle/status/steering_status steering_tire_angle",),
            "lateral_velocity": (
                "/vehicle/status/velocity_status lateral_velocity",
                "/localization/kinematic_state twist.twist.linear.y",
            ),
            "target_velocity": ("/control/command/control_cmd velocity",),
            "obstacle_distance": ("/perception/obstacle_distance data",),
            "emergency": ("/system/emergency data",),
            "longitudinal_acceleration": ("/localization/acceleration accel.accel.linear.x",),
            "brake_pressure": OPEN,
            "pedestrian_distance": OPEN,
        },
        {
            "autoware_vehicle_msgs/msg/VelocityReport": "std_msgs/Header header\n"
            "float32 longitudinal_velocity\nfloat32 lateral_velocity\nfloat32 heading_rate\n",
            "autoware_vehicle_msgs/msg/SteeringReport": "builtin_interfaces/Time stamp\n"
            "float32 steering_tire_angle\n",
            "autoware_control_msgs/msg/Command": "float32 velocity\nfloat32 acceleration\n",
        },
    ),
    "franka": Robot(
        {
            "/franka_state_controller/joint_states": joints(
                *(f"panda_joint{number}" for number in range(1, 8))
            ),
            "/franka_state_controller/F_ext": WRENCH,
            "/franka_gripper/joint_states": joints("panda_finger_joint1", "panda_finger_joint2"),
            "/franka_state_controller/ee_pose": POSE,
            "/equilibrium_pose": POSE,
        },
        "signal joint1, joint7 : real [rad]\nsignal joint_4_torque : real [N*m]\n"
        "signal finger_1 : real [mm]\nsignal ee_x, ee_z : real [m]\nsignal ext_force_x : real [N]\n"
        "signal contact : bool\nsignal tcp_speed : real [m/s]",
        {
            "joint1": ("/franka_state_controller/joint_states position[panda_joint1]",),
            "joint7": ("/franka_state_controller/joint_states position[panda_joint7]",),
            "joint_4_torque": ("/franka_state_controller/joint_states effort[panda_joint4]",),
            "finger_1": ("/franka_gripper/joint_states position[panda_finger_joint1]",),
            "ee_x": ("/franka_state_controller/ee_pose pose.position.x",),
            "ee_z": ("/franka_state_controller/ee_pose pose.position.z",),
            "ext_force_x": ("/franka_state_controller/F_ext wrench.force.x",),
            "contact": OPEN,
            "tcp_speed": OPEN,
        },
    ),
    "agv": Robot(
        {
            "/agv/odom": ODOMETRY,
            "/agv/fork/height": FLOAT,
            "/agv/load/weight": FLOAT,
            "/agv/bumper/front": BOOL,
            "/agv/bumper/rear": BOOL,
            "/agv/sonar_left": RANGE,
            "/agv/sonar_right": RANGE,
            "/agv/state": TEXT,
            "/agv/emergency_stop": BOOL,
            "/agv/horn": ("std_msgs/msg/Empty", {}),
            "/agv/goal_pose": POSE,
            "/agv/gps/fix": FIX,
            "/agv/charging": BOOL,
        },
        "signal fork_height : real [cm]\nsignal load_weight : real [kg]\n"
        "signal front_bumper : bool\n"
        "signal bumper : bool\nsignal left_distance : real [m]\nsignal state : {idle, busy}\n"
        "signal goal_x, x : real [m]\nsignal latitude : real [deg]\nsignal charging : bool\n"
        "event horn, estop, rear_bumper\nsignal door_open : bool\nsignal agv_speed : real [m/s]",
        {
            "fork_height": ("/agv/fork/height data",),
            "load_weight": ("/agv/load/weight data",),
            "front_bumper": ("/agv/bumper/front data",),
            "bumper": OPEN,
            "left_distance": ("/agv/sonar_left range",),
            "state": ("/agv/state data",),
            "goal_x": ("/agv/goal_pose pose.position.x",),
            "x": ("/agv/odom pose.pose.position.x",),
            "latitude": ("/agv/gps/fix latitude",),
            "charging": ("/agv/charging data",),
            "horn": ("/agv/horn",),
            "estop": ("/agv/emergency_stop data",),
            "rear_bumper": ("/agv/bumper/rear data",),
            "door_open": OPEN,
            "agv_speed": speeds("/agv/odom"),
        },
    ),
    "quadruped": Robot(
        {
            "/anymal/odometry": ODOMETRY,
            "/anymal/imu": ("sensor_msgs/msg/Imu", TURNED),
            "/anymal/joint_states": joints("LF_HAA", "LF_HFE", "RH_KFE"),
            "/anymal/LF_foot/contact": BOOL,
            "/anymal/RH_foot/contact": BOOL,
            "/anymal/cmd_vel": STAMPED_TWIST,
        },
        "signal LF_HFE_position, knee : real [rad]\nsignal rh_kfe_torque : real [N*m]\n"
        "signal lf_contact, contact : bool\nsignal body_roll_rate : real [rad/s]\n"
        "signal desired_yaw_rate : real [rad/s]\nsignal yaw : real [deg]",
        {
            "LF_HFE_position": ("/anymal/joint_states position[LF_HFE]",),
            "knee": OPEN,
            "rh_kfe_torque": ("/anymal/joint_states effort[RH_KFE]",),
            "lf_contact": ("/anymal/LF_foot/contact data",),
            "contact": OPEN,
            "body_roll_rate": (
                "/anymal/imu angular_velocity.x",
                "/anymal/odometry twist.twist.angular.x",
            ),
            "desired_yaw_rate": ("/anymal/cmd_vel twist.angular.z",),
            "yaw": ("/anymal/odometry yaw(pose.pose.orientation)", "/anymal/imu yaw(orientation)"),
        },
    ),
}

LAST = {
    "ridgeback": Robot(
        {
            "/odometry/filtered": ODOMETRY,
            "/front/scan": SCAN,
            "/rear/scan": SCAN,
            "/mcu/status": ("ridgeback_msgs/msg/Status", {"measured_battery": 24.2}),
            "/motors/feedback": ("puma_motor_msgs/msg/MultiFeedback", {}),
            "/lift/position": FLOAT,
            "/lift/target_position": FLOAT,
            "/lift/max_speed": FLOAT,
            "/ambient/temperature": TEMPERATURE,
            "/joy": ("sensor_msgs/msg/Joy", {"axes": [0.0, 1.0], "buttons": [0, 1]}),
        },
        "signal front_obstacle, obstacle, lift_position, lift_target : real [m]\n"
        "signal lift_speed : real [m/s]\nsignal speed_limit : real [m/s]\n"
        "signal measured_battery : real [V]\nsignal battery_current : real [A]\n"
        "signal left_motor_temperature : real [degC]\nsignal sideways_speed : real [m/s]\n"
        "signal turn_rate : real [deg/s]\nsignal tilt : real [deg]\nsignal roll : real [rad]\n"
        "signal uptime : real [s]\nsignal ambient_temperature : real [degC]\n"
        "signal joystick_x : real",
        {
            "front_obstacle": ("/front/scan min(ranges)",),
            "obstacle": OPEN,
            "lift_position": ("/lift/position data",),
            "lift_target": ("/lift/target_position data",),
            "lift_speed": OPEN,  # there is its limit only
            "speed_limit": OPEN,
            "measured_battery": ("/mcu/status measured_battery",),
            "battery_current": ("/mcu/status current_battery",),
            "left_motor_temperature": OPEN,
            "sideways_speed": ("/odometry/filtered twist.twist.linear.y",),
            "turn_rate": ("/odometry/filtered twist.twist.angular.z",),
            "tilt": OPEN,
            "roll": OPEN,
            "uptime": ("/mcu/status uptime_s",),
            "ambient_temperature": ("/ambient/temperature temperature",),
            "joystick_x": OPEN,
        },
        {
            "ridgeback_msgs/msg/Status": "std_msgs/Header header\nfloat32 uptime_s\n"
            "float64 measured_battery\nfloat64 current_battery\nfloat64 pcb_temperature\n",
            "puma_motor_msgs/msg/MultiFeedback": "std_msgs/Header header\nfloat64 temperature\n",
        },
    ),
    "drone": Robot(
        {
            "/uav1/odometry/odom_main": ODOMETRY,
            "/uav1/garmin/range": RANGE,
            "/uav1/mavros/battery": BATTERY,
            "/uav1/control_manager/position_cmd": POSE,
            "/uav1/wind": STAMPED_TWIST,
            "/uav1/mag": ("sensor_msgs/msg/MagneticField", {}),
            "/uav1/baro": ("sensor_msgs/msg/FluidPressure", {"fluid_pressure": 1e5}),
            "/uav1/baro/temperature": TEMPERATURE,
        },
        "signal height : real [m]\nsignal ground_distance : real [m]\n"
        "signal wind_speed : real [m/s]\n"
        "signal air_speed : real [m/s]\nsignal cmd_z : real [m]\nsignal z : real [m]\n"
        "signal battery_level : real [%]\nsignal mag_x : real [uT]\nsignal pressure : real [kPa]\n"
        "signal climb_rate : real [m/s]\nsignal motor_temperature : real [degC]\n"
        "signal heading_error : real [rad]\nsignal payload_mass : real [kg]\n"
        "signal uav2_x : real [m]",
        {
            "height": ("/uav1/odometry/odom_main pose.pose.position.z",),
            "ground_distance": ("/uav1/garmin/range range", ""),  # is it the ground?
            "wind_speed": speeds("/uav1/wind", "twist."),
            "air_speed": OPEN,
            "cmd_z": ("/uav1/control_manager/position_cmd pose.position.z",),
            "z": ("/uav1/odometry/odom_main pose.pose.position.z",),
            "battery_level": ("/uav1/mavros/battery percentage",),
            "mag_x": ("/uav1/mag magnetic_field.x",),
            "pressure": ("/uav1/baro fluid_pressure",),
            "climb_rate": ("/uav1/odometry/odom_main twist.twist.linear.z",),
            "motor_temperature": OPEN,
            "heading_error": OPEN,
            "payload_mass": OPEN,
            "uav2_x": OPEN,
        },
    ),
    "diagnosed": Robot(
        {
            "/diagnostics": (
                "diagnostic_msgs/msg/DiagnosticArray",
                {
                    "status": [
                        {
                            "name": "left motor",
                            "values": [
                                {"key": "Temperature (C)", "value": "41.5"},
                                {"key": "Mode", "value": "idle"},
                            ],
                        },
                        {
                            "name": "right motor",
                            "values": [{"key": "Temperature (C)", "value": "40.5"}],
                        },
                    ]
                },
            )
        },
        "signal left_motor_temperature, motor_temperature : real [degC]\n"
        "signal left_motor_mode : {idle, busy}\nsignal left_motor_current : real [A]",
        {
            "left_motor_temperature": (
                "/diagnostics number(status[left motor].values[Temperature (C)].value)",
            ),
            "motor_temperature": OPEN,
            "left_motor_mode": ("/diagnostics status[left motor].values[Mode].value",),
            "left_motor_current": OPEN,
        },
    ),
}

"""Recordings of robots that others publish, with what should feed the names that they would write.

Written down before anything was proposed for them. The definitions have the fields, and say the
units, that those of the robots have; the values are made up.
"""

from __future__ import annotations

from tests.rvmon.binding.more_robots import STAMPED_TWIST
from tests.rvmon.binding.robots import BATTERY, BOOL, FIX, IMU, ODOMETRY, OPEN, TWIST, Robot, speeds

STRANGERS = {
    "create3": Robot(
        {
            "/dock_status": ("irobot_create_msgs/msg/DockStatus", {"is_docked": True}),
            "/kidnap_status": ("irobot_create_msgs/msg/KidnapStatus", {}),
            "/slip_status": ("irobot_create_msgs/msg/SlipStatus", {}),
            "/stop_status": ("irobot_create_msgs/msg/StopStatus", {"is_stopped": True}),
            "/wheel_status": (
                "irobot_create_msgs/msg/WheelStatus",
                {"current_ma_left": 120, "current_ma_right": 118, "wheels_enabled": True},
            ),
            "/wheel_vels": ("irobot_create_msgs/msg/WheelVels", {"velocity_left": 3.1}),
            "/wheel_ticks": ("irobot_create_msgs/msg/WheelTicks", {"ticks_left": 9123}),
            "/mouse": ("irobot_create_msgs/msg/Mouse", {"integrated_x": 0.4}),
            "/odom": ODOMETRY,
            "/battery_state": BATTERY,
            "/imu": IMU,
            "/cmd_vel": TWIST,
        },
        "signal docked, kidnapped : bool\nsignal left_wheel_current : real [A]\n"
        "signal right_wheel_velocity : real [rad/s]\nsignal battery_charge : real [%]",
        {
            "docked": ("/dock_status is_docked",),
            "kidnapped": ("/kidnap_status is_kidnapped",),
            "left_wheel_current": ("/wheel_status current_ma_left [mA]",),
            "right_wheel_velocity": ("/wheel_vels velocity_right [rad/s]",),
            "battery_charge": ("/battery_state percentage [1]",),
        },
        {
            "irobot_create_msgs/msg/DockStatus": "std_msgs/Header header\nbool dock_visible\n"
            "bool is_docked\n",
            "irobot_create_msgs/msg/KidnapStatus": "std_msgs/Header header\nbool is_kidnapped\n",
            "irobot_create_msgs/msg/SlipStatus": "std_msgs/Header header\nbool is_slipping\n",
            "irobot_create_msgs/msg/StopStatus": "std_msgs/Header header\nbool is_stopped\n",
            "irobot_create_msgs/msg/WheelStatus": "std_msgs/Header header\n"
            "int16 current_ma_left  # of the left wheel, in milliamps\n"
            "int16 current_ma_right  # of the right wheel, in milliamps\n"
            "int16 pwm_left\nint16 pwm_right\nbool wheels_enabled\n",
            "irobot_create_msgs/msg/WheelVels": "std_msgs/Header header\n"
            "float32 velocity_left  # of the left wheel in rad/sec.\n"
            "float32 velocity_right  # of the right wheel in rad/sec.\n",
            "irobot_create_msgs/msg/WheelTicks": "std_msgs/Header header\nint32 ticks_left\n"
            "int32 ticks_right\n",
            "irobot_create_msgs/msg/Mouse": "std_msgs/Header header\n"
            "float32 integrated_x  # along x in meters.\n"
            "float32 integrated_y  # along y in meters.\nuint32 frame_id\nuint8 last_squal\n",
        },
    ),
    "go2": Robot(
        {
            "/lowstate": (
                "unitree_go/msg/LowState",
                {"bms_state": {"soc": 81, "current": -1350}, "power_v": 29.4, "power_a": 1.3},
            ),
            "/sportmodestate": (
                "unitree_go/msg/SportModeState",
                {"body_height": 0.31, "yaw_speed": 0.2, "gait_type": 1},
            ),
        },
        "signal body_height : real [m]\nsignal yaw_rate : real [deg/s]\n"
        "signal battery_soc : real [%]\nsignal bus_voltage : real [V]\nsignal gait : int",
        {
            "body_height": ("/sportmodestate body_height [m]",),
            "yaw_rate": ("/sportmodestate yaw_speed [rad/s]",),
            "battery_soc": ("/lowstate bms_state.soc [%]",),
            "bus_voltage": ("/lowstate power_v [V]", ""),
            "gait": ("/sportmodestate gait_type",),
        },
        {
            "unitree_go/msg/LowState": "uint8 level_flag\nunitree_go/IMUState imu_state\n"
            "unitree_go/MotorState[20] motor_state\nunitree_go/BmsState bms_state\n"
            "int16[4] foot_force\nuint32 tick\nuint8 bit_flag\nfloat32 adc_reel\n"
            "int8 temperature_ntc1\nint8 temperature_ntc2\nfloat32 power_v\nfloat32 power_a\n"
            "uint16[4] fan_frequency\nuint32 crc\n" + "=" * 80 + "\nMSG: unitree_go/IMUState\n"
            "float32[4] quaternion\nfloat32[3] gyroscope\nfloat32[3] accelerometer\n"
            "float32[3] rpy\nint8 temperature\n" + "=" * 80 + "\nMSG: unitree_go/MotorState\n"
            "uint8 mode\nfloat32 q\nfloat32 dq\nfloat32 tau_est\nint8 temperature\n"
            "uint32 lost\n" + "=" * 80 + "\nMSG: unitree_go/BmsState\nuint8 status\nuint8 soc\n"
            "int32 current\nuint16 cycle\nint8[2] bq_ntc\nint8[2] mcu_ntc\nuint16[15] cell_vol\n",
            "unitree_go/msg/SportModeState": "uint32 error_code\nunitree_go/IMUState imu_state\n"
            "uint8 mode\nfloat32 progress\nuint8 gait_type\nfloat32 foot_raise_height\n"
            "float32[3] position\nfloat32 body_height\nfloat32[3] velocity\nfloat32 yaw_speed\n"
            "float32[4] range_obstacle\nint16[4] foot_force\n" + "=" * 80 + "\n"
            "MSG: unitree_go/IMUState\nfloat32[4] quaternion\nfloat32[3] gyroscope\n"
            "float32[3] accelerometer\nfloat32[3] rpy\nint8 temperature\n",
        },
    ),
    "mkz": Robot(
        {
            "/vehicle/steering_report": (
                "dbw_mkz_msgs/msg/SteeringReport",
                {"steering_wheel_angle": 0.4, "speed": 8.2, "enabled": True},
            ),
            "/vehicle/brake_info_report": (
                "dbw_mkz_msgs/msg/BrakeInfoReport",
                {"brake_torque_actual": 120.0, "abs_enabled": True},
            ),
            "/vehicle/fuel_level_report": (
                "dbw_mkz_msgs/msg/FuelLevelReport",
                {"fuel_level": 62.0},
            ),
            "/vehicle/tire_pressure_report": (
                "dbw_mkz_msgs/msg/TirePressureReport",
                {"front_left": 236.0, "front_right": 235.0, "rear_left": 231.0},
            ),
            "/vehicle/wheel_speed_report": (
                "dbw_mkz_msgs/msg/WheelSpeedReport",
                {"front_left": 24.1, "front_right": 24.2, "rear_left": 24.0},
            ),
            "/vehicle/misc_1_report": (
                "dbw_mkz_msgs/msg/Misc1Report",
                {"outside_temperature": 17.5, "buckle_driver": True},
            ),
            "/vehicle/dbw_enabled": BOOL,
            "/vehicle/gps/fix": FIX,
            "/vehicle/imu/data_raw": IMU,
        },
        "signal steering_wheel_angle : real [deg]\nsignal vehicle_speed : real [km/h]\n"
        "signal tire_pressure_rear_left : real [bar]\nsignal fuel_level : real [%]\n"
        "signal outside_temperature : real [degC]\nsignal driver_door_open, abs_active : bool",
        {
            "steering_wheel_angle": ("/vehicle/steering_report steering_wheel_angle [rad]",),
            "vehicle_speed": ("/vehicle/steering_report speed [m/s]",),
            "tire_pressure_rear_left": ("/vehicle/tire_pressure_report rear_left [kPa]",),
            "fuel_level": ("/vehicle/fuel_level_report fuel_level [%]",),
            "outside_temperature": ("/vehicle/misc_1_report outside_temperature [degC]",),
            "driver_door_open": ("/vehicle/misc_1_report door_driver", ""),
            "abs_active": ("/vehicle/brake_info_report abs_active",),
        },
        {
            "dbw_mkz_msgs/msg/SteeringReport": "std_msgs/Header header\n# Steering Wheel\n"
            "float32 steering_wheel_angle      # rad\nfloat32 steering_wheel_angle_cmd  # rad\n"
            "float32 steering_wheel_torque     # Nm\n# Vehicle Speed\n"
            "float32 speed                     # m/s\nbool enabled\nbool override\nbool timeout\n"
            "bool fault_wdc\nbool fault_calibration\n",
            "dbw_mkz_msgs/msg/BrakeInfoReport": "std_msgs/Header header\n# Wheel torques (Nm)\n"
            "float32 brake_torque_request\nfloat32 brake_torque_actual\n"
            "float32 wheel_torque_actual\n# Acceleration (m/s^2)\nfloat32 accel_over_ground\n"
            "# Brakes\nbool abs_active\nbool abs_enabled\nbool stab_active\nbool stab_enabled\n"
            "bool stationary\n",
            "dbw_mkz_msgs/msg/FuelLevelReport": "std_msgs/Header header\n\n"
            "# Level of fuel (%, 0 to 100)\nfloat32 fuel_level\n",
            "dbw_mkz_msgs/msg/TirePressureReport": "std_msgs/Header header\n\n"
            "# Pressures (kPa)\nfloat32 front_left\nfloat32 front_right\nfloat32 rear_left\n"
            "float32 rear_right\n",
            "dbw_mkz_msgs/msg/WheelSpeedReport": "std_msgs/Header header\n\n# Speeds (rad/s)\n"
            "float32 front_left\nfloat32 front_right\nfloat32 rear_left\nfloat32 rear_right\n",
            "dbw_mkz_msgs/msg/Misc1Report": "std_msgs/Header header\nbool high_beam_headlights\n"
            "# Air outside\nfloat32 outside_temperature # Degrees Celsius\nbool fault_bus\n"
            "bool door_driver\nbool door_passenger\nbool door_rear_left\nbool door_trunk\n"
            "bool passenger_detect\nbool buckle_driver\nbool buckle_passenger\n",
        },
    ),
    "kobuki": Robot(
        {
            "/mobile_base/sensors/core": ("kobuki_msgs/msg/SensorState", {"battery": 161}),
            "/mobile_base/events/bumper": ("kobuki_msgs/msg/BumperEvent", {"state": 1}),
            "/mobile_base/events/wheel_drop": ("kobuki_msgs/msg/WheelDropEvent", {}),
            "/mobile_base/events/cliff": ("kobuki_msgs/msg/CliffEvent", {"bottom": 900}),
            "/mobile_base/commands/velocity": TWIST,
            "/mobile_base/sensors/imu_data": IMU,
            "/odom": ODOMETRY,
        },
        "signal battery_voltage : real [V]\nsignal commanded_speed : real [m/s]\nevent bumper",
        {
            "battery_voltage": OPEN,  # in tenths, and it does not call itself one
            "commanded_speed": tuple(
                f"{one} [m/s]" for one in speeds("/mobile_base/commands/velocity", "")
            ),
            "bumper": ("/mobile_base/events/bumper",),
        },
        {
            "kobuki_msgs/msg/SensorState": "std_msgs/Header header\nuint16 time_stamp\n"
            "uint8  bumper\nuint8  wheel_drop\nuint8  cliff\nuint16 left_encoder\n"
            "uint16 right_encoder\nint8   left_pwm\nint8   right_pwm\nuint8  buttons\n"
            "uint8  charger\nuint8  battery        # voltage in 0.1V (16.1V -> 161)\n"
            "uint16[] bottom\nuint8[] current  # of left and right motor in 10mA\n"
            "uint8   over_current\nuint16   digital_input\nuint16[] analog_input\n",
            "kobuki_msgs/msg/BumperEvent": "uint8 RELEASED=0\nuint8 PRESSED=1\nuint8 bumper\n"
            "uint8 state\n",
            "kobuki_msgs/msg/WheelDropEvent": "uint8 wheel\nuint8 state\n",
            "kobuki_msgs/msg/CliffEvent": "uint8 sensor\nuint8 state\nuint16 bottom\n",
        },
    ),
    "a50": Robot(
        {
            "/dvl/data": (
                "waterlinked_a50_ros_driver/msg/DVL",
                {"velocity": {"x": 0.4, "z": 0.05}, "altitude": 3.2, "velocity_valid": True},
            ),
            "/dvl/json_data": ("std_msgs/msg/String", {"data": "{}"}),
            "/imu/data": IMU,
            "/pressure": ("sensor_msgs/msg/FluidPressure", {"fluid_pressure": 151000.0}),
            "/cmd_vel": TWIST,
        },
        "signal altitude_above_seabed : real [m]\nsignal velocity_valid : bool\n"
        "signal surge_speed : real [m/s]",
        {
            "altitude_above_seabed": ("/dvl/data altitude [m]", ""),
            "velocity_valid": ("/dvl/data velocity_valid",),
            "surge_speed": ("/dvl/data velocity.x [m/s]",),
        },
        {
            "waterlinked_a50_ros_driver/msg/DVL": "std_msgs/Header header\nfloat64 time\n"
            "#Velocity [m/s]\ngeometry_msgs/Vector3 velocity\nfloat64 fom\n"
            "#Altitude of the sensor\nfloat64 altitude\n"
            "waterlinked_a50_ros_driver/DVLBeam[] beams\nbool velocity_valid\nint64 status\n"
            "string form\n" + "=" * 80 + "\nMSG: waterlinked_a50_ros_driver/DVLBeam\nint64 id\n"
            "float64 velocity\nfloat64 distance\nfloat64 rssi\nfloat64 nsd\nbool valid\n"
        },
    ),
    "ardrone": Robot(
        {
            "/ardrone/navdata": (
                "ardrone_autonomy/msg/Navdata",
                {"batteryPercent": 64.0, "state": 3, "altd": 870, "vx": 412.0, "rotY": -2.5},
            ),
            "/ardrone/imu": IMU,
            "/ardrone/takeoff": ("std_msgs/msg/Empty", {}),
            "/ardrone/land": ("std_msgs/msg/Empty", {}),
            "/ardrone/reset": ("std_msgs/msg/Empty", {}),
            "/cmd_vel": TWIST,
        },
        "signal battery_percent : real [%]\nsignal altitude : real [m]\n"
        "signal forward_velocity : real [m/s]\nevent takeoff",
        {
            "battery_percent": ("/ardrone/navdata batteryPercent [%]",),
            "altitude": ("/ardrone/navdata altd [cm]", ""),
            "forward_velocity": ("/ardrone/navdata vx [mm/s]",),
            "takeoff": ("/ardrone/takeoff",),
        },
        {
            "ardrone_autonomy/msg/Navdata": "std_msgs/Header header\n\n"
            "# 0: no battery, 100: a full one\nfloat32 batteryPercent\nuint32 state\n"
            "int32 magX\nint32 magY\nint32 magZ\n\nint32 pressure\nint32 temp\n"
            "float32 wind_speed\nfloat32 wind_angle\n\n# tilt to the left in degrees\n"
            "float32 rotX\n\n# tilt to the front in degrees\nfloat32 rotY\n\n"
            "# orientation in degrees\nfloat32 rotZ\n\n# altitude (cm)\nint32 altd\n\n"
            "# velocity (mm/sec)\nfloat32 vx\n\n# velocity (mm/sec)\nfloat32 vy\n\n"
            "# velocity (mm/sec)\nfloat32 vz\n\n# accelerations (unit: g)\nfloat32 ax\n"
            "float32 ay\nfloat32 az\n\n# commands (0 to 255)\nuint8 motor1\nuint8 motor2\n"
            "uint8 motor3\nuint8 motor4\n\nuint32 tags_count\nfloat32[] tags_distance\n"
            "float32 tm\n"
        },
    ),
    "carla": Robot(
        {
            "/carla/ego_vehicle/vehicle_status": (
                "carla_msgs/msg/CarlaEgoVehicleStatus",
                {"velocity": 7.5, "control": {"throttle": 0.4, "gear": 2}},
            ),
            "/carla/ego_vehicle/vehicle_control_cmd": (
                "carla_msgs/msg/CarlaEgoVehicleControl",
                {"throttle": 0.4},
            ),
            "/carla/ego_vehicle/collision": (
                "carla_msgs/msg/CarlaCollisionEvent",
                {"other_actor_id": 12},
            ),
            "/carla/ego_vehicle/imu": IMU,
            "/carla/ego_vehicle/gnss": FIX,
            "/carla/ego_vehicle/target_velocity": STAMPED_TWIST,
        },
        "signal ego_speed : real [m/s]\nsignal handbrake : bool\nevent collision",
        {
            "ego_speed": ("/carla/ego_vehicle/vehicle_status velocity [m/s]",),
            "handbrake": ("/carla/ego_vehicle/vehicle_status control.hand_brake",),
            "collision": ("/carla/ego_vehicle/collision",),
        },
        {
            "carla_msgs/msg/CarlaEgoVehicleStatus": "std_msgs/Header header\nfloat32 velocity\n"
            "geometry_msgs/Accel acceleration\ngeometry_msgs/Quaternion orientation\n"
            "carla_msgs/CarlaEgoVehicleControl control\n" + "=" * 80 + "\n"
            "MSG: carla_msgs/CarlaEgoVehicleControl\nstd_msgs/Header header\n"
            "float32 throttle\nfloat32 steer\nfloat32 brake\nbool hand_brake\nbool reverse\n"
            "int32 gear\nbool manual_gear_shift\n",
            "carla_msgs/msg/CarlaEgoVehicleControl": "std_msgs/Header header\n"
            "float32 throttle\nfloat32 steer\nfloat32 brake\nbool hand_brake\nbool reverse\n"
            "int32 gear\nbool manual_gear_shift\n",
            "carla_msgs/msg/CarlaCollisionEvent": "std_msgs/Header header\n"
            "uint32 other_actor_id\ngeometry_msgs/Vector3 normal_impulse\n",
        },
    ),
}
"""Thirty names of seven robots, the first set: a place, and the unit in which it is there."""

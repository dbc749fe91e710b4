"""More recordings of robots that others publish; see `strangers`."""

from __future__ import annotations

from tests.rvmon.binding.more_robots import WRENCH
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
    TWIST,
    Robot,
    joints,
    speeds,
)

VECTOR = ("geometry_msgs/msg/Vector3Stamped", {"vector": {"x": 1.5, "y": -12.0, "z": 88.0}})

MORE_STRANGERS = {
    "mir": Robot(
        {
            "/bms_data": (
                "mir_msgs/msg/BMSData",
                {"pack_voltage": 50.1, "state_of_charge": 78.0, "temperature": 24},
            ),
            "/safety_status": ("mir_msgs/msg/SafetyStatus", {"max_lin_speed": 1.5}),
            "/odom": ODOMETRY,
            "/f_scan": SCAN,
            "/b_scan": SCAN,
            "/cmd_vel": TWIST,
        },
        "signal battery_voltage : real [V]\nsignal state_of_charge : real [%]\n"
        "signal battery_temperature : real [degC]\nsignal emergency_stop : bool",
        {
            "battery_voltage": ("/bms_data pack_voltage [V]",),
            "state_of_charge": ("/bms_data state_of_charge [%]",),
            "battery_temperature": ("/bms_data temperature [degC]",),
            "emergency_stop": ("/safety_status in_emergency_stop",),
        },
        {
            "mir_msgs/msg/BMSData": "float64 pack_voltage\nfloat64 charge_current\n"
            "float64 discharge_current\nfloat64 state_of_charge\n"
            "float64 remaining_time_to_full_charge\nint32 remaining_capacity\n"
            "int32 state_of_health\nint32 status_flags\nint32 temperature\n"
            "uint32[] cell_voltage\nuint32 cell_voltage_diff\nfloat64 full_voltage\n"
            "int32 full_capacity\nint32 temperature2\nint32 temperature_pcb\n"
            "int32 cycle_count\nfloat64 status_chargefet_voltage\n"
            "float64 last_battery_msg_time\n",
            "mir_msgs/msg/SafetyStatus": "bool is_connected\nbool is_firmware_ok\n"
            "int32 firmware_version\nbool in_protective_stop\nbool in_emergency_stop\n"
            "bool sto_feedback\nbool is_restart_required\nbool is_safety_muted\n"
            "float64 max_lin_speed\nfloat64 max_rot_speed\nbool is_limited_speed_active\n"
            "bool is_lifter_down\nbool in_sleep_mode\nbool in_manual_mode\n",
        },
    ),
    "ublox": Robot(
        {
            "/ublox/navpvt": (
                "ublox_msgs/msg/NavPVT",
                {"numSV": 14, "lat": 481234567, "gSpeed": 5200, "hAcc": 850, "heading": 9000000},
            ),
            "/ublox/fix": FIX,
            "/ublox/fix_velocity": ("geometry_msgs/msg/TwistWithCovarianceStamped", {}),
            "/imu/data": IMU,
        },
        "signal gps_ground_speed : real [m/s]\nsignal horizontal_accuracy : real [m]\n"
        "signal num_satellites : int\nsignal latitude : real [deg]",
        {
            "gps_ground_speed": ("/ublox/navpvt gSpeed [mm/s]", ""),
            "horizontal_accuracy": ("/ublox/navpvt hAcc [mm]",),
            "num_satellites": ("/ublox/navpvt numSV",),
            "latitude": ("/ublox/fix latitude [deg]",),
        },
        {
            "ublox_msgs/msg/NavPVT": "uint8 CLASS_ID = 1\n\nuint32 iTOW  # of the week [ms]\n"
            "uint8 hour\nuint8 min\nuint8 sec\nuint8 valid\nuint32 tAcc  # estimate [ns]\n"
            "int32 nano  # [ns], range -1e9 .. 1e9\nuint8 fixType\nuint8 flags\nuint8 numSV\n"
            "int32 lon  # Longitude [deg / 1e-7]\nint32 lat  # Latitude [deg / 1e-7]\n"
            "int32 height  # above Ellipsoid [mm]\nint32 hMSL  # above mean sea level [mm]\n"
            "uint32 hAcc  # Horizontal Accuracy [mm]\nuint32 vAcc  # Vertical Accuracy [mm]\n"
            "int32 velN  # to the north [mm/s]\nint32 velE  # to the east [mm/s]\n"
            "int32 velD  # down [mm/s]\nint32 gSpeed  # Ground Speed (2-D) [mm/s]\n"
            "int32 heading  # of motion 2-D [deg / 1e-5]\nuint32 sAcc  # of speed [mm/s]\n"
            "uint32 headAcc  # of heading\nuint16 pDOP  # [1 / 0.01]\n"
            "int32 headVeh  # of the vehicle (2-D) [deg / 1e-5]\n"
            "int16 magDec  # Declination [deg / 1e-2]\n"
        },
    ),
    "dji": Robot(
        {
            "/dji_osdk_ros/height_above_takeoff": ("std_msgs/msg/Float32", {"data": 21.5}),
            "/dji_osdk_ros/battery_state": BATTERY,
            "/dji_osdk_ros/gimbal_angle": VECTOR,
            "/dji_osdk_ros/velocity": VECTOR,
            "/dji_osdk_ros/rtk_velocity": VECTOR,
            "/dji_osdk_ros/rtk_yaw": ("std_msgs/msg/Int16", {"data": 143}),
            "/dji_osdk_ros/gps_position": FIX,
            "/dji_osdk_ros/rtk_position": FIX,
            "/dji_osdk_ros/imu": IMU,
            "/dji_osdk_ros/flight_status": ("std_msgs/msg/UInt8", {"data": 2}),
            "/dji_osdk_ros/rc": ("sensor_msgs/msg/Joy", {"axes": [0.0, 0.2]}),
        },
        "signal height_above_takeoff : real [m]\nsignal battery_level : real [%]\n"
        "signal rtk_yaw : real [deg]\nsignal gimbal_pitch : real [deg]",
        {
            "height_above_takeoff": ("/dji_osdk_ros/height_above_takeoff data [m]",),
            "battery_level": ("/dji_osdk_ros/battery_state percentage [1]",),
            "rtk_yaw": ("/dji_osdk_ros/rtk_yaw data [deg]",),
            "gimbal_pitch": OPEN,  # nothing says which axis it is
        },
    ),
    "raptor": Robot(
        {
            "/vehicle/misc_report": (
                "raptor_dbw_msgs/msg/MiscReport",
                {"fuel_level": 55.0, "vehicle_speed": 31.0, "ambient_temp": 12.0},
            ),
            "/vehicle/low_voltage_system_report": (
                "raptor_dbw_msgs/msg/LowVoltageSystemReport",
                {"vehicle_battery_volts": 13.8, "dbw_battery_volts": 13.1},
            ),
            "/vehicle/steering_report": (
                "raptor_dbw_msgs/msg/SteeringReport",
                {"steering_wheel_angle": 21.0, "steering_wheel_angle_cmd": 22.0},
            ),
            "/vehicle/driver_input_report": ("raptor_dbw_msgs/msg/DriverInputReport", {}),
            "/vehicle/imu/data_raw": IMU,
            "/vehicle/twist": ("geometry_msgs/msg/TwistStamped", {}),
        },
        "signal vehicle_battery_voltage : real [V]\nsignal steering_angle : real [deg]\n"
        "signal ambient_temperature : real [degC]\nsignal driver_door_ajar : bool",
        {
            "vehicle_battery_voltage": (
                "/vehicle/low_voltage_system_report vehicle_battery_volts [V]",
            ),
            "steering_angle": ("/vehicle/steering_report steering_wheel_angle [deg]",),
            "ambient_temperature": ("/vehicle/misc_report ambient_temp [degC]",),
            "driver_door_ajar": ("/vehicle/driver_input_report driver_door_ajar",),
        },
        {
            "raptor_dbw_msgs/msg/MiscReport": "std_msgs/Header header\n\n"
            "float32 fuel_level          # %\n\nbool drive_by_wire_enabled\n\n"
            "float32 vehicle_speed       # km/h\n\nbool general_actuator_fault\n"
            "bool by_wire_ready\nbool comms_fault\n\nfloat32 ambient_temp # degrees-C\n",
            "raptor_dbw_msgs/msg/LowVoltageSystemReport": "std_msgs/Header header\n\n"
            "float32 dbw_battery_volts # Volts\nfloat32 vehicle_battery_volts # Volts\n"
            "float32 vehicle_battery_current # Amps\nfloat32 vehicle_alternator_current #Amps\n"
            "float32 dcdc_current # Amps\nbool aux_inverter_contactor\n",
            "raptor_dbw_msgs/msg/SteeringReport": "std_msgs/Header header\n\n# Steering Wheel\n"
            "float32 steering_wheel_angle      # degrees\n"
            "float32 steering_wheel_angle_cmd  # degrees\n"
            "float32 steering_wheel_torque     # 0 to 100%\n\nbool enabled\n"
            "bool driver_activity\nuint8 rolling_counter\n",
            "raptor_dbw_msgs/msg/DriverInputReport": "std_msgs/Header header\n\n# Doors\n"
            "bool driver_door_ajar\nbool passenger_door_ajar\nbool rear_left_door_ajar\n"
            "bool rear_right_door_ajar\nbool liftgate_ajar\nbool any_seatbelt_unbuckled\n"
            "bool airbag_deployed\nbool door_or_hood_ajar\n",
        },
    ),
    "kinova": Robot(
        {
            "/j2n6s300_driver/out/joint_angles": ("kinova_msgs/msg/JointAngles", {"joint3": 74.0}),
            "/j2n6s300_driver/out/joint_torques": ("kinova_msgs/msg/JointTorque", {"joint3": 2.0}),
            "/j2n6s300_driver/out/joint_state": joints(
                *(f"j2n6s300_joint_{number}" for number in range(1, 7)),
                *(f"j2n6s300_joint_finger_{number}" for number in range(1, 4)),
            ),
            "/j2n6s300_driver/out/tool_pose": POSE,
            "/j2n6s300_driver/out/tool_wrench": WRENCH,
            "/j2n6s300_driver/out/finger_position": ("kinova_msgs/msg/FingerPosition", {}),
        },
        "signal joint_3 : real [deg]\nsignal tool_force_z : real [N]\nsignal tool_x : real [m]",
        {
            "joint_3": (
                "/j2n6s300_driver/out/joint_state position[j2n6s300_joint_3] [rad]",
                "/j2n6s300_driver/out/joint_angles joint3 [deg]",
            ),
            "tool_force_z": ("/j2n6s300_driver/out/tool_wrench wrench.force.z [N]",),
            "tool_x": ("/j2n6s300_driver/out/tool_pose pose.position.x [m]",),
        },
        {
            "kinova_msgs/msg/JointAngles": "".join(f"float32 joint{n}\n" for n in range(1, 8)),
            "kinova_msgs/msg/JointTorque": "".join(f"float32 joint{n}\n" for n in range(1, 8)),
            "kinova_msgs/msg/FingerPosition": "".join(f"float32 finger{n}\n" for n in (1, 2, 3)),
        },
    ),
    "novatel": Robot(
        {
            "/novatel/bestvel": (
                "novatel_gps_msgs/msg/NovatelVelocity",
                {"horizontal_speed": 6.1, "track_ground": 201.0, "vertical_speed": 0.1},
            ),
            "/novatel/heading2": (
                "novatel_gps_msgs/msg/NovatelHeading2",
                {"heading": 199.0, "baseline_length": 1.2},
            ),
            "/novatel/inspva": (
                "novatel_gps_msgs/msg/Inspva",
                {"latitude": 48.1, "roll": 1.2, "azimuth": 199.5},
            ),
            "/novatel/fix": FIX,
            "/sonar_depth": FLOAT,
        },
        "signal speed_over_ground : real [m/s]\nsignal vertical_speed : real [m/s]\n"
        "signal heading : real [deg]",
        {
            "speed_over_ground": ("/novatel/bestvel horizontal_speed [m/s]",),
            "vertical_speed": ("/novatel/bestvel vertical_speed [m/s]",),
            "heading": ("/novatel/heading2 heading [deg]",),
        },
        {
            "novatel_gps_msgs/msg/NovatelVelocity": "std_msgs/Header header\n"
            "string solution_status\nstring velocity_type\n\n# of the time tag in seconds.\n"
            "float32 latency\n\n# Age in seconds\nfloat32 age\n\n"
            "# Over ground, meters/second\nfloat64 horizontal_speed\n\n"
            "# Direction over ground with respect to true North, degrees\n"
            "float64 track_ground\n\n# Upwards, meters/second\nfloat64 vertical_speed\n",
            "novatel_gps_msgs/msg/NovatelHeading2": "std_msgs/Header header\n"
            "string solution_status\nstring position_type\n\n# Length (m)\n"
            "float32 baseline_length\n\n# Heading in degrees [0,360)\nfloat32 heading\n\n"
            "# Pitch in degrees +- 90\nfloat32 pitch\n\n# Deviations (deg)\n"
            "float32 heading_sigma\nfloat32 pitch_sigma\n\nuint8 num_satellites_tracked\n",
            "novatel_gps_msgs/msg/Inspva": "std_msgs/Header header\nuint32 week\n"
            "float64 seconds\nfloat64 latitude\nfloat64 longitude\nfloat64 height\n"
            "float64 north_velocity\nfloat64 east_velocity\nfloat64 up_velocity\n"
            "float64 roll\nfloat64 pitch\nfloat64 azimuth\nstring status\n",
        },
    ),
    "amr": Robot(
        {
            "/base/odometry": ODOMETRY,
            "/base/cmd_vel": TWIST,
            "/scan_front": SCAN,
            "/scan_rear": SCAN,
            "/joint_states": joints("lift_joint", "elbow_joint"),
            "/imu/data": IMU,
            "/ambient/light": ("sensor_msgs/msg/Illuminance", {"illuminance": 320.0}),
            "/ambient/humidity": ("sensor_msgs/msg/RelativeHumidity", {"relative_humidity": 0.4}),
            "/gps/fix": FIX,
            "/power/main_battery": BATTERY,
            "/safety/bumper": BOOL,
        },
        "signal travel_speed : real [m/s]\n"
        "signal nearest_behind, altitude, lift_height : real [m]\n"
        "signal brightness : real [lx]\nsignal humidity : real [%]\n"
        "signal roll_angle : real [rad]\n"
        "signal bus_voltage : real [V]\nevent bumper_hit",
        {
            "travel_speed": speeds("/base/odometry"),
            "nearest_behind": ("/scan_rear min(ranges) [m]",),
            "altitude": ("/gps/fix altitude [m]",),
            "lift_height": OPEN,  # a position of a joint may count from anywhere
            "brightness": ("/ambient/light illuminance [lx]",),
            "humidity": ("/ambient/humidity relative_humidity [1]",),
            "roll_angle": ("/imu/data roll(orientation) [rad]",),
            "bus_voltage": OPEN,  # there may be several
            "bumper_hit": ("/safety/bumper data",),
        },
    ),
}
"""Thirty-one names of seven robots; eight more were bound in public logs."""
